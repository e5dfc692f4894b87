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
    // The view's upper left pixel in its target.
    origin_x: f32,
    origin_y: f32,
    // 1 if depth is near / distance, 0 if it is 1 - near / distance.
    reversed: u32,
    // What f32 leaves of the eye.
    eye_residual: vec3f,
}

// From the eye to a place that is kept as what f32 rounds it to and what that leaves: where they are
// near each other, nothing is lost.
fn umbrage_minus_eye(view: View, rounded: vec3f, residual: vec3f) -> vec3f {
    return (rounded - view.eye) + (residual - view.eye_residual);
}

// Clip position of a world point (w = 1) at q = point - eye, or of the point at infinity (w = 0)
// in direction q. The far plane is infinite.
fn umbrage_clip(view: View, q: vec3f, w: f32) -> vec4f {
    let ahead = dot(view.forward, q);
    let near = view.near * w;
    return vec4f(
        view.scale_x * dot(view.right, q),
        view.scale_y * dot(view.up, q),
        select(ahead - near, near, view.reversed == 1u),
        ahead,
    );
}

// near / distance, from a depth as the depth buffer has it; 0 where there is no surface.
fn umbrage_nearness(view: View, depth: f32) -> f32 {
    return select(1.0 - depth, depth, view.reversed == 1u);
}

// From the eye along the ray through a place in the target, in pixels: as far as the ray goes while
// the distance along the viewing direction grows by 1.
fn umbrage_ray(view: View, pixel: vec2f) -> vec3f {
    let within = pixel - vec2f(view.origin_x, view.origin_y);
    let ndc = vec2f(2.0, -2.0) * within / vec2f(view.width, view.height) + vec2f(-1.0, 1.0);
    return view.forward + view.right * (ndc.x / view.scale_x) + view.up * (ndc.y / view.scale_y);
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
