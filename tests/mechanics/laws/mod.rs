//! Laws that hold for every link: segments, limits, energy, reciprocity, units, counts of modes.

pub(crate) mod links;
mod modes;
mod power;
mod reciprocity;
mod segments;
mod shares;
mod units;
