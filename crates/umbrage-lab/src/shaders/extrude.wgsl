// Brennan's static buffer: the corners of triangles that face away from the light go to infinity.
// A vertex index is three times a triangle's number plus its corner; the instance index is the
// light's number.

struct SkinnedCorner {
    normal: vec3f,
    joints: vec4u,
    weights: vec4f,
}

// The first corner that has an entry in `skin`.
@group(0) @binding(0) var<uniform> first_skinned: vec4u;
@group(0) @binding(1) var<storage, read> lights: array<UmbrageLight>;
@group(0) @binding(2) var<storage, read> skin: array<SkinnedCorner>;
// What each joint does to normals.
@group(0) @binding(3) var<storage, read> joints: array<mat3x3f>;

// 0: from the posed corners. 1: from rest, by the weights of the face. 2: by those of the vertex.
override normals: u32 = 0u;

// The corner, or its image at infinity. As in the library's volumes, sides run a little below the
// surface of the triangle whose edge they hang from, and caps tie with it.
fn extruded(corner: u32, number: u32, is_cap: bool) -> vec4f {
    let light = lights[number];
    let first = corner / 3u * 3u;
    let a = umbrage_corner(first);
    let b = umbrage_corner(first + 1u);
    let c = umbrage_corner(first + 2u);
    let vertex = umbrage_corner(corner);
    let q = array(umbrage_from_eye(a), umbrage_from_eye(b), umbrage_from_eye(c));
    let size = max(max(length(q[0]), length(q[1])), length(q[2]));
    // The same for all three corners, to the last bit: a triangle goes or stays as a whole.
    var normal = cross(umbrage_between(a, b), umbrage_between(a, c));
    let edge_on = umbrage_eye_in_plane(normal, q[0], size);
    var on_plane = a;
    if normals > 0u && corner >= first_skinned.x {
        let bound = skin[corner - first_skinned.x];
        if any(bound.normal != vec3f(0.0)) {
            normal = vec3f(0.0);
            for (var i = 0u; i < 4u; i++) {
                normal += bound.weights[i] * (joints[bound.joints[i]] * bound.normal);
            }
            // The article's own, corner by corner: normals and places differ, and so may answers.
            on_plane = select(a, vertex, normals == 2u);
        }
    }
    if dot(normal, umbrage_from_light(on_plane, light)) < 0.0 {
        // As the depth pass leaves it out.
        if is_cap && edge_on {
            return UMBRAGE_NOWHERE;
        }
        let recede = select(1.0 - 1.0 / 2097152.0, 1.0, is_cap);
        return umbrage_clip(umbrage_world_view, umbrage_from_eye(vertex), recede);
    }
    return umbrage_clip(umbrage_world_view, umbrage_from_light(vertex, light), 0.0);
}

@vertex
fn cap(@builtin(vertex_index) corner: u32, @builtin(instance_index) number: u32)
    -> @builtin(position) @invariant vec4f
{
    return extruded(corner, number, true);
}

@vertex
fn side(@builtin(vertex_index) corner: u32, @builtin(instance_index) number: u32)
    -> @builtin(position) @invariant vec4f
{
    return extruded(corner, number, false);
}

// All of the scissor, to leave the stencil clean for the next light.
@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32((index << 1u) & 2u) * 2.0 - 1.0, f32(index & 2u) * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn nothing() {}
