//! Steps of a task: takes commands, runs them one after the other, gives a table of durations.
//!
//! Output of the commands stays visible as they run. Where the standard output of a step passes
//! through (test runs), libtest's result lines are counted on the way.

use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::{Stop, browser, root};

/// Tells the tests which Vulkan driver to compare with the usual one.
const SECOND_DRIVER: &str = "UMBRAGE_SECOND_DRIVER";

/// Tests counted from libtest's result lines.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TestCount {
    pub(crate) passed: u64,
    pub(crate) failed: u64,
    pub(crate) ignored: u64,
}

impl TestCount {
    /// Adds one line if it is `test result: ok. 12 passed; 0 failed; 1 ignored; ...`.
    fn read_line(&mut self, line: &str) {
        let Some(result) = line.strip_prefix("test result: ") else {
            return;
        };
        let counts = result.split_once(". ").map_or("", |(_, counts)| counts);
        for part in counts.split("; ") {
            let Some((number, word)) = part.split_once(' ') else {
                continue;
            };
            let Ok(number) = number.parse::<u64>() else {
                continue;
            };
            match word {
                "passed" => self.passed += number,
                "failed" => self.failed += number,
                "ignored" => self.ignored += number,
                _ => {}
            }
        }
    }
}

struct Done {
    name: &'static str,
    took: Duration,
    passed: bool,
    tests: Option<TestCount>,
}

/// The steps run so far.
#[derive(Default)]
pub(crate) struct Steps {
    done: Vec<Done>,
}

impl Steps {
    /// Runs one cargo command under a heading; its output goes straight to the terminal.
    pub(crate) fn cargo(&mut self, name: &'static str, args: &[&str]) -> Result<(), Stop> {
        self.run(name, &mut cargo(args), false)
    }

    /// Runs `cargo test` with `args`, and counts the tests. They are told of a second Vulkan driver
    /// where there is one, unless the caller's environment says which.
    pub(crate) fn cargo_test(&mut self, name: &'static str, args: &[&str]) -> Result<(), Stop> {
        let mut command = cargo(&["test"]);
        if let (None, Some(driver)) = (std::env::var_os(SECOND_DRIVER), browser::vulkan_driver()) {
            command.env(SECOND_DRIVER, driver);
        }
        self.run(name, command.args(args), true)
    }

    /// Runs any command under a heading.
    pub(crate) fn run(
        &mut self,
        name: &'static str,
        command: &mut Command,
        count_tests: bool,
    ) -> Result<(), Stop> {
        println!("\n==== {name}: {}", spelled(command));
        let start = Instant::now();
        let mut tests = TestCount::default();
        let passed = if count_tests {
            echo(command, &mut tests)
        } else {
            status(command)
        };
        let took = start.elapsed();
        println!("---- {name}: {} in {}", verdict(passed), seconds(took));
        self.done.push(Done {
            name,
            took,
            passed,
            tests: count_tests.then_some(tests),
        });
        if passed {
            Ok(())
        } else {
            Err(Stop::StepFailed)
        }
    }

    /// The table of all steps; its last line is `N passed, M failed`, in tests where any ran,
    /// else in steps. A step that failed without naming a failed test counts as one failure.
    pub(crate) fn summary(&self) -> String {
        let mut table = String::from("\n");
        let mut total = Duration::ZERO;
        let mut tests = TestCount::default();
        for step in &self.done {
            total += step.took;
            let mut row = format!(
                "{:<24} {:>9}  {}",
                step.name,
                seconds(step.took),
                verdict(step.passed)
            );
            if let Some(count) = step.tests {
                row += &format!("  {} passed, {} failed", count.passed, count.failed);
                if count.ignored > 0 {
                    row += &format!(", {} ignored", count.ignored);
                }
                tests.passed += count.passed;
                tests.failed += count.failed;
            } else if step.passed && !self.counts_tests() {
                tests.passed += 1;
            }
            table += &row;
            table.push('\n');
        }
        if tests.failed == 0 {
            tests.failed = self.done.iter().filter(|step| !step.passed).count() as u64;
        }
        table += &format!("{:<24} {:>9}\n", "total", seconds(total));
        table += &format!("{} passed, {} failed", tests.passed, tests.failed);
        table
    }

    fn counts_tests(&self) -> bool {
        self.done.iter().any(|step| step.tests.is_some())
    }
}

/// The cargo that runs this task, at the repository root.
pub(crate) fn cargo(args: &[&str]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args).current_dir(root());
    command
}

fn status(command: &mut Command) -> bool {
    match command.status() {
        Ok(status) => status.success(),
        Err(error) => could_not_start(command, &error),
    }
}

/// Runs `command`, repeats its standard output line by line, and counts test results.
fn echo(command: &mut Command, tests: &mut TestCount) -> bool {
    let mut child = match command.stdout(Stdio::piped()).spawn() {
        Ok(child) => child,
        Err(error) => return could_not_start(command, &error),
    };
    if let Some(out) = child.stdout.take() {
        for line in BufReader::new(out).split(b'\n').map_while(Result::ok) {
            let line = String::from_utf8_lossy(&line);
            println!("{line}");
            tests.read_line(line.trim_end());
        }
    }
    child.wait().is_ok_and(|status| status.success())
}

fn could_not_start(command: &Command, error: &std::io::Error) -> bool {
    eprintln!("could not start {:?}: {error}", command.get_program());
    false
}

/// A command as one would type it, with the environment that was set for it.
fn spelled(command: &Command) -> String {
    let set = command.get_envs().filter_map(|(key, value)| {
        let value = value?.to_string_lossy();
        Some(format!("{}={value:?} ", key.to_string_lossy()))
    });
    let program = std::path::Path::new(command.get_program());
    let name = program
        .file_name()
        .unwrap_or(OsStr::new("?"))
        .to_string_lossy();
    let args = command
        .get_args()
        .map(|arg| format!(" {}", arg.to_string_lossy()));
    set.chain([name.into_owned()]).chain(args).collect()
}

fn verdict(passed: bool) -> &'static str {
    if passed { "ok" } else { "FAILED" }
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn result_lines_are_counted_and_nothing_else() {
        let mut tests = TestCount::default();
        for line in [
            "test result: ok. 12 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.00s",
            "test result: FAILED. 3 passed; 2 failed; 0 ignored; 0 measured; 0 filtered out",
            "test mesh::tests::result ... ok",
            "running 12 tests",
        ] {
            tests.read_line(line);
        }
        assert_eq!(
            tests,
            TestCount {
                passed: 15,
                failed: 2,
                ignored: 1
            }
        );
    }

    #[test]
    fn summary_ends_with_counts_and_a_failed_step_is_a_failure() {
        let step = |name, passed, tests| Done {
            name,
            took: Duration::from_secs(1),
            passed,
            tests,
        };
        let count = TestCount {
            passed: 7,
            failed: 0,
            ignored: 0,
        };
        let mut steps = Steps {
            done: vec![step("lint", true, None), step("t", true, Some(count))],
        };
        assert!(steps.summary().ends_with("\n7 passed, 0 failed"));
        steps.done.push(step("doc", false, None));
        assert!(steps.summary().ends_with("\n7 passed, 1 failed"));
    }
}
