//! A window on a scene: fly through it, hear each light alone, see what its shadow is made of and what
//! it costs.
//!
//! [`open`] takes a staged scene, its lights and a view, and returns when the window is closed. What
//! is drawn is what [`umbrage_lab`] draws, on a device that can present. The viewer itself knows no
//! window: it takes input events and draws into any texture; `app` brings both to the screen.
#![forbid(unsafe_code)]

mod app;
pub mod camera;
mod check;
mod controls;
mod costs;
pub mod debug_view;
mod lines;
pub mod mix;
mod moment;
mod overlay;
mod panel;
mod screen;
mod table;
mod tone;
mod viewer;

use std::path::PathBuf;

use thiserror::Error;
use umbrage_core::View;
use umbrage_lab::Culls;
use umbrage_lab::application::Application;
use umbrage_lab::gpu::{AdapterChoice, GpuError};
use umbrage_lab::lab::Method;
use umbrage_lab::picture::PictureError;
use umbrage_lab::stage::{Stage, StageLight};

pub use app::open;
pub use debug_view::DebugView;

/// What to look at.
#[derive(Debug)]
pub struct Subject {
    /// The scene.
    pub stage: Stage,
    /// Its lights, by name in the list.
    pub lights: Vec<StageLight>,
    /// Where the camera begins; the window begins with its size, in pixels.
    pub view: View,
}

/// How to look at it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Options {
    /// Which adapter draws, among those that can present.
    pub adapter: AdapterChoice,
    /// How shadows are found.
    pub method: Method,
    /// Which steps skip work.
    pub culls: Culls,
    /// What masks leave of a light in its shadow.
    pub application: Application,
    /// The debug view to begin with.
    pub shown: DebugView,
    /// Number of the light chosen at the beginning, if there is one of that number.
    pub chosen: Option<usize>,
    /// Takes a picture of the window, and closes it.
    pub screenshot: Option<Screenshot>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            adapter: AdapterChoice::default(),
            method: Method::default(),
            culls: Culls::EVERY,
            application: Application::default(),
            shown: DebugView::default(),
            chosen: None,
            screenshot: None,
        }
    }
}

/// A picture of the window's content, panels included.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Screenshot {
    /// The PNG to write.
    pub file: PathBuf,
    /// Frames to draw first, at least: it waits for what the debug view has to count, and until
    /// every light's cost is measured.
    pub frames: u32,
}

/// What was seen until the window was closed.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Seen {
    /// Name of the adapter.
    pub adapter: String,
    /// Width and height of the last frame, in pixels.
    pub size: [u32; 2],
    /// Frames drawn.
    pub frames: u64,
    /// Milliseconds of the last frame, from lights to picture, panels apart.
    pub frame_ms: f64,
}

/// Why there is no window, or none any more.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// No display to open a window on.
    #[error(
        "no window can be opened: {0}; log in at a desktop, or set DISPLAY or WAYLAND_DISPLAY, or run \
         under xvfb-run. umbrage render needs no window"
    )]
    NoWindow(String),
    /// The adapter draws, but not to the screen.
    #[error("the window's surface cannot be drawn to: {0}; choose another --adapter")]
    Surface(String),
    /// Drawing failed.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The screenshot could not be written.
    #[error(transparent)]
    Picture(#[from] PictureError),
}
