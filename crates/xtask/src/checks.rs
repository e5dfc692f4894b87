//! `cargo xtask lint` and `cargo xtask test`: the one list of what must hold.

use crate::steps::{Steps, cargo};
use crate::{Stop, browser, display, driver};

/// Formatting and clippy.
pub(crate) fn lint() -> Result<(), Stop> {
    summarised(run_lint)
}

/// All that CI runs.
pub(crate) fn test() -> Result<(), Stop> {
    driver::ensure()?;
    browser::ensure();
    display::ensure();
    summarised(|steps| {
        run_lint(steps)?;
        steps.cargo_test("test, validators on", &["--workspace"])?;
        steps.cargo("benches, once each", &["test", "--benches"])?;
        let mut doc = cargo(&["doc", "--workspace", "--no-deps"]);
        steps.run(
            "documentation",
            doc.env("RUSTDOCFLAGS", "-D warnings"),
            false,
        )
    })
}

fn run_lint(steps: &mut Steps) -> Result<(), Stop> {
    steps.cargo("format", &["fmt", "--all", "--check"])?;
    steps.cargo(
        "clippy",
        &[
            "clippy",
            "--workspace",
            "--all-targets",
            "--",
            "-D",
            "warnings",
        ],
    )
}

/// Runs a list of steps and prints their table, also when one failed.
fn summarised(list: impl FnOnce(&mut Steps) -> Result<(), Stop>) -> Result<(), Stop> {
    let mut steps = Steps::default();
    let outcome = list(&mut steps);
    println!("{}", steps.summary());
    outcome
}
