use crate::numeric::{CubicSpline, SplineEnds};

/// How a torque goes on between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// A cubic spline through all samples.
    #[default]
    Cubic,
    /// Straight lines.
    Linear,
}

/// Coefficients of a cubic over one step: `u(s) = Σ c_j (s/Δt)ʲ`.
pub(super) type Cubic = [f64; 4];

/// The pieces between samples, one fewer than there are samples.
pub(super) fn pieces(samples: &[f64], interpolation: Interpolation) -> Vec<Cubic> {
    match interpolation {
        Interpolation::Linear => {
            samples.windows(2).map(|ends| [ends[0], ends[1] - ends[0], 0.0, 0.0]).collect()
        }
        Interpolation::Cubic => {
            let spline = CubicSpline::uniform(samples, SplineEnds::NotAKnot);
            spline.slopes().windows(2).zip(samples.windows(2)).map(hermite).collect()
        }
    }
}

fn hermite((slopes, ends): (&[f64], &[f64])) -> Cubic {
    let rise = ends[1] - ends[0];
    [
        ends[0],
        slopes[0],
        3.0 * rise - 2.0 * slopes[0] - slopes[1],
        slopes[0] + slopes[1] - 2.0 * rise,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_a_cubic_are_that_cubic() {
        let cubic = |s: f64| 0.5 - s + 0.25 * s * s - 0.125 * s * s * s;
        let samples: Vec<f64> = (0..6).map(|k| cubic(f64::from(k))).collect();
        let evaluated = |c: &Cubic, s: f64| c[0] + s * (c[1] + s * (c[2] + s * c[3]));
        for (k, piece) in pieces(&samples, Interpolation::Cubic).iter().enumerate() {
            for s in [0.0, 0.3, 1.0] {
                assert!((evaluated(piece, s) - cubic(k as f64 + s)).abs() < 1e-13);
            }
        }
        for (k, piece) in pieces(&samples, Interpolation::Linear).iter().enumerate() {
            let middle = 0.5 * (samples[k] + samples[k + 1]);
            assert!((evaluated(piece, 0.5) - middle).abs() < 1e-15);
        }
    }
}
