// After what Shadows::wgsl gives.

struct Surface {
    @builtin(position) @invariant clip: vec4f,
    @location(0) normal: vec3f,
}

@vertex
fn surface_vertex(@builtin(vertex_index) index: u32) -> Surface {
    let corner = umbrage_world_corner(index);
    return Surface(corner.clip, corner.normal);
}

@fragment
fn surface_fragment(in: Surface) -> @location(0) vec4f {
    // What stands in `position.w` is one over the distance ahead of the eye.
    return vec4f(normalize(in.normal), 1.0 / in.clip.w);
}

struct Look {
    position: vec3f,
    range: f32,
    colour: vec3f,
}

@group(1) @binding(0) var<storage, read> looks: array<Look>;
@group(1) @binding(1) var surface: texture_2d<f32>;

struct Lit {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) light: u32,
}

@vertex
fn light_vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> Lit {
    return Lit(umbrage_light_corner(index, light), light);
}

// Only where the light is not in shadow.
@fragment
fn light_fragment(in: Lit) -> @location(0) vec4f {
    let at = textureLoad(surface, vec2i(in.clip.xy), 0);
    let look = looks[in.light];
    let place = at.w * umbrage_ray(umbrage_view, in.clip.xy);
    let towards = umbrage_minus_eye(umbrage_view, look.position, vec3f(0.0)) - place;
    let distance = length(towards);
    let falloff = max(1.0 - distance / look.range, 0.0);
    let cosine = max(dot(at.xyz, towards) / distance, 0.0);
    return vec4f(look.colour * falloff * falloff * cosine, 1.0);
}
