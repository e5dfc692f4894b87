//! `examples/viewer.rs`, run under an X server that draws into memory.

#[path = "../crates/umbrage-view/tests/display/mod.rs"]
mod display;

use std::path::PathBuf;

use display::Display;

/// Cargo builds it with this test: `target/PROFILE/examples/viewer`, beside `deps/`.
fn example() -> PathBuf {
    let test = std::env::current_exe().expect("this test is a file");
    let folder = test.ancestors().nth(2).expect("it lies in deps/");
    let name = format!("viewer{}", std::env::consts::EXE_SUFFIX);
    let example = folder.join("examples").join(name);
    assert!(example.is_file(), "build it: cargo build --example viewer");
    example
}

#[test]
fn the_example_opens_a_window_and_draws() {
    let Some(display) = Display::start() else {
        return;
    };
    let name = format!("umbrage-viewer-{}.png", std::process::id());
    let picture = std::env::temp_dir().join(name);
    let mut command = display.command(example());
    let command = command
        .arg("gen:city?triangles=2000&lights=16")
        .arg(&picture);
    let output = command.output().expect("the example starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let png = std::fs::read(&picture).expect("a picture");
    // Left behind at worst: it is the system's temporary folder.
    let _ = std::fs::remove_file(&picture);
    assert!(png.len() > 20_000, "an empty window: {} bytes", png.len());
}
