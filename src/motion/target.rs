use crate::numeric::TimeGrid;

/// A tip displacement to compare with; it need not be at rest at its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct TipTarget {
    grid: TimeGrid,
    displacement_m: Vec<f64>,
}

impl TipTarget {
    /// Displacements in m, one a time of `grid`.
    ///
    /// # Panics
    /// Without samples, or with another number of them than there are times.
    pub fn new(grid: TimeGrid, displacement_m: Vec<f64>) -> Self {
        assert!(grid.len > 0 && grid.len == displacement_m.len(), "every time has a sample");
        Self { grid, displacement_m }
    }

    /// Times of the samples.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Displacement along the arc in m.
    pub fn displacement_m(&self) -> &[f64] {
        &self.displacement_m
    }

    /// Displacement at the first sample in m.
    pub fn start_m(&self) -> f64 {
        self.displacement_m[0]
    }

    /// Largest distance from the first sample in m.
    pub fn farthest_m(&self) -> f64 {
        self.displacement_m.iter().fold(0.0, |m, x| m.max((x - self.start_m()).abs()))
    }
}
