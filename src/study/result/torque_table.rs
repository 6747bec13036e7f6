//! A torque for a controller to play: the rows that matter, and the output of a converter that holds its values.

use std::f64::consts::PI;
use std::ops::Range;

use num_complex::Complex64;

use super::metrics::Acting;
use crate::inverse::{Solution, size};
use crate::link::Joint;
use crate::motion::Ends;
use crate::numeric::{FourierPair, TimeGrid};
use crate::response::Interpolation;

/// Torques of a solution, the hub's or those of all joints, or the force on a carriage, as a controller plays them.
#[derive(Debug, Clone, PartialEq)]
pub struct TorqueTable {
    /// Times of the solution.
    grid: TimeGrid,
    /// One column for each joint, over the whole grid.
    torques_n_m: Vec<Vec<f64>>,
    /// Rows of the table; outside them the torque is at rest.
    rows: Range<usize>,
    /// Time in s of the solution when the motion begins.
    moves_from_s: f64,
    interpolation: Interpolation,
    /// Time in s of the first row, if the user sets it.
    start_s: Option<f64>,
    /// Share of its size below which each torque stays outside the rows of a cut table.
    window: Option<f64>,
    /// Whether the torques hold a weight at rest.
    has_weight: bool,
    /// The joint of one link, or the first joint.
    joint: Joint,
    /// Whether the last column is the force on an arm's carriage in N.
    has_carriage: bool,
}

impl TorqueTable {
    /// The torques of all joints.
    pub fn of(solution: &Solution) -> Self {
        let torques = solution.joints.iter().map(|joint| joint.torque_n_m.clone());
        Self {
            grid: solution.grid,
            torques_n_m: torques.collect(),
            rows: 0..solution.grid.len,
            moves_from_s: solution.grid.time_s(solution.moving.0),
            interpolation: Interpolation::default(),
            start_s: None,
            window: None,
            has_weight: solution.arm.has_weight(),
            joint: solution.arm.joint(),
            has_carriage: solution.arm.carriage().is_some(),
        }
    }

    /// True if the last column is the force on an arm's carriage in N.
    pub fn has_carriage(&self) -> bool {
        self.has_carriage
    }

    /// The joint of one link, or the first joint.
    pub fn joint(&self) -> Joint {
        self.joint
    }

    /// Replaces the torques by the values for a converter that holds each for a step, so that the torque up to the
    /// Nyquist frequency is that of the table. Its images above this frequency remain.
    ///
    /// Holding for a step h multiplies an amplitude at ω by `sinc(ωh/2) e^{−iωh/2}`; the correction divides by this
    /// factor.
    #[must_use]
    pub fn held(mut self, ends: Ends) -> Self {
        let repeats = ends == Ends::Periodic;
        for torque_n_m in &mut self.torques_n_m {
            *torque_n_m = for_hold(torque_n_m, repeats);
        }
        Self { interpolation: Interpolation::Zero, ..self }
    }

    /// Cuts the rows before and after which every torque stays below a share of its peak. With weight, the share
    /// counts of the torque's range, from the torque that holds link or arm at rest. One row of the torques at rest
    /// remains on either side.
    #[must_use]
    pub fn cut(mut self, share: f64) -> Self {
        let last = self.grid.len - 1;
        let acting = self.torques_n_m.iter().filter_map(|torque| {
            let size = size(torque, self.has_weight);
            (size > 0.0).then(|| Acting::beyond_rest(torque, share * size))
        });
        let (first, end) = acting
            .map(|acting| (acting.first, acting.last))
            .reduce(|(first, end), (own_first, own_end)| (first.min(own_first), end.max(own_end)))
            .unwrap_or((0, last));
        for torque in &mut self.torques_n_m {
            let rest = if self.has_weight { [torque[0], torque[last]] } else { [0.0; 2] };
            torque[..first].fill(rest[0]);
            torque[end + 1..].fill(rest[1]);
        }
        self.rows = first.saturating_sub(1)..(end + 1).min(last) + 1;
        Self { window: Some(share), ..self }
    }

    /// The table with its first row at this time in s.
    #[must_use]
    pub fn starting_at(self, start_s: f64) -> Self {
        Self { start_s: Some(start_s), ..self }
    }

    /// Times of the rows.
    #[expect(clippy::cast_possible_wrap, reason = "samples stay far below 2^63")]
    pub fn grid(&self) -> TimeGrid {
        let Self { grid, rows, .. } = self;
        match self.start_s {
            Some(origin_s) => TimeGrid { origin_s, first: 0, len: rows.len(), ..*grid },
            None => TimeGrid { first: grid.first + rows.start as i64, len: rows.len(), ..*grid },
        }
    }

    /// Time in s of the table when the motion begins.
    pub fn moves_from_s(&self) -> f64 {
        self.time_s(self.moves_from_s)
    }

