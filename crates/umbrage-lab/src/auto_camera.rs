//! A standpoint that shows much of a scene's lit surface, found with rays.
//!
//! Takes triangles, lights and the lens; gives eye and target. Two stages: a panorama of rays
//! from many candidate eyes (near lights, at eye level over floors), then whole pictures of 16
//! by 9 rays for the best windows of those panoramas and for views of the scene from outside.
//! Deterministic: candidates are drawn from fixed seeds, and scored independently.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use rayon::prelude::*;
use umbrage_core::{Light, LightShape, Mesh};

use crate::seeded_lights::{Random, Surface};

/// Where to stand and what to look at; feed it to [`umbrage_core::View::look_at`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standpoint {
    /// World space, relative to the world origin.
    pub eye: Vec3,
    /// A point ahead, about as far as the surfaces in the picture.
    pub target: Vec3,
}

/// Eyes drawn near lights, and again as many over floors.
const EYES: usize = 256;
/// Panorama: columns around, and rows from [`LOWEST`] up, each [`ROW`] higher.
const COLUMNS: usize = 24;
const ROWS: usize = 8;
const LOWEST: f32 = -54.0 * PI / 180.0;
const ROW: f32 = 12.0 * PI / 180.0;
/// Windows of panoramas that are looked at closely, at most [`PER_EYE`] from one eye.
const FINALISTS: usize = 32;
const PER_EYE: usize = 2;
/// Lights beyond this many are thinned out evenly before they are sampled.
const LIGHTS: usize = 2048;
/// Shadow rays a surface point.
const SHADOW_RAYS: usize = 3;
/// What a view from outside is worth beside one from within: of a world, and of an object.
const OUTSIDE_WORLD: f32 = 0.6;
const OUTSIDE_OBJECT: f32 = 3.0;

/// The best standpoint found for a lens of `fovy_rad` (vertical, full angle) and `aspect`
/// (width over height). Triangles that cast from their front alone are taken as invisible from
/// behind, so give the mesh as the scene's materials have it, before any override.
pub fn auto_camera(mesh: &Mesh, lights: &[Light], fovy_rad: f32, aspect: f32) -> Standpoint {
    let surface = Surface::new(mesh);
    if surface.is_empty() {
        return Standpoint {
            eye: Vec3::ZERO,
            target: Vec3::NEG_Z,
        };
    }
    let search = Search::new(surface, lights, fovy_rad, aspect);
    let eyes: Vec<Vec3> = search.eyes();

    let mut windows: Vec<Shot> = eyes
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, &eye)| search.windows(number, eye))
        .collect();
    windows.sort_by(|a, b| b.score.total_cmp(&a.score));
    windows.truncate(FINALISTS);

    let mut shots: Vec<Shot> = windows.iter().flat_map(Shot::neighbours).collect();
    shots.extend(search.outside());
    shots
        .par_iter_mut()
        .for_each(|shot| search.look_closely(shot));
    // The first of equals, whatever the order in which threads finished.
    let best = shots
        .iter()
        .rev()
        .max_by(|a, b| a.score.total_cmp(&b.score));
    best.map_or(
        Standpoint {
            eye: Vec3::ZERO,
            target: Vec3::NEG_Z,
        },
        |shot| Standpoint {
            eye: shot.eye,
            target: shot.eye + direction(shot.turn, shot.pitch) * shot.reach,
        },
    )
}

/// An eye, a direction and what it is worth.
#[derive(Clone, Copy, Debug)]
struct Shot {
    eye: Vec3,
    /// Radians about +y, from +z towards +x.
    turn: f32,
    /// Radians above the horizon.
    pitch: f32,
    /// Typical distance of what is seen.
    reach: f32,
    /// Factor on the score.
    worth: f32,
    /// Factor on the value of rays that miss everything: the background of an object is no fault.
    misses: f32,
    score: f32,
}

