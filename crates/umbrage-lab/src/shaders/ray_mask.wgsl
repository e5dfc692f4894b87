// Lit or not by the bit that the rays left.

@group(2) @binding(0) var bits: texture_2d_array<u32>;

fn visibility(light: u32, pixel: vec2f) -> f32 {
    let layer = (light >> 5u) % LAYERS;
    return f32((textureLoad(bits, vec2i(pixel), layer, 0).x >> (light & 31u)) & 1u);
}
