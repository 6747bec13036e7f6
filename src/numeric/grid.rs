/// Uniform time grid: sample k stands at `origin + (first + k)·step`.
///
/// The grid of a result extends the one of its trajectory, so both keep the same origin and their
/// common samples the same times to the last bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeGrid {
    /// Time of the trajectory's first sample in s.
    pub origin_s: f64,
    /// Step in s, above 0.
    pub step_s: f64,
    /// Number of the first sample, counted from the origin; negative before it.
    pub first: i64,
    /// Number of samples.
    pub len: usize,
}

impl TimeGrid {
    /// Time of sample `k` in s.
    ///
    /// ```
    /// use flexlink::numeric::TimeGrid;
    /// let grid = TimeGrid { origin_s: 0.25, step_s: 0.5, first: -2, len: 4 };
    /// assert_eq!(grid.time_s(0), -0.75);
    /// assert_eq!(grid.time_s(3), 0.75);
    /// ```
    pub fn time_s(&self, k: usize) -> f64 {
        let steps = k as f64 + self.first as f64;
        self.origin_s + steps * self.step_s
    }

    /// Where sample `k` stands in a period of `len` samples that begins at the origin.
    pub(crate) fn in_period(&self, k: usize, len: usize) -> usize {
        #[expect(
            clippy::cast_possible_wrap,
            clippy::cast_possible_truncation,
            reason = "samples stay far below 2^63, and the remainder is not negative"
        )]
        let number = (self.first + k as i64).rem_euclid(len as i64) as usize;
        number
    }

    /// Time of the last sample in s.
    pub fn end_s(&self) -> f64 {
        self.time_s(self.len.saturating_sub(1))
    }

    /// Time from the first sample to the last in s.
    pub fn duration_s(&self) -> f64 {
        self.len.saturating_sub(1) as f64 * self.step_s
    }

    /// Every `every`-th sample, beginning with the first.
    #[must_use]
    pub fn thinned(&self, every: usize) -> ThinnedGrid {
        ThinnedGrid { grid: *self, every }
    }
}

/// Every n-th sample of a [`TimeGrid`], beginning with its first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinnedGrid {
    grid: TimeGrid,
    every: usize,
}

impl ThinnedGrid {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.grid.len.div_ceil(self.every)
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.grid.len == 0
    }

    /// Time of sample `k` in s.
    pub fn time_s(&self, k: usize) -> f64 {
        self.grid.time_s(k * self.every)
    }
}
