// Where a light is drawn: over the rows of pixels in which it reaches visible surface, or over the
// whole view where that is not known. For the host's light shaders, with the bind group of
// ShadowRenderer::light_bind_group at UMBRAGE_LIGHT_GROUP.

struct UmbrageSpans {
    // Rows of tiles a light has below; 0 if it is to be drawn over the whole view.
    rows: u32,
    // Light after light, row after row: first pixel, and end pixel in the upper half.
    span: array<u32>,
}

@group(UMBRAGE_LIGHT_GROUP) @binding(0) var<uniform> umbrage_view: View;
@group(UMBRAGE_LIGHT_GROUP) @binding(1) var<storage, read> umbrage_spans: UmbrageSpans;

// Clip position of vertex `index` of light number `light`, as ShadowRenderer::draw_light numbers
// them.
fn umbrage_light_corner(index: u32, light: u32) -> vec4f {
    if umbrage_spans.rows == 0u {
        return vec4f(f32((index << 1u) & 2u) * 2.0 - 1.0, f32(index & 2u) * 2.0 - 1.0, 0.0, 1.0);
    }
    let row = index / 6u;
    let corner = index % 6u;
    let span = umbrage_spans.span[light * umbrage_spans.rows + row];
    // Counter-clockwise, as the triangle above.
    let x = select(span & 0xffffu, span >> 16u, corner == 2u || corner == 3u || corner == 5u);
    let y = (row + select(0u, 1u, corner == 1u || corner >= 4u)) * 8u;
    let ndc = vec2f(2.0, -2.0) * vec2f(f32(x), f32(y)) / vec2f(umbrage_view.width, umbrage_view.height)
        + vec2f(-1.0, 1.0);
    return vec4f(ndc, 0.0, 1.0);
}
