//! `umbrage view`: under an X server that draws into memory, and where there is no display.

mod common;
#[path = "../../umbrage-view/tests/display/mod.rs"]
mod display;

use std::process::Command;

use common::{Folder, assert_keys, png_rgb, refused};
use display::Display;
use serde_json::Value;

const CITY: &str = "gen:city?triangles=2000&lights=12&seed=4";
const SIZE: [usize; 2] = [900, 500];

/// Opens the window, and gives what it reported and its screenshot.
fn view(display: &Display, folder: &Folder, more: &[&str]) -> (Value, Vec<[u8; 3]>) {
    let picture = folder.path("window.png");
    let mut command = display.command(env!("CARGO_BIN_EXE_umbrage"));
    let fixed = ["view", CITY, "--size", "900x500", "--json", "-", "--quiet"];
    command
        .args(fixed)
        .args(["--screenshot", &picture])
        .args(more);
    let output = command.output().expect("the binary starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{more:?}: {errors}");
    let report = serde_json::from_slice(&output.stdout).expect("JSON");
    let (size, rgb) = png_rgb(&picture);
    assert_eq!(size, SIZE.map(|side| side as u32));
    (report, rgb)
}

/// Pixels left of the panel that are about this colour.
fn count(rgb: &[[u8; 3]], is: impl Fn([u8; 3]) -> bool) -> usize {
    let rows = rgb.chunks_exact(SIZE[0]);
    rows.flat_map(|row| &row[..400]).filter(|p| is(**p)).count()
}

#[test]
fn each_debug_view_shows_what_it_is_about() {
    let Some(display) = Display::start() else {
        return;
    };
    let folder = Folder::new("view");
    let (report, lit) = view(&display, &folder, &["--frames", "2"]);
    assert_keys(&report, "scene method adapter size frames frame_ms");
    assert!(report["frames"].as_u64() >= Some(2) && report["frame_ms"].as_f64() > Some(0.0));
    let green = |[r, g, b]: [u8; 3]| g > 90 && g > r.saturating_add(35) && g > b.saturating_add(35);
    let white = |p: [u8; 3]| p.iter().all(|&c| c > 225);
    let orange = |[r, g, b]: [u8; 3]| r > 200 && (100..200).contains(&g) && b < 110;
    let red = |[r, g, b]: [u8; 3]| r > 240 && g < 20 && b < 20;
    for (debug, select, is, least) in [
        ("volumes", None, &green as &dyn Fn([u8; 3]) -> bool, 300),
        ("scissors", None, &green, 100),
        ("silhouettes", None, &white, 50),
        ("subset", Some("lamp_0"), &orange, 50),
    ] {
        let mut options = vec!["--debug", debug, "--frames", "1"];
        options.extend(select.into_iter().flat_map(|name| ["--select", name]));
        let (_, shown) = view(&display, &folder, &options);
        let [with, without] = [count(&shown, is), count(&lit, is)];
        assert!(with >= without + least, "{debug}: {with}, lit: {without}");
    }
    // An exact method is nowhere wrong; no shadows at all are, and are marked.
    let check = |method| {
        let options = ["--debug", "wrong", "--method", method, "--frames", "1"];
        count(&view(&display, &folder, &options).1, red)
    };
    assert_eq!(check("counter"), 0);
    assert!(check("none") > 500);
}

#[test]
fn without_a_display_it_says_what_to_do() {
    let output = Command::new(env!("CARGO_BIN_EXE_umbrage"))
        .args(["view", CITY, "--size", "64x48", "--quiet"])
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .output()
        .expect("the binary starts");
    if !cfg!(target_os = "linux") {
        return;
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{errors}");
    assert!(
        errors.contains("DISPLAY") && !errors.contains("panicked"),
        "{errors}"
    );
}

#[test]
fn what_is_not_there_is_refused_by_name() {
    let errors = refused(2, &["view", CITY, "--debug", "ghosts"]);
    assert!(errors.contains("silhouettes"), "{errors}");
    let errors = refused(2, &["view", CITY, "--select", "nobody", "--quiet"]);
    assert!(
        errors.contains("nobody") && errors.contains("lamp_0"),
        "{errors}"
    );
    refused(2, &["view", CITY, "--frames", "0", "--screenshot", "x.png"]);
}
