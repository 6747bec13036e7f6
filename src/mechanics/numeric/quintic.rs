use nalgebra::{Matrix2, Vector2};

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
        self.samples.windows(2).zip(self.ends.windows(2)).map(|(y, ends)| {
            let rise = y[1] - y[0];
            let [(r, a), (s, b)] = [(ends[0][0], ends[0][1]), (ends[1][0], ends[1][1])];
            let third = 10.0 * rise - 6.0 * r - 4.0 * s - 1.5 * a + 0.5 * b;
            let fourth = -15.0 * rise + 8.0 * r + 7.0 * s + 1.5 * a - b;
            let fifth = 6.0 * rise - 3.0 * (r + s) + 0.5 * (b - a);
            [a, 6.0 * third, 12.0 * fourth, 20.0 * fifth]
        })
    }
}

fn inverse(m: &Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(m.m22, -m.m12, -m.m21, m.m11) / (m.m11 * m.m22 - m.m12 * m.m21)
}

#[cfg(test)]
mod tests {
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
        let [a, b, c, d] = pieces[pieces.len() - 1];
        assert!((b + 2.0 * c + 3.0 * d).abs() < 1e-8 && (c + 3.0 * d).abs() < 1e-8, "{a}");
    }
}
