// Volume geometry by vertex pulling: sides from one u32 a quad, caps from one u32 a triangle.
// The instance index is the light's number.

@group(0) @binding(0) var<storage, read> quads: array<u32>;
@group(0) @binding(1) var<storage, read> caps: array<u32>;
@group(0) @binding(2) var<storage, read> lights: array<UmbrageLight>;
// To which vertices are moved, measured from the light; 0 is infinity. Filled if UMBRAGE_FINITE.
@group(0) @binding(3) var<storage, read> distances: array<f32>;

// Whether any light's volume may be finite: decided when the pipeline is made.
override UMBRAGE_FINITE: bool = false;

// Sides recede from the eye by 2^-21 of the distance: what is counted at a surface are the sides
// before the point that much nearer. Under a grazing light the sides of a triangle run below its
// own surface by less than depth resolves; receding, they stay below. Screen positions are the
// same, so nothing opens, and the eye count stays. Caps do not recede: they must tie with the
// surface that they lie in.
const RECEDE: f32 = 1.0 - 1.0 / 2097152.0;

// The vertex relative to the eye, or moved away from the light to its distance; one that is
// farther away stays.
fn moved(vertex: u32, light: UmbrageLight, distance: f32) -> vec3f {
    let away = umbrage_from_light(vertex, light);
    // Scaled, so that no square overflows or vanishes.
    let scale = max(max(abs(away.x), abs(away.y)), abs(away.z));
    let direction = away / scale;
    let size = length(direction);
    let far = umbrage_light_from_eye(light) + direction * (distance / size);
    return select(far, umbrage_from_eye(vertex), scale * size >= distance);
}

// The vertex itself, or its image away from the light: at the light's distance, or at infinity.
fn volume_vertex(vertex: u32, extruded: bool, light: u32, recede: f32) -> vec4f {
    let view = umbrage_world_view;
    if extruded {
        let at = lights[light];
        if UMBRAGE_FINITE {
            let distance = distances[light];
            if distance > 0.0 {
                return umbrage_clip(view, moved(vertex, at, distance), recede);
            }
        }
        return umbrage_clip(view, umbrage_from_light(vertex, at), 0.0);
    }
    return umbrage_clip(view, umbrage_from_eye(vertex), recede);
}

// A quad's edge as its triangle runs along it.
struct Side {
    ends: vec2u,
    // Whether that is against the order in the edge table.
    against: bool,
}

fn side_of(quad: u32) -> Side {
    let word = quads[quad];
    let ends = umbrage_edge(word >> 1u);
    let against = (word & 1u) == 1u;
    return Side(select(ends, ends.yx, against), against);
}

// Two triangles a quad, extruded vertices marked: (a, a', b) and (b, a', b'); front faces look
// outward. Along the other way of the edge the same two, each with its last two vertices swapped:
// where an edge has quads both ways, they are to count alike to the last bit of depth, and a
// rasteriser that turns triangles the other way round by such a swap then does.
fn side_corner(side: Side, index: u32, light: u32) -> vec4f {
    let corner = index % 6u;
    let at_end = select(0x2cu, 0x25u, side.against) >> corner & 1u;
    let extruded = select(0x32u, 0x34u, side.against) >> corner & 1u;
    let vertex = select(side.ends.x, side.ends.y, at_end == 1u);
    return volume_vertex(vertex, extruded == 1u, light, RECEDE);
}

@vertex
fn side(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32)
    -> @builtin(position) @invariant vec4f
{
    return side_corner(side_of(index / 6u), index, light);
}

// The z-fail path's sides: those that the eye is on are left out.
@vertex
fn zfail_side(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32)
    -> @builtin(position) @invariant vec4f
{
    let side = side_of(index / 6u);
    if eye_on_side(side.ends, lights[light]) {
        return UMBRAGE_NOWHERE;
    }
    return side_corner(side, index, light);
}

// Whether the eye is on the side that the edge casts, not just in its plane.
fn eye_on_side(ends: vec2u, light: UmbrageLight) -> bool {
    let qa = umbrage_from_eye(ends.x);
    let qb = umbrage_from_eye(ends.y);
    let edge = umbrage_between(ends.x, ends.y);
    let away_a = umbrage_from_light(ends.x, light);
    let away_b = umbrage_from_light(ends.y, light);
    let normal = cross(edge, away_a);
    let size = max(length(qa), length(qb));
    // Between the two extruded sides, and beyond the edge. A wide margin: what else lies in the
    // plane is seen edge-on.
    let slack = size * 1e-3;
    let inward_a = cross(normalize(away_a), normalize(normal));
    let inward_b = cross(normalize(normal), normalize(away_b));
    let outward = away_a - edge * (dot(away_a, edge) / dot(edge, edge));
    return umbrage_eye_in_plane(normal, qa, size)
        && dot(inward_a, -qa) >= -slack
        && dot(inward_b, -qb) >= -slack
        && dot(normalize(outward), -qa) >= -slack;
}

// A corner of a cap that ends somewhere, relative to the eye.
fn cap_corner(vertex: u32, extruded: bool, light: u32) -> vec3f {
    if UMBRAGE_FINITE {
        if extruded {
            return moved(vertex, lights[light], distances[light]);
        }
    }
    return umbrage_from_eye(vertex);
}

// The light cap with the triangle's own vertex order, then the dark cap with the other winding. A
// triangle taken reversed keeps its order and is drawn by a pipeline that counts the other way
// round: rasterised in another order, the cap's depth could differ from that of the visible
// triangle it lies in. A cap in whose plane the eye is, is left out; at infinity it is in none.
@vertex
fn cap(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32)
    -> @builtin(position) @invariant vec4f
{
    let corner = index % 6u;
    let extruded = corner >= 3u;
    let k = select(corner, (6u - corner) % 3u, extruded);
    let first = 3u * (caps[index / 6u] >> 1u);
    let is_infinite = extruded && !(UMBRAGE_FINITE && distances[light] > 0.0);
    if !is_infinite {
        let a = cap_corner(umbrage_corner(first), extruded, light);
        let b = cap_corner(umbrage_corner(first + 1u), extruded, light);
        let c = cap_corner(umbrage_corner(first + 2u), extruded, light);
        let size = max(max(length(a), length(b)), length(c));
        if umbrage_eye_in_plane(cross(b - a, c - a), a, size) {
            return UMBRAGE_NOWHERE;
        }
    }
    return volume_vertex(umbrage_corner(first + k), extruded, light, 1.0);
}

// All of the scissor, to leave it clean for the next light.
@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32((index << 1u) & 2u) * 2.0 - 1.0, f32(index & 2u) * 2.0 - 1.0, 0.0, 1.0);
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
