//! Installing packages where that needs no question: Debian and its descendants, as root.
//!
//! Takes names of packages; gives whether apt installed them. Its messages stay visible.

use std::process::{Command, Stdio};

/// An apt that may be used without a question.
#[derive(Clone, Copy)]
pub(crate) enum Apt {
    AlreadyRoot,
    PasswordlessSudo,
}

impl Apt {
    /// If this is a system with apt, and this user root or allowed to become root.
    pub(crate) fn here() -> Option<Self> {
        let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
        if !is_debian_like(&release) {
            return None;
        }
        let id = Command::new("id").arg("-u").output().ok()?;
        if String::from_utf8_lossy(&id.stdout).trim() == "0" {
            return Some(Self::AlreadyRoot);
        }
        let mut ask = Command::new("sudo");
        ask.args(["-n", "true"])
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        ask.status()
            .ok()?
            .success()
            .then_some(Self::PasswordlessSudo)
    }

    /// Brings the package lists up to date, then installs.
    pub(crate) fn install(self, packages: &[&str]) -> bool {
        if !self.run(&["update"]) {
            println!("apt-get update failed; trying with the package lists that are there.");
        }
        self.run(&[&["install", "-y", "--no-install-recommends"], packages].concat())
    }

    fn run(self, args: &[&str]) -> bool {
        let mut command = match self {
            Self::AlreadyRoot => Command::new("env"),
            Self::PasswordlessSudo => {
                let mut command = Command::new("sudo");
                command.args(["-n", "env"]);
                command
            }
        };
        command
            .args(["DEBIAN_FRONTEND=noninteractive", "apt-get"])
            .args(args);
        command.status().is_ok_and(|status| status.success())
    }
}

fn is_debian_like(os_release: &str) -> bool {
    os_release
        .lines()
        .filter_map(|line| line.strip_prefix("ID=").or(line.strip_prefix("ID_LIKE=")))
        .any(|ids| {
            ids.trim_matches('"')
                .split(' ')
                .any(|id| matches!(id, "debian" | "ubuntu"))
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn debian_and_its_descendants_have_apt() {
        assert!(is_debian_like("NAME=x\nID=debian\n"));
        assert!(is_debian_like("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n"));
        assert!(!is_debian_like("ID=fedora\nVERSION_ID=41\n"));
    }
}
