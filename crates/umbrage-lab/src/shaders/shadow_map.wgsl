// Lit or not by a shadow map: the four nearest texels compared and weighted by the sampler.

@group(2) @binding(0) var<uniform> map: ShadowMap;
@group(2) @binding(1) var depths: texture_depth_2d_array;
@group(2) @binding(2) var compare: sampler_comparison;

// +x, -x, +y, -y, +z, -z.
fn cube_face(v: vec3f) -> u32 {
    let a = abs(v);
    if a.x >= a.y && a.x >= a.z {
        return select(0u, 1u, v.x < 0.0);
    }
    if a.y >= a.z {
        return select(2u, 3u, v.y < 0.0);
    }
    return select(4u, 5u, v.z < 0.0);
}

fn visibility(light: u32, pixel: vec2f) -> f32 {
    let distance = textureLoad(distance_texture, vec2i(pixel), 0).x;
    let q = surface_offset(pixel, distance) + ((view.eye - map.faces[0].origin) + view.eye_residual);
    var number = 0u;
    if map.count == 6u {
        number = cube_face(q);
    }
    let face = map.faces[number];
    let clip = shadow_clip(face, q);
    let uv = vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5;
    // A texel's width is a share of the distance, or of the width of what parallel light shows.
    var depth = clip.z / clip.w;
    if face.length > 0.0 {
        depth += BIAS / (min(face.scale_x, face.scale_y) * face.length);
    } else {
        depth *= 1.0 + BIAS / face.scale_x;
    }
    return textureSampleCompareLevel(depths, compare, uv, number, depth);
}
