// Light to screen: the same exposure, curve and colours as Lit::to_rgb8 of the lab.

struct Tone {
    exposure: f32,
}

@group(0) @binding(0) var<uniform> tone: Tone;
@group(0) @binding(1) var light_texture: texture_2d<f32>;
@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var distance_texture: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn luminance(c: vec3f) -> f32 {
    return dot(c, vec3f(0.2126, 0.7152, 0.0722));
}

fn filmic(color: vec3f) -> vec3f {
    let y = max(luminance(color), 1e-6);
    let x = y * 0.8;
    let mapped = clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    let scaled = color * (mapped / y);
    let most = max(scaled.r, max(scaled.g, scaled.b));
    if most > 1.0 {
        let fade = (most - 1.0) / max(most - mapped, 1e-6);
        return clamp(mix(scaled, vec3f(mapped), fade), vec3f(0.0), vec3f(1.0));
    }
    return scaled;
}

fn srgb(c: vec3f) -> vec3f {
    let low = 12.92 * c;
    let high = 1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055;
    return select(high, low, c <= vec3f(0.0031308));
}

@fragment
fn fragment(@builtin(position) position: vec4f) -> @location(0) vec4f {
    let texel = vec2i(position.xy);
    if textureLoad(distance_texture, texel, 0).x <= 0.0 {
        return vec4f(srgb(filmic(vec3f(0.004, 0.006, 0.011))), 1.0);
    }
    let light = textureLoad(light_texture, texel, 0).rgb;
    // What is seen where no light falls: the base colour as the texture has it, by a plain power.
    let base = pow(srgb(textureLoad(albedo_texture, texel, 0).rgb), vec3f(2.2));
    return vec4f(srgb(filmic(light * tone.exposure + base * 0.035)), 1.0);
}