impl Shot {
    /// The shot and its neighbours, half a panorama step away.
    fn neighbours(&self) -> impl Iterator<Item = Shot> + use<> {
        let shot = *self;
        (0..9).map(move |n| Shot {
            turn: shot.turn + (n % 3) as f32 * 0.13 - 0.13,
            pitch: (shot.pitch + (n / 3) as f32 * 0.1 - 0.1).clamp(-0.8, 0.35),
            ..shot
        })
    }
}

/// What one ray saw.
#[derive(Clone, Copy, Debug)]
struct Glance {
    /// From -1.5 (the back of a wall) to 1 (well lit, well away).
    value: f32,
    /// ln(distance); none for a miss.
    depth: Option<f32>,
    /// Share of the lights tested that are hidden: shadows to look at; none where none was.
    hidden: Option<f32>,
    /// The triangle seen; `u32::MAX` for a miss.
    triangle: u32,
}

struct Search<'a> {
    surface: Surface,
    lights: Vec<&'a Light>,
    /// About a standing person, in the scene's own unit.
    person: f32,
    /// See [`objectness`].
    objectness: f32,
    tan_x: f32,
    tan_y: f32,
}

impl<'a> Search<'a> {
    fn new(surface: Surface, lights: &'a [Light], fovy_rad: f32, aspect: f32) -> Self {
        let stride = lights.len().div_ceil(LIGHTS).max(1);
        let lights: Vec<&Light> = lights
            .iter()
            .step_by(stride)
            .filter(|light| light.position.is_finite() && light.range > 0.0)
            .collect();
        let mut ranges: Vec<f32> = lights.iter().map(|light| light.range).collect();
        ranges.retain(|range| range.is_finite());
        ranges.sort_unstable_by(f32::total_cmp);
        // Lamps reach 10 to 15 m in metric scenes, 300 to 400 units in Quake's, where a player
        // is 56 high: a person is about 0.15 of a range in both.
        let size = surface.size();
        let person = match ranges.get(ranges.len() / 2) {
            Some(range) => (0.15 * range).clamp(size / 400.0, size / 25.0),
            None => size / 50.0,
        };
        let tan_y = (fovy_rad * 0.5).tan();
        Self {
            objectness: objectness(&surface),
            surface,
            lights,
            person,
            tan_x: tan_y * aspect,
            tan_y,
        }
    }

    /// Candidate eyes: off lights in a free direction, then brought down towards eye level; and
    /// above surfaces that face up.
    fn eyes(&self) -> Vec<Vec3> {
        let mut random = Random::new(0x5eed);
        let mut eyes = Vec::with_capacity(2 * EYES);
        let lamps: Vec<&Light> = self
            .lights
            .iter()
            .copied()
            .filter(|light| !light.is_directional())
            .collect();
        for number in 0..if lamps.is_empty() { 0 } else { EYES } {
            let lamp = lamps[number * lamps.len() / EYES];
            let away = random.direction();
            let most = lamp.range.min(self.surface.size());
            let free = self
                .surface
                .hit(lamp.position.as_vec3(), away, most)
                .map_or(most, |hit| hit.distance);
            let eye = lamp.position.as_vec3() + away * (free * random.between(0.1, 0.7));
            eyes.push(self.at_eye_level(eye, &mut random));
        }
        for _ in 0..4 * EYES {
            if eyes.len() == eyes.capacity() {
                break;
            }
            let Some((point, normal, two_sided)) = self.surface.random_point(&mut random) else {
                break;
            };
            if normal.y > 0.5 || two_sided && normal.y < -0.5 {
                let level = Vec3::new(point.x, point.y + self.surface.skin() * 4.0, point.z);
                eyes.push(self.at_eye_level(level, &mut random));
            }
        }
        eyes
    }

    /// `point` moved to one to four persons above the floor under it, below half the headroom.
    fn at_eye_level(&self, point: Vec3, random: &mut Random) -> Vec3 {
        let far = self.surface.size();
        let Some(floor) = self.surface.hit(point, Vec3::NEG_Y, far) else {
            return point;
        };
        let above = self
            .surface
            .hit(point, Vec3::Y, far)
            .map_or(far, |hit| hit.distance);
        let level = self.person * [1.0, 1.0, 2.0, 4.0][random.below(4)];
        point + Vec3::Y * (level.min(0.6 * (floor.distance + above)) - floor.distance)
    }

