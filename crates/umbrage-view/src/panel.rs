//! The panels: figures of the frame, debug views, the light list, help.

use egui::{Align2, Color32, FontId, Rect, RichText, Sense, Stroke, StrokeKind, Ui, pos2, vec2};
use umbrage_core::frame::LightPath;
use umbrage_lab::gpu::GpuError;

use crate::controls::{self, KEYS};
use crate::debug_view::DebugView;
use crate::table::{Column, Row, rows};
use crate::viewer::Viewer;

const WIDTH: f32 = 470.0;
const ROW: f32 = 17.0;
/// Of the two buttons before a row.
const BUTTON: f32 = 18.0;

pub(crate) const GREEN: Color32 = Color32::from_rgb(110, 225, 120);
pub(crate) const RED: Color32 = Color32::from_rgb(255, 105, 95);
const GREY: Color32 = Color32::from_gray(140);
const CHOSEN: Color32 = Color32::from_rgb(60, 75, 120);

/// Shows everything, and does what keys, mouse and buttons ask for.
pub(crate) fn show(viewer: &mut Viewer, ui: &mut Ui) -> Result<(), GpuError> {
    let mut rows = match viewer.lab.plan.lights.len() == viewer.lights.len() {
        true => rows(&viewer.lab, &viewer.lights, &viewer.costs),
        // Before the first frame nothing is known.
        false => Vec::new(),
    };
    let all = rows.clone();
    viewer.order.apply(&mut rows);
    if viewer.show_list {
        let frame = egui::Frame::side_top_panel(ui.style()).fill(Color32::from_black_alpha(215));
        let panel = egui::Panel::right("lights")
            .exact_size(WIDTH)
            .resizable(false)
            .show_separator_line(false)
            .frame(frame);
        panel.show(ui, |ui| {
            figures(viewer, ui, &all);
            ui.separator();
            debug_views(viewer, ui);
            ui.separator();
            chosen(viewer, ui, &all);
            list(viewer, ui, &rows);
        });
    }
    let free = ui.available_rect_before_wrap();
    let picture = ui.interact(free, ui.scope_id().with("picture"), Sense::click_and_drag());
    over_picture(viewer, ui, free);
    if viewer.show_help {
        help(viewer, ui.ctx());
    }
    controls::apply(viewer, &picture, &rows)
}

/// Of the frame.
fn figures(viewer: &mut Viewer, ui: &mut Ui, rows: &[Row]) {
    let lab = &viewer.lab;
    let times = &lab.times;
    ui.horizontal(|ui| {
        ui.strong(&viewer.stage.scene.name);
        let drawn_by = format!("{}, {}", viewer.method.name(), lab.gpu().adapter);
        // Whole, it could widen the panel.
        ui.add(egui::Label::new(RichText::new(drawn_by).weak()).truncate());
    });
    let on_gpu = match lab.gpu().timestamp_ns {
        Some(_) => format!(
            "GPU {:.1} + {:.1} + lights {:.1}",
            times.gpu_surface, times.gpu_receivers, times.gpu_lights
        ),
        None => "GPU without timestamps: -".to_owned(),
    };
    ui.monospace(format!("frame {:8.2} ms   {on_gpu} ms", times.frame));
    ui.monospace(format!(
        "volumes {:6.2} ms   plan {:.2}, upload {:.2}, record {:.2}",
        times.volumes, times.plan, times.upload, times.record
    ));
    let count = |is: fn(&LightPath) -> bool| rows.iter().filter(|row| is(&row.path)).count();
    let quads: u64 = rows.iter().map(|row| u64::from(row.quads)).sum();
    let built: u64 = rows.iter().map(|row| u64::from(row.quads_built)).sum();
    ui.horizontal(|ui| {
        ui.monospace(format!("{} lights:", rows.len()));
        let zpass = count(|path| matches!(path, LightPath::ZPass { .. }));
        let zfail = count(|path| matches!(path, LightPath::ZFail(_)));
        let skipped = count(|path| matches!(path, LightPath::Skipped(_)));
        for (number, name, color) in [
            (zpass, "z-pass", GREEN),
            (zfail, "z-fail", RED),
            (skipped, "skipped", GREY),
        ] {
            ui.label(
                RichText::new(format!("{number} {name}"))
                    .monospace()
                    .color(color),
            );
        }
    });
    ui.monospace(format!("{quads} of {built} quads drawn"));
    ui.horizontal(|ui| {
        ui.label("brightness");
        ui.add(egui::Slider::new(&mut viewer.stops, -6.0..=6.0).suffix(" stops"));
        ui.weak(format!("speed {:.3} m/s", viewer.camera.speed_m_s));
        ui.weak("H: keys");
    });
    if viewer.can_play() {
        time(viewer, ui);
    }
}

