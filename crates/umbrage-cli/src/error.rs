//! Why a verb ended early, and the exit code that says so.

use std::fmt::Display;
use std::path::Path;

use thiserror::Error;
use umbrage_core::world::SavedWorldError;
use umbrage_lab::application::NoMask;
use umbrage_lab::gpu::GpuError;
use umbrage_lab::picture::PictureError;
use umbrage_lab::stage::StageError;
use umbrage_report::bench::{BaselineError, OtherSettings};
use umbrage_view::ViewError;

/// The one error of the command line. Wrong options never get here: clap reports them.
#[derive(Debug, Error)]
pub(crate) enum CliError {
    /// A scene, light file, option value or output path that cannot be used.
    #[error("{0}")]
    BadInput(String),
    /// No adapter that satisfies `--adapter`, one whose device was lost, or no display for a window.
    #[error("{0}")]
    NoAdapter(String),
    /// The verb did its work, and what it checks does not hold.
    #[error("check failed: {0}")]
    CheckFailed(String),
}

impl CliError {
    /// The exit code; scripts depend on it.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            CliError::CheckFailed(_) => 1,
            CliError::BadInput(_) => 2,
            CliError::NoAdapter(_) => 3,
        }
    }

    /// A file that could not be read, written or understood.
    pub(crate) fn file(path: &Path, why: impl Display) -> Self {
        CliError::BadInput(format!("{}: {why}", path.display()))
    }
}

impl From<umbrage_scene::SceneError> for CliError {
    fn from(error: umbrage_scene::SceneError) -> Self {
        CliError::BadInput(error.to_string())
    }
}

impl From<StageError> for CliError {
    fn from(error: StageError) -> Self {
        let remedy = match &error {
            // What is no world may be dear to someone, and what the system says is no fault of it.
            StageError::SavedWorld {
                error: SavedWorldError::NotASavedWorld,
                ..
            } => "",
            StageError::SavedWorld {
                error: SavedWorldError::Io(_),
                ..
            } => "; is the folder there and writable?",
            StageError::SavedWorld { .. } => ": delete the file, or name another with --world",
            _ => "",
        };
        CliError::BadInput(format!("{error}{remedy}"))
    }
}

impl From<GpuError> for CliError {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::NoAdapter { .. } | GpuError::NoDevice { .. } | GpuError::DeviceLost(_) => {
                CliError::NoAdapter(error.to_string())
            }
            _ => CliError::BadInput(error.to_string()),
        }
    }
}

impl From<ViewError> for CliError {
    fn from(error: ViewError) -> Self {
        match error {
            ViewError::Gpu(error) => error.into(),
            ViewError::NoWindow(_) | ViewError::Surface(_) => {
                CliError::NoAdapter(error.to_string())
            }
            _ => CliError::BadInput(error.to_string()),
        }
    }
}

impl From<NoMask> for CliError {
    fn from(error: NoMask) -> Self {
        CliError::BadInput(error.to_string())
    }
}

impl From<BaselineError> for CliError {
    fn from(error: BaselineError) -> Self {
        CliError::BadInput(error.to_string())
    }
}

impl From<OtherSettings> for CliError {
    fn from(error: OtherSettings) -> Self {
        CliError::BadInput(format!("--baseline: {error}"))
    }
}

impl From<PictureError> for CliError {
    fn from(error: PictureError) -> Self {
        CliError::BadInput(error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exit_codes_are_fixed() {
        assert_eq!(CliError::CheckFailed(String::new()).exit_code(), 1);
        assert_eq!(CliError::BadInput(String::new()).exit_code(), 2);
        assert_eq!(CliError::NoAdapter(String::new()).exit_code(), 3);
    }

    #[test]
    fn a_lost_device_is_no_usable_adapter() {
        let error = CliError::from(GpuError::DeviceLost("hung".into()));
        assert_eq!(error.exit_code(), 3);
        assert!(error.to_string().contains("--adapter"), "{error}");
    }

    #[test]
    fn a_baseline_that_is_none_is_bad_input() {
        let error = umbrage_report::bench::read(Path::new("no/such/report.json")).unwrap_err();
        let error = CliError::from(error);
        assert_eq!(error.exit_code(), 2);
        assert!(error.to_string().contains("no/such/report.json"), "{error}");
    }
}
