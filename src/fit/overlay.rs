//! What was measured and what the fitted link does in its place, to be drawn over each other.

/// How the numbers of an axis are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spacing {
    /// Evenly.
    Linear,
    /// By their logarithm: all are above 0.
    Logarithmic,
}

/// A quantity along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Coordinate {
    /// Its name: `frequency`.
    pub name: &'static str,
    /// Its unit: `Hz`; empty for a number without one.
    pub unit: &'static str,
    /// How its numbers are spread.
    pub spacing: Spacing,
}

impl Coordinate {
    /// A quantity whose numbers are spread evenly.
    pub fn linear(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, spacing: Spacing::Linear }
    }

    /// A quantity whose numbers are all above 0 and spread by their logarithm.
    pub fn logarithmic(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, spacing: Spacing::Logarithmic }
    }
}

/// One quantity as it was measured, over frequency or time, and as the fitted link has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// File and quantity: `frf.csv: hub angle per torque, gain`.
    pub name: String,
    /// What the quantity is drawn over.
    pub x: Coordinate,
    /// The quantity.
    pub y: Coordinate,
    /// Places along x, ascending.
    pub places: Vec<f64>,
    /// The measured value at each place.
    pub measured: Vec<f64>,
    /// The fitted link's value at each place.
    pub fitted: Vec<f64>,
}
