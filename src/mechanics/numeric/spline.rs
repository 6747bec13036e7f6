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
}

impl CubicSpline {
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

#[cfg(test)]
mod tests {
    use super::*;

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
