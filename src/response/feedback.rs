use thiserror::Error;

use super::history::{HubReference, Torque};
use crate::numeric::{CubicSpline, SplineEnds, TimeGrid, rounded};

/// Collocated feedback at the hub around a computed motion (Bayo 1987, section 6).
///
/// ```text
/// u = T + k_p (θ_ref − θ) + k_d (θ̇_ref − θ̇)
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Feedback {
    stiffness_n_m_rad: f64,
    damping_n_m_s_rad: f64,
    reference: HubReference,
}

/// Why gains and a reference are no feedback.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FeedbackError {
    /// A gain out of its range.
    #[error("{gain} = {found} {unit}, but must be finite and at least 0")]
    Gain {
        /// Name of the gain.
        gain: &'static str,
        /// What was found.
        found: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// A reference at other times than the torque.
    #[error(
        "the reference = {found} samples from {} s at {} s, but must stand at the torque's times: \
         {samples} samples from {} s at {} s",
        rounded(*found_start_s, 12),
        rounded(*found_step_s, 12),
        rounded(*start_s, 12),
        rounded(*step_s, 12)
    )]
    OtherTimes {
        /// Samples of the reference.
        found: usize,
        /// Its first time in s.
        found_start_s: f64,
        /// Its step in s.
        found_step_s: f64,
        /// Samples of the torque.
        samples: usize,
        /// Its first time in s.
        start_s: f64,
        /// Its step in s.
        step_s: f64,
    },
}

impl FeedbackError {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Gain { .. } => None,
            Self::OtherTimes { .. } => {
                Some("take hub_angle.csv and torque.csv of one run of solve")
            }
        }
    }
}

impl Feedback {
    /// Gains `k_p` in N m/rad and `k_d` in N m s/rad around a reference.
    ///
    /// # Errors
    /// [`FeedbackError::Gain`] names the first gain that is negative or not finite.
    pub fn new(
        stiffness_n_m_rad: f64,
        damping_n_m_s_rad: f64,
        reference: HubReference,
    ) -> Result<Self, FeedbackError> {
        let gains = [("KP", stiffness_n_m_rad, "N m/rad"), ("KD", damping_n_m_s_rad, "N m s/rad")];
        for (gain, found, unit) in gains {
            if !found.is_finite() || found < 0.0 {
                return Err(FeedbackError::Gain { gain, found, unit });
            }
        }
        Ok(Self { stiffness_n_m_rad, damping_n_m_s_rad, reference })
    }

    /// `k_p` in N m/rad.
    pub fn stiffness_n_m_rad(&self) -> f64 {
        self.stiffness_n_m_rad
    }

    /// `k_d` in N m s/rad.
    pub fn damping_n_m_s_rad(&self) -> f64 {
        self.damping_n_m_s_rad
    }

    /// Turn of the reference from its start to its end in rad.
    pub(super) fn turn_rad(&self) -> f64 {
        let angle = self.reference.angle_rad();
        angle[angle.len() - 1] - angle[0]
    }

    /// What the reference adds to the torque at each sample, `k_p (θ_ref − θ_ref(0)) + k_d θ̇_ref`;
    /// the link starts at the reference's first angle.
    ///
    /// # Errors
    /// [`FeedbackError::OtherTimes`].
    pub(super) fn wanted_torque_n_m(&self, torque: &Torque) -> Result<Vec<f64>, FeedbackError> {
        let (own, grid) = (self.reference.grid(), torque.grid());
        if !same_times(&own, &grid) {
            return Err(FeedbackError::OtherTimes {
                found: own.len,
                found_start_s: own.time_s(0),
                found_step_s: own.step_s,
                samples: grid.len,
                start_s: grid.time_s(0),
                step_s: grid.step_s,
            });
        }
        let angle = self.reference.angle_rad();
        let wanted = angle.iter().zip(self.rate_rad_s()).map(|(angle_rad, rate)| {
            self.stiffness_n_m_rad * (angle_rad - angle[0]) + self.damping_n_m_s_rad * rate
        });
        Ok(wanted.collect())
    }

    /// Rate of the reference, if the gains let it move the hub.
    pub(super) fn driving_rate_rad_s(&self) -> Option<Vec<f64>> {
        let drives = self.stiffness_n_m_rad > 0.0 || self.damping_n_m_s_rad > 0.0;
        drives.then(|| self.rate_rad_s())
    }

    /// Rate of the reference: as given, or that of a spline through its angles.
    fn rate_rad_s(&self) -> Vec<f64> {
        let given = self.reference.rate_rad_s().map(<[f64]>::to_vec);
        given.unwrap_or_else(|| {
            let angle = self.reference.angle_rad();
            let spline = CubicSpline::uniform(angle, SplineEnds::NotAKnot);
            spline.slopes().iter().map(|slope| slope / self.reference.grid().step_s).collect()
        })
    }
}

/// Whether two grids have the same samples, times within a thousandth of a step.
fn same_times(a: &TimeGrid, b: &TimeGrid) -> bool {
    let near = |x: f64, y: f64| (x - y).abs() <= 1e-3 * a.step_s;
    a.len == b.len
        && near(a.time_s(0), b.time_s(0))
        && near(a.time_s(a.len - 1), b.time_s(b.len - 1))
}
