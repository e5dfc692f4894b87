// A light's mask at a pixel: what is left of the light there.

@group(2) @binding(0) var masks: texture_2d_array<f32>;
@group(2) @binding(1) var mask_sampler: sampler;
@group(2) @binding(2) var<storage, read> slots: array<Slot>;

fn visibility(light: u32, pixel: vec2f) -> f32 {
    let slot = slots[light];
    let uv = pixel / vec2f(textureDimensions(distance_texture));
    return READ_MASKS[slot.channel];
}