    /// The best windows of the panorama around `eye`.
    fn windows(&self, number: usize, eye: Vec3) -> Vec<Shot> {
        let mut random = Random::new(number as u64);
        let panorama: Vec<Glance> = (0..COLUMNS * ROWS)
            .map(|ray| {
                let turn = (ray % COLUMNS) as f32 * (TAU / COLUMNS as f32);
                self.glance(
                    eye,
                    direction(turn, LOWEST + (ray / COLUMNS) as f32 * ROW),
                    &mut random,
                )
            })
            .collect();
        let closest = panorama
            .iter()
            .filter_map(|glance| glance.depth)
            .fold(f32::MAX, f32::min);
        if closest < (0.2 * self.person).ln() {
            return Vec::new();
        }
        let half_columns = (self.tan_x.atan() / (TAU / COLUMNS as f32)).round() as usize;
        let half_rows = (self.tan_y.atan() / ROW).round() as usize;
        // Close to an object there is much to see, and yet not the object.
        let worth = (1.0 - self.objectness).powi(2);
        let mut seen = Vec::new();
        let mut shots: Vec<Shot> = Vec::new();
        for middle in 0..COLUMNS {
            for row in [2, 3, 4] {
                seen.clear();
                for column in
                    COLUMNS + middle - half_columns.min(8)..=COLUMNS + middle + half_columns.min(8)
                {
                    for row in row - half_rows.min(row)..=(row + half_rows).min(ROWS - 1) {
                        seen.push(panorama[row * COLUMNS + column % COLUMNS]);
                    }
                }
                let turn = middle as f32 * (TAU / COLUMNS as f32);
                let pitch = LOWEST + row as f32 * ROW;
                shots.push(Shot {
                    eye,
                    turn,
                    pitch,
                    reach: 1.0,
                    worth,
                    misses: 1.0,
                    score: judge(&seen),
                });
            }
        }
        shots.sort_by(|a, b| b.score.total_cmp(&a.score));
        let apart = |a: f32, b: f32| ((a - b + PI).rem_euclid(TAU) - PI).abs() > 0.6;
        let mut best: Vec<Shot> = Vec::new();
        for shot in shots {
            if best.len() < PER_EYE && best.iter().all(|other| apart(other.turn, shot.turn)) {
                best.push(shot);
            }
        }
        best
    }

    /// Views from around the scene towards its middle, far enough that all of it is in view.
    fn outside(&self) -> Vec<Shot> {
        let middle = (self.surface.core_min + self.surface.core_max) * 0.5;
        let radius = 0.5 * self.surface.size();
        let away = radius / self.tan_x.min(self.tan_y).atan().sin();
        let worth = OUTSIDE_WORLD + (OUTSIDE_OBJECT - OUTSIDE_WORLD) * self.objectness;
        let shots = (0..48).map(|n| {
            let (turn, pitch) = (
                (n % 16) as f32 * TAU / 16.0 + 0.3,
                -[0.15, 0.4, 0.75][n / 16],
            );
            let eye = middle - direction(turn, pitch) * (0.75 * away);
            Shot {
                eye,
                turn,
                pitch,
                reach: away,
                worth,
                misses: 0.0,
                score: 0.0,
            }
        });
        shots.collect()
    }

