//! `cargo xtask demo`: from a fresh clone to a picture of the bundled world.

use std::process::Command;

use crate::steps::Steps;
use crate::{Stop, driver, root, target_dir};

/// The bundled world, relative to the repository root.
const DEMO_SCENE: &str = "data/worlds/colosseum.glb";

/// Exit code of `umbrage` when no usable adapter was found.
const NO_ADAPTER: i32 = 3;

/// Driver, build, render; prints where the picture is.
pub(crate) fn run() -> Result<(), Stop> {
    driver::ensure()?;
    let scene = root().join(DEMO_SCENE);
    if !scene.is_file() {
        eprintln!("{DEMO_SCENE} is missing: is this a full clone?");
        return Err(Stop::StepFailed);
    }
    Steps::default().cargo("build", &["build", "--release", "-p", "umbrage-cli"])?;

    let folder = target_dir().join("demo");
    if let Err(error) = std::fs::create_dir_all(&folder) {
        eprintln!("cannot create {}: {error}", folder.display());
        return Err(Stop::StepFailed);
    }
    let picture = folder.join("colosseum.png");
    let figures = folder.join("colosseum.json");
    let binary = target_dir()
        .join("release/umbrage")
        .with_extension(std::env::consts::EXE_EXTENSION);
    let mut render = Command::new(binary);
    render.arg("render").arg(DEMO_SCENE).arg("-o").arg(&picture);
    render
        .args(["--size", "1920x1080", "--json"])
        .arg(&figures)
        .current_dir(root());

    println!("\n==== render: every light of {DEMO_SCENE}, exact shadows, 1920x1080");
    let mut code = exit_code(&mut render);
    if code == Some(NO_ADAPTER) {
        // Driver files were there, but no device behind them: a software driver always has one.
        driver::install()?;
        code = exit_code(&mut render);
    }
    match code {
        Some(0) => {
            println!("\nThe picture: {}", picture.display());
            println!("Its figures: {}", figures.display());
            println!("Next: target/release/umbrage --help");
            Ok(())
        }
        Some(NO_ADAPTER) => {
            eprintln!("{}", driver::ADVICE);
            Err(Stop::NoDriver)
        }
        _ => Err(Stop::StepFailed),
    }
}

fn exit_code(command: &mut Command) -> Option<i32> {
    match command.status() {
        Ok(status) => status.code(),
        Err(error) => {
            eprintln!("could not start {:?}: {error}", command.get_program());
            None
        }
    }
}
