// The triangle seen at each pixel, from the depth that the surface pass left: 1 + its number.

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

// As in gbuffer.wgsl, so that depths are equal.
@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> Varying {
    let triangle = corner / 3u;
    let a = umbrage_corner(3u * triangle);
    let b = umbrage_corner(3u * triangle + 1u);
    let c = umbrage_corner(3u * triangle + 2u);
    let face = cross(umbrage_between(a, b), umbrage_between(a, c));
    let q = array(umbrage_from_eye(a), umbrage_from_eye(b), umbrage_from_eye(c));
    let size = max(max(length(q[0]), length(q[1])), length(q[2]));
    if umbrage_eye_in_plane(face, q[0], size) {
        return Varying(UMBRAGE_NOWHERE, 0u);
    }
    let p = umbrage_from_eye(umbrage_corner(corner));
    return Varying(umbrage_clip(umbrage_world_view, p, 1.0), triangle);
}

@fragment
fn fragment(in: Varying) -> @location(0) u32 {
    return in.triangle + 1u;
}
