// The one place where shaders read the world: positions, edges, triangles, and where a vertex lies
// from the eye and from a light. What comes from here has the same bits in every pass. The bind
// group is ShadowRenderer::world_bind_group, at UMBRAGE_WORLD_GROUP. Declarations of the arrays, with
// umbrage_place(vertex), umbrage_edge(edge) and umbrage_corner(corner), come before it: see
// windows.rs.

@group(UMBRAGE_WORLD_GROUP) @binding(0) var<uniform> umbrage_world_view: View;

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

// From one vertex to another.
fn umbrage_between(start: u32, end: u32) -> vec3f {
    let a = umbrage_place(start);
    let b = umbrage_place(end);
    return (b.rounded - a.rounded) + (b.residual - a.residual);
}

// From the eye to a vertex.
fn umbrage_from_eye(vertex: u32) -> vec3f {
    let p = umbrage_place(vertex);
    return umbrage_minus_eye(umbrage_world_view, p.rounded, p.residual);
}

// From a light to a vertex.
fn umbrage_from_light(vertex: u32, light: UmbrageLight) -> vec3f {
    let p = umbrage_place(vertex);
    let w = light.rounded.w;
    return (p.rounded * w - light.rounded.xyz) + (p.residual * w - light.residual.xyz);
}

// From the eye to a light that has a position.
fn umbrage_light_from_eye(light: UmbrageLight) -> vec3f {
    return umbrage_minus_eye(umbrage_world_view, light.rounded.xyz, light.residual.xyz);
}

// A corner of a triangle, as a depth pass draws it that is to agree with the volumes to the last bit.
struct UmbrageCorner {
    // For an output that is @builtin(position) @invariant.
    clip: vec4f,
    // From the eye.
    place: vec3f,
    // Of the triangle, towards its front; of any length, 0 where it is left out.
    normal: vec3f,
}

// Corner number `corner` of the world: three times a triangle's number, plus 0, 1 or 2.
fn umbrage_world_corner(corner: u32) -> UmbrageCorner {
    let first = corner - corner % 3u;
    let a = umbrage_corner(first);
    let b = umbrage_corner(first + 1u);
    let c = umbrage_corner(first + 2u);
    let normal = cross(umbrage_between(a, b), umbrage_between(a, c));
    let q = array(umbrage_from_eye(a), umbrage_from_eye(b), umbrage_from_eye(c));
    let size = max(max(length(q[0]), length(q[1])), length(q[2]));
    if umbrage_eye_in_plane(normal, q[0], size) {
        return UmbrageCorner(UMBRAGE_NOWHERE, q[0], vec3f(0.0));
    }
    let place = umbrage_from_eye(umbrage_corner(corner));
    return UmbrageCorner(umbrage_clip(umbrage_world_view, place, 1.0), place, normal);
}
