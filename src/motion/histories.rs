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
    /// Largest distance in m from where the tip is at the first sample.
    pub fn largest_travel_m(&self) -> f64 {
        let away = self.displacement_m.iter().map(|d| (d - self.displacement_m[0]).abs());
        away.fold(0.0, f64::max)
    }
}
/// Motion of the tip over a period of N samples, sample 0 the trajectory's first.
#[derive(Debug, Clone, PartialEq)]
pub struct TipHistories {
    /// Acceleration in m/s².
    pub acceleration_m_s2: Vec<f64>,
    /// Velocity in m/s.
    pub velocity_m_s: Vec<f64>,
    /// Displacement in m. Samples from `before` on stand for times before the trajectory.
    pub displacement_m: Vec<f64>,
    /// The first sample that stands one period earlier.
    pub before: usize,
}

impl TipHistories {
    /// Displacement in m at the far end of the rest before the motion.
    pub fn start_m(&self) -> f64 {
        self.displacement_m[self.before % self.displacement_m.len()]
    }

    /// What alternates from sample to sample in m where the motion rests farthest from itself: the rest of
    /// a spectrum that ends at the Nyquist frequency.
    pub fn ringing_m(&self) -> f64 {
        let all = &self.displacement_m;
        let rest = all.get(self.before..self.before + 3);
        let rest = rest.or_else(|| all.get(self.before.checked_sub(3)?..self.before));
        rest.map_or(0.0, |rest| 0.25 * (rest[0] - 2.0 * rest[1] + rest[2]).abs())
    }

    /// Largest distance in m from there.
    pub fn way_m(&self) -> f64 {
        let start_m = self.start_m();
        self.displacement_m.iter().fold(0.0, |most, at_m| most.max((at_m - start_m).abs()))
    }
}
