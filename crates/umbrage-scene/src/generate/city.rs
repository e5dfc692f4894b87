//! `gen:city`: blocks of houses between lamp-lit streets.
//!
//! Takes a number of triangles and of lights; gives as many whole blocks around the centre as the
//! triangles allow, the last one partly built and filled with market crates. More triangles make
//! the city larger, not denser. Invariant: a block and its lamps depend on the seed and the block's
//! place only, so a larger city contains the smaller one, lights included. Lights beyond the built
//! blocks stand where lamps will be when the city grows that far.

use glam::{DAffine3, DVec3, Vec3, vec3};

use super::house::{self, Paint};
use super::rng::Rng;
use super::shape::{cuboid, glow, paint, quad, tube};
use crate::{Camera, Instance, Light, LightKind, Material, Mesh, Progress, Scene};

/// Side of a block with half the streets around it, and half of a street's width, in metres.
const PITCH: f32 = 48.0;
const STREET: f32 = 5.0;
const PAVEMENT: f32 = 2.5;
const LAMP_HEIGHT: f32 = 4.6;
const LAMPS_A_BLOCK: usize = 12;

const ASPHALT: u32 = 0;
const STONE: u32 = 1;
const GRASS: u32 = 2;
const IRON: u32 = 3;
const SHADE: u32 = 4;
const BULB: u32 = 5;
const WOOD: u32 = 6;
const TRIM: u32 = 7;
const GLASS: u32 = 8;
const LIT: u32 = 9;
const SHEET: u32 = 10;
const ROOFS: u32 = 11;
const FACADES: u32 = 14;
const FACADE_COUNT: u32 = 9;

/// Builds the city.
pub(super) fn build(
    triangles: u64,
    lights: usize,
    seed: u64,
    moon: bool,
    progress: &dyn Progress,
) -> Scene {
    let mut scene = Scene {
        materials: materials(),
        ..Scene::default()
    };
    progress.stage("city", triangles);
    // A block has at least 2000 triangles; lamps take the blocks that they need.
    let blocks = (triangles / 2000 + 4).max(lights.div_ceil(LAMPS_A_BLOCK) as u64 * 2 + 16);
    let places = places(blocks as usize);
    let mut left = triangles as usize;
    for &place in &places {
        if left == 0 {
            break;
        }
        let mesh = block(seed, place, left);
        left = left.saturating_sub(mesh.triangles.len());
        let (name, number) = (mesh.name.clone(), scene.meshes.len() as u32);
        let transform = DAffine3::from_translation(corner(place).as_dvec3());
        scene.meshes.push(mesh);
        scene.instances.push(Instance {
            name,
            mesh: number,
            transform,
            ..Instance::default()
        });
        progress.advance(triangles - left as u64);
    }
    scene.lights = lamps(seed, &places, lights);
    if moon {
        scene.lights.push(Light {
            name: "moon".to_owned(),
            direction: DVec3::new(-0.4, -0.8, -0.45).normalize(),
            color: vec3(0.6, 0.7, 1.0),
            intensity: 0.4,
            kind: LightKind::Directional,
            ..Light::default()
        });
    }
    let street = [DVec3::new(1.4, 1.7, 26.0), DVec3::new(-1.0, 3.2, -20.0)];
    scene
        .cameras
        .push(Camera::look_at("street", street[0], street[1], 1.1));
    let side = f64::from(PITCH) * (scene.instances.len() as f64).sqrt();
    let above = DVec3::new(0.35, 0.45, 0.75) * side.max(60.0);
    scene
        .cameras
        .push(Camera::look_at("overview", above, DVec3::ZERO, 0.9));
    scene
}

/// The places of the `count` blocks nearest to the crossing at the centre of the world.
fn places(count: usize) -> Vec<[i64; 2]> {
    let reach = (count as f64).sqrt() as i64 / 2 + 8;
    let mut places: Vec<[i64; 2]> = (-reach..reach)
        .flat_map(|x| (-reach..reach).map(move |z| [x, z]))
        .collect();
    places.sort_by_key(|&[x, z]| {
        let (x2, z2) = (2 * x + 1, 2 * z + 1);
        (x2 * x2 + z2 * z2, x, z)
    });
    places.truncate(count);
    places
}

