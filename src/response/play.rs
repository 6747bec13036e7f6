use super::error::SimulationError;
use super::feedback::Feedback;
use super::history::Torque;
use super::selection::torque_band_rad_s;
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid};

/// Most samples that are simulated.
const LONGEST: usize = 1 << 24;

/// A torque to play on a link at rest, and how.
#[derive(Debug, Clone, Copy)]
pub struct Play<'a> {
    /// The torque at the hub; zero before its first and after its last sample.
    pub torque: &'a Torque,
    /// The torque between its samples.
    pub interpolation: Interpolation,
    /// Time in s at which to end, without torque after its last sample; `None`: at that sample.
    pub until_s: Option<f64>,
    /// Feedback at the hub, added to the torque.
    pub feedback: Option<&'a Feedback>,
    /// Displacement of the tip at the start in m.
    pub initial_tip_m: f64,
    /// Most memory in bytes that playing may take; `None`: no bound.
    pub memory_bytes: Option<usize>,
}

impl<'a> Play<'a> {
    /// A torque played to its end, by cubics, without feedback, the tip at 0 at the start.
    pub fn of(torque: &'a Torque) -> Self {
        Self {
            torque,
            interpolation: Interpolation::default(),
            until_s: None,
            feedback: None,
            initial_tip_m: 0.0,
            memory_bytes: None,
        }
    }

    /// The torque's grid, continued to the given end.
    pub(super) fn grid(&self) -> Result<TimeGrid, SimulationError> {
        let grid = self.torque.grid();
        let Some(until_s) = self.until_s else { return Ok(grid) };
        let end_s = grid.end_s();
        let steps = (until_s - end_s) / grid.step_s;
        // A millionth of a step beside the last sample is that sample.
        if steps.is_nan() || steps < -1e-6 {
            return Err(SimulationError::EndsEarly { until_s, end_s });
        }
        let more = (steps - 1e-6).ceil().max(0.0);
        let samples = grid.len as f64 + more;
        if samples > LONGEST as f64 {
            return Err(SimulationError::TooLong { until_s, samples, limit: LONGEST });
        }
        Ok(TimeGrid { len: samples as usize, ..grid })
    }

    /// Frequency in rad/s above which the link is not driven; none where nothing drives it.
    pub(super) fn band_rad_s(&self) -> Option<f64> {
        let grid = self.torque.grid();
        let torque = torque_band_rad_s(&grid, self.torque.torque_n_m());
        // The reference's rate, unlike its angle, is zero at both ends.
        let wanted = self.feedback.and_then(Feedback::driving_rate_rad_s);
        let wanted = wanted.and_then(|rate| torque_band_rad_s(&grid, &rate));
        torque.into_iter().chain(wanted).reduce(f64::max)
    }

    /// The input of the modal equations at all samples and between them.
    ///
    /// # Errors
    /// [`SimulationError::Feedback`] if the reference stands at other times than the torque.
    pub(super) fn driving(&self) -> Result<Driving, SimulationError> {
        let torque = self.torque.torque_n_m();
        let (samples, hold) = match self.feedback {
            None => (torque.to_vec(), 0.0),
            Some(feedback) => {
                let wanted = feedback.wanted_torque_n_m(self.torque)?;
                let samples = torque.iter().zip(wanted).map(|(t, wanted)| t + wanted).collect();
                (samples, feedback.stiffness_n_m_rad() * feedback.turn_rad())
            }
        };
        let pieces = pieces(&samples, self.interpolation);
        Ok(Driving { samples, pieces, hold })
    }
}

/// Input u of the modal equations: the torque, and the part of the feedback that depends on its reference.
/// The part that depends on the link's motion belongs to the equations.
#[derive(Debug, Clone)]
pub(super) struct Driving {
    samples: Vec<f64>,
    pieces: Vec<Cubic>,
    /// After the last sample.
    hold: f64,
}

impl Driving {
    /// At a sample, also after the torque's last.
    pub(super) fn at(&self, sample: usize) -> f64 {
        self.samples.get(sample).copied().unwrap_or(self.hold)
    }

    /// Over the step that follows a sample.
    pub(super) fn after(&self, sample: usize) -> Cubic {
        self.pieces.get(sample).copied().unwrap_or(self.held())
    }

    /// Over any step after the last sample.
    pub(super) fn held(&self) -> Cubic {
        [self.hold, 0.0, 0.0, 0.0]
    }
}

/// The torque between its samples.
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
