use super::cutoff::Cutoff;
use super::tip_motion::TipMotion;
use crate::numeric::{TimeGrid, fast_length};

/// Motion of the tip over the grid of a result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipMotionHistories {
    /// Displacement along the arc in m.
    pub displacement_m: Vec<f64>,
    /// Velocity in m/s.
    pub velocity_m_s: Vec<f64>,
    /// Acceleration in m/s².
    pub acceleration_m_s2: Vec<f64>,
}

impl TipMotionHistories {
    /// Largest displacement in m from the first sample.
    pub fn largest_travel_m(&self) -> f64 {
        let away = self.displacement_m.iter().map(|d| (d - self.displacement_m[0]).abs());
        away.fold(0.0, f64::max)
    }
}
/// A tip displacement to compare with. It need not be at rest at its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct TipTarget {
    grid: TimeGrid,
    displacement_m: Vec<f64>,
}

impl TipTarget {
    /// Displacements in m, one at each time of `grid`.
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

    /// Largest displacement from the first sample in m.
    pub fn largest_travel_m(&self) -> f64 {
        self.displacement_m.iter().fold(0.0, |m, x| m.max((x - self.start_m()).abs()))
    }
}

impl TipMotion {
    /// The motion as a target, with as much of the rest around it, in whole steps, as lies between
    /// two times in s.
    pub fn target(&self, from_s: f64, until_s: f64) -> TipTarget {
        let own = self.grid();
        // A time within a millionth of a step of a sample is that sample.
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a number of steps, at least 0"
        )]
        let steps = |time_s: f64| (time_s / own.step_s + 1e-6).floor().max(0.0) as usize;
        let (before, after) = (steps(own.time_s(0) - from_s), steps(until_s - own.end_s()));
        let len = fast_length(2 * own.len + before + after);
        let seam = own.len + after + own.len / 2;
        let period_m = self.over_period(len, seam, Cutoff::ALL).histories.displacement_m;
        let displacement_m = period_m[len - before..].iter().chain(&period_m[..own.len + after]);
        let first = own.first.saturating_sub_unsigned(before as u64);
        let grid = TimeGrid { first, len: before + own.len + after, ..own };
        TipTarget::new(grid, displacement_m.copied().collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Profile;

    #[test]
    fn a_target_rests_before_and_after_its_motion() {
        let motion = TipMotion::new(Profile::Septic.sampled(0.5, 0.01, 100, [0, 0])).unwrap();
        let target = motion.target(-0.25, 1.5);
        let (grid, at) = (target.grid(), target.displacement_m());
        assert_eq!((grid.len, grid.time_s(25)), (176, 0.0));
        assert!(at[..26].iter().all(|d| d.abs() < 1e-8));
        assert!(at[125..].iter().all(|d| (d - 0.5).abs() < 1e-8));
        assert!((at[75] - 0.25).abs() < 1e-12, "half the way after half the time");
        assert_eq!(motion.target(0.3, 0.6).grid(), motion.grid(), "no sample is cut off");
    }
}
