//! Project tasks that take more than one command: `cargo xtask <task>`.
//!
//! Takes the name of a task, gives an exit code: 0 done, 1 a step failed, 2 no such task,
//! 3 no usable graphics driver. Standard library only, so that it compiles in a second.
#![forbid(unsafe_code)]

mod apt;
mod browser;
mod checks;
mod demo;
mod display;
mod driver;
mod steps;

use std::path::PathBuf;
use std::process::ExitCode;

const HELP: &str = "\
cargo xtask <task>

  demo    From a fresh clone to a picture: installs a software Vulkan driver where there is
          none (Debian, Ubuntu), builds the release binary and renders the bundled world with
          all its lights to target/demo/.
  test    Everything that CI runs, in its order, stopping at the first failure: driver,
          browser and display (installed likewise; without them the tests of HTML reports, of a
          second Vulkan driver and of windows are skipped),
          formatting, clippy, tests with every validator on (dev profile), every bench once,
          documentation.
  lint    The quick half of `test`: formatting and clippy.

More than one task may be named; they run in order. Exit codes: 0 done, 1 a step failed,
2 no such task, 3 no usable graphics driver.

Next: cargo xtask demo";

/// Why a task ended early.
#[derive(Debug, PartialEq)]
pub(crate) enum Stop {
    /// A step failed; its own output, already shown, says why.
    StepFailed,
    /// No graphics driver, and none could be installed; what to do has been printed.
    NoDriver,
}

fn main() -> ExitCode {
    let tasks: Vec<String> = std::env::args().skip(1).collect();
    if tasks.is_empty()
        || tasks
            .iter()
            .any(|t| matches!(t.as_str(), "help" | "-h" | "--help"))
    {
        println!("{HELP}");
        return ExitCode::SUCCESS;
    }
    for task in &tasks {
        let done = match task.as_str() {
            "demo" => demo::run(),
            "test" => checks::test(),
            "lint" => checks::lint(),
            other => {
                eprintln!("cargo xtask: no task is called {other:?}\n\n{HELP}");
                return ExitCode::from(2);
            }
        };
        match done {
            Ok(()) => {}
            Err(Stop::StepFailed) => return ExitCode::from(1),
            Err(Stop::NoDriver) => return ExitCode::from(3),
        }
    }
    ExitCode::SUCCESS
}

/// The repository root: two folders above this crate.
pub(crate) fn root() -> PathBuf {
    let manifest = std::env::var("CARGO_MANIFEST_DIR")
        .unwrap_or_else(|_| env!("CARGO_MANIFEST_DIR").to_owned());
    let mut root = PathBuf::from(manifest);
    root.pop();
    root.pop();
    root
}

/// Where cargo builds: `CARGO_TARGET_DIR` if set, else `target` at the root.
pub(crate) fn target_dir() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(dir) => root().join(dir),
        None => root().join("target"),
    }
}