/// Of what moves.
fn time(viewer: &mut Viewer, ui: &mut Ui) {
    ui.horizontal(|ui| {
        let does = if viewer.plays { "stop" } else { "play" };
        if ui.button(format!("{does} (T)")).clicked() {
            viewer.plays ^= true;
        }
        let mut time_s = viewer.stage.time_s;
        let shown = egui::DragValue::new(&mut time_s).suffix(" s").speed(0.01);
        if ui.add(shown.fixed_decimals(2)).changed() {
            viewer.set_time(time_s);
        }
        ui.weak(format!("moving instances: {}", viewer.stage.actors.len()));
    });
}

fn debug_views(viewer: &mut Viewer, ui: &mut Ui) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 3.0;
        for (number, view) in (1..).zip(DebugView::ALL) {
            let text = format!("{number} {}", view.name());
            ui.selectable_value(&mut viewer.shown, view, text);
        }
    });
    ui.label(note(viewer));
}

/// What the debug view shows, or why it shows nothing yet.
fn note(viewer: &Viewer) -> String {
    let (shown, chosen) = (viewer.shown, viewer.mix.chosen);
    let of = match (shown, chosen) {
        (_, Some(light)) => format!(" ({})", viewer.lights[light].name),
        (DebugView::Volumes | DebugView::Silhouettes, None) => " (all lights)".to_owned(),
        _ => String::new(),
    };
    if !viewer.trouble.is_empty() {
        return viewer.trouble.clone();
    }
    if let Some(overlay) = &viewer.overlay {
        return overlay.note.clone();
    }
    match (shown, viewer.check.progress()) {
        (DebugView::Wrong, Some(done)) => format!("the oracle looks: {:.0} %", done * 100.0),
        (DebugView::Wrong, None) => "press O to compare this view with the oracle".to_owned(),
        (DebugView::Layers | DebugView::Lights, _) => "counted once the camera rests".to_owned(),
        _ if shown.needs_light() && chosen.is_none() => {
            format!("{}: choose a light", shown.meaning())
        }
        (DebugView::Lit | DebugView::Scissors, _) => shown.meaning().to_owned(),
        _ => format!("{}{of}", shown.meaning()),
    }
}

/// More about the chosen light.
fn chosen(viewer: &mut Viewer, ui: &mut Ui, rows: &[Row]) {
    let Some(row) = viewer.mix.chosen.and_then(|light| rows.get(light)) else {
        ui.weak("no light is chosen: click one, or press Down");
        return;
    };
    let volume = &viewer.lab.volumes.lights[row.number];
    let light = &viewer.lights[row.number].light;
    ui.horizontal(|ui| {
        ui.strong(&row.name);
        let range = match light.is_directional() {
            true => "no range".to_owned(),
            false => format!("range {:.2} m", light.range),
        };
        ui.label(format!("{}, {range}", row.kind));
        let reason = row.path.reason();
        if !reason.is_empty() {
            ui.weak(reason);
        }
    });
    ui.monospace(format!(
        "{} triangles in reach, {} cast, {} quads ({} drawn), {} layers at most",
        volume.subset_triangles,
        volume.facing_triangles,
        row.quads_built,
        row.quads,
        volume.layers_bound,
    ));
}

/// Columns: where each begins in a row, and whether it ends there instead.
const AT: [(Column, f32, Align2); 6] = [
    (Column::Name, 44.0, Align2::LEFT_CENTER),
    (Column::Kind, 190.0, Align2::LEFT_CENTER),
    (Column::Path, 232.0, Align2::LEFT_CENTER),
    (Column::Quads, 322.0, Align2::RIGHT_CENTER),
    (Column::Build, 385.0, Align2::RIGHT_CENTER),
    (Column::Cost, 445.0, Align2::RIGHT_CENTER),
];

fn list(viewer: &mut Viewer, ui: &mut Ui, rows: &[Row]) {
    ui.horizontal(|ui| {
        let filter = egui::TextEdit::singleline(&mut viewer.order.filter);
        ui.add(filter.hint_text("part of a name").desired_width(140.0));
        if ui.button("all shine (C)").clicked() {
            viewer.mix.clear();
        }
        ui.weak("S solo, M mute; white: rebuilt");
    });
    let (head, _) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    for (column, x, align) in AT {
        let at = pos2(head.left() + x, head.center().y);
        let is_order = viewer.order.column == column;
        let color = if is_order { Color32::WHITE } else { GREY };
        let rect = ui.painter().text(at, align, column.title(), font(), color);
        let response = ui.interact(
            rect.expand(2.0),
            ui.scope_id().with(column.title()),
            Sense::click(),
        );
        if response.clicked() {
            viewer.order.choose(column);
        }
    }
    ui.spacing_mut().item_spacing.y = 0.0;
    let scroll = egui::ScrollArea::vertical().auto_shrink(false);
    scroll.show_rows(ui, ROW, rows.len(), |ui, range| {
        for row in &rows[range] {
            one(viewer, ui, row);
        }
    });
}

