// One ray for each pixel and light that reaches it: does a caster cross the open segment between?
//
// A ray runs from the light, whose position is exact, to the surface (from the surface to a
// directional light). What decides is where light and surface lie relative to the caster's plane,
// not a distance along the ray, so that there is no offset that grows where light grazes.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> nodes: array<Node>;
// Three a triangle; the first one's w says how it casts.
@group(0) @binding(2) var<storage, read> corners: array<vec4f>;
@group(0) @binding(3) var<storage, read> lights: array<Light>;
@group(0) @binding(4) var<uniform> batch: Batch;
@group(0) @binding(5) var ids: texture_2d<u32>;
@group(0) @binding(6) var bits: texture_storage_2d_array<r32uint, write>;

struct Node {
    low: vec3f,
    // The node after all that is below this one.
    next: u32,
    high: vec3f,
    // First triangle times 64, and how many; 0 if there are nodes below.
    leaf: u32,
}

struct Light {
    position: vec3f,
    range: f32,
    direction: vec3f,
    cos_outer: f32,
    // What f32 leaves of the position.
    residual: vec3f,
    // 0 point, 1 spot, 2 directional
    kind: u32,
    // Not drawn if the end is the first.
    first_row: u32,
    end_row: u32,
}

struct Batch {
    // A multiple of 32.
    first: u32,
    end: u32,
}

struct Ray {
    // World point that corners are taken relative to, exactly, before `shift` is taken off.
    base: vec3f,
    shift: vec3f,
    direction: vec3f,
    // Components of direction, of which z is the longest.
    axes: vec3u,
    shear: vec2f,
    inverse: vec3f,
    end: f32,
    is_far: bool,
    // From eye to surface.
    distance: f32,
    // The triangle that the surface is on.
    own: u32,
}

const TILE: u32 = 8u;
const ULP: f32 = 1.0 / 8388608.0;

var<workgroup> in_tile: array<atomic<u32>, LAYERS>;

@compute @workgroup_size(8, 8)
fn trace(
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
    @builtin(global_invocation_id) pixel: vec3u,
) {
    if lane < LAYERS {
        atomicStore(&in_tile[lane], 0u);
    }
    workgroupBarrier();
    for (var number = batch.first + lane; number < batch.end; number += TILE * TILE) {
        if is_in_tile(number, tile.xy) {
            let i = number - batch.first;
            atomicOr(&in_tile[i >> 5u], 1u << (i & 31u));
        }
    }
    workgroupBarrier();
    let size = textureDimensions(ids);
    if any(pixel.xy >= size) {
        return;
    }
    let id = textureLoad(ids, pixel.xy, 0).x;
    let own = max(id, 1u) - 1u;
    let a = corners[3u * own].xyz;
    let b = corners[3u * own + 1u].xyz;
    let c = corners[3u * own + 2u].xyz;
    let normal = cross(b - a, c - a);
    let height = dot(normal, umbrage_minus_eye(view, a, vec3f(0.0)));
    let ndc = vec2f(2.0, -2.0) * (vec2f(pixel.xy) + 0.5) / vec2f(size) + vec2f(-1.0, 1.0);
    let ahead = view.forward + view.right * (ndc.x / view.scale_x) + view.up * (ndc.y / view.scale_y);
    // From the eye to the surface, no farther and no nearer than the triangle is.
    let depths = vec3f(dot(a - view.eye, view.forward), dot(b - view.eye, view.forward),
        dot(c - view.eye, view.forward));
    let nearest = min(depths.x, min(depths.y, depths.z));
    let farthest = max(depths.x, max(depths.y, depths.z));
    let q = ahead * clamp(height / dot(normal, ahead), max(nearest, 0.0), farthest);
    for (var first = batch.first; first < batch.end; first += 32u) {
        var left = atomicLoad(&in_tile[(first - batch.first) >> 5u]);
        var lit = 0u;
        while left != 0u && id != 0u {
            let i = firstTrailingBit(left);
            left &= left - 1u;
            if is_lit(lights[first + i], q, own, normal, height) {
                lit |= 1u << i;
            }
        }
        textureStore(bits, pixel.xy, (first >> 5u) % LAYERS, vec4u(lit));
    }
}

// Whether the light is drawn in a tile.
fn is_in_tile(number: u32, tile: vec2u) -> bool {
    let light = lights[number];
    if tile.y < light.first_row || tile.y >= light.end_row {
        return false;
    }
    if umbrage_spans.rows == 0u {
        return true;
    }
    let span = umbrage_spans.span[number * umbrage_spans.rows + tile.y];
    let x = tile.x * TILE;
    return x >= (span & 0xffffu) && x < (span >> 16u);
}

