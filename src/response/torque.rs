use super::history::{HistoryError, grid_of};
use crate::numeric::TimeGrid;

/// A torque at the hub on a uniform time grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Torque {
    grid: TimeGrid,
    torque_n_m: Vec<f64>,
}

impl Torque {
    /// Checks samples in N m at times in s.
    ///
    /// ```
    /// use flexlink::response::Torque;
    /// let torque = Torque::new(&[-0.5, 0.0, 0.5, 1.0], vec![0.0, 2.0, 2.0, 0.0])?;
    /// assert_eq!((torque.grid().time_s(0), torque.grid().step_s), (-0.5, 0.5));
    /// assert!(Torque::new(&[0.0, 0.5, 1.5, 2.0], vec![0.0; 4]).is_err(), "an uneven step");
    /// # Ok::<(), flexlink::response::HistoryError>(())
    /// ```
    ///
    /// # Errors
    /// [`HistoryError`]: fewer than 4 samples, not as many as there are times, one that is not
    /// finite, or times off a uniform grid.
    pub fn new(time_s: &[f64], torque_n_m: Vec<f64>) -> Result<Self, HistoryError> {
        let grid = grid_of(time_s, &[("torque", &torque_n_m)])?;
        Ok(Self { grid, torque_n_m })
    }

    /// Grid of the samples; its origin is the first of them.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Torque in N m, one sample a time of the grid.
    pub fn torque_n_m(&self) -> &[f64] {
        &self.torque_n_m
    }
}
