// Rectangles over a light's rows of pixels, which change its mask in one channel and leave the
// other channels alone: how, the blend states say that each of these goes with.

struct Slot {
    layer: u32,
    channel: u32,
    start: f32,
    dark: f32,
}

@group(0) @binding(0) var<storage, read> slots: array<Slot>;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) light: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return Varying(umbrage_light_corner(index, light), light);
}

// `value` in the light's channel, `other` elsewhere.
fn chosen(light: u32, value: f32, other: f32) -> vec4f {
    let is_ours = vec4u(0u, 1u, 2u, 3u) == vec4u(slots[light].channel);
    return select(vec4f(other), vec4f(value), is_ours);
}

@fragment
fn start(in: Varying) -> @location(0) vec4f {
    return chosen(in.light, slots[in.light].start, 1.0);
}

@fragment
fn one(in: Varying) -> @location(0) vec4f {
    return chosen(in.light, 1.0, 0.0);
}

@fragment
fn half_of_one(in: Varying) -> @location(0) vec4f {
    return chosen(in.light, 0.5, 0.0);
}

// Others are below the largest half float.
@fragment
fn at_most_one(in: Varying) -> @location(0) vec4f {
    return chosen(in.light, 1.0, 65504.0);
}

@fragment
fn dark(in: Varying) -> @location(0) vec4f {
    return chosen(in.light, slots[in.light].dark, 1.0);
}
