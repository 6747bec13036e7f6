//! Tip motions in closed form, and the files that hold their samples.

use std::f64::consts::{PI, TAU};
use std::fmt::Write;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Profile {
    Sine,
    Versine,
    MinJerk,
    Septic,
    Trapezoid,
    SCurve,
    BangBang,
    Gaussian,
}

/// Which column the file has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Column {
    Acceleration,
    Displacement,
    /// Displacement in so many decimals.
    Rounded(usize),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    pub(crate) profile: Profile,
    pub(crate) distance_m: f64,
    pub(crate) duration_s: f64,
    /// Step at which the case is first run.
    pub(crate) step_s: f64,
    /// So many steps are taken for one.
    pub(crate) finer: usize,
    pub(crate) column: Column,
}

/// What a file says: uniform samples of one quantity.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Samples {
    pub(crate) step_s: f64,
    pub(crate) values: Vec<f64>,
    pub(crate) is_displacement: bool,
}

impl Profile {
    pub(crate) const ALL: [Self; 8] = [
        Self::Sine,
        Self::Versine,
        Self::MinJerk,
        Self::Septic,
        Self::Trapezoid,
        Self::SCurve,
        Self::BangBang,
        Self::Gaussian,
    ];

    /// Displacement at the share u of the duration, of a way of 1.
    pub(crate) fn displacement(self, u: f64) -> f64 {
        let u = u.clamp(0.0, 1.0);
        // The second half mirrors the first.
        if u > 0.5 {
            return 1.0 - self.displacement(1.0 - u);
        }
        match self {
            Self::Sine => u - (TAU * u).sin() / TAU,
            Self::Versine => 0.5 * (1.0 - (PI * u).cos()),
            Self::MinJerk => u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u),
            Self::Septic => u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3)),
            // Peak velocity 3/2.
            Self::Trapezoid if u > 1.0 / 3.0 => 0.25 + 1.5 * (u - 1.0 / 3.0),
            Self::Trapezoid => 2.25 * u * u,
            Self::BangBang => 2.0 * u * u,
            Self::SCurve => {
                // Ramps of a twelfth, peak acceleration 6.
                let ramp = |u: f64| 12.0 * 6.0 * u.max(0.0).powi(3) / 6.0;
                ramp(u) - ramp(u - 1.0 / 12.0) - ramp(u - 0.25) + ramp(u - 1.0 / 3.0)
            }
            Self::Gaussian => {
                let s = 12.0 * (u - 0.5);
                0.5 * libm::erfc(-s / 2.0_f64.sqrt())
            }
        }
    }

    /// Acceleration at the share u, of a way of 1 in a time of 1; a jump is the side towards the
    /// middle at the ends, and zero in the middle.
    pub(crate) fn acceleration(self, u: f64) -> f64 {
        if (u - 0.5).abs() < 1e-12 {
            return 0.0;
        }
        if u > 0.5 {
            return -self.acceleration(1.0 - u);
        }
        match self {
            Self::Sine => TAU * (TAU * u).sin(),
            Self::Versine => 0.5 * PI * PI * (PI * u).cos(),
            Self::MinJerk => u * (60.0 - 180.0 * u + 120.0 * u * u),
            Self::Septic => u * u * (420.0 - 1680.0 * u + 2100.0 * u * u - 840.0 * u.powi(3)),
            Self::Trapezoid if u > 1.0 / 3.0 => 0.0,
            Self::Trapezoid => 4.5,
            Self::BangBang => 4.0,
            Self::SCurve => 6.0 * (12.0 * u).min(4.0 - 12.0 * u).clamp(0.0, 1.0),
            Self::Gaussian => {
                let s = 12.0 * (u - 0.5);
                -144.0 * s * (-0.5 * s * s).exp() / TAU.sqrt()
            }
        }
    }
}

impl Motion {
    pub(crate) fn new(profile: Profile, distance_m: f64, duration_s: f64, step_s: f64) -> Self {
        Self { profile, distance_m, duration_s, step_s, finer: 1, column: Column::Acceleration }
    }

    /// The same motion at a part of its step.
    pub(crate) fn finer(self, finer: usize) -> Self {
        Self { finer, ..self }
    }

    pub(crate) fn samples(self) -> Samples {
        let steps = (self.duration_s / self.step_s).round() as usize;
        let (count, step_s) = (steps * self.finer, self.step_s / self.finer as f64);
        let at = |k: usize| k as f64 / count as f64;
        let acceleration = self.distance_m / (count as f64 * step_s).powi(2);
        let (is_displacement, values): (bool, Vec<f64>) = match self.column {
            Column::Acceleration => {
                // Antisymmetric to the last bit, so that the samples end at rest.
                let own = |k: usize| {
                    let mirrored = k.min(count - k);
                    let sign = if mirrored == k { 1.0 } else { -1.0 };
                    sign * acceleration * self.profile.acceleration(at(mirrored))
                };
                (false, (0..=count).map(own).collect())
            }
            // Rest on both sides, so that the file begins and ends at rest whatever the profile.
            Column::Displacement | Column::Rounded(_) => {
                let own = |k: usize| self.distance_m * self.profile.displacement(at(k));
                let digits = |d: f64| match self.column {
                    Column::Rounded(decimals) => {
                        format!("{d:.decimals$}").parse().expect("a number")
                    }
                    _ => d,
                };
                let rest = (steps / 20).max(4) * self.finer;
                let before = std::iter::repeat_n(digits(own(0)), rest);
                let after = std::iter::repeat_n(digits(own(count)), rest);
                (true, before.chain((0..=count).map(|k| digits(own(k)))).chain(after).collect())
            }
        };
        Samples { step_s, values, is_displacement }
    }
}

impl Samples {
    /// The file for the program.
    pub(crate) fn csv(&self) -> String {
        let name = if self.is_displacement { "displacement" } else { "acceleration" };
        let mut text = format!("time,{name}\n");
        for (k, value) in self.values.iter().enumerate() {
            writeln!(text, "{},{value:e}", k as f64 * self.step_s).expect("text takes all");
        }
        text
    }

    /// Travel of the tip in m.
    pub(crate) fn way_m(&self) -> f64 {
        if self.is_displacement {
            let last = self.values.len() - 1;
            return self.values[last] - self.values[0];
        }
        let moments = self.values.iter().enumerate().map(|(k, a)| -(k as f64) * a);
        moments.sum::<f64>() * self.step_s * self.step_s
    }
}
