// The triangle seen at each pixel, from the depth that the surface pass left: 1 + its number.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@group(0) @binding(2) var<storage, read> triangles: array<u32>;

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

fn corner_position(corner: u32) -> vec3f {
    let i = 3u * triangles[corner];
    return vec3f(positions[i], positions[i + 1u], positions[i + 2u]);
}

// As in gbuffer.wgsl, so that depths are equal.
@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> Varying {
    let triangle = corner / 3u;
    let p = corner_position(corner);
    let a = corner_position(3u * triangle);
    let b = corner_position(3u * triangle + 1u);
    let c = corner_position(3u * triangle + 2u);
    let face = cross(b - a, c - a);
    let q = array(a - view.eye, b - view.eye, c - view.eye);
    let size = max(max(length(q[0]), length(q[1])), length(q[2]));
    if umbrage_eye_in_plane(face, q[0], size) {
        return Varying(UMBRAGE_NOWHERE, 0u);
    }
    return Varying(umbrage_clip(view, p - view.eye, 1.0), triangle);
}

@fragment
fn fragment(in: Varying) -> @location(0) u32 {
    return in.triangle + 1u;
}
