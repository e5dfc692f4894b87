//! A display for the tests of windows: Xvfb, an X server that draws into memory.
//!
//! Without one those tests are skipped, each saying so.

#[path = "../../umbrage-view/tests/display/find.rs"]
mod places;

use crate::apt::Apt;
use places::find;

/// What to do where none can be installed for the user.
const ADVICE: &str = "\
No Xvfb here: the tests that open a window will be skipped.
  Debian, Ubuntu   apt-get install xvfb libxkbcommon-x11-0 libx11-xcb1 libxcursor1 libxi6
  Fedora, Arch     dnf install xorg-x11-server-Xvfb, pacman -S xorg-server-xvfb";

/// Installs Xvfb, and the libraries that windows need, unless it is there; prints what to do
/// otherwise. Other systems have their own displays, which tests do not open windows on.
pub(crate) fn ensure() {
    if !cfg!(target_os = "linux") || find().is_some() {
        return;
    }
    if let Some(apt) = Apt::here() {
        println!("No Xvfb here: installing it through apt.");
        let packages = [
            "xvfb",
            "libxkbcommon-x11-0",
            "libx11-xcb1",
            "libxcursor1",
            "libxi6",
        ];
        if apt.install(&packages) && find().is_some() {
            println!("Installed {}.", packages.join(", "));
            return;
        }
    }
    eprintln!("{ADVICE}");
}
