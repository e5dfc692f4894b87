// What of the world each light can be seen to light, and which of its quads matter for that.
//
// First the depth buffer becomes boxes of visible surface, one a tile. Then each light joins the
// boxes in its range: a light with none is not drawn, and a quad that cannot meet the hull of the
// eye and that box crosses no eye ray that ends there. Everything is relative to the eye. Quads are
// taken to be infinite: a finite one is a part of that, and what misses the hull still does. On the
// z-fail path, which counts behind the surface, all are kept.

@group(0) @binding(0) var<storage, read> quads: array<u32>;
@group(0) @binding(1) var<storage, read> plan: array<LightPlan>;
@group(0) @binding(2) var<storage, read_write> tiles: array<Box>;
@group(0) @binding(3) var<storage, read_write> kept_quads: array<u32>;
@group(0) @binding(4) var<storage, read_write> calls: array<LightCalls>;
@group(0) @binding(5) var depth_texture: texture_depth_2d;
@group(0) @binding(6) var<storage, read_write> spans: array<u32>;

struct LightPlan {
    homogeneous: UmbrageLight,
    // Of a spot's cone; a cosine of -1 for all directions.
    axis: vec3f,
    cos_outer: f32,
    // first x, first y, end x, end y
    tiles: vec4u,
    // first and end
    quads: vec2u,
    caps: vec2u,
    reversed_caps: vec2u,
    range: f32,
    // 0 not drawn, 1 z-pass, 2 z-fail; 4 is added if the light is drawn whatever it reaches, 8 if
    // all its quads are, 16 if this is a part of a light: what lies between parts changes the
    // stencil even where a part has nothing to draw
    path: u32,
}

struct Box {
    low: vec3f,
    // Surface was seen.
    some: u32,
    high: vec3f,
    unused: u32,
}

struct Call {
    vertex_count: u32,
    instance_count: u32,
    first_vertex: u32,
    first_instance: u32,
}

struct LightCalls {
    sides: Call,
    caps: Call,
    reversed_caps: Call,
    light: Call,
    clean: Call,
}

const TILE: u32 = 8u;

// Farther than anything; its square is finite.
const FAR: f32 = 1e18;

// What a depth may be off by: interpolated over a triangle that reaches to the near plane, where
// depth is 1, and somewhat nearer.
const DEPTH_ERROR: f32 = 1.0 / 1048576.0;

fn nothing() -> Box {
    return Box(vec3f(FAR), 0u, vec3f(-FAR), 0u);
}

fn joined(a: Box, b: Box) -> Box {
    return Box(min(a.low, b.low), a.some | b.some, max(a.high, b.high), 0u);
}

fn with_point(a: Box, p: vec3f, margin: vec3f) -> Box {
    return Box(min(a.low, p - margin), 1u, max(a.high, p + margin), 0u);
}

fn view_size() -> vec2u {
    return vec2u(u32(umbrage_world_view.width), u32(umbrage_world_view.height));
}

@compute @workgroup_size(8, 8)
fn surface(@builtin(global_invocation_id) id: vec3u) {
    let view = umbrage_world_view;
    let size = view_size();
    let origin = vec2u(u32(view.origin_x), u32(view.origin_y));
    let across = (size + TILE - 1u) / TILE;
    if all(id.xy == vec2u(0u)) {
        // From here on light draws go by spans.
        spans[0] = across.y;
    }
    if any(id.xy >= across) {
        return;
    }
    var box = nothing();
    let end = min((id.xy + 1u) * TILE, size);
    for (var y = id.y * TILE; y < end.y; y++) {
        for (var x = id.x * TILE; x < end.x; x++) {
            let texel = origin + vec2u(x, y);
            let depth = umbrage_nearness(view, textureLoad(depth_texture, texel, 0));
            if depth > 0.0 {
                let ray = umbrage_ray(view, vec2f(texel) + 0.5);
                // Before the near plane all depths are 1.
                let nearest = select(view.near / (depth + DEPTH_ERROR), 0.0, depth >= 1.0);
                let farthest = min(FAR, view.near / max(depth - DEPTH_ERROR, 1e-30));
                // A quarter of a pixel aside, which is far above any rounding of the ray.
                let margin = farthest * 0.5 / f32(size.x)
                    * (abs(view.right) / view.scale_x + abs(view.up) / view.scale_x);
                box = with_point(box, nearest * ray, margin);
                box = with_point(box, farthest * ray, margin);
            }
        }
    }
    tiles[id.y * across.x + id.x] = box;
}

const LANES: u32 = 64u;
var<workgroup> boxes: array<Box, LANES>;
var<workgroup> receivers: Box;
var<workgroup> kept: atomic<u32>;

@compute @workgroup_size(64)
fn light(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32)
{
    let number = group.y * groups.x + group.x;
    if number >= arrayLength(&plan) {
        return;
    }
    let ours = plan[number];
    let path = ours.path & 3u;
    if path == 0u {
        return;
    }
    let homogeneous = ours.homogeneous;
    if lane == 0u {
        atomicStore(&kept, 0u);
    }
    boxes[lane] = in_range(number, ours, homogeneous, lane);
    workgroupBarrier();
    if lane == 0u {
        var box = nothing();
        for (var i = 0u; i < LANES; i++) {
            box = joined(box, boxes[i]);
        }
        receivers = box;
    }
    workgroupBarrier();
    let box = workgroupUniformLoad(&receivers);
    let seen = box.some != 0u || (ours.path & 4u) != 0u;
    if seen {
        let all = path == 2u || (ours.path & 8u) != 0u;
        for (var i = ours.quads.x + lane; i < ours.quads.y; i += LANES) {
            let quad = quads[i];
            if all || meets_hull(quad, homogeneous, box) {
                kept_quads[ours.quads.x + atomicAdd(&kept, 1u)] = quad;
            }
        }
    }
    workgroupBarrier();
    if lane == 0u {
        let drawn = select(0u, 1u, seen);
        let count = atomicLoad(&kept);
        let caps = ours.caps.y - ours.caps.x;
        let reversed = ours.reversed_caps.y - ours.reversed_caps.x;
        calls[number] = LightCalls(
            Call(6u * count, drawn, 6u * ours.quads.x, number),
            Call(6u * caps, drawn, 6u * ours.caps.x, number),
            Call(6u * reversed, drawn, 6u * ours.reversed_caps.x, number),
            Call(6u * (ours.tiles.w - ours.tiles.y), drawn, 6u * ours.tiles.y, number),
            Call(3u, select(min(drawn, count + caps + reversed), drawn, (ours.path & 16u) != 0u), 0u, number),
        );
    }
}

