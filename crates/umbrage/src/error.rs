//! What can go wrong.

use thiserror::Error;
use umbrage_core::world::{ObjectError, SavedWorldError, WorldError};
use umbrage_wgpu::RenderError;
use wgpu::TextureFormat;

/// Why the library cannot do what it is asked. Whatever it is, nothing was changed that a later call
/// would stumble over.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Error {
    /// Indices that do not make up triangles.
    #[error("{indices} indices of mesh {mesh}: hand over three a triangle")]
    Indices {
        /// Which of the meshes.
        mesh: usize,
        /// Indices given.
        indices: usize,
    },
    /// Casting rules that fit no triangles.
    #[error(
        "{casting} casting rules for {triangles} triangles of mesh {mesh}: hand over one for all, \
         or one a triangle"
    )]
    Casting {
        /// Which of the meshes.
        mesh: usize,
        /// Rules given.
        casting: usize,
        /// Triangles given.
        triangles: usize,
    },
    /// A mesh that cannot become a world.
    #[error(transparent)]
    World(#[from] WorldError),
    /// An object that cannot be inserted, moved or removed; a handle that is no longer valid.
    #[error(transparent)]
    Object(#[from] ObjectError),
    /// A world that cannot be saved.
    #[error(transparent)]
    Save(#[from] SavedWorldError),
    /// A light that cannot shine.
    #[error(
        "not a light: give a finite position, a range above zero, a direction that is not zero \
         and a cone of at most 180 degrees to each side"
    )]
    Light,
    /// A handle of a light that was removed, or of another set.
    #[error("no such light in this set: it was removed, or belongs to another set")]
    UnknownLight,
    /// A view from which nothing can be seen.
    #[error("not a view: {what}")]
    View {
        /// What is wrong with it.
        what: &'static str,
    },
    /// A format that the device cannot draw into as it is asked to.
    #[error("{format:?} {what}")]
    Format {
        /// The format.
        format: TextureFormat,
        /// What is wrong with it, and what to do.
        what: &'static str,
    },
    /// Masks of more than one sample a pixel.
    #[error(
        "no mask of {samples} samples a pixel: draw lights in a pass of your own, or shade with \
         one sample"
    )]
    MaskSamples {
        /// As the host has it.
        samples: u32,
    },
    /// A mask that was not asked for.
    #[error("masks were not asked for: create the renderer for Host::with_mask")]
    NoMask,
    /// A mask that does not fit.
    #[error(
        "a mask of {found:?} pixels for {lights} lights; {needed:?} pixels for {slots} lights are \
         needed: make a new one"
    )]
    Mask {
        /// Its size.
        found: [u32; 2],
        /// Lights it holds.
        lights: u32,
        /// Size of the depth texture.
        needed: [u32; 2],
        /// Lights to be held.
        slots: u32,
    },
    /// A mask beyond the device's limits.
    #[error("a mask of {size:?} pixels for {lights} lights is beyond this device's {limit}")]
    MaskTooLarge {
        /// Asked size.
        size: [u32; 2],
        /// Asked lights.
        lights: u32,
        /// What the device calls the limit.
        limit: &'static str,
    },
    /// A depth texture that is not what the host said it would be.
    #[error("the depth texture {what}")]
    Depth {
        /// What is wrong with it, and what to do.
        what: &'static str,
    },
    /// Something made by another renderer.
    #[error("the view was made by another renderer: make views with Shadows::view")]
    ForeignView,
    /// The device refused.
    #[error("the device refused: {0}")]
    Device(String),
    /// A limit of the device, or a world that has outgrown the renderer.
    #[error(transparent)]
    Render(#[from] RenderError),
}
