// Volume geometry by vertex pulling: sides from one u32 a quad, caps from one u32 a triangle.
// The instance index is the light's number.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@group(0) @binding(2) var<storage, read> edges: array<vec2u>;
@group(0) @binding(3) var<storage, read> triangles: array<u32>;
@group(0) @binding(4) var<storage, read> quads: array<u32>;
@group(0) @binding(5) var<storage, read> caps: array<u32>;
@group(0) @binding(6) var<storage, read> lights: array<vec4f>;

fn position(vertex: u32) -> vec3f {
    let i = 3u * vertex;
    return vec3f(positions[i], positions[i + 1u], positions[i + 2u]);
}

// Sides recede from the eye by 2^-21 of the distance: what is counted at a surface are the sides
// before the point that much nearer. Under a grazing light the sides of a triangle run below its
// own surface by less than depth resolves; receding, they stay below. Screen positions are the
// same, so nothing opens, and the eye count stays. Caps do not recede: they must tie with the
// surface that they lie in.
const RECEDE: f32 = 1.0 - 1.0 / 2097152.0;

// The vertex itself, or its image at infinity, away from the light.
fn volume_vertex(vertex: u32, extruded: bool, light: vec4f, recede: f32) -> vec4f {
    let p = position(vertex);
    if extruded {
        return umbrage_clip(view, p * light.w - light.xyz, 0.0);
    }
    return umbrage_clip(view, p - view.eye, recede);
}

// Two triangles a quad: (a, a', b) and (b, a', b'), a' extruded; front faces look outward.
@vertex
fn side(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32)
    -> @builtin(position) @invariant vec4f
{
    let word = quads[index / 6u];
    let corner = index % 6u;
    let ends = edges[word >> 1u];
    let at_end = corner == 2u || corner == 3u || corner == 5u;
    let reversed = (word & 1u) == 1u;
    let vertex = select(ends.x, ends.y, at_end != reversed);
    let extruded = corner == 1u || corner >= 4u;
    return volume_vertex(vertex, extruded, lights[light], RECEDE);
}

// The light cap with the triangle's own vertex order, then the dark cap with the other winding. A
// triangle taken reversed keeps its order and is drawn by a pipeline that counts the other way
// round: rasterised in another order, the cap's depth could differ from that of the visible
// triangle it lies in.
@vertex
fn cap(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32)
    -> @builtin(position) @invariant vec4f
{
    let corner = index % 6u;
    let extruded = corner >= 3u;
    let k = select(corner, (6u - corner) % 3u, extruded);
    let vertex = triangles[3u * (caps[index / 6u] >> 1u) + k];
    return volume_vertex(vertex, extruded, lights[light], 1.0);
}

@fragment
fn nothing() {}

// Debug views: fragments, and layers.
@fragment
fn one() -> @location(0) vec4f {
    return vec4f(1.0);
}

@fragment
fn layer(@builtin(front_facing) front: bool) -> @location(0) vec4f {
    return vec4f(select(-1.0, 1.0, front));
}