// The visible surface that may lie in the light's range, in every 64th row of tiles; and for each
// of these rows the span of tiles that has any.
fn in_range(number: u32, ours: LightPlan, homogeneous: UmbrageLight, lane: u32) -> Box {
    let across = (view_size() + TILE - 1u) / TILE;
    let center = umbrage_light_from_eye(homogeneous);
    // Far above the rounding of the distance, and below what a tile's box adds to it.
    let range = ours.range * 1.00390625;
    let asked = (ours.path & 4u) == 0u;
    var found = nothing();
    for (var y = ours.tiles.y + lane; y < ours.tiles.w; y += LANES) {
        var first = ours.tiles.z;
        var end = ours.tiles.x;
        for (var x = ours.tiles.x; x < ours.tiles.z; x++) {
            var box = tiles[y * across.x + x];
            if box.some != 0u && homogeneous.rounded.w != 0.0 {
                let aside = max(max(box.low - center, center - box.high), vec3f(0.0));
                let reached = dot(aside, aside) <= range * range && meets_cone(ours, center, box);
                box.some = select(0u, 1u, reached);
                box.low = max(box.low, center - range);
                box.high = min(box.high, center + range);
            }
            if box.some != 0u {
                found = joined(found, box);
            }
            if box.some != 0u || !asked {
                first = min(first, x);
                end = x + 1u;
            }
        }
        let span = select(0u, first * TILE | (end * TILE) << 16u, first < end);
        spans[1u + number * across.y + y] = span;
    }
    return found;
}

// Whether the sphere around a box meets the light's cone, with slack above that of any shading.
fn meets_cone(ours: LightPlan, apex: vec3f, box: Box) -> bool {
    if ours.cos_outer <= -1.0 {
        return true;
    }
    let v = 0.5 * (box.low + box.high) - apex;
    let along = dot(v, ours.axis);
    let aside = length(v - along * ours.axis);
    let sin_outer = sqrt(max(0.0, 1.0 - ours.cos_outer * ours.cos_outer));
    let distance = ours.cos_outer * aside - sin_outer * along;
    let near = 0.5 * length(box.high - box.low) + length(v) / 256.0;
    return distance <= near || length(v) <= near;
}

// The largest and the least value of dot(normal, x - foot) over the hull of the eye and a box. The
// normal is a product of unit vectors: shorter than 1, and off by some 2^-23 however short it is.
fn over_hull(normal: vec3f, foot: vec3f, box: Box) -> vec2f {
    let middle = 0.5 * (box.low + box.high);
    let half = 0.5 * (box.high - box.low);
    let at_eye = -dot(normal, foot);
    let at_middle = at_eye + dot(normal, middle);
    let spread = dot(abs(normal), half);
    let sizes = abs(foot) + abs(middle) + half;
    let error = (sizes.x + sizes.y + sizes.z) / 262144.0;
    return vec2f(max(at_eye, at_middle + spread) + error, min(at_eye, at_middle - spread) - error);
}

// False only if a plane separates the quad from the hull of the eye and the box. Tried are the
// planes of the box, the quad's own plane, and the three planes upright on it through its edges.
fn meets_hull(quad: u32, light: UmbrageLight, box: Box) -> bool {
    let ends = umbrage_edge(quad >> 1u);
    let a = umbrage_from_eye(ends.x);
    let b = umbrage_from_eye(ends.y);
    let away_a = umbrage_from_light(ends.x, light);
    let away_b = umbrage_from_light(ends.y, light);
    if dot(away_a, away_a) == 0.0 || dot(away_b, away_b) == 0.0 {
        return true;
    }

    let low = min(box.low, vec3f(0.0));
    let high = max(box.high, vec3f(0.0));
    let slack = (abs(a) + abs(b)) / 262144.0;
    let recedes = min(away_a, away_b) >= vec3f(0.0);
    let precedes = max(away_a, away_b) <= vec3f(0.0);
    if any((min(a, b) - slack > high) & recedes) || any((max(a, b) + slack < low) & precedes) {
        return false;
    }

    // From positions as they are: relative to the eye both ends are rounded already.
    let along = normalize(umbrage_between(ends.x, ends.y));
    let ray_a = normalize(away_a);
    let ray_b = normalize(away_b);
    let normal = cross(along, ray_a);
    let plane = over_hull(normal, a, box);
    if plane.y > 0.0 || plane.x < 0.0 {
        return false;
    }
    let beside_a = cross(normal, ray_a);
    let beside_b = cross(normal, ray_b);
    let beyond = cross(along, normal);
    let turn = sign(dot(beside_a, along));
    let ahead = sign(dot(beyond, ray_a));
    return !(over_hull(beside_a * turn, a, box).x < 0.0
        || over_hull(-beside_b * turn, b, box).x < 0.0
        || over_hull(beyond * ahead, a, box).x < 0.0);
}
