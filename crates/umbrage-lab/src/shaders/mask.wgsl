// Rectangles over a light's rows of pixels, which change its mask in one channel and leave the
// other channels alone: how, the blend states say that each of these goes with.

// Whether a row reaches from one side of the scissor to the other, past the receivers: faces do, and
// a mask that is read filtered is read there.
override whole_rows: bool = false;

@group(0) @binding(0) var<storage, read> slots: array<Slot>;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) color: vec4f,
}

fn place(index: u32, light: u32) -> vec4f {
    let seen = umbrage_light_corner(index, light);
    if !whole_rows || umbrage_spans.rows == 0u {
        return seen;
    }
    // Its corners as umbrage_light_corner numbers them.
    let corner = index % 6u;
    let right = corner == 2u || corner == 3u || corner == 5u;
    return vec4f(select(-1.0, 1.0, right), seen.yzw);
}

// `value` in the light's channel, `other` elsewhere.
fn rectangle(index: u32, light: u32, value: f32, other: f32) -> Varying {
    let is_ours = vec4u(0u, 1u, 2u, 3u) == vec4u(slots[light].channel);
    let color = select(vec4f(other), vec4f(value), is_ours);
    return Varying(place(index, light), color);
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

// Other channels are at most 1: each light's mask is normalised before the next one is drawn, over
// all that is left of it. Beside spans a mask that is not normalised may be infinite, where nobody
// reads it.
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
