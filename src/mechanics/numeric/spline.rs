//! Cubic and quintic splines through samples.

use std::borrow::Cow;

use nalgebra::{Matrix2, Vector2};

use super::grid::TimeGrid;
use crate::system::end_if_stopped;

/// Condition of a [`CubicSpline`] at its two ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SplineEnds {
    /// The two outermost pieces at each end are one cubic: no assumption on the curve.
    NotAKnot,
    /// The slope vanishes at both ends: the curve comes from rest and goes to rest.
    Clamped,
}

/// Interpolating cubic spline, twice continuously differentiable, through points of any spacing.
///
/// Between neighbours a distance h apart, with τ from 0 to 1 and slopes s:
/// ```text
/// y = (1 + 2τ)(1 − τ)² y₀ + τ²(3 − 2τ) y₁ + h τ(1 − τ)² s₀ − h τ²(1 − τ) s₁
/// ```
/// The spline meets each point to the last bit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CubicSpline {
    x: Vec<f64>,
    y: Vec<f64>,
    slope: Vec<f64>,
}

impl CubicSpline {
    /// Fewest points a spline goes through.
    pub(crate) const MIN_POINTS: usize = 4;

    /// Draws the spline through the points (x, y), x ascending; O(n).
    ///
    /// # Panics
    /// If x and y differ in length, x does not ascend or there are fewer than 4 points.
    pub(crate) fn new(x: &[f64], y: &[f64], ends: SplineEnds) -> Self {
        end_if_stopped();
        assert!(x.len() == y.len(), "every abscissa has a value");
        assert!(x.len() >= Self::MIN_POINTS, "a spline goes through 4 points");
        assert!(x.is_sorted_by(|a, b| a < b), "the abscissae ascend");
        Self { x: x.to_vec(), y: y.to_vec(), slope: slopes(x, y, ends) }
    }

    /// Draws the spline through samples one step apart: abscissae and slopes are in steps.
    ///
    /// # Panics
    /// With fewer than 4 samples.
    pub(crate) fn uniform(samples: &[f64], ends: SplineEnds) -> Self {
        let steps: Vec<f64> = (0..samples.len()).map(|k| k as f64).collect();
        Self::new(&steps, samples, ends)
    }

    /// Slopes at the points.
    pub(crate) fn slopes(&self) -> &[f64] {
        &self.slope
    }

    /// Integral from the first point to each point: with step h, `h (y₀ + y₁)/2 + h² (s₀ − s₁)/12` for
    /// each piece.
    pub(crate) fn integral(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let piece = |i: usize| {
            let h = self.x[i + 1] - self.x[i];
            let bend = h * h * (self.slope[i] - self.slope[i + 1]) / 12.0;
            sum += 0.5 * h * (self.y[i] + self.y[i + 1]) + bend;
            sum
        };
        std::iter::once(0.0).chain((0..self.x.len() - 1).map(piece)).collect()
    }

    /// Value at `x`; the outermost cubics continue beyond the ends.
    pub(crate) fn value(&self, x: f64) -> f64 {
        let right = self.x.partition_point(|&known| known <= x);
        let i = right.clamp(1, self.x.len() - 1) - 1;
        let h = self.x[i + 1] - self.x[i];
        let t = (x - self.x[i]) / h;
        let u = 1.0 - t;
        let values = (1.0 + 2.0 * t) * u * u * self.y[i] + t * t * (3.0 - 2.0 * t) * self.y[i + 1];
        values + h * t * u * (u * self.slope[i] - t * self.slope[i + 1])
    }

    /// Slope at `x`; the outermost cubics continue beyond the ends.
    pub(crate) fn slope(&self, x: f64) -> f64 {
        let right = self.x.partition_point(|&known| known <= x);
        let i = right.clamp(1, self.x.len() - 1) - 1;
        let h = self.x[i + 1] - self.x[i];
        let t = (x - self.x[i]) / h;
        let u = 1.0 - t;
        let rise = 6.0 * t * u * (self.y[i + 1] - self.y[i]) / h;
        rise + u * (1.0 - 3.0 * t) * self.slope[i] + t * (3.0 * t - 2.0) * self.slope[i + 1]
    }
}

