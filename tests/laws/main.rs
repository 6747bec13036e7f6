//! Laws that hold for every link: segments, limits, energy, units, counts of modes.

mod links;
mod modes;
mod power;
mod segments;
mod units;
