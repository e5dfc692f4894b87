//! Lights for scenes that bring none, and the ray queries that place them.
//!
//! Takes a mesh, a count and a seed; gives positions in free space near surfaces, and ranges
//! under which neighbours overlap. The same arguments give the same lights, with any number of
//! threads, so that a benchmark can name its lights by count and seed.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use umbrage_core::{Casting, Mesh};

/// Tries for one light before a position in the void behind the walls is accepted.
const TRIES: usize = 24;

/// `count` lights as (position, range in metres): surface points, area for area, moved off the
/// surface along its normal by 15 to 50% of the free distance. Empty for a mesh without area.
pub fn seeded_lights(mesh: &Mesh, count: usize, seed: u64) -> Vec<(Vec3, f32)> {
    place_lights(&Surface::new(mesh), count, seed)
}

/// [`seeded_lights`] over a surface that is there already.
pub(crate) fn place_lights(surface: &Surface, count: usize, seed: u64) -> Vec<(Vec3, f32)> {
    let extent = surface.core_max - surface.core_min;
    // Lights sit one to `spacing` squared of surface: at 1.5 spacings each surface point lies
    // within about seven of them, some behind walls.
    let spacing = (surface.core_area() / count.max(1) as f64).sqrt() as f32;
    let range = (1.5 * spacing).min(0.5 * extent.length());
    let cap = (0.7 * range).min(0.15 * extent.length());
    let mut lights = Vec::with_capacity(count);
    for number in 0..count {
        let mut random = Random::new(seed ^ (number as u64) << 32);
        let Some(light) = place_one(surface, &mut random, cap) else {
            break;
        };
        lights.push((light, range * random.between(0.75, 1.25)));
    }
    lights
}

fn place_one(surface: &Surface, random: &mut Random, cap: f32) -> Option<Vec3> {
    let mut fallback = None;
    for _ in 0..TRIES {
        let (point, mut normal, two_sided) = surface.random_point(random)?;
        if two_sided && random.unit() < 0.5 {
            normal = -normal;
        }
        let start = point + normal * surface.skin();
        let hit = surface.hit(start, normal, cap / 0.15);
        let free = hit.map_or(cap / 0.15, |hit| hit.distance);
        let light = point + normal * (free * random.between(0.15, 0.5)).min(cap);
        if free > 4.0 * surface.skin() && hit.is_none_or(|hit| hit.front) {
            return Some(light);
        }
        fallback.get_or_insert(light);
    }
    fallback
}

/// What a ray met first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceHit {
    /// Numbered among the triangles that have an area.
    pub(crate) triangle: u32,
    pub(crate) distance: f32,
    /// Unit, of the side that was hit.
    pub(crate) normal: Vec3,
    /// Not the culled back of a single-sided triangle.
    pub(crate) front: bool,
    /// Wound towards the ray, whether or not the back counts as a front.
    pub(crate) wound_front: bool,
}

/// A mesh's triangles under ray queries.
pub(crate) struct Surface {
    triangles: Vec<Triangle>,
    two_sided: Vec<bool>,
    bvh: CwBvh,
    /// Areas summed up, of triangles whose centroid lies in the core: to draw by area.
    area_sum: Vec<f64>,
    /// The box between the 2nd and 98th percentile of corners, 5% wider each way: the scene
    /// without its sky box and far backdrop.
    pub(crate) core_min: Vec3,
    pub(crate) core_max: Vec3,
}

impl Surface {
    /// Triangles that are not finite or have no area are left out.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let (mut triangles, mut two_sided) = (Vec::new(), Vec::new());
        for t in 0..mesh.triangles.len() {
            let [v0, v1, v2] = mesh.corners(t).map(|p| Vec3A::from(p.as_vec3()));
            let doubled = (v1 - v0).cross(v2 - v0);
            if doubled.is_finite() && doubled.length_squared() > 0.0 {
                triangles.push(Triangle { v0, v1, v2 });
                two_sided.push(mesh.casting.get(t) == Some(&Casting::Both));
            }
        }
        let (core_min, core_max) = core(&triangles);
        let mut sum = 0.0;
        let area_sum = triangles
            .iter()
            .map(|triangle| {
                if inside(centroid(triangle), core_min, core_max) {
                    sum += f64::from(
                        (triangle.v1 - triangle.v0)
                            .cross(triangle.v2 - triangle.v0)
                            .length(),
                    );
                }
                sum * 0.5
            })
            .collect();
        Self {
            bvh: build_bvh(&triangles),
            triangles,
            two_sided,
            area_sum,
            core_min,
            core_max,
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Diagonal of the core box.
    pub(crate) fn size(&self) -> f32 {
        (self.core_max - self.core_min).length()
    }

    /// Distance by which ray origins are moved off a surface.
    pub(crate) fn skin(&self) -> f32 {
        let reach = self.core_min.abs().max(self.core_max.abs()).max_element();
        (self.size() * 1e-5).max(reach * 4e-6)
    }

    /// The nearest triangle along a unit `direction`, up to `limit`.
    pub(crate) fn hit(&self, origin: Vec3, direction: Vec3, limit: f32) -> Option<SurfaceHit> {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, limit);
        let mut hit = RayHit::none();
        if !self
            .bvh
            .ray_traverse(ray, &mut hit, |ray, id| self.triangle(id).intersect(ray))
        {
            return None;
        }
        let id = hit.primitive_id as usize;
        let wound = Vec3::from(self.triangle(id).compute_normal());
        let wound_front = wound.dot(direction) < 0.0;
        let triangle = self.bvh.primitive_indices[id];
        let two_sided = self.two_sided[triangle as usize];
        Some(SurfaceHit {
            triangle,
            distance: hit.t,
            normal: if wound_front { wound } else { -wound },
            front: wound_front || two_sided,
            wound_front,
        })
    }

