// After what Shadows::wgsl gives, and ShadowMask::WGSL.

struct Surface {
    @builtin(position) @invariant clip: vec4f,
    @location(0) place: vec3f,
    @location(1) @interpolate(flat) normal: vec3f,
}

@vertex
fn shade_vertex(@builtin(vertex_index) index: u32) -> Surface {
    let corner = umbrage_world_corner(index);
    return Surface(corner.clip, corner.place, corner.normal);
}

struct Look {
    position: vec3f,
    range: f32,
    colour: vec3f,
}

@group(1) @binding(0) var<storage, read> looks: array<Look>;
@group(1) @binding(1) var mask: texture_2d_array<f32>;

// All lights at once. An engine would take those of the pixel's cluster.
@fragment
fn shade_fragment(in: Surface) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    var sum = vec3f(0.0);
    for (var light = 0u; light < arrayLength(&looks); light++) {
        let look = looks[light];
        let towards =
            umbrage_minus_eye(umbrage_world_view, look.position, vec3f(0.0)) - in.place;
        let distance = length(towards);
        if distance < look.range && umbrage_lit(mask, vec2i(in.clip.xy), light) {
            let falloff = 1.0 - distance / look.range;
            sum += look.colour * falloff * falloff * max(dot(normal, towards) / distance, 0.0);
        }
    }
    return vec4f(sum, 1.0);
}