/// Distance of a time from a sample, in steps, that is round-off.
const ON_SAMPLE: f64 = 1e-6;

/// Largest distance of a time from the ends of a grid, in steps, as in [`TimeGrid::through`].
const AT_END: f64 = 1e-3;

/// A quantity over a time grid: a cubic spline through its samples. The first and the last sample hold outside.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TimeCurve {
    grid: TimeGrid,
    spline: CubicSpline,
}

impl TimeCurve {
    /// Draws the curve through the samples of a grid.
    ///
    /// # Panics
    /// With fewer than 4 samples.
    pub(crate) fn new(grid: TimeGrid, samples: &[f64], ends: SplineEnds) -> Self {
        Self { grid, spline: CubicSpline::uniform(samples, ends) }
    }

    /// Samples of a grid at the times of another; those on both grids stay as they are.
    pub(crate) fn resampled<'a>(
        samples: &'a [f64],
        from: TimeGrid,
        to: &TimeGrid,
    ) -> Cow<'a, [f64]> {
        if from == *to {
            return samples.into();
        }
        let curve = Self::new(from, samples, SplineEnds::NotAKnot);
        (0..to.len).map(|k| curve.value(to.time_s(k))).collect()
    }

    /// Times of the samples.
    pub(crate) fn grid(&self) -> &TimeGrid {
        &self.grid
    }

    /// Distance of a time in s from the first sample, in steps.
    fn place(&self, time_s: f64) -> f64 {
        (time_s - self.grid.time_s(0)) / self.grid.step_s
    }

    /// True for a time in s from the first sample to the last.
    pub(crate) fn covers(&self, time_s: f64) -> bool {
        let last = (self.grid.len - 1) as f64;
        (-AT_END..=last + AT_END).contains(&self.place(time_s))
    }

    /// Value at a time in s.
    pub(crate) fn value(&self, time_s: f64) -> f64 {
        let place = self.place(time_s).clamp(0.0, (self.grid.len - 1) as f64);
        let nearest = place.round();
        let is_sample = (place - nearest).abs() <= ON_SAMPLE;
        self.spline.value(if is_sample { nearest } else { place })
    }

    /// Rate per s at a time in s; 0 outside the samples.
    pub(crate) fn rate(&self, time_s: f64) -> f64 {
        let (place, last) = (self.place(time_s), (self.grid.len - 1) as f64);
        let is_inside = (0.0..=last).contains(&place);
        if is_inside { self.spline.slope(place) / self.grid.step_s } else { 0.0 }
    }
}

/// One row of the tridiagonal system for the slopes: `before`·s₋ + `own`·s + `after`·s₊ = `right`.
struct Row {
    before: f64,
    own: f64,
    after: f64,
    right: f64,
}

/// Slopes at the points that make the second derivative continuous.
///
/// With steps a before and b after a point, and chord slopes p and q:
/// ```text
/// b s₋ + 2(a + b) s + a s₊ = 3(b p + a q)
/// ```
fn slopes(x: &[f64], y: &[f64], ends: SplineEnds) -> Vec<f64> {
    let step = |i: usize| x[i + 1] - x[i];
    let chord = |i: usize| (y[i + 1] - y[i]) / step(i);
    let inner = |i: usize| {
        let (a, b) = (step(i - 1), step(i));
        Row {
            before: b,
            own: 2.0 * (a + b),
            after: a,
            right: 3.0 * (b * chord(i - 1) + a * chord(i)),
        }
    };
    let last = x.len() - 1;
    let first_row = end_row(ends, [step(0), step(1)], [chord(0), chord(1)]);
    let [near, next] = [last - 1, last - 2];
    let mirrored = end_row(ends, [step(near), step(next)], [chord(near), chord(next)]);
    let last_row = Row { before: mirrored.after, after: 0.0, ..mirrored };
    let inner_rows = (1..last).map(inner);
    solve_tridiagonal(std::iter::once(first_row).chain(inner_rows).chain(std::iter::once(last_row)))
}

