//! The link file as JSON Schema: derived from the raw form, so that an editor knows the keys that
//! the reader knows.
//!
//! The dialect is draft 7, what TOML editors understand, and nothing refers to a definition
//! elsewhere: they show a description only where it stands.

mod alternatives;
mod file;
mod kinds;
mod ranges;

pub(super) use alternatives::{
    a_model, a_shape, at_least_one, damping_laws, section_shapes, stiffness_and_mass,
};
pub use file::link_file_schema;
pub(super) use ranges::{Range, a_share, quantity, shares, within};
