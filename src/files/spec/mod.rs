//! Conversion from the text of a link file, and the `--set` of the command line, to a checked link.
//!
//! The raw form mirrors the file key by key without physics; one conversion makes it a valid [`Specification`]. Its
//! errors name a dotted path. A final step finds the line or the `--set` that wrote this path.
//!
//! ```
//! use flexlink::spec::{Override, read_specification};
//! let text = "segments = [{ length = '150 cm', EI = '5e4 N cm^2', mass_per_length = 0.8 }]";
//! let stiffer: Override = "segments.*.EI*=4".parse()?;
//! let specification = read_specification("link.toml", text, &[stiffer])?;
//! assert_eq!(specification.link().segments()[0].bending_stiffness_n_m2.inner, 20.0);
//! # Ok::<(), flexlink::spec::SpecError>(())
//! ```

mod changed;
mod convert;
mod document;
mod error;
mod free;
mod measured;
mod measured_table;
mod measured_values;
mod overrides;
mod raw;
mod schema;
mod segment;
mod tolerances;
mod tree;
mod uncertain;
mod value;

pub use changed::changed_text;
pub use document::{LinkDocument, Specification, read_specification};
pub use error::SpecError;
pub use free::{FreeValue, rewrite};
pub use measured::{
    ChannelFile, DecayFile, MeasuredFile, RecordFile, ResponseFile, read_measurements,
};
pub use measured_table::TableKeys;
pub use overrides::Override;
pub use schema::{link_file_schema, unit_of_key};
pub use tolerances::read_tolerances;
pub use uncertain::Uncertain;
