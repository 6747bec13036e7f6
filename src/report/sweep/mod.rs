//! Figures of a sweep: what changes with the values that were varied.

mod figures;
mod topics;

pub(super) use figures::sweep_figures;
