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
    @location(0) @interpolate(flat) color: vec4f,
}

// `value` in the light's channel, `other` elsewhere.
fn rectangle(index: u32, light: u32, value: f32, other: f32) -> Varying {
    let is_ours = vec4u(0u, 1u, 2u, 3u) == vec4u(slots[light].channel);
    let color = select(vec4f(other), vec4f(value), is_ours);
    return Varying(umbrage_light_corner(index, light), color);
}

@vertex
fn start(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return rectangle(index, light, slots[light].start, 1.0);
}

@vertex
fn one(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return rectangle(index, light, 1.0, 0.0);
}

@vertex
fn half_of_one(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return rectangle(index, light, 0.5, 0.0);
}

// Other channels are below the largest half float.
@vertex
fn at_most_one(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return rectangle(index, light, 1.0, 65504.0);
}

@vertex
fn dark(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return rectangle(index, light, slots[light].dark, 1.0);
}

@fragment
fn fragment(in: Varying) -> @location(0) vec4f {
    return in.color;
}
