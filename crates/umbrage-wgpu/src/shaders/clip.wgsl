// The one place where clip positions come from. Every pass that must agree about depth includes
// this file: a position computed twice must have the same bits twice.

struct View {
    eye: vec3f,
    scale_x: f32,
    right: vec3f,
    scale_y: f32,
    up: vec3f,
    near: f32,
    forward: vec3f,
    width: f32,
    height: f32,
    // What f32 leaves of the eye.
    eye_residual: vec3f,
}

// From the eye to a place that is kept as what f32 rounds it to and what that leaves: where they are
// near each other, nothing is lost.
fn umbrage_minus_eye(view: View, rounded: vec3f, residual: vec3f) -> vec3f {
    return (rounded - view.eye) + (residual - view.eye_residual);
}

// Clip position of a world point (w = 1) at q = point - eye, or of the point at infinity (w = 0)
// in direction q. Reversed, infinite depth: near / distance.
fn umbrage_clip(view: View, q: vec3f, w: f32) -> vec4f {
    return vec4f(
        view.scale_x * dot(view.right, q),
        view.scale_y * dot(view.up, q),
        view.near * w,
        dot(view.forward, q),
    );
}

// Whether the eye, as far as f32 can tell, lies in the plane of a polygon: `normal` of any length,
// `q` from the eye to a point of the plane, `size` from the eye to the farthest vertex. Such a
// polygon is seen edge-on and covers no pixel; rounded, it may cover half of them, at any depth. So
// the depth pass and the volumes leave it out alike.
fn umbrage_eye_in_plane(normal: vec3f, q: vec3f, size: f32) -> bool {
    return abs(dot(normal, q)) <= UMBRAGE_ROUNDING * size * length(normal);
}

// What clip positions are rounded by, as a share of the distance: 2^-22.
const UMBRAGE_ROUNDING: f32 = 1.0 / 4194304.0;

// Where the corners of a polygon that is left out go.
const UMBRAGE_NOWHERE = vec4f(0.0, 0.0, 0.0, 1.0);