/// Row of the first point, from the two nearest steps and chord slopes, nearest first.
///
/// Not a knot: the third derivative does not jump at the second point, which gives
/// ```text
/// b s + (a + b) s₊ = ((3a + 2b) b p + a² q)/(a + b)
/// ```
fn end_row(ends: SplineEnds, [a, b]: [f64; 2], [p, q]: [f64; 2]) -> Row {
    let (own, after, right) = match ends {
        SplineEnds::Clamped => (1.0, 0.0, 0.0),
        SplineEnds::NotAKnot => {
            let both = a + b;
            let right = ((3.0 * a + 2.0 * b) * b * p + a * a * q) / both;
            (b, both, right)
        }
    };
    Row { before: 0.0, own, after, right }
}

/// Elimination without exchange of rows: the pivots stay positive, also for not-a-knot ends.
fn solve_tridiagonal(rows: impl Iterator<Item = Row>) -> Vec<f64> {
    let mut solution = Vec::new();
    let mut ratios = Vec::new();
    let (mut ratio, mut value) = (0.0, 0.0);
    for row in rows {
        let pivot = row.own - row.before * ratio;
        value = (row.right - row.before * value) / pivot;
        ratio = row.after / pivot;
        ratios.push(ratio);
        solution.push(value);
    }
    for i in (1..solution.len()).rev() {
        solution[i - 1] -= ratios[i - 1] * solution[i];
    }
    solution
}

/// Quintic spline from rest, four times continuously differentiable, through samples one step apart: slope and
/// curvature vanish at the first sample, third and fourth derivative at the last.
///
/// With slopes r and curvatures a at the samples y, in steps, continuous third and fourth derivatives mean
/// ```text
/// 4 (r₊ − r₋) − (a₋ − 6 a + a₊)/2 = 10 (y₋ − 2 y + y₊)
/// 7 r₋ + 16 r + 7 r₊ + a₋ − a₊ = 15 (y₊ − y₋)
/// ```
///
/// The curvature is a cubic between two samples. Its error falls with the fourth power of the step, against the second
/// for a cubic spline. A motion with a third derivative at its end breaks the end condition. The error at the last
/// samples falls only with the step, and decays by a factor of about 2.3 per sample before them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct QuinticSpline {
    samples: Vec<f64>,
    /// Slope and curvature at each sample.
    ends: Vec<Vector2<f64>>,
}

impl QuinticSpline {
    /// Draws the spline; O(n).
    ///
    /// # Panics
    /// With fewer than 4 samples.
    pub(crate) fn from_rest(samples: &[f64]) -> Self {
        assert!(samples.len() >= 4, "a spline goes through 4 samples");
        let before = Matrix2::new(-4.0, -0.5, 7.0, 1.0);
        let own = Matrix2::new(0.0, 3.0, 16.0, 0.0);
        let after = Matrix2::new(4.0, -0.5, 7.0, -1.0);
        // Both derivatives vanish at the end of the last piece.
        let (last_before, last) =
            (Matrix2::new(-4.0, -0.5, -7.0, -1.0), Matrix2::new(-6.0, 1.5, -8.0, 1.5));
        // Both unknowns of the first sample are 0: the elimination starts at the second.
        let (mut gain, mut rest) = (Matrix2::zeros(), Vector2::zeros());
        let mut steps = Vec::with_capacity(samples.len());
        for y in samples.windows(3) {
            let right = Vector2::new(10.0 * (y[0] - 2.0 * y[1] + y[2]), 15.0 * (y[2] - y[0]));
            let pivot = inverse(&(own - before * gain));
            (gain, rest) = (pivot * after, pivot * (right - before * rest));
            steps.push((gain, rest));
        }
        let mut ends = vec![Vector2::zeros(); samples.len()];
        let end = samples.len() - 1;
        let rise = samples[end] - samples[end - 1];
        let right = Vector2::new(-10.0 * rise, -15.0 * rise);
        ends[end] = inverse(&(last - last_before * gain)) * (right - last_before * rest);
        for (k, (gain, rest)) in steps.iter().enumerate().rev() {
            ends[k + 1] = rest - gain * ends[k + 2];
        }
        Self { samples: samples.to_vec(), ends }
    }