    /// Scores a whole picture, and measures its reach.
    fn look_closely(&self, shot: &mut Shot) {
        const WIDE: usize = 16;
        const HIGH: usize = 9;
        let forward = direction(shot.turn, shot.pitch);
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        // One seed for all: neighbours are compared under the same samples.
        let mut random = Random::new(1);
        let seen: Vec<Glance> = (0..WIDE * HIGH)
            .map(|ray| {
                let x = ((ray % WIDE) as f32 + 0.5) / (WIDE as f32 * 0.5) - 1.0;
                let y = ((ray / WIDE) as f32 + 0.5) / (HIGH as f32 * 0.5) - 1.0;
                let ray = forward + right * (x * self.tan_x) + up * (y * self.tan_y);
                let glance = self.glance(shot.eye, ray.normalize(), &mut random);
                let factor = if glance.depth.is_none() {
                    shot.misses
                } else {
                    1.0
                };
                Glance {
                    value: glance.value * factor,
                    ..glance
                }
            })
            .collect();
        let mut depths: Vec<f32> = seen.iter().filter_map(|glance| glance.depth).collect();
        depths.sort_unstable_by(f32::total_cmp);
        shot.reach = depths
            .get(depths.len() / 2)
            .map_or(shot.reach, |depth| depth.exp());
        let score = judge(&seen);
        shot.score = score * if score > 0.0 { shot.worth } else { 1.0 };
    }

    fn glance(&self, eye: Vec3, ray: Vec3, random: &mut Random) -> Glance {
        let Some(hit) = self.surface.hit(eye, ray, 20.0 * self.surface.size()) else {
            // Sky above is no fault; nothing below is.
            let value = if ray.y > 0.0 { -0.1 } else { -0.35 };
            return Glance {
                value,
                depth: None,
                hidden: None,
                triangle: u32::MAX,
            };
        };
        let depth = Some(hit.distance.max(f32::MIN_POSITIVE).ln());
        let seen = |value, hidden| Glance {
            value,
            depth,
            hidden,
            triangle: hit.triangle,
        };
        let persons = hit.distance / self.person;
        if !hit.front || persons < 0.7 {
            return seen(if hit.front { -0.4 } else { -1.5 }, None);
        }
        let point = eye + ray * hit.distance + hit.normal * self.surface.skin();
        let (lit, hidden) = self.light_on(point, hit.normal, random);
        // Rises from 0.4 at arm's length to 1 at twenty persons; the wound back of a two-sided
        // triangle is more often an inside that was not meant to be seen.
        let well_away = 0.4 + 0.6 * (persons.ln() / 20f32.ln()).clamp(0.0, 1.0);
        let wound = if hit.wound_front { 1.0 } else { 0.6 };
        seen((0.2 + 0.8 * lit) * well_away * wound, hidden)
    }

    /// How well a surface point is lit, 0 to 1 in steps that shrink from light to light, and
    /// the share of the lights tested that is hidden from it.
    fn light_on(&self, point: Vec3, normal: Vec3, random: &mut Random) -> (f32, Option<f32>) {
        if self.lights.is_empty() {
            return (0.5, None);
        }
        let mut drawn = [(Vec3::ZERO, 0.0); SHADOW_RAYS];
        let mut count = 0;
        for light in &self.lights {
            let Some(towards) = towards(light, point, self.surface.size()) else {
                continue;
            };
            if towards.0.dot(normal) <= 0.0 {
                continue;
            }
            // Reservoir sampling: each light in reach is drawn with equal chance.
            let slot = if count < SHADOW_RAYS {
                count
            } else {
                random.below(count + 1)
            };
            if let Some(slot) = drawn.get_mut(slot) {
                *slot = towards;
            }
            count += 1;
        }
        if count == 0 {
            return (0.0, None);
        }
        let drawn = &drawn[..count.min(SHADOW_RAYS)];
        let free = drawn
            .iter()
            .filter(|(way, length)| self.surface.is_free(point, *way, *length));
        let visible = free.count() as f32 / drawn.len() as f32;
        (
            1.0 - (-0.7 * visible * count as f32).exp(),
            Some(1.0 - visible),
        )
    }
}