// `height` is how far the eye is behind the surface's plane, times the length of `normal`.
fn is_lit(light: Light, q: vec3f, own: u32, normal: vec3f, height: f32) -> bool {
    let to_light = umbrage_minus_eye(view, light.position, light.residual);
    let v = q - to_light;
    var facing = -dot(normal, light.direction);
    var ray: Ray;
    ray.own = own;
    ray.distance = length(q);
    ray.is_far = light.kind == 2u;
    if ray.is_far {
        ray.base = view.eye;
        ray.shift = q + view.eye_residual;
        ray.direction = -light.direction;
        ray.end = 3e38;
    } else {
        // A little more than the light draw asks for.
        let range = light.range * (1.0 + 1.0 / 2048.0);
        if dot(v, v) >= range * range {
            return false;
        }
        if light.kind == 1u && dot(light.direction, v) < (light.cos_outer - 1.0 / 2048.0) * length(v) {
            return false;
        }
        facing = dot(normal, to_light) - height;
        ray.base = light.position;
        ray.shift = light.residual;
        ray.direction = v;
        ray.end = 1.0 + 8.0 * ULP;
    }
    // A surface that is turned away is dark without a ray; where rounding leaves that open, the ray
    // decides.
    let size = length(normal) * select(length(to_light) + ray.distance, 1.0, ray.is_far);
    if facing * -height < 0.0 && abs(facing) > 16.0 * ULP * size {
        return false;
    }
    let d = ray.direction;
    let m = abs(d);
    ray.axes = vec3u(0u, 1u, 2u);
    if m.x >= m.y && m.x >= m.z {
        ray.axes = vec3u(1u, 2u, 0u);
    } else if m.y >= m.z {
        ray.axes = vec3u(2u, 0u, 1u);
    }
    ray.shear = vec2f(d[ray.axes.x], d[ray.axes.y]) / d[ray.axes.z];
    ray.inverse = 1.0 / select(d, vec3f(1e-20), m < vec3f(1e-20));
    return !is_blocked(ray);
}

fn is_blocked(ray: Ray) -> bool {
    // What `shift` rounds corners by.
    let pad = 4.0 * ULP * select(length(ray.shift), ray.distance, ray.is_far);
    let count = arrayLength(&nodes);
    var at = 0u;
    while at < count {
        let node = nodes[at];
        let near = ((node.low - ray.base) - ray.shift - pad) * ray.inverse;
        let far = ((node.high - ray.base) - ray.shift + pad) * ray.inverse;
        let enter = min(near, far);
        let leave = max(near, far);
        let first = max(max(enter.x, enter.y), max(enter.z, 0.0));
        let last = min(min(leave.x, leave.y), min(leave.z, ray.end));
        if first * (1.0 - 4.0 * ULP) > last * (1.0 + 4.0 * ULP) {
            at = node.next;
            continue;
        }
        if node.leaf == 0u {
            at += 1u;
            continue;
        }
        let triangle = node.leaf >> 6u;
        for (var t = triangle; t < triangle + (node.leaf & 63u); t++) {
            if t != ray.own && blocks(ray, t) {
                return true;
            }
        }
        at = node.next;
    }
    return false;
}

// Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (JCGT 2013), with edges as wide as
// their own rounding: compilers may fuse products, so that two neighbours need not round alike.
fn blocks(ray: Ray, triangle: u32) -> bool {
    let corner = corners[3u * triangle];
    let p0 = corner.xyz;
    let p1 = corners[3u * triangle + 1u].xyz;
    let p2 = corners[3u * triangle + 2u].xyz;
    let a = (p0 - ray.base) - ray.shift;
    let b = (p1 - ray.base) - ray.shift;
    let c = (p2 - ray.base) - ray.shift;
    let k = ray.axes;
    let fa = vec2f(a[k.x], a[k.y]) - ray.shear * a[k.z];
    let fb = vec2f(b[k.x], b[k.y]) - ray.shear * b[k.z];
    let fc = vec2f(c[k.x], c[k.y]) - ray.shear * c[k.z];
    let left = vec3f(fc.x * fb.y, fa.x * fc.y, fb.x * fa.y);
    let right = vec3f(fc.y * fb.x, fa.y * fc.x, fb.y * fa.x);
    let edges = left - right;
    let rounding = 2.0 * ULP * (abs(left) + abs(right));
    if any(edges < -rounding) && any(edges > rounding) {
        return false;
    }
    let u = p1 - p0;
    let v = p2 - p0;
    let normal = cross(u, v);
    // Heights of light and surface over the plane, times the length of the normal. The corner that is
    // nearest to the surface is the one that rounding has moved least.
    let end = select(ray.direction, vec3f(0.0), ray.is_far);
    var surface = end - a;
    for (var i = 0; i < 2; i++) {
        let other = end - select(b, c, i == 1);
        surface = select(surface, other, dot(other, other) < dot(surface, surface));
    }
    let light_height = select(-dot(normal, a), dot(normal, ray.direction), ray.is_far);
    let surface_height = dot(normal, surface);
    let casts = u32(corner.w);
    let side = select(2u, 1u, light_height > 0.0);
    if light_height == 0.0 || (casts & side) == 0u {
        return false;
    }
    // A surface within its own rounding of the plane touches the caster and is not in its shadow.
    let size = ray.distance + length(ray.direction) * select(1.0, 0.0, ray.is_far);
    let touch = ULP * (TOUCH.x * size * length(normal) + TOUCH.y * length(u) * length(v) * length(surface));
    return select(-surface_height, surface_height, light_height < 0.0) > touch;
}