    /// First derivative per step at a sample.
    pub(crate) fn slope(&self, sample: usize) -> f64 {
        self.ends[sample][0]
    }

    /// Second derivatives per squared step at the samples.
    pub(crate) fn curvatures(&self) -> impl Iterator<Item = f64> {
        self.ends.iter().map(|end| end[1])
    }

    /// Coefficients of the second derivative between neighbours: a cubic in the distance from the first of them, in
    /// steps.
    pub(crate) fn curvature_pieces(&self) -> impl Iterator<Item = [f64; 4]> {
        let neighbours = self.samples.windows(2).zip(self.ends.windows(2));
        neighbours.map(|(y, ends)| curvature(y[1] - y[0], [ends[0], ends[1]]))
    }

    /// The same after the last sample, of a curve that returns to it with slope and curvature 0. `more` adds to the slope of
    /// the spline.
    pub(crate) fn stop(&self, more: f64) -> [f64; 4] {
        let last = self.ends[self.ends.len() - 1] + Vector2::new(more, 0.0);
        curvature(0.0, [last, Vector2::zeros()])
    }
}

/// Second derivative of a quintic that rises by `rise` in a step, from slope and curvature at its ends.
fn curvature(rise: f64, [from, to]: [Vector2<f64>; 2]) -> [f64; 4] {
    let [(r, a), (s, b)] = [(from[0], from[1]), (to[0], to[1])];
    let third = 10.0 * rise - 6.0 * r - 4.0 * s - 1.5 * a + 0.5 * b;
    let fourth = -15.0 * rise + 8.0 * r + 7.0 * s + 1.5 * a - b;
    let fifth = 6.0 * rise - 3.0 * (r + s) + 0.5 * (b - a);
    [a, 6.0 * third, 12.0 * fourth, 20.0 * fifth]
}

