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
// triangle it lies in.
@vertex
fn cap(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32)
    -> @builtin(position) @invariant vec4f
{
    if cap_is_edge_on(cap_corners(index, light)) {
        return UMBRAGE_NOWHERE;
    }
    return cap_vertex(index, light);
}

// Caps in whose plane the eye is, which `cap` leaves out. Seen as a line, on the rasteriser's grid a
// cap may be a sliver that its sides leave open; this closes it. What the depths of three corners
// in a line say of the depth beside it is any number: it is taken from the nearest edge in the line.
@vertex
fn edge_on_cap(@builtin(vertex_index) index: u32, @builtin(instance_index) light: u32) -> EdgeOn {
    let view = umbrage_world_view;
    let corners = cap_corners(index, light);
    let a = umbrage_clip(view, corners.a, 1.0);
    let b = umbrage_clip(view, corners.b, 1.0);
    let c = umbrage_clip(view, corners.c, 1.0);
    // Where it is around the eye it is a line nowhere.
    if !cap_is_edge_on(corners) || min(min(a.w, b.w), c.w) <= 0.0 {
        return EdgeOn(UMBRAGE_NOWHERE, vec3f(), vec3f(), 0u);
    }
    let half = vec2f(0.5, -0.5) * vec2f(view.width, view.height);
    let columns = mat3x2f(a.xy / a.w * half, b.xy / b.w * half, c.xy / c.w * half);
    let rows = transpose(columns);
    let extent = vec2f(extent_of(rows[0]), extent_of(rows[1]));
    let axis = select(0u, 1u, extent.y > extent.x);
    let middle = vec2f(view.origin_x, view.origin_y) + abs(half);
    let nearness = vec3f(view.near / a.w, view.near / b.w, view.near / c.w);
    return EdgeOn(cap_vertex(index, light), rows[axis] + middle[axis], nearness, axis);
}

struct EdgeOn {
    @builtin(position) @invariant position: vec4f,
    // Of the corners: pixels along the axis in which they are farther apart, and near / distance.
    @location(0) @interpolate(flat) along: vec3f,
    @location(1) @interpolate(flat) nearness: vec3f,
    @location(2) @interpolate(flat) axis: u32,
}

@fragment
fn edge_on_depth(in: EdgeOn) -> @builtin(frag_depth) f32 {
    let at = in.position[in.axis];
    let ab = nearness_between(at, in.along.xy, in.nearness.xy);
    let bc = nearness_between(at, in.along.yz, in.nearness.yz);
    let ca = nearness_between(at, in.along.zx, in.nearness.zx);
    let nearest = max(max(ab, bc), ca);
    return select(1.0 - nearest, nearest, umbrage_world_view.reversed == 1u);
}

// On an edge, along which it is linear on the screen; 0 beside it.
fn nearness_between(at: f32, along: vec2f, nearness: vec2f) -> f32 {
    let share = (at - along.x) / (along.y - along.x);
    return select(0.0, mix(nearness.x, nearness.y, share), share >= 0.0 && share <= 1.0);
}

fn extent_of(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z) - min(min(v.x, v.y), v.z);
}

// A corner of the light cap or the dark cap.
fn cap_vertex(index: u32, light: u32) -> vec4f {
    let corner = index % 6u;
    let extruded = corner >= 3u;
    let k = select(corner, (6u - corner) % 3u, extruded);
    let first = 3u * (caps[index / 6u] >> 1u);
    return volume_vertex(umbrage_corner(first + k), extruded, light, 1.0);
}

struct CapCorners {
    a: vec3f,
    b: vec3f,
    c: vec3f,
    // Those of a dark cap at infinity are nowhere.
    is_infinite: bool,
}

// Relative to the eye.
fn cap_corners(index: u32, light: u32) -> CapCorners {
    let first = 3u * (caps[index / 6u] >> 1u);
    let extruded = index % 6u >= 3u;
    return CapCorners(
        cap_corner(umbrage_corner(first), extruded, light),
        cap_corner(umbrage_corner(first + 1u), extruded, light),
        cap_corner(umbrage_corner(first + 2u), extruded, light),
        extruded && !(UMBRAGE_FINITE && distances[light] > 0.0),
    );
}

fn cap_is_edge_on(q: CapCorners) -> bool {
    let size = max(max(length(q.a), length(q.b)), length(q.c));
    return !q.is_infinite && umbrage_eye_in_plane(cross(q.b - q.a, q.c - q.a), q.a, size);
}

// All of the scissor, to leave it clean for the next light.
@vertex
fn everywhere(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(f32((index << 1u) & 2u) * 2.0 - 1.0, f32(index & 2u) * 2.0 - 1.0, 0.0, 1.0);
}

@fragment
fn nothing() {}

@fragment
fn one() -> @location(0) vec4f {
    return vec4f(1.0);
}

// Debug views: fragments, in red alone, and layers.
@fragment
fn one_in_red() -> @location(0) vec4f {
    return vec4f(1.0, 0.0, 0.0, 0.0);
}

@fragment
fn layer(@builtin(front_facing) front: bool) -> @location(0) vec4f {
    return vec4f(select(-1.0, 1.0, front));
}