fn font() -> FontId {
    FontId::monospace(11.5)
}

/// One row: two buttons, then the figures. A click chooses the light, or none if it was chosen.
fn one(viewer: &mut Viewer, ui: &mut Ui, row: &Row) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    let light = row.number;
    let is_chosen = viewer.mix.chosen == Some(light);
    if is_chosen || response.hovered() {
        let fill = if is_chosen {
            CHOSEN
        } else {
            Color32::from_white_alpha(14)
        };
        ui.painter().rect_filled(rect, 2.0, fill);
    }
    if response.clicked() {
        viewer.mix.chosen = (!is_chosen).then_some(light);
    }
    let mix = &mut viewer.mix;
    if button(ui, rect, 0.0, "S", light, mix.is_solo(light)) {
        mix.toggle_solo(light);
    }
    if button(ui, rect, BUTTON + 2.0, "M", light, mix.is_muted(light)) {
        mix.toggle_mute(light);
    }
    let color = match row.path {
        LightPath::ZPass { .. } => GREEN,
        LightPath::ZFail(_) => RED,
        LightPath::Skipped(_) => GREY,
    };
    let painter = ui.painter();
    for (column, x, align) in AT {
        let (text, color) = match column {
            Column::Name => (shortened(&row.name, 19), Color32::from_gray(225)),
            Column::Kind => (row.kind.chars().take(5).collect(), GREY),
            Column::Path => (row.path.name().to_owned(), color),
            Column::Quads => (row.quads.to_string(), Color32::from_gray(225)),
            Column::Build => {
                let fresh = if row.cached { GREY } else { Color32::WHITE };
                (format!("{:.0}", row.build_us), fresh)
            }
            Column::Cost => match row.gpu_us {
                Some(us) => (format!("{us:.0}"), Color32::from_gray(225)),
                None => ("-".to_owned(), GREY),
            },
        };
        let at = pos2(rect.left() + x, rect.center().y);
        painter.text(at, align, text, font(), color);
    }
}

fn button(ui: &Ui, row: Rect, x: f32, text: &str, light: usize, is_on: bool) -> bool {
    let rect = Rect::from_min_size(row.min + vec2(x, 1.0), vec2(BUTTON, ROW - 2.0));
    let response = ui.interact(rect, ui.scope_id().with((text, light)), Sense::click());
    let (fill, color) = match (is_on, response.hovered()) {
        (true, _) => (Color32::from_rgb(250, 215, 70), Color32::BLACK),
        (false, true) => (Color32::from_gray(80), Color32::WHITE),
        (false, false) => (Color32::from_gray(45), GREY),
    };
    ui.painter().rect_filled(rect, 2.0, fill);
    (ui.painter()).text(rect.center(), Align2::CENTER_CENTER, text, font(), color);
    response.clicked()
}

fn shortened(name: &str, most: usize) -> String {
    match name.chars().count() > most {
        true => name.chars().take(most - 1).chain(['…']).collect(),
        false => name.to_owned(),
    }
}

/// Counts and marks over the picture, or scissors.
fn over_picture(viewer: &Viewer, ui: &Ui, free: Rect) {
    let whole = ui.ctx().content_rect();
    let layer = egui::LayerId::background();
    let painter = ui.ctx().layer_painter(layer).with_clip_rect(free);
    if let Some(overlay) = &viewer.overlay {
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(overlay.texture.id(), whole, uv, Color32::WHITE);
    }
    if viewer.shown == DebugView::Scissors {
        let scale = 1.0 / ui.ctx().pixels_per_point();
        for (number, light) in viewer.lab.plan.drawn() {
            let path = viewer.lab.path(number);
            let color = match path {
                LightPath::ZPass { .. } => GREEN,
                LightPath::ZFail(_) => RED,
                LightPath::Skipped(_) => continue,
            };
            let s = light.scissor;
            let min = pos2(s.x as f32, s.y as f32);
            let rect = Rect::from_min_size(min, vec2(s.width as f32, s.height as f32));
            let is_chosen = viewer.mix.chosen == Some(number);
            let (width, color) = match is_chosen {
                true => (2.5, Color32::WHITE),
                false => (1.0, color.gamma_multiply(0.6)),
            };
            let (rect, stroke) = (rect * scale, Stroke::new(width, color));
            painter.rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);
        }
    }
}

fn help(viewer: &mut Viewer, ctx: &egui::Context) {
    let window = egui::Window::new("Keys").open(&mut viewer.show_help);
    window.resizable(false).collapsible(false).show(ctx, |ui| {
        egui::Grid::new("keys").show(ui, |ui| {
            for (key, what) in KEYS {
                ui.monospace(key);
                ui.label(what);
                ui.end_row();
            }
            for (number, view) in (1..).zip(DebugView::ALL) {
                ui.monospace(number.to_string());
                ui.label(view.meaning());
                ui.end_row();
            }
        });
    });
}