/// The corner of a block with the least x and z, in whole metres.
fn corner([x, z]: [i64; 2]) -> Vec3 {
    vec3(x as f32 * PITCH, 0.0, z as f32 * PITCH)
}

/// A block of at most `most` triangles, relative to its corner.
fn block(seed: u64, place: [i64; 2], most: usize) -> Mesh {
    let name = format!("block_{}_{}", place[0], place[1]);
    let mut mesh = Mesh {
        name,
        ..Mesh::default()
    };
    let mut rng = Rng::new(seed, place);
    ground(&mut mesh);
    for (foot, arm) in lamp_places() {
        lamp(&mut mesh, foot, arm);
    }
    if mesh.triangles.len() > most {
        truncate(&mut mesh, most);
        return mesh;
    }
    let first = STREET + PAVEMENT;
    let lot = [(PITCH - 2.0 * first) / 3.0, (PITCH - 2.0 * first) / 2.0];
    let mut crates = false;
    for number in 0..6u32 {
        let (column, row) = (number % 3, number / 3);
        let low = vec3(
            first + column as f32 * lot[0],
            0.0,
            first + row as f32 * lot[1],
        );
        let mut house = Mesh::default();
        // Drawn even if the lot stays empty: the next one must not depend on it.
        let inset = rng.point(vec3(0.6, 0.0, 0.8), vec3(1.4, 0.0, 3.2));
        let (from, to) = (low + inset, low + vec3(lot[0] - 0.8, 0.0, lot[1] - 1.2));
        let colours = Paint {
            wall: FACADES + rng.below(FACADE_COUNT),
            trim: TRIM,
            roof: ROOFS + rng.below(3),
            sheet: SHEET,
            glass: GLASS,
            lit: LIT,
        };
        house::build(&mut house, &mut rng, from, to, colours);
        if mesh.triangles.len() + house.triangles.len() > most {
            let room = most - mesh.triangles.len();
            if !crates {
                market(&mut mesh, low, lot, room);
            }
            crates = true;
        } else if !crates {
            append(&mut mesh, house);
        }
    }
    mesh
}

/// Street, pavement and yard: 2 + 10 + 2 triangles.
fn ground(mesh: &mut Mesh) {
    let square = |inset: f32, y: f32| {
        let (l, h) = (inset, PITCH - inset);
        [vec3(l, y, l), vec3(l, y, h), vec3(h, y, h), vec3(h, y, l)]
    };
    quad(mesh, square(0.0, 0.0), ASPHALT);
    let kerb = 0.14;
    cuboid(
        mesh,
        vec3(STREET, 0.0, STREET),
        vec3(PITCH - STREET, kerb, PITCH - STREET),
        STONE,
    );
    quad(mesh, square(STREET + PAVEMENT, kerb + 0.02), GRASS);
}

/// Foot of each lamp of a block, and the direction of its arm over the street.
fn lamp_places() -> impl Iterator<Item = (Vec3, Vec3)> {
    let (near, far) = (STREET + 0.5, PITCH - STREET - 0.5);
    let step = (far - near) / 3.0;
    (0..3).flat_map(move |i| {
        let a = near + step * (i as f32 + 0.5);
        [
            (vec3(a, 0.14, near), Vec3::NEG_Z),
            (vec3(near, 0.14, a), Vec3::NEG_X),
            (vec3(a, 0.14, far), Vec3::Z),
            (vec3(far, 0.14, a), Vec3::X),
        ]
    })
}

/// A post, an arm, an open shade of one layer, and a bulb above the light.
fn lamp(mesh: &mut Mesh, foot: Vec3, arm: Vec3) {
    tube(mesh, foot, [0.09, 0.05], LAMP_HEIGHT + 0.5, IRON);
    let head = foot + arm * 1.1 + Vec3::Y * LAMP_HEIGHT;
    let from = foot + Vec3::Y * (LAMP_HEIGHT + 0.44);
    let to = head + Vec3::Y * 0.5;
    let thick = Vec3::splat(0.03);
    cuboid(mesh, from.min(to) - thick, from.max(to) + thick, IRON);
    tube(mesh, head + Vec3::Y * 0.1, [0.42, 0.0], 0.36, SHADE);
    let bulb = head + Vec3::Y * 0.2;
    cuboid(
        mesh,
        bulb - Vec3::splat(0.06),
        bulb + Vec3::splat(0.06),
        BULB,
    );
}

