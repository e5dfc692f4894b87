//! `cargo xtask demo`: from a fresh clone to pictures of the bundled worlds.

use std::path::Path;
use std::process::Command;

use crate::steps::Steps;
use crate::{Stop, driver, root, target_dir};

/// A bundled world, relative to the repository root, and where to stand in it.
struct Demo {
    scene: &'static str,
    camera: &'static str,
    picture: &'static str,
}

const DEMOS: [Demo; 2] = [
    Demo {
        scene: "data/worlds/colosseum.glb",
        camera: "60,60,60,0,10,-40",
        picture: "colosseum",
    },
    Demo {
        scene: "data/worlds/stormkeep.glb",
        camera: "auto",
        picture: "stormkeep",
    },
];

/// Exit code of `umbrage` when no usable adapter was found.
const NO_ADAPTER: i32 = 3;

/// Driver, build, render; prints where the pictures are.
pub(crate) fn run() -> Result<(), Stop> {
    driver::ensure()?;
    Steps::default().cargo("build", &["build", "--release", "-p", "umbrage-cli"])?;
    let folder = target_dir().join("demo");
    if let Err(error) = std::fs::create_dir_all(&folder) {
        eprintln!("cannot create {}: {error}", folder.display());
        return Err(Stop::StepFailed);
    }
    for demo in &DEMOS {
        render(demo, &folder)?;
    }
    println!("\nNext: target/release/umbrage --help");
    Ok(())
}

fn render(demo: &Demo, folder: &Path) -> Result<(), Stop> {
    let scene = demo.scene;
    if !root().join(scene).is_file() {
        eprintln!("{scene} is missing: is this a full clone?");
        return Err(Stop::StepFailed);
    }
    let picture = folder.join(demo.picture).with_extension("png");
    let figures = folder.join(demo.picture).with_extension("json");
    let binary = target_dir()
        .join("release/umbrage")
        .with_extension(std::env::consts::EXE_EXTENSION);
    let mut render = Command::new(binary);
    render
        .args([
            "render",
            scene,
            "--camera",
            demo.camera,
            "--size",
            "1920x1080",
            "-o",
        ])
        .arg(&picture)
        .arg("--json")
        .arg(&figures)
        .current_dir(root());

    println!("\n==== render: every light of {scene}, exact shadows, 1920x1080");
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
