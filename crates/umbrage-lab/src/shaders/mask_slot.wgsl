// Where a light's mask is: see slots.rs.
struct Slot {
    layer: u32,
    channel: u32,
    start: f32,
    dark: f32,
}
