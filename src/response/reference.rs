use super::history::{HistoryError, grid_of};
use crate::numeric::TimeGrid;

/// The hub motion that a feedback holds the hub to, on a uniform time grid.
#[derive(Debug, Clone, PartialEq)]
pub struct HubReference {
    grid: TimeGrid,
    angle_rad: Vec<f64>,
    rate_rad_s: Option<Vec<f64>>,
}

impl HubReference {
    /// Checks samples in rad, and in rad/s where they are given, at times in s.
    ///
    /// # Errors
    /// [`HistoryError`]: fewer than 4 samples, not as many as there are times, one that is not
    /// finite, or times off a uniform grid.
    pub fn new(
        time_s: &[f64],
        angle_rad: Vec<f64>,
        rate_rad_s: Option<Vec<f64>>,
    ) -> Result<Self, HistoryError> {
        let rate = rate_rad_s.as_deref().map(|rate| ("hub_rate", rate));
        let columns: Vec<_> = [("hub_angle", &angle_rad[..])].into_iter().chain(rate).collect();
        let grid = grid_of(time_s, &columns)?;
        Ok(Self { grid, angle_rad, rate_rad_s })
    }

    /// Grid of the samples; its origin is the first of them.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Hub angle in rad, one sample a time of the grid.
    pub fn angle_rad(&self) -> &[f64] {
        &self.angle_rad
    }

    /// Hub rate in rad/s, one sample a time of the grid, if it was given.
    pub fn rate_rad_s(&self) -> Option<&[f64]> {
        self.rate_rad_s.as_deref()
    }
}
