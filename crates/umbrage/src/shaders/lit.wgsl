// Whether a light reaches the surface at a pixel of the mask's target. Range, cone and facing are the
// host's to apply: beyond them the answer may be either.
fn umbrage_lit(mask: texture_2d_array<f32>, pixel: vec2i, light: u32) -> bool {
    let lights = pack4x8unorm(textureLoad(mask, pixel, light / 32u, 0));
    return ((lights >> (light % 32u)) & 1u) == 1u;
}