/// From 0 (a world one stands in: walls around, or ground that is wide and flat) to 1 (a thing
/// one looks at: its surface sees no other surface, and it is about as high as wide).
fn objectness(surface: &Surface) -> f32 {
    const SAMPLES: usize = 512;
    let mut random = Random::new(2);
    let mut enclosed = 0;
    for _ in 0..SAMPLES {
        let Some((point, normal, _)) = surface.random_point(&mut random) else {
            break;
        };
        // Two-sided or not, triangles are mostly wound towards where they are meant to be seen.
        let ray = (normal + 0.95 * random.direction()).normalize();
        let start = point + normal * surface.skin();
        enclosed += usize::from(!surface.is_free(start, ray, 20.0 * surface.size()));
    }
    let extent = surface.core_max - surface.core_min;
    let height = extent.y / extent.x.max(extent.z).max(f32::MIN_POSITIVE);
    let open = 1.0 - enclosed as f32 / SAMPLES as f32;
    open * ((height - 0.15) / 0.3).clamp(0.0, 1.0)
}

/// Unit direction and distance to a light whose reach holds `point`.
fn towards(light: &Light, point: Vec3, size: f32) -> Option<(Vec3, f32)> {
    if let LightShape::Directional { direction } = light.shape {
        return Some((-direction, 4.0 * size));
    }
    let way = light.position.as_vec3() - point;
    let squared = way.length_squared();
    if squared > light.range * light.range || squared == 0.0 {
        return None;
    }
    let length = squared.sqrt();
    let way = way / length;
    match light.shape {
        LightShape::Spot {
            direction,
            cos_outer,
        } if -way.dot(direction) < cos_outer => None,
        _ => Some((way, length)),
    }
}

/// A picture's score: the mean of its rays, raised by variety of depth and by shadows, lowered
/// where a few large triangles are all there is.
fn judge(seen: &[Glance]) -> f32 {
    let count = seen.len().max(1) as f32;
    let value = seen.iter().map(|glance| glance.value).sum::<f32>() / count;
    if value <= 0.0 {
        return value;
    }
    let depths: Vec<f32> = seen.iter().filter_map(|glance| glance.depth).collect();
    let mean = depths.iter().sum::<f32>() / depths.len().max(1) as f32;
    let squares = depths
        .iter()
        .map(|depth| (depth - mean).powi(2))
        .sum::<f32>();
    let spread = (squares / count).sqrt().min(1.0);

    let hidden: Vec<f32> = seen.iter().filter_map(|glance| glance.hidden).collect();
    let share = hidden.iter().sum::<f32>() / hidden.len().max(1) as f32;
    let shadows = 4.0 * share * (1.0 - share) * (hidden.len() as f32 / count);

    let mut triangles: Vec<u32> = seen.iter().map(|glance| glance.triangle).collect();
    triangles.sort_unstable();
    triangles.dedup();
    let detail = (triangles.len() as f32 / count).sqrt();
    value * (1.0 + 0.35 * spread + 0.5 * shadows) * (0.3 + 0.7 * detail)
}

/// Unit direction from a turn about +y and a pitch above the horizon.
fn direction(turn: f32, pitch: f32) -> Vec3 {
    Vec3::new(
        turn.sin() * pitch.cos(),
        pitch.sin(),
        turn.cos() * pitch.cos(),
    )
}

/// Plain shapes for the tests of this crate.
#[cfg(test)]
pub(crate) mod shapes {
    use glam::Vec3;
    use umbrage_core::{Casting, Mesh};

