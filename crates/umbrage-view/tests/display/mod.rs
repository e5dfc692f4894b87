//! A display of a test's own: Xvfb, an X server that draws into memory.

mod find;

use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, Command, Stdio};
use std::sync::Once;

/// An X server that ends with it.
pub(crate) struct Display {
    server: Child,
    /// As in `DISPLAY`.
    pub(crate) name: String,
}

impl Display {
    /// Starts a server; says so where there is none to start.
    pub(crate) fn start() -> Option<Self> {
        let Some(server) = find::find() else {
            // Written past the test harness, which would keep it to itself as the test passes.
            static SAY: Once = Once::new();
            SAY.call_once(|| {
                let line = "skipped: no Xvfb here; `cargo xtask test` installs it\n";
                std::io::stderr().write_all(line.as_bytes()).unwrap();
            });
            return None;
        };
        // It chooses a free number, and writes it once it listens.
        let mut server = Command::new(server)
            .args(["-displayfd", "1", "-nolisten", "tcp"])
            .args(["-screen", "0", "1600x1000x24"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut number = String::new();
        let out = server.stdout.take().expect("its standard output");
        BufReader::new(out)
            .read_line(&mut number)
            .expect("its number");
        let name = format!(":{}", number.trim());
        Some(Self { server, name })
    }

    /// A command that opens its windows here.
    pub(crate) fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.name);
        command
            .env_remove("WAYLAND_DISPLAY")
            .env_remove("WAYLAND_SOCKET");
        command
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // Gone already, at worst.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
