// How a shadow map sees: shared by who draws it and by who reads it.

struct Face {
    right: vec3f,
    scale_x: f32,
    up: vec3f,
    scale_y: f32,
    forward: vec3f,
    near: f32,
    // The light's position, or the middle of a parallel light's nearest plane.
    origin: vec3f,
    // Depth of parallel light's map in metres; 0 for a map with a perspective.
    length: f32,
}

struct ShadowMap {
    faces: array<Face, 6>,
    // 6 for a cube, 1 for all others.
    count: u32,
}

// Clip position of a point at q = point - origin: reversed depth, near / distance or linear.
fn shadow_clip(face: Face, q: vec3f) -> vec4f {
    let across = vec2f(face.scale_x * dot(face.right, q), face.scale_y * dot(face.up, q));
    let ahead = dot(face.forward, q);
    if face.length > 0.0 {
        return vec4f(across, 1.0 - ahead / face.length, 1.0);
    }
    return vec4f(across, face.near, ahead);
}