    /// A box; with `inward`, a room.
    pub(crate) fn block(low: Vec3, high: Vec3, inward: bool) -> Mesh {
        let corner = |n: usize| {
            Vec3::new(
                [low, high][n & 1].x,
                [low, high][n >> 1 & 1].y,
                [low, high][n >> 2].z,
            )
        };
        let quads = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let mut triangles: Vec<[u32; 3]> = quads
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
            .collect();
        if inward {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let casting = vec![Casting::Front; triangles.len()];
        Mesh {
            positions: (0..8).map(corner).collect(),
            triangles,
            casting,
            ..Mesh::default()
        }
    }

    pub(crate) fn merged(parts: &[Mesh]) -> Mesh {
        let mut all = Mesh::default();
        for part in parts {
            let first = all.positions.len() as u32;
            all.positions.extend(&part.positions);
            all.triangles
                .extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
            all.casting.extend(&part.casting);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::shapes::{block, merged};
    use super::*;
    use umbrage_core::Casting;

    const FOVY: f32 = 0.9;

    fn lamp(x: f32, y: f32, z: f32, range: f32) -> Light {
        Light {
            position: glam::DVec3::new(x.into(), y.into(), z.into()),
            range,
            shape: LightShape::Point,
        }
    }

    fn is_within(p: Vec3, low: Vec3, high: Vec3) -> bool {
        p.cmpgt(low).all() && p.cmplt(high).all()
    }

    #[test]
    fn closed_room_is_seen_from_inside() {
        let (low, high) = (Vec3::new(-6.0, 0.0, -4.0), Vec3::new(6.0, 3.0, 4.0));
        let mut room = merged(&[
            block(low, high, true),
            block(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(0.0, 1.0, 0.5), false),
        ]);
        let lamps = [lamp(2.0, 2.5, 1.0, 12.0), lamp(-4.0, 2.5, -1.0, 12.0)];
        let found = auto_camera(&room, &lamps, FOVY, 16.0 / 9.0);
        assert!(is_within(found.eye, low, high), "{found:?}");
        // Without lights, the walls' backs still tell outside from inside.
        let found = auto_camera(&room, &[], FOVY, 16.0 / 9.0);
        assert!(is_within(found.eye, low, high), "{found:?}");
        // With two-sided walls, the light does.
        room.casting.fill(Casting::Both);
        let found = auto_camera(&room, &lamps, FOVY, 16.0 / 9.0);
        assert!(is_within(found.eye, low, high), "{found:?}");
    }

    #[test]
    fn open_ground_is_seen_from_above() {
        let mut ground = block(
            Vec3::new(-50.0, -1.0, -50.0),
            Vec3::new(50.0, 0.0, 50.0),
            false,
        );
        for (x, z) in [(0.0, 0.0), (-20.0, 10.0), (15.0, -25.0)] {
            let house = block(
                Vec3::new(x, 0.0, z),
                Vec3::new(x + 4.0, 5.0, z + 4.0),
                false,
            );
            ground = merged(&[ground, house]);
        }
        let lamps: Vec<Light> = (0..25)
            .map(|n| {
                lamp(
                    (n % 5) as f32 * 20.0 - 40.0,
                    3.0,
                    (n / 5) as f32 * 20.0 - 40.0,
                    15.0,
                )
            })
            .collect();
        for lights in [&lamps[..], &[]] {
            let found = auto_camera(&ground, lights, FOVY, 16.0 / 9.0);
            assert!(found.eye.y > 0.0, "{found:?}");
        }
    }

    #[test]
    fn a_model_is_seen_from_outside() {
        let (low, high) = (Vec3::ZERO, Vec3::new(0.2, 0.3, 0.1));
        let mut model = block(low, high, false);
        let outside = |found: Standpoint| {
            let towards = ((low + high) * 0.5 - found.eye).normalize();
            !is_within(found.eye, low, high)
                && towards.dot((found.target - found.eye).normalize()) > 0.9
        };
        let found = auto_camera(&model, &[], FOVY, 1.0);
        assert!(outside(found), "{found:?}");
        model.casting.fill(Casting::Both);
        let lights = [lamp(0.4, 0.4, 0.4, 2.0), lamp(-0.4, 0.4, 0.4, 2.0)];
        let found = auto_camera(&model, &lights, FOVY, 1.0);
        assert!(outside(found), "{found:?}");
    }

    #[test]
    fn threads_do_not_change_the_standpoint() {
        let room = block(Vec3::ZERO, Vec3::new(9.0, 3.0, 7.0), true);
        let lamps = [lamp(2.0, 2.5, 1.0, 12.0), lamp(7.0, 2.5, 6.0, 12.0)];
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| auto_camera(&room, &lamps, FOVY, 1.6))
        };
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn nothing_to_see_is_no_panic() {
        let found = auto_camera(&Mesh::default(), &[lamp(0.0, 0.0, 0.0, 1.0)], FOVY, 1.0);
        assert!(found.eye.is_finite() && found.target != found.eye);
    }
}
