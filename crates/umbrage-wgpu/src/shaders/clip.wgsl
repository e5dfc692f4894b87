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
