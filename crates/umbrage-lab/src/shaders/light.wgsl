// One light over its scissor. Which pixels are lit, the stencil test has decided, or
// visibility(light, pixel) does: 0 in shadow, 1 lit. It comes with the method.

struct Light {
    position: vec3f,
    range: f32,
    power: vec3f,
    // 0 point, 1 spot, 2 directional
    kind: u32,
    direction: vec3f,
    cos_outer: f32,
    cos_inner: f32,
    // What f32 leaves of the position.
    residual: vec3f,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> lights: array<Light>;
@group(0) @binding(2) var albedo_texture: texture_2d<f32>;
@group(0) @binding(3) var normal_texture: texture_2d<f32>;
@group(0) @binding(4) var distance_texture: texture_2d<f32>;

struct Varying {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) light: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Varying {
    return Varying(umbrage_light_corner(index, light), light);
}

// From the eye to the surface at a pixel.
fn surface_offset(pixel: vec2f, distance: f32) -> vec3f {
    let size = vec2f(textureDimensions(distance_texture));
    let ndc = vec2f(2.0, -2.0) * pixel / size + vec2f(-1.0, 1.0);
    return distance * (view.forward + view.right * (ndc.x / view.scale_x)
        + view.up * (ndc.y / view.scale_y));
}

// KHR_lights_punctual: inverse square with a window that reaches zero at the range.
fn attenuation(d2: f32, range: f32) -> f32 {
    let ratio2 = d2 / (range * range);
    return clamp(1.0 - ratio2 * ratio2, 0.0, 1.0) / max(d2, 1e-4);
}

// Direction to the light, and what of its power arrives at q from the eye, shadows apart.
fn arriving(light: Light, q: vec3f) -> vec4f {
    if light.kind == 2u {
        return vec4f(-light.direction, 1.0);
    }
    let v = umbrage_minus_eye(view, light.position, light.residual) - q;
    let d2 = dot(v, v);
    let to_light = v * inverseSqrt(max(d2, 1e-12));
    var strength = attenuation(d2, light.range);
    if light.kind == 1u {
        let c = dot(light.direction, -to_light);
        let edge = clamp((c - light.cos_outer)
            / max(light.cos_inner - light.cos_outer, 1e-4), 0.0, 1.0);
        strength *= edge * edge;
    }
    return vec4f(to_light, strength);
}

// What the surface reflects of a light.
fn reflected(in: Varying) -> vec4f {
    let light = lights[in.light];
    let texel = vec2i(in.position.xy);
    let distance = textureLoad(distance_texture, texel, 0).x;
    if distance <= 0.0 {
        return vec4f(0.0);
    }
    let q = surface_offset(in.position.xy, distance);
    let arrives = arriving(light, q);
    let to_light = arrives.xyz;
    var strength = arrives.w;
    if strength > 0.0 {
        strength *= visibility(in.light, in.position.xy);
    }
    if strength <= 0.0 {
        return vec4f(0.0);
    }
    let surface = textureLoad(albedo_texture, texel, 0);
    let to_eye = -normalize(q);
    var n = textureLoad(normal_texture, texel, 0).xyz;
    if dot(n, to_eye) < 0.0 {
        n = -n;
    }
    let cosine = max(dot(n, to_light), 0.0);
    let roughness = max(surface.a, 0.05);
    let shininess = 2.0 / (roughness * roughness * roughness * roughness) - 2.0;
    let half_way = normalize(to_light + to_eye);
    let highlight = 0.04 * (shininess + 8.0) / 25.1327
        * pow(max(dot(n, half_way), 0.0), max(shininess, 1.0));
    let brdf = (surface.rgb / 3.14159265 + highlight) * cosine;
    return vec4f(min(light.power * strength * brdf, vec3f(6e4)), 1.0);
}

@fragment
fn shade(in: Varying) -> @location(0) vec4f {
    return reflected(in);
}

// Counts: a sample in green, one where the light shows (reflected light of at least 1) in blue, and
// there, in alpha, the least part of its range that would do: the pixel gets darker by no more than 1
// and a little of what it has.
@fragment
fn count(in: Varying) -> @location(0) vec4f {
    let added = reflected(in).xyz;
    let most = max(added.x, max(added.y, added.z));
    if most < 1.0 {
        return vec4f(0.0, 1.0, 0.0, 0.0);
    }
    let light = lights[in.light];
    let distance = textureLoad(distance_texture, vec2i(in.position.xy), 0).x;
    let v = umbrage_minus_eye(view, light.position, light.residual)
        - surface_offset(in.position.xy, distance);
    let ratio2 = dot(v, v) / (light.range * light.range);
    // The window of attenuation() at another range, against what must remain.
    let kept = 1.0 - min((1.0 + 0.008 * most) / most, 1.0);
    let share = sqrt(sqrt(ratio2 * ratio2 / (1.0 - (1.0 - ratio2 * ratio2) * kept)));
    return vec4f(0.0, 1.0, 1.0, select(share, 0.0, light.kind == 2u || kept == 0.0));
}

// What the light adds in its shadow too: an eighth of what arrives, from everywhere.
@fragment
fn ambient(in: Varying) -> @location(0) vec4f {
    let texel = vec2i(in.position.xy);
    let distance = textureLoad(distance_texture, texel, 0).x;
    if distance <= 0.0 {
        return vec4f(0.0);
    }
    let light = lights[in.light];
    let strength = arriving(light, surface_offset(in.position.xy, distance)).w / 8.0;
    let albedo = textureLoad(albedo_texture, texel, 0).rgb;
    return vec4f(min(light.power * strength * albedo / 3.14159265, vec3f(6e4)), 0.0);
}

// Whether the light reaches the surface at a pixel, with `slack` on its range and its cone.
fn is_reached(light: Light, pixel: vec2f, slack: f32) -> bool {
    let distance = textureLoad(distance_texture, vec2i(pixel), 0).x;
    let v = umbrage_minus_eye(view, light.position, light.residual)
        - surface_offset(pixel, distance);
    let range = light.range * (1.0 + slack);
    let in_cone = dot(light.direction, -v) >= (light.cos_outer - slack) * length(v);
    let in_reach = dot(v, v) < range * range && (light.kind != 1u || in_cone);
    return distance > 0.0 && (light.kind == 2u || in_reach);
}

// One bit a light, 32 lights a texture: channel by byte, additive. Beyond a light's range and cone
// its volume says nothing; a little slack keeps their own rounding out of the mask.
@fragment
fn mark(in: Varying) -> @location(0) vec4f {
    let bit = in.light & 7u;
    let byte = (in.light >> 3u) & 3u;
    var value = f32(1u << bit) / 255.0;
    if !is_reached(lights[in.light], in.position.xy, 1.0 / 4096.0)
        || visibility(in.light, in.position.xy) < 0.5
    {
        value = 0.0;
    }
    return select(vec4f(0.0), vec4f(value), vec4u(0u, 1u, 2u, 3u) == vec4u(byte));
}

// The same in integers of eleven bits, red, green and blue, for half floats whose alpha is taken.
// Each is multiplied by alpha, which is 0 or 1 exactly: anything else would be other lights' bits.
@fragment
fn mark_wide(in: Varying) -> @location(0) vec4f {
    let bit = in.light & 31u;
    let reached = is_reached(lights[in.light], in.position.xy, 1.0 / 4096.0);
    let value = select(0.0, f32(1u << (bit % 11u)), reached);
    return select(vec4f(0.0), vec4f(value), vec4u(0u, 1u, 2u, 3u) == vec4u(bit / 11u));
}

// Lights that reach a pixel, counted.
@fragment
fn reach(in: Varying) -> @location(0) vec4f {
    let reaches = is_reached(lights[in.light], in.position.xy, 0.0);
    return vec4f(select(0.0, 1.0, reaches), 0.0, 0.0, 0.0);
}

// Light fragments, counted.
@fragment
fn one() -> @location(0) vec4f {
    return vec4f(1.0);
}
