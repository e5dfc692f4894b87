//! How far a long step is, on standard error.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use umbrage_scene::Progress;

/// A bar that goes from stage to stage; invisible with `--quiet` and where no one watches.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
    quiet: bool,
}

impl Bar {
    pub(crate) fn new(quiet: bool) -> Self {
        let seen = !quiet && std::io::stderr().is_terminal();
        let target = if seen {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(None, target);
        if seen {
            bar.enable_steady_tick(Duration::from_millis(120));
        }
        Self { bar, quiet }
    }

    /// A line for whoever reads standard error, watched or not; none with `--quiet`.
    pub(crate) fn say(&self, line: &str) {
        if !self.quiet {
            self.bar.suspend(|| eprintln!("{line}"));
        }
    }
}

impl Progress for Bar {
    fn stage(&self, name: &str, total: u64) {
        let template = if total > 0 {
            "{msg:<24} {wide_bar} {pos}/{len}"
        } else {
            "{msg:<24} {spinner}"
        };
        // The templates are constants that the test below parses.
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
        self.bar.set_length(total);
        self.bar.set_position(0);
        self.bar.set_message(name.to_owned());
    }

    fn advance(&self, done: u64) {
        self.bar.set_position(done);
    }
}

/// A bar over many steps of some seconds each, with the time that is left.
#[derive(Debug)]
pub(crate) struct Steps {
    bar: Bar,
    /// Of the step at hand, in [`Steps::PARTS`] a step.
    begun: AtomicU64,
}

impl Steps {
    const PARTS: u64 = 1000;

    pub(crate) fn new(quiet: bool, steps: usize) -> Self {
        let bar = Bar::new(quiet);
        if let Ok(style) = ProgressStyle::with_template(TIMED) {
            bar.bar.set_style(style);
        }
        bar.bar.set_length(steps as u64 * Self::PARTS);
        Self {
            bar,
            begun: AtomicU64::new(0),
        }
    }

    /// A line for whoever reads standard error.
    pub(crate) fn say(&self, line: &str) {
        self.bar.say(line);
    }

    /// Says what is being done.
    pub(crate) fn now(&self, scene: &str, what: &str) {
        let name = scene.rsplit('/').next().unwrap_or(scene);
        self.bar.bar.set_message(format!("{name}: {what}"));
    }

    /// A share of the step at hand is done; later calls with less change nothing.
    pub(crate) fn within(&self, share: f64) {
        let part = (share.clamp(0.0, 1.0) * Self::PARTS as f64) as u64;
        let done = self.begun.load(Ordering::Relaxed) + part;
        self.bar.bar.set_position(done.max(self.bar.bar.position()));
    }

    /// The step at hand is done.
    pub(crate) fn step(&self) {
        let done = self.begun.fetch_add(Self::PARTS, Ordering::Relaxed) + Self::PARTS;
        self.bar.bar.set_position(done);
    }
}

const TIMED: &str = "{msg:<44} {wide_bar} {percent:>3} %, {eta} left";

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quiet_is_hidden_and_still_counts() {
        let bar = Bar::new(true);
        bar.stage("read", 10);
        bar.advance(4);
        assert!(bar.bar.is_hidden());
        assert_eq!((bar.bar.position(), bar.bar.length()), (4, Some(10)));
    }

    #[test]
    fn steps_count_whole_and_in_part_and_never_go_back() {
        assert!(ProgressStyle::with_template(TIMED).is_ok());
        let steps = Steps::new(true, 4);
        steps.now("a/b.glb", "oracle");
        steps.within(0.5);
        steps.within(0.25);
        assert_eq!(steps.bar.bar.position(), 500);
        steps.step();
        steps.within(0.1);
        assert_eq!(
            (steps.bar.bar.position(), steps.bar.bar.length()),
            (1100, Some(4000))
        );
    }
}
