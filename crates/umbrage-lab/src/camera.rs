//! Cameras of scenes as views.

use glam::DVec3;
use umbrage_core::View;
use umbrage_scene::Camera;

/// The view of a scene's camera whose position, relative to the world origin, is `eye`.
pub fn view(camera: &Camera, eye: DVec3, near: f32, size: [u32; 2]) -> View {
    let right = camera.forward.cross(camera.up).normalize();
    let scale_y = (1.0 / (camera.fovy_rad * 0.5).tan()) as f32;
    View {
        eye,
        right: right.as_vec3(),
        up: camera.up.as_vec3(),
        forward: camera.forward.as_vec3(),
        near,
        scale_x: scale_y * size[1] as f32 / size[0] as f32,
        scale_y,
        size,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_camera_becomes_the_view_that_looks_the_same_way() {
        let (eye, target) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(-4.0, 1.0, 8.0));
        let camera = Camera::look_at("c", eye, target, 1.0);
        let ours = view(&camera, eye, 0.1, [640, 360]);
        let theirs = View::look_at(eye.as_vec3(), target.as_vec3(), 1.0, 0.1, [640, 360]);
        for (a, b) in [
            (ours.right, theirs.right),
            (ours.up, theirs.up),
            (ours.forward, theirs.forward),
        ] {
            assert!(a.distance(b) < 1e-6, "{a} {b}");
        }
        assert!((ours.scale_x - theirs.scale_x).abs() < 1e-6);
    }
}
