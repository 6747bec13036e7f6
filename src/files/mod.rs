//! The files: links and measurements in TOML, tables in CSV, the folder of a result.

pub mod csv;
pub mod measured;
pub mod spec;
pub mod store;