    /// Time in s of the table at a time of the solution.
    pub fn time_s(&self, solution_s: f64) -> f64 {
        self.grid().time_s(0) + (solution_s - self.grid.time_s(self.rows.start))
    }

    /// Torques in N m of the rows, one column for each joint.
    pub fn torques_n_m(&self) -> Vec<&[f64]> {
        self.torques_n_m.iter().map(|torque| &torque[self.rows.clone()]).collect()
    }

    /// Torques in N m at all times of the solution, at rest outside the rows.
    pub fn whole_n_m(&self) -> &[Vec<f64>] {
        &self.torques_n_m
    }

    /// Share of its size below which each torque stays outside the rows of a cut table.
    pub fn window(&self) -> Option<f64> {
        self.window
    }

    /// Whether the torques hold a weight at rest.
    pub fn has_weight(&self) -> bool {
        self.has_weight
    }

    /// Time in s of the table when the solution ends.
    pub fn solved_until_s(&self) -> f64 {
        self.time_s(self.grid.end_s())
    }

    /// Course of the torque between the rows.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }
}

/// Samples that, each held for a step, have the amplitudes of these samples up to the Nyquist frequency.
///
/// Unless the samples repeat, the function corrects their differences and adds them up, because differences are zero
/// at both ends even if the torque holds a weight there.
pub(crate) fn for_hold(samples: &[f64], repeats: bool) -> Vec<f64> {
    let len = samples.len();
    if repeats {
        // Two cycles, because the number of samples must be even.
        let mut found = unheld(&[samples, samples].concat(), &FourierPair::new(2 * len));
        found.truncate(len);
        return found;
    }
    let differences: Vec<f64> = samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let found = unheld(&differences, &FourierPair::fast(2 * len));
    // The second half of the period lies before the first sample.
    let (after, before) = found.split_at(len);
    let mut sum = samples[0] + before.iter().sum::<f64>();
    let add = |difference: &f64| {
        let sample = sum;
        sum += difference;
        sample
    };
    after.iter().map(add).collect()
}

/// Samples of a period divided by the transfer of a hold.
fn unheld(samples: &[f64], pair: &FourierPair) -> Vec<f64> {
    let mut amplitudes = pair.amplitudes(samples);
    let half = PI / pair.len() as f64;
    for (k, amplitude) in amplitudes.iter_mut().enumerate().skip(1) {
        let (sine, cosine) = libm::sincos(half * k as f64);
        *amplitude *= Complex64::new(cosine, sine) * (half * k as f64 / sine);
    }
    pair.samples(amplitudes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Amplitude of e^{iωt} in a staircase over one period of all its samples, by the sum of its steps' integrals on
    /// a hundredfold grid.
    fn amplitude(stairs: &[f64], cycles: usize) -> Complex64 {
        const FINE: usize = 100;
        let len = stairs.len() * FINE;
        let turn = |j: usize| TAU * (cycles as f64) * (j as f64 + 0.5) / len as f64;
        let part = |j: usize| Complex64::from_polar(stairs[j / FINE], -turn(j));
        (0..len).map(part).sum::<Complex64>() / len as f64
    }

    #[test]
    fn a_staircase_has_the_amplitudes_of_the_wave_that_it_is_for() {
        for len in [64, 45] {
            for cycles in [1, 5, 20] {
                let wave = |k: usize| (TAU * (cycles * k) as f64 / len as f64 + 0.4).cos();
                let samples: Vec<f64> = (0..len).map(wave).collect();
                let exact = Complex64::from_polar(0.5, 0.4);
                let of_held = amplitude(&for_hold(&samples, true), cycles);
                let of_samples = amplitude(&samples, cycles);
                let bound = 1e-4 * cycles as f64 / 20.0;
                assert!((of_held - exact).norm() < bound, "{len}, {cycles}: {of_held}");
                assert!(
                    (of_samples - exact).norm() > 100.0 * bound,
                    "{len}, {cycles}: {of_samples}"
                );
            }
        }
    }

    #[test]
    fn a_step_between_two_rests_comes_half_a_step_earlier() {
        // Smooth, and resting at other values on either side.
        let rises = |t: f64| 2.0 + 3.0 * libm::erf((t - 100.0) / 12.0);
        let samples: Vec<f64> = (0..200).map(|k| rises(f64::from(k))).collect();
        // In the middle of its step a held value is T − h² T''/24 + ….
        let curved = |t: f64| (rises(t + 1.0) - 2.0 * rises(t) + rises(t - 1.0)) / 24.0;
        for (k, held) in (0..).zip(for_hold(&samples, false)) {
            let t = f64::from(k) + 0.5;
            assert!((held - (rises(t) - curved(t))).abs() < 1e-4, "{k}: {held}");
        }
    }
}
