//! What the samples of a recorded motion are worth.

use std::f64::consts::TAU;

/// How samples are uncertain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Uncertainty {
    /// Displacements are rounded to this many decimals of the unit of their file.
    Rounded {
        /// Number of decimals; negative for tens, hundreds, ….
        decimals: i32,
        /// The last decimal in m: each sample is off by up to half of it.
        step_m: f64,
    },
    /// Displacements carry noise that is independent from sample to sample.
    Noisy {
        /// Its standard deviation in m.
        deviation_m: f64,
        /// Largest distance in m by which the rests at the ends were moved to their means.
        moved_m: f64,
    },
}

/// What is known of the samples of a motion beside their values. By default they are exact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Recording {
    /// How displacements are uncertain; `None`: by less than anything that matters.
    pub uncertainty: Option<Uncertainty>,
    /// Largest distance of a time from the uniform grid of all, in steps, where the samples were taken
    /// between the times of that grid and interpolated.
    pub jitter: Option<f64>,
    /// Whether a velocity column says by itself that the tip moves at the ends.
    pub moves_by_column: bool,
    /// Cut-off in rad/s that the user has chosen; `None`: the one that the tip needs.
    pub lowpass_rad_s: Option<f64>,
    /// Direction in rad of the chord, from the axis to the tip, where the displacement is 0, if the samples were
    /// given as angles of a link with gravity.
    pub start_angle_rad: Option<f64>,
}

impl Uncertainty {
    /// Standard deviation of a sample in m. That of rounding is evenly distributed over one step.
    pub fn deviation_m(&self) -> f64 {
        match self {
            Self::Rounded { step_m, .. } => step_m / 12.0_f64.sqrt(),
            Self::Noisy { deviation_m, .. } => *deviation_m,
        }
    }

    /// Distance in m within which a motion can follow `samples` samples: the largest error of one of them,
    /// and √3 standard deviations for what the cut-off leaves out of the motion itself. For rounding this
    /// is one step; the largest of n normal errors is √(2 ln n) deviations.
    pub fn tolerance_m(&self, samples: usize) -> f64 {
        match self {
            Self::Rounded { step_m, .. } => *step_m,
            Self::Noisy { deviation_m, .. } => {
                let largest = (2.0 * libm::log(samples.max(2) as f64)).sqrt();
                (largest + 3.0_f64.sqrt()) * deviation_m
            }
        }
    }

    fn scaled(self, distance: f64) -> Self {
        let distance = distance.abs();
        match self {
            Self::Rounded { decimals, step_m } => {
                Self::Rounded { decimals, step_m: distance * step_m }
            }
            Self::Noisy { deviation_m, moved_m } => {
                let [deviation_m, moved_m] = [deviation_m, moved_m].map(|x| distance * x);
                Self::Noisy { deviation_m, moved_m }
            }
        }
    }
}

impl Recording {
    /// With displacements and duration times these factors.
    pub(super) fn scaled(self, distance: f64, duration: f64) -> Self {
        Self {
            uncertainty: self.uncertainty.map(|own| own.scaled(distance)),
            lowpass_rad_s: self.lowpass_rad_s.map(|own| own / duration),
            ..self
        }
    }

    /// The chosen cut-off in Hz.
    pub fn lowpass_hz(&self) -> Option<f64> {
        self.lowpass_rad_s.map(|omega| omega / TAU)
    }
}
