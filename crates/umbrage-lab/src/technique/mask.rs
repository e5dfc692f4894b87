//! Shadow masks without a stencil: each light's volume doubles and halves the values of a mask,
//! which is then normalised and multiplied with the light.
//!
//! Follows Roettger, Irion and Ertl, "Shadow Volumes Revisited" (2002), sections 4.2 to 4.5, with
//! these differences:
//!
//! - *Many lights.* The paper has one. Here masks are made, normalised and applied light after
//!   light, over the rows of pixels that the light reaches instead of the whole window.
//! - *The eye in shadow.* The paper clips volumes at the near plane and caps them there. Here the
//!   mask starts from the eye count n: at 1/4 * 2^min(n, 2).
//! - *Order.* The paper draws volume by volume, the fronts of one and then its backs. A volume here
//!   is one closed surface of all casters, not convex, and no sequence of convex ones: all its
//!   fronts come first, then all its backs. So the clamp at 1 may swallow fronts whose backs
//!   follow: three fronts and two backs before a surface leave 1/4 -> 1 -> 1/4, lit where it is in
//!   shadow. Drawing the casters' volumes one by one would avoid that, at the price of the counter:
//!   each triangle would have its own three sides again. Sorting faces by depth would not: three
//!   nested volumes clamp as well. `check` counts the pixel-lights whose layers pass what the mask
//!   can represent ([`Overflow`]); no other can be wrong.
//! - *A float alpha.* Light adds up in half floats, whose alpha does not clamp at 1: there the
//!   exponent counts, up to 16 layers instead of two, starting from 1/2. Normalising, the least of
//!   alpha and 1 stands where the paper doubles with a clamp; both leave 1/2 and 1, and the other
//!   two rectangles are the paper's. `mask-screen` is the paper's own arithmetic. Nor does such
//!   alpha stop at white: where rounding leaves a count below zero, at single ambiguous pixels, it
//!   ends at 1.5 or 3, and one more rectangle takes that back to 1. Such a pixel is lit, where the
//!   stencil has a dark one.

mod in_frame;
mod in_layers;
mod lighting;
mod low;
mod low_depth;
mod overflow;
mod pack;
mod painter;
mod plan;
mod reading;
mod slots;

pub(crate) use in_frame::InFrame;
pub(crate) use in_layers::InLayers;
pub(crate) use overflow::Overflow;
