//! Result folders and tables of sweeps, read back: the other half of what a run writes.

mod folder;
mod link;
mod mesh;
mod nodal;
mod numbers;
mod readings;
mod result;
mod run;
mod summary;
mod sweep;

pub use result::read_result;
