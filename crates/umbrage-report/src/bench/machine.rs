//! Where a run took place.
//!
//! Takes what the system tells without a question; gives plain data. What it does not tell is
//! empty or null.

use std::process::Command;

use serde::{Deserialize, Serialize};

use crate::figure::{figure, plural};
use crate::page::escape;

/// The computer and the program, so that figures can be placed and repeated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Machine {
    /// Name of the processor.
    pub cpu: String,
    /// Logical processors that this process may use.
    pub cores: u32,
    /// Threads that built volumes.
    pub threads: u32,
    /// Main memory.
    pub memory_gib: Option<f64>,
    /// Name and version.
    pub os: String,
    /// Name of the graphics adapter.
    pub adapter: String,
    /// Name and version of its driver.
    pub driver: String,
    /// Of umbrage.
    pub version: String,
}

impl Machine {
    /// This computer; adapter, driver, threads and version are the caller's to fill in.
    pub fn here() -> Self {
        let cores = std::thread::available_parallelism().map_or(0, |n| n.get() as u32);
        let (cpu, memory_gib, os) = match std::env::consts::OS {
            "linux" => linux(),
            "macos" => macos(),
            other => (
                std::env::var("PROCESSOR_IDENTIFIER").unwrap_or_default(),
                None,
                other.to_owned(),
            ),
        };
        Self {
            cpu,
            cores,
            memory_gib,
            os: format!("{os} ({})", std::env::consts::ARCH),
            ..Self::default()
        }
    }
}

impl Machine {
    /// What is known of it as HTML, and when (RFC 3339) it was at work; the rest is left out.
    pub(crate) fn html(&self, when: &str) -> String {
        let Self {
            cpu,
            cores,
            threads,
            memory_gib,
            os,
            adapter,
            driver,
            version,
        } = self;
        let mut processor = cpu.clone();
        if *cores > 0 {
            let gap = if cpu.is_empty() { "" } else { ", " };
            processor += &format!("{gap}{}", plural(*cores as usize, "core"));
            if *threads > 0 && threads != cores {
                processor += &format!(", {} used", plural(*threads as usize, "thread"));
            }
        }
        let memory = memory_gib.map_or_else(String::new, |gib| format!("{} GiB", figure(gib)));
        let date = when.replacen('T', " ", 1).replace('Z', " UTC");
        let entries = [
            ("Adapter", adapter),
            ("Driver", driver),
            ("Processor", &processor),
            ("Memory", &memory),
            ("System", os),
            ("Umbrage", version),
            ("Begun", &date),
        ];
        let mut html = String::from("<dl class=\"machine\">");
        for (name, value) in entries.into_iter().filter(|(_, value)| !value.is_empty()) {
            html += &format!("<div><dt>{name}</dt><dd>{}</dd></div>", escape(value));
        }
        html + "</dl>"
    }
}

fn linux() -> (String, Option<f64>, String) {
    let read = |path| std::fs::read_to_string(path).unwrap_or_default();
    let cpu = value(&read("/proc/cpuinfo"), "model name", ':');
    let memory = value(&read("/proc/meminfo"), "MemTotal", ':');
    let os = value(&read("/etc/os-release"), "PRETTY_NAME", '=');
    let kib = memory.trim_end_matches(" kB").parse::<f64>().ok();
    let os = if os.is_empty() {
        "Linux"
    } else {
        os.trim_matches('"')
    };
    (cpu, kib.map(|kib| kib / (1024.0 * 1024.0)), os.to_owned())
}

fn macos() -> (String, Option<f64>, String) {
    let ask = |program: &str, args: &[&str]| {
        let output = Command::new(program).args(args).output();
        output.map_or_else(
            |_| String::new(),
            |output| String::from_utf8_lossy(&output.stdout).trim().to_owned(),
        )
    };
    let bytes = ask("sysctl", &["-n", "hw.memsize"]).parse::<f64>().ok();
    (
        ask("sysctl", &["-n", "machdep.cpu.brand_string"]),
        bytes.map(|bytes| bytes / (1024.0 * 1024.0 * 1024.0)),
        format!("macOS {}", ask("sw_vers", &["-productVersion"])),
    )
}

/// What follows `key` and the separator on the first line that begins with it.
fn value(text: &str, key: &str, separator: char) -> String {
    text.lines()
        .filter_map(|line| line.split_once(separator))
        .find(|(name, _)| name.trim() == key)
        .map_or_else(String::new, |(_, value)| value.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_value_of_a_key_and_nothing_for_another() {
        let text = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nMemTotal:  16 kB\n";
        assert_eq!(value(text, "model name", ':'), "Some CPU @ 2 GHz");
        assert_eq!(value(text, "MemTotal", ':'), "16 kB");
        assert_eq!(value(text, "model", ':'), "");
    }

    #[test]
    fn this_machine_has_a_processor_at_least() {
        assert!(Machine::here().cores > 0);
    }
}
