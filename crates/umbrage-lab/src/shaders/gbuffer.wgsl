// Depth and surface of the nearest triangle. Vertices are pulled from the world's own buffers, and
// clip positions come from umbrage_clip, so that depth agrees with the volumes to the last bit.

struct Surface {
    base_color: vec4f,
    // roughness, metallic, unused, unused
    params: vec4f,
}

// Of the triangles from the one whose number is the instance index on.
@group(0) @binding(0) var<storage, read> triangle_material: array<u32>;
// One packed normal a corner, or a single entry where the scene has none.
@group(0) @binding(1) var<storage, read> normals: array<u32>;
// One pair a corner, or a single entry where the scene has none.
@group(0) @binding(2) var<storage, read> uvs: array<vec2f>;
@group(0) @binding(3) var<storage, read> materials: array<Surface>;
@group(1) @binding(0) var base_color_texture: texture_2d<f32>;
@group(1) @binding(1) var base_color_sampler: sampler;

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) distance: f32,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @location(3) @interpolate(flat) material: u32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32, @builtin(instance_index) start: u32) -> Varying {
    let ours = umbrage_world_corner(corner);
    var out: Varying;
    out.clip = ours.clip;
    out.distance = out.clip.w;
    out.material = triangle_material[corner / 3u - start];
    out.normal = ours.normal;
    let at = corner - 3u * start;
    if arrayLength(&normals) > 1u && normals[at] != 0u {
        out.normal = unpack4x8snorm(normals[at]).xyz;
    }
    if arrayLength(&uvs) > 1u {
        out.uv = uvs[at];
    }
    return out;
}

struct Targets {
    @location(0) albedo: vec4f,
    @location(1) normal: vec4f,
    @location(2) distance: f32,
}

@fragment
fn fragment(in: Varying) -> Targets {
    let material = materials[in.material];
    let texel = textureSample(base_color_texture, base_color_sampler, in.uv);
    var out: Targets;
    out.albedo = vec4f(material.base_color.rgb * texel.rgb, material.params.x);
    let length2 = dot(in.normal, in.normal);
    out.normal = vec4f(select(vec3f(0.0), in.normal * inverseSqrt(length2), length2 > 0.0), 1.0);
    out.distance = in.distance;
    return out;
}
