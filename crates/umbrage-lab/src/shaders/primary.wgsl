// The triangle seen at each pixel, from the depth that the surface pass left: 1 + its number.

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> Varying {
    return Varying(umbrage_world_corner(corner).clip, corner / 3u);
}

@fragment
fn fragment(in: Varying) -> @location(0) u32 {
    return in.triangle + 1u;
}