fn inverse(m: &Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(m.m22, -m.m12, -m.m21, m.m11) / (m.m11 * m.m22 - m.m12 * m.m21)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_keeps_its_samples_on_other_grids_and_its_ends_outside() {
        let from = TimeGrid { origin_s: 0.1, step_s: 0.3, first: -1, len: 5 };
        let cube = |t: f64| t * (1.0 - t * t);
        let samples: Vec<f64> = (0..5).map(|k| cube(from.time_s(k))).collect();
        // A third of the step: each third time is a sample to round-off.
        let to = TimeGrid { origin_s: 0.1, step_s: 0.1, first: -6, len: 20 };
        let found = TimeCurve::resampled(&samples, from, &to);
        for (k, value) in found.iter().enumerate() {
            let time_s = to.time_s(k);
            let is_near = |own: &usize| (from.time_s(*own) - time_s).abs() < 1e-9;
            match (0..5).find(is_near) {
                Some(own) => assert_eq!(value.to_bits(), samples[own].to_bits(), "{k}"),
                None if time_s < -0.2 => assert_eq!(value.to_bits(), samples[0].to_bits(), "{k}"),
                None if time_s > 1.0 => assert_eq!(value.to_bits(), samples[4].to_bits(), "{k}"),
                None => assert!((value - cube(time_s)).abs() < 1e-14, "{k}: {value}"),
            }
        }
        let curve = TimeCurve::new(from, &samples, SplineEnds::NotAKnot);
        assert!((curve.rate(0.25) - (1.0 - 3.0 * 0.0625)).abs() < 1e-13);
        assert!(curve.rate(1.31) == 0.0 && curve.covers(1.0002) && !curve.covers(1.0004));
    }

    type Curve = fn(f64) -> f64;

    #[test]
    fn four_points_of_a_cube_give_the_cube() {
        let (x, y) = ([0.0, 1.0, 2.0, 4.0], [0.0, 1.0, 8.0, 64.0]);
        let cube = CubicSpline::new(&x, &y, SplineEnds::NotAKnot);
        assert!((cube.value(3.0) - 27.0).abs() < 1e-13);
    }

    fn uneven(n: usize) -> Vec<f64> {
        let even = (0..n).map(|k| k as f64 / (n - 1) as f64);
        even.map(|u| u + 0.1 * (6.0 * u).sin()).collect()
    }

    fn error_on_a_wave(n: usize, ends: SplineEnds, wave: Curve) -> f64 {
        let x: Vec<f64> = (0..n).map(|k| k as f64 / (n - 1) as f64).collect();
        let y: Vec<f64> = x.iter().map(|&x| wave(x)).collect();
        let spline = CubicSpline::new(&x, &y, ends);
        let probes = (0..=4000).map(|k| f64::from(k) / 4000.0);
        probes.map(|x| (spline.value(x) - wave(x)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_cubic_is_reproduced_on_uneven_points_without_end_conditions() {
        let cubic = |x: f64| 0.3 - 2.0 * x + 5.0 * x * x - 4.0 * x * x * x;
        let x = uneven(9);
        let y: Vec<f64> = x.iter().map(|&x| cubic(x)).collect();
        let spline = CubicSpline::new(&x, &y, SplineEnds::NotAKnot);
        for k in -10..=130 {
            let x = 0.01 * f64::from(k);
            assert!((spline.value(x) - cubic(x)).abs() < 1e-12, "at {x}");
        }
    }

    #[test]
    fn the_error_falls_with_the_fourth_power_of_the_step() {
        let waves: [(SplineEnds, Curve); 2] = [
            (SplineEnds::NotAKnot, |x| (5.0 * x + 0.4).sin()),
            (SplineEnds::Clamped, |x| (std::f64::consts::TAU * x).cos()),
        ];
        for (ends, wave) in waves {
            let coarse = error_on_a_wave(81, ends, wave);
            let fine = error_on_a_wave(161, ends, wave);
            let order = (coarse / fine).log2();
            assert!((3.9..4.1).contains(&order), "{ends:?}: order {order}");
        }
    }

    #[test]
    fn a_clamped_spline_starts_and_ends_flat() {
        let x = uneven(7);
        let y = [0.0, 0.3, 0.2, 0.9, 0.4, 0.5, 1.0];
        let spline = CubicSpline::new(&x, &y, SplineEnds::Clamped);
        for end in [x[0], x[6]] {
            let slope = (spline.value(end + 1e-6) - spline.value(end - 1e-6)) / 2e-6;
            assert!(slope.abs() < 1e-9, "slope {slope} at {end}");
        }
    }

    #[test]
    fn every_point_is_met_to_the_last_bit() {
        let x = uneven(20);
        let y: Vec<f64> = x.iter().map(|&x| (7.0 * x).exp()).collect();
        for ends in [SplineEnds::NotAKnot, SplineEnds::Clamped] {
            let spline = CubicSpline::new(&x, &y, ends);
            let met = x.iter().zip(&y);
            assert!(met.clone().all(|(&x, &y)| spline.value(x).to_bits() == y.to_bits()));
        }
    }

    #[test]
    fn steps_of_very_different_length_stay_accurate() {
        let x = [0.0, 1e-6, 1.0, 1.0 + 1e-6, 2.0];
        let y = x.map(|x| x * x);
        let spline = CubicSpline::new(&x, &y, SplineEnds::NotAKnot);
        assert!((spline.value(1.5) - 2.25).abs() < 1e-9);
    }
}

#[cfg(test)]
mod tests_of_quintics {
    use std::f64::consts::PI;

    use super::*;
    use crate::numeric::largest;

    /// sin⁶ from 0 to the angle `end_rad`, and its second derivative, both per step.
    fn bell(steps: u32, end_rad: f64) -> (Vec<f64>, Vec<f64>) {
        let omega = end_rad / f64::from(steps);
        let at = |k: u32| {
            let (sine, cosine) = (omega * f64::from(k)).sin_cos();
            let curvature = 30.0 * sine.powi(4) * cosine.powi(2) - 6.0 * sine.powi(6);
            (sine.powi(6), omega * omega * curvature)
        };
        (0..=steps).map(at).unzip()
    }

    /// Errors of the curvature at the samples, per squared length.
    fn curvature_errors(steps: u32, end_rad: f64) -> Vec<f64> {
        let (samples, exact) = bell(steps, end_rad);
        let spline = QuinticSpline::from_rest(&samples);
        let errors = spline.curvatures().zip(&exact).map(|(a, b)| (a - b).abs());
        errors.map(|error| error * f64::from(steps).powi(2)).collect()
    }

    #[test]
    fn the_curvature_of_a_motion_that_ends_at_rest_has_an_error_of_fourth_order() {
        let [coarse, fine] = [100, 200].map(|steps| largest(&curvature_errors(steps, PI)));
        let order = (coarse / fine).log2();
        assert!((3.8..4.2).contains(&order), "order {order}");
        assert!(fine < 3e-5, "{fine:e}");
    }

    #[test]
    fn the_curvature_of_a_motion_that_ends_moving_has_an_error_of_first_order_at_the_end_alone() {
        let [coarse, fine] = [100, 200].map(|steps| curvature_errors(steps, 0.7 * PI));
        let order = (largest(&coarse) / largest(&fine)).log2();
        assert!((0.9..1.1).contains(&order), "order {order}");
        let [coarse, fine] = [&coarse[..60], &fine[..120]].map(largest);
        let order = (coarse / fine).log2();
        assert!((3.8..4.2).contains(&order), "order {order} before the end");
    }

    #[test]
    fn pieces_join_and_integrate_to_the_samples_whatever_these_are() {
        let samples: Vec<f64> = (0..50).map(|k| f64::from(k * k * 7919 % 101)).collect();
        let spline = QuinticSpline::from_rest(&samples);
        let pieces: Vec<_> = spline.curvature_pieces().collect();
        for (k, pair) in pieces.windows(2).enumerate() {
            let [a, b, c, d] = pair[0];
            let slope = b + 2.0 * c + 3.0 * d;
            assert!((a + b + c + d - pair[1][0]).abs() < 1e-9, "curvature after piece {k}");
            assert!((slope - pair[1][1]).abs() < 1e-9, "its slope after piece {k}");
        }
        let (mut slope, mut value) = (0.0, samples[0]);
        for (piece, next) in pieces.iter().zip(&samples[1..]) {
            let [a, b, c, d] = *piece;
            value += slope + a / 2.0 + b / 6.0 + c / 12.0 + d / 20.0;
            slope += a + b / 2.0 + c / 3.0 + d / 4.0;
            assert!((value - next).abs() < 1e-8, "{value} is not {next}");
        }
        let [a, b, c, d] = spline.stop(0.5);
        let stopped = [
            slope + 0.5 + a + b / 2.0 + c / 3.0 + d / 4.0,
            slope + 0.5 + a / 2.0 + b / 6.0 + c / 12.0 + d / 20.0,
            a + b + c + d,
        ];
        assert!(stopped.iter().all(|own| own.abs() < 1e-8), "{stopped:?}");
        let [a, b, c, d] = pieces[pieces.len() - 1];
        assert!((b + 2.0 * c + 3.0 * d).abs() < 1e-8 && (c + 3.0 * d).abs() < 1e-8, "{a}");
    }
}
