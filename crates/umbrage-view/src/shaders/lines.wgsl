// Segments as rectangles of a width in pixels: an instance a segment, six vertices each.

struct Frame {
    // Times the view's scale.
    right: vec3f,
    near: f32,
    up: vec3f,
    half_width_px: f32,
    forward: vec3f,
    unused: f32,
    // From the eye to the place that segments are relative to.
    anchor: vec3f,
    unused_too: f32,
    size: vec2f,
}

@group(0) @binding(0) var<uniform> frame: Frame;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) color: vec4f,
}

// Reversed, infinite depth, a little nearer than it is: lines stand before the surface they lie on.
fn clip(p: vec3f) -> vec4f {
    let q = p + frame.anchor;
    let nearer = frame.near * (1.0 + 1.0 / 2048.0);
    return vec4f(dot(frame.right, q), dot(frame.up, q), nearer, dot(frame.forward, q));
}

// The end of a segment, cut at the near plane.
fn cut(end: vec4f, other: vec4f) -> vec4f {
    if end.w >= frame.near {
        return end;
    }
    return mix(end, other, (frame.near - end.w) / (other.w - end.w));
}

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @location(0) start: vec3f,
    @location(1) stop: vec3f,
    @location(2) color: vec4f,
) -> Varying {
    let ends = array(clip(start), clip(stop));
    if max(ends[0].w, ends[1].w) <= frame.near {
        return Varying(vec4f(0.0, 0.0, 0.0, 1.0), color);
    }
    let a = cut(ends[0], ends[1]);
    let b = cut(ends[1], ends[0]);
    let along = (b.xy / b.w - a.xy / a.w) * frame.size;
    let ahead = along * inverseSqrt(max(dot(along, along), 1e-12));
    // The first two corners at the start, the others at the end.
    let corners = array(0u, 1u, 2u, 2u, 1u, 3u);
    let corner = corners[index];
    let at_end = corner >= 2u;
    let side = select(-1.0, 1.0, (corner & 1u) == 1u);
    var position = select(a, b, at_end);
    let sideways = vec2f(-ahead.y, ahead.x) * side * frame.half_width_px * 2.0 / frame.size;
    position = vec4f(position.xy + sideways * position.w, min(position.z, position.w), position.w);
    return Varying(position, color);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return in.color;
}
