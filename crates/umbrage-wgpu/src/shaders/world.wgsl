// The one place where shaders read the world: positions, edges, triangles, and where a vertex lies
// from the eye and from a light. What comes from here has the same bits in every pass. The bind
// group is ShadowRenderer::world_bind_group, at UMBRAGE_WORLD_GROUP.

@group(UMBRAGE_WORLD_GROUP) @binding(0) var<uniform> umbrage_world_view: View;
@group(UMBRAGE_WORLD_GROUP) @binding(1) var<storage, read> umbrage_positions: array<f32>;
@group(UMBRAGE_WORLD_GROUP) @binding(2) var<storage, read> umbrage_edges: array<vec2u>;
@group(UMBRAGE_WORLD_GROUP) @binding(3) var<storage, read> umbrage_triangles: array<u32>;

// Where something is: rounded to f32, and what that leaves. Two such places are subtracted part by
// part: where they are near each other, nothing is lost.
struct UmbragePlace {
    rounded: vec3f,
    residual: vec3f,
}

// A homogeneous light: position and 1, or the direction towards the light and 0; and what f32 leaves
// of it.
struct UmbrageLight {
    rounded: vec4f,
    residual: vec4f,
}

fn umbrage_floats(first: u32) -> vec3f {
    return vec3f(
        umbrage_positions[first], umbrage_positions[first + 1u], umbrage_positions[first + 2u]);
}

// Where a vertex is in the world. It has six floats where f32 does not hold the world, else three.
fn umbrage_place(vertex: u32) -> UmbragePlace {
    let floats = umbrage_world_view.vertex_floats;
    let first = floats * vertex;
    if floats == 3u {
        return UmbragePlace(umbrage_floats(first), vec3f(0.0));
    }
    return UmbragePlace(umbrage_floats(first), umbrage_floats(first + 3u));
}

// The two vertices of an edge.
fn umbrage_edge(edge: u32) -> vec2u {
    return umbrage_edges[edge];
}

// The vertex at a corner: three times a triangle's number, plus 0, 1 or 2.
fn umbrage_corner(corner: u32) -> u32 {
    return umbrage_triangles[corner];
}

// From one vertex to another.
fn umbrage_between(start: u32, end: u32) -> vec3f {
    let a = umbrage_place(start);
    let b = umbrage_place(end);
    return (b.rounded - a.rounded) + (b.residual - a.residual);
}

// From the eye to a vertex.
fn umbrage_from_eye(vertex: u32) -> vec3f {
    let p = umbrage_place(vertex);
    return (p.rounded - umbrage_world_view.eye) + (p.residual - umbrage_world_view.eye_residual);
}

// From a light to a vertex.
fn umbrage_from_light(vertex: u32, light: UmbrageLight) -> vec3f {
    let p = umbrage_place(vertex);
    let w = light.rounded.w;
    return (p.rounded * w - light.rounded.xyz) + (p.residual * w - light.residual.xyz);
}

// From the eye to a light that has a position.
fn umbrage_light_from_eye(light: UmbrageLight) -> vec3f {
    return (light.rounded.xyz - umbrage_world_view.eye)
        + (light.residual.xyz - umbrage_world_view.eye_residual);
}
