//! What a mask makes of the surface in shadow: the three choices of Roettger, Irion and Ertl,
//! "Shadow Volumes Revisited" (2002), section 4.3.

use thiserror::Error;

use crate::method::Method;

/// What remains of a light in its shadow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Application {
    /// Nothing.
    #[default]
    Black,
    /// An ambient term, which the light adds wherever it reaches, in one more draw: an eighth of its
    /// light, whatever the surface's orientation. It falls off with the distance; the paper's, from
    /// a light without a range, does not.
    Ambient,
    /// Half of the light itself, highlights included.
    Attenuated,
}

impl Application {
    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Application::Black => "black",
            Application::Ambient => "ambient",
            Application::Attenuated => "attenuated",
        }
    }
}

/// A method that makes no mask was asked to apply it.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error(
    "{} makes no mask, so its shadows are black: ask for --shadows {} with mask-screen, \
     mask-alpha, mask-max, half or quarter", method.name(), application.name()
)]
pub struct NoMask {
    /// The method.
    pub method: Method,
    /// What was asked of it.
    pub application: Application,
}