    /// Whether nothing stands on the first `length` metres along a unit `direction`.
    pub(crate) fn is_free(&self, origin: Vec3, direction: Vec3, length: f32) -> bool {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, length);
        self.bvh
            .ray_traverse_miss(ray, |ray, id| self.triangle(id).intersect(ray))
    }

    /// A point of the core's surface, area for area: point, unit normal, two-sided.
    pub(crate) fn random_point(&self, random: &mut Random) -> Option<(Vec3, Vec3, bool)> {
        let drawn = f64::from(random.unit()) * self.core_area();
        let at = self.area_sum.partition_point(|&sum| sum <= drawn);
        let triangle = self.triangles.get(at)?;
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let edges = (triangle.v1 - triangle.v0) * u + (triangle.v2 - triangle.v0) * v;
        let point = triangle.v0 + edges;
        Some((
            point.into(),
            triangle.compute_normal().into(),
            self.two_sided[at],
        ))
    }

    fn core_area(&self) -> f64 {
        self.area_sum.last().copied().unwrap_or(0.0)
    }

    fn triangle(&self, id: usize) -> &Triangle {
        &self.triangles[self.bvh.primitive_indices[id] as usize]
    }
}

/// Built on one thread: the builder's chunks, and with them the winner among coplanar
/// triangles, would follow the number of threads.
fn build_bvh(triangles: &[Triangle]) -> CwBvh {
    let build = || {
        build_cwbvh_from_tris(
            triangles,
            BvhBuildParams::fast_build(),
            &mut Duration::default(),
        )
    };
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(one) => one.install(build),
        Err(_) => build(),
    }
}

fn core(triangles: &[Triangle]) -> (Vec3, Vec3) {
    let (mut low, mut high) = (Vec3::ZERO, Vec3::ZERO);
    if triangles.is_empty() {
        return (low, high);
    }
    let stride = triangles.len().div_ceil(8192);
    for axis in 0..3 {
        // Corners, not centroids alone: a room of twelve triangles is as wide as its corners.
        let corners = triangles
            .iter()
            .step_by(stride)
            .flat_map(|t| [t.v0, t.v1, t.v2]);
        let mut along: Vec<f32> = corners.map(|corner| corner[axis]).collect();
        along.sort_unstable_by(f32::total_cmp);
        let last = along.len() - 1;
        (low[axis], high[axis]) = (along[last / 50], along[last - last / 50]);
    }
    let margin = (high - low) * 0.05;
    (low - margin, high + margin)
}

fn centroid(triangle: &Triangle) -> Vec3 {
    ((triangle.v0 + triangle.v1 + triangle.v2) / 3.0).into()
}

fn inside(point: Vec3, low: Vec3, high: Vec3) -> bool {
    point.cmpge(low).all() && point.cmple(high).all()
}

/// SplitMix64 (Steele, Lea and Flood 2014, figure 16): small, and the same everywhere.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Self(seed);
        Self(random.next())
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    pub(crate) fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1_u64 << 24) as f32
    }

    /// In [low, high).
    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Below `count`, which is not 0.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// Unit, evenly over the sphere; by rejection, since sine and cosine differ by platform.
    pub(crate) fn direction(&mut self) -> Vec3 {
        loop {
            let [x, y, z] = [(); 3].map(|()| self.between(-1.0, 1.0));
            let point = Vec3::new(x, y, z);
            if (1e-4..=1.0).contains(&point.length_squared()) {
                return point.normalize();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::auto_camera::shapes::{block, merged};

    #[test]
    fn lights_of_a_room_are_in_its_free_space() {
        // A room of 10 x 4 x 10 m, seen from inside, with a solid crate in the middle.
        let room = block(Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 4.0, 5.0), true);
        let crate_ = block(Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0), false);
        let lights = seeded_lights(&merged(&[room, crate_]), 100, 7);
        assert_eq!(lights.len(), 100);
        for (p, range) in &lights {
            assert!(
                inside(*p, Vec3::new(-5.0, 0.0, -5.0), Vec3::new(5.0, 4.0, 5.0)),
                "{p}"
            );
            assert!(
                !inside(*p, Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 2.0, 1.0)),
                "{p}"
            );
            assert!((0.5..10.0).contains(range), "{range}");
        }
    }

    #[test]
    fn seed_decides() {
        let mesh = block(Vec3::ZERO, Vec3::ONE, true);
        assert_eq!(seeded_lights(&mesh, 9, 1), seeded_lights(&mesh, 9, 1));
        assert_ne!(seeded_lights(&mesh, 9, 1), seeded_lights(&mesh, 9, 2));
    }

    #[test]
    fn no_area_no_lights() {
        assert!(seeded_lights(&Mesh::default(), 64, 0).is_empty());
        let flat = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::NAN],
            triangles: vec![[0, 1, 1], [0, 1, 2]],
            casting: vec![Casting::Front; 2],
            ..Mesh::default()
        };
        assert!(seeded_lights(&flat, 64, 0).is_empty());
    }
}
