//! Keys and mouse over the picture.

use egui::{Key, Response};
use umbrage_lab::gpu::GpuError;

use crate::camera::Push;
use crate::debug_view::DebugView;
use crate::table::Row;
use crate::viewer::Viewer;

/// Every key, and what it does.
pub(crate) const KEYS: [(&str, &str); 17] = [
    ("W A S D", "fly ahead, left, back, right"),
    ("Q E", "fly down, up"),
    ("Shift", "with them: faster"),
    ("drag", "look around"),
    ("wheel", "change speed"),
    ("1 - 9", "debug views, as numbered in the panel"),
    ("X", "see lines through surfaces, or not"),
    ("Up Down", "choose a light of the list"),
    ("Esc", "choose none"),
    (
        "Space",
        "solo: the chosen light alone, with others so marked",
    ),
    ("M", "mute the chosen light"),
    ("C", "all lights shine again"),
    ("T", "time goes on, or stands"),
    ("O", "compare with the oracle, wrong pixels in red"),
    ("P", "expose the picture anew"),
    ("L", "light list"),
    ("H", "this help"),
];

const NUMBERS: [Key; 9] = [
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

/// Does what the mouse says over the picture, and the keys unless a text is being typed.
pub(crate) fn apply(viewer: &mut Viewer, picture: &Response, rows: &[Row]) -> Result<(), GpuError> {
    let ctx = &picture.ctx;
    if picture.dragged() {
        let by = picture.drag_delta() * ctx.pixels_per_point();
        viewer.camera.turn(by.x, by.y);
    }
    if picture.contains_pointer() {
        let notches = ctx.input(|input| input.smooth_scroll_delta().y) / 50.0;
        if notches != 0.0 {
            viewer.camera.change_speed(notches);
        }
    }
    if picture.clicked() {
        ctx.memory_mut(egui::Memory::stop_text_input);
    }
    if !ctx.egui_wants_keyboard_input() {
        keys(viewer, ctx, rows)?;
    }
    if viewer.plays {
        viewer.set_time(viewer.stage.time_s + f64::from(ctx.input(seconds)));
        ctx.request_repaint();
    }
    Ok(())
}

/// Since the last frame; less where that was long ago.
fn seconds(input: &egui::InputState) -> f32 {
    input.stable_dt.min(0.1)
}

fn keys(viewer: &mut Viewer, ctx: &egui::Context, rows: &[Row]) -> Result<(), GpuError> {
    let (push, seconds) = ctx.input(|input| {
        let axis = |plus, minus| {
            f32::from(i8::from(input.key_down(plus)) - i8::from(input.key_down(minus)))
        };
        let push = Push {
            right: axis(Key::D, Key::A),
            up: axis(Key::E, Key::Q),
            ahead: axis(Key::W, Key::S),
            fast: input.modifiers.shift,
        };
        (push, seconds(input))
    });
    if push
        != (Push {
            fast: push.fast,
            ..Push::default()
        })
    {
        viewer.camera.fly(push, seconds);
        ctx.request_repaint();
    }
    let pressed = |key| ctx.input(|input| input.key_pressed(key));
    for (key, view) in NUMBERS.into_iter().zip(DebugView::ALL) {
        if pressed(key) {
            viewer.shown = view;
        }
    }
    viewer.through ^= pressed(Key::X);
    viewer.show_list ^= pressed(Key::L);
    viewer.show_help ^= pressed(Key::H);
    for (key, step) in [(Key::ArrowDown, 1), (Key::ArrowUp, -1)] {
        if pressed(key) {
            viewer.mix.chosen = neighbour(rows, viewer.mix.chosen, step);
        }
    }
    if let Some(chosen) = viewer.mix.chosen {
        if pressed(Key::Space) {
            viewer.mix.toggle_solo(chosen);
        }
        if pressed(Key::M) {
            viewer.mix.toggle_mute(chosen);
        }
    }
    if pressed(Key::Escape) {
        viewer.mix.chosen = None;
    }
    if pressed(Key::C) {
        viewer.mix.clear();
    }
    if pressed(Key::T) {
        viewer.plays = !viewer.plays && viewer.can_play();
    }
    if pressed(Key::P) {
        viewer.expose();
    }
    match pressed(Key::O) {
        true => viewer.start_check(),
        false => Ok(()),
    }
}

/// The light before or after the chosen one in the list; without one, the first.
fn neighbour(rows: &[Row], chosen: Option<usize>, step: isize) -> Option<usize> {
    let at = rows.iter().position(|row| Some(row.number) == chosen);
    let to = at.map_or(0, |at| at.saturating_add_signed(step));
    rows.get(to.min(rows.len().saturating_sub(1)))
        .map(|row| row.number)
}
