// The one place where shaders read the world: positions, edges, triangles, and where a vertex lies
// from the eye and from a light. What comes from here has the same bits in every pass. The bind
// group is ShadowRenderer::world_bind_group, at UMBRAGE_WORLD_GROUP.

@group(UMBRAGE_WORLD_GROUP) @binding(0) var<uniform> umbrage_world_view: View;
@group(UMBRAGE_WORLD_GROUP) @binding(1) var<storage, read> umbrage_positions: array<f32>;
@group(UMBRAGE_WORLD_GROUP) @binding(2) var<storage, read> umbrage_edges: array<vec2u>;
@group(UMBRAGE_WORLD_GROUP) @binding(3) var<storage, read> umbrage_triangles: array<u32>;

// Where a vertex is in the world.
fn umbrage_position(vertex: u32) -> vec3f {
    let i = 3u * vertex;
    return vec3f(umbrage_positions[i], umbrage_positions[i + 1u], umbrage_positions[i + 2u]);
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
    return umbrage_position(end) - umbrage_position(start);
}

// From the eye to a vertex.
fn umbrage_from_eye(vertex: u32) -> vec3f {
    return umbrage_position(vertex) - umbrage_world_view.eye;
}

// From a light to a vertex, as homogeneous lights have it: position and 1, or the direction towards
// the light and 0.
fn umbrage_from_light(vertex: u32, light: vec4f) -> vec3f {
    return umbrage_position(vertex) * light.w - light.xyz;
}

// From the eye to a light that has a position.
fn umbrage_light_from_eye(light: vec4f) -> vec3f {
    return light.xyz - umbrage_world_view.eye;
}
