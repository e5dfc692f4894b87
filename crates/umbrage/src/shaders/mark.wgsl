// A light's bit of the mask, drawn where the stencil says that it is lit.

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) light: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return Varying(umbrage_light_corner(index, light), light);
}

// Bits add up: each is drawn once.
@fragment
fn mark(in: Varying) -> @location(0) vec4f {
    let byte = (in.light >> 3u) & 3u;
    let value = f32(1u << (in.light & 7u)) / 255.0;
    return select(vec4f(0.0), vec4f(value), vec4u(0u, 1u, 2u, 3u) == vec4u(byte));
}
