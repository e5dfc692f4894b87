//! Volumes to a frame plan: plain data that says how each light is drawn for one view.
pub mod view;