/// The lights of the lamps nearest to the centre.
fn lamps(seed: u64, places: &[[i64; 2]], count: usize) -> Vec<Light> {
    let mut lights = Vec::with_capacity(places.len() * LAMPS_A_BLOCK);
    for &place in places {
        let mut rng = Rng::new(seed ^ 0x1A3B_5C7D, place);
        for (foot, arm) in lamp_places() {
            let position = corner(place) + foot + arm * 1.1 + Vec3::Y * (LAMP_HEIGHT - 0.02);
            // From candle to warm white; one in nine is a cool replacement.
            let warm = rng.unit();
            let color = match rng.one_in(9) {
                true => vec3(0.78, 0.88, 1.0),
                false => vec3(1.0, 0.56 + 0.2 * warm, 0.22 + 0.3 * warm),
            };
            lights.push(Light {
                position: position.as_dvec3(),
                color,
                intensity: rng.within(55.0, 95.0),
                range: Some(rng.within(12.0, 18.0)),
                ..Light::default()
            });
        }
    }
    lights.sort_by(|a, b| {
        a.position
            .length_squared()
            .total_cmp(&b.position.length_squared())
    });
    lights.truncate(count);
    for (number, light) in lights.iter_mut().enumerate() {
        light.name = format!("lamp_{number}");
    }
    lights
}

/// Fills what is left of the triangles with stacks of crates on one lot.
fn market(mesh: &mut Mesh, low: Vec3, lot: [f32; 2], room: usize) {
    let (columns, rows) = ((lot[0] / 1.2) as usize, (lot[1] / 1.2) as usize);
    for number in 0..room.div_ceil(12) {
        let (layer, place) = (number / (columns * rows), number % (columns * rows));
        let at = vec3(
            (place % columns) as f32,
            layer as f32 * 0.85,
            (place / columns) as f32,
        ) * 1.2;
        let at = low + at + Vec3::Y * 0.16;
        cuboid(mesh, at, at + vec3(0.9, 0.9, 0.9), WOOD);
    }
    let most = mesh.triangles.len() - (room.div_ceil(12) * 12 - room);
    truncate(mesh, most);
}

fn truncate(mesh: &mut Mesh, most: usize) {
    mesh.triangles.truncate(most);
    mesh.materials.truncate(most);
}

fn append(mesh: &mut Mesh, other: Mesh) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.triangles
        .extend(other.triangles.into_iter().map(|t| t.map(|v| base + v)));
    mesh.materials.extend(other.materials);
}

/// Every material, at the index of its constant.
fn materials() -> Vec<Material> {
    let mut list = vec![
        paint("asphalt", [0.06, 0.06, 0.07], false),
        paint("paving stone", [0.27, 0.26, 0.24], false),
        paint("grass", [0.10, 0.15, 0.06], false),
        paint("cast iron", [0.03, 0.04, 0.04], false),
        paint("lamp shade", [0.05, 0.12, 0.10], true),
        glow("bulb", [1.0, 0.78, 0.48], 12.0),
        paint("crate", [0.35, 0.22, 0.11], false),
        paint("trim", [0.62, 0.60, 0.55], false),
        paint("window", [0.04, 0.05, 0.08], false),
        glow("lit window", [1.0, 0.68, 0.32], 1.4),
        paint("tin roof", [0.22, 0.27, 0.26], true),
        paint("clay tiles", [0.40, 0.13, 0.07], false),
        paint("slate", [0.11, 0.12, 0.15], false),
        paint("brown tiles", [0.24, 0.13, 0.08], false),
    ];
    let facades = [
        ("ochre", [0.66, 0.45, 0.18]),
        ("rose", [0.63, 0.33, 0.28]),
        ("cream", [0.70, 0.62, 0.45]),
        ("brick", [0.40, 0.14, 0.09]),
        ("sage", [0.34, 0.42, 0.28]),
        ("sky", [0.33, 0.45, 0.55]),
        ("plaster", [0.60, 0.58, 0.54]),
        ("terracotta", [0.56, 0.25, 0.13]),
        ("lilac", [0.43, 0.36, 0.50]),
    ];
    list.extend(facades.map(|(name, rgb)| paint(name, rgb, false)));
    list
}
