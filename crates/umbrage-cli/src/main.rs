//! The `umbrage` command line: `umbrage <verb> SCENE [options]`.
//!
//! Takes arguments, gives an exit code: 0 success, 1 a check failed, 2 bad input or usage,
//! 3 no usable adapter, no display for a window, or its device was lost. Each verb has its file in `verbs/`.
#![forbid(unsafe_code)]

mod actor;
mod args;
mod error;
mod json;
mod progress;
mod report;
mod setting;
mod values;
mod verbs;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Verb};

fn main() -> ExitCode {
    umbrage_lab::spans::start();
    // A usage error or --help ends here: clap prints it and exits with 2 or 0.
    let done = match Cli::parse().verb {
        Verb::Render(args) => verbs::render::run(&args),
        Verb::Inspect(args) => verbs::inspect::run(&args),
        Verb::Check(args) => verbs::check::run(&args),
        Verb::Volumes(args) => verbs::volumes::run(&args),
        Verb::Bench(args) => verbs::bench::run(&args),
        Verb::Profile(args) => verbs::profile::run(&args),
        Verb::Stress(args) => verbs::stress::run(&args),
        Verb::View(args) => verbs::view::run(*args),
        Verb::Gen(args) => verbs::generate::run(&args),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("umbrage: {error}");
            ExitCode::from(error.exit_code())
        }
    }
}
