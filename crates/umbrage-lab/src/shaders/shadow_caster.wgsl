// A light's casters into one face of its map. Vertices are pulled from the world's own buffers.

@group(0) @binding(0) var<uniform> map: ShadowMap;
// Triangles that cast, face after face.
@group(0) @binding(1) var<storage, read> casters: array<u32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32, @builtin(instance_index) face: u32)
    -> @builtin(position) vec4f
{
    let p = umbrage_place(umbrage_corner(3u * casters[index / 3u] + index % 3u)).rounded;
    return shadow_clip(map.faces[face], p - map.faces[face].origin);
}
