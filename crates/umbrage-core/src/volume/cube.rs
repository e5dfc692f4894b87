//! Faces of a cube around a point light.
//!
//! Takes rays; gives the face that each meets, and its coordinates there: x and y across, z along the
//! face's axis, so that a ray in the face's pyramid has |x| <= z and |y| <= z.

use glam::DVec3;

/// The face that a ray meets: +x -x +y -y +z -z.
pub(super) fn face_of(ray: DVec3) -> u32 {
    let size = ray.abs();
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    2 * axis + u32::from(ray[axis as usize] < 0.0)
}

/// Coordinates in which the face's axis is z: a linear map of length and of dot products.
pub(super) fn to_face(face: u32, r: DVec3) -> DVec3 {
    match face {
        0 => DVec3::new(r.y, r.z, r.x),
        1 => DVec3::new(r.y, r.z, -r.x),
        2 => DVec3::new(r.z, r.x, r.y),
        3 => DVec3::new(r.z, r.x, -r.y),
        4 => r,
        _ => DVec3::new(r.x, r.y, -r.z),
    }
}
