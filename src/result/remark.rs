//! Values that are possible but rare.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::peak::Peaks;
use crate::beam::Mesh;
use crate::inverse::Solution;
use crate::link::Link;
use crate::modal::{LoweredMode, Thickness};
use crate::motion::{ArmPath, TipMotion, Uncertainty};
use crate::text::significant;

/// Densities of solids in kg/m³: the lightest foams and osmium, with little beside.
const DENSITIES_KG_M3: RangeInclusive<f64> = 25.0..=25_000.0;

/// Moduli of solids in Pa: soft rubber and diamond, with little beside.
const MODULI_PA: RangeInclusive<f64> = 1e6..=2e12;

/// First natural frequencies in Hz of links that are turned: a boom in space and a needle.
const FIRST_FREQUENCIES_HZ: RangeInclusive<f64> = 0.02..=1e5;

/// Durations of motions in s: motors are not faster, and slower motions bend no link.
const DURATIONS_S: RangeInclusive<f64> = 1e-3..=500.0;

/// Share by which an acceleration that jumps must exceed its samples to be told.
const OVERSHOOT: f64 = 0.05;

/// Usual travel of the tip relative to the length: a full turn.
const MOST_TRAVEL: f64 = TAU;

/// A value that is possible but rare, often a slip of units. It neither stops a run nor counts as a
/// warning.
#[derive(Debug, Clone, PartialEq, Error, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Remark {
    /// A density that no solid has.
    #[error(
        "{parameter} = {kg_m3} kg/m^3, where solids have {} to {}: probably another unit",
        DENSITIES_KG_M3.start(),
        DENSITIES_KG_M3.end()
    )]
    Density {
        /// Dotted path, as in the link file.
        parameter: String,
        /// The density in kg/m³.
        kg_m3: f64,
    },
    /// A modulus that no solid has.
    #[error(
        "{parameter} = {pa:?} Pa, where solids have {:e} to {:e}: probably another unit",
        MODULI_PA.start(),
        MODULI_PA.end()
    )]
    Modulus {
        /// Dotted path, as in the link file.
        parameter: String,
        /// Young's modulus in Pa.
        pa: f64,
    },
    /// A rectangle that is thicker in the plane of motion than it is wide.
    #[error(
        "{parameter}: thickness = {} m, which is above width = {} m: the link bends across its stiffer side",
        significant(*thickness_m, 6),
        significant(*width_m, 6)
    )]
    Rectangle {
        /// Dotted path, as in the link file.
        parameter: String,
        /// Size across the plane of motion in m.
        width_m: f64,
        /// Size in the plane of motion in m.
        thickness_m: f64,
    },
    /// A start angle of more than a turn.
    #[error(
        "start_angle = {} rad, more than a whole turn: probably meant in another unit, as \"{} deg\"",
        significant(*angle_rad, 4),
        significant(*angle_rad, 4)
    )]
    StartAngle {
        /// The angle in rad.
        angle_rad: f64,
    },
    /// A first natural frequency that is unusual for a link.
    #[error(
        "the first natural frequency is {} Hz, where links have {:?} to {:e}: probably a wrong unit of \
         length, mass or stiffness",
        significant(*hertz, 2),
        FIRST_FREQUENCIES_HZ.start(),
        FIRST_FREQUENCIES_HZ.end()
    )]
    FirstFrequency {
        /// The frequency in Hz.
        hertz: f64,
    },
    /// An unusual duration.
    #[error(
        "the tip moves for {} s, where motions take {:?} to {:?}: probably time in another unit",
        significant(*duration_s, 4),
        DURATIONS_S.start(),
        DURATIONS_S.end()
    )]
    Duration {
        /// From the last sample at rest to the first one at rest again, in s.
        duration_s: f64,
    },
    /// A travel of more than a full turn.
    #[error(
        "the tip moves by {} m, {} turns of a link of {} m: probably length in another unit",
        significant(*travel_m, 4),
        significant(travel_m / (TAU * length_m), 3),
        significant(*length_m, 4)
    )]
    #[serde(rename = "way")]
    Travel {
        /// Largest distance from where the tip starts, in m.
        travel_m: f64,
        /// Length of the link in m.
        length_m: f64,
    },
    /// Times between those of a uniform grid.
    #[error(
        "the times are off a uniform grid of {} s by up to {} % of a step: the samples are interpolated at \
         uniform times by a cubic spline",
        significant(*step_s, 6),
        significant(100.0 * steps, 2)
    )]
    Jitter {
        /// Largest distance of a time from the grid, in steps.
        steps: f64,
        /// The step in s.
        step_s: f64,
    },
    /// Samples that did not follow their neighbours, and were replaced.
    #[error(
        "{samples} {} replaced by what {} neighbours lead to",
        if *samples == 1 { "sample was" } else { "samples were" },
        if *samples == 1 { "its" } else { "their" }
    )]
    DroppedOutliers {
        /// Number of the samples.
        samples: usize,
    },
    /// A tip that moves at its ends because a velocity column says so.
    #[error(
        "the velocity says that the tip moves at {} m/s before its motion and at {} m/s after it, and has done so all along",
        significant(*before_m_s, 3),
        significant(*after_m_s, 3)
    )]
    MovingEnds {
        /// Velocity before the motion in m/s.
        before_m_s: f64,
        /// Velocity after it in m/s.
        after_m_s: f64,
    },
    /// A displacement with few digits.
    #[error(
        "the displacement has {decimals} decimals, ±{half_step_m:.1e} m: the tip is followed to \
         {followed:.1e} of its travel instead of {tolerance:e}"
    )]
    FewDigits {
        /// Number of decimals in the unit of the file.
        decimals: i32,
        /// Half of the last decimal in m.
        half_step_m: f64,
        /// Share of its travel that the tip is followed to.
        followed: f64,
        /// The same for exact samples.
        tolerance: f64,
    },
    /// A path with few digits.
    #[error(
        "the path has {decimals} decimals, ±{half_step_m:.1e} m: the tip is followed to {followed:.1e} of its way instead of \
         {tolerance:e}"
    )]
    PathDigits {
        /// Number of decimals in the unit of the file.
        decimals: i32,
        /// Half of the last decimal in m.
        half_step_m: f64,
        /// Share of its way that the tip is followed to.
        followed: f64,
        /// The same for exact samples.
        tolerance: f64,
    },
    /// A displacement with noise.
    #[error(
        "noise of {deviation_m:.1e} m: the tip is followed to {followed:.1e} of its travel instead of \
         {tolerance:e}, and the rests at the ends are their means, up to {moved_m:.1e} m from the data"
    )]
    Noise {
        /// Standard deviation in m.
        deviation_m: f64,
        /// Largest distance of a rest from the data in m.
        moved_m: f64,
        /// Share of its travel that the tip is followed to.
        followed: f64,
        /// The same for exact samples.
        tolerance: f64,
    },
    /// An acceleration that jumps: what follows it in a band of frequencies overshoots.
    #[error(
        "the acceleration jumps: followed to {} Hz it peaks at {} m/s², {:.0} % above its samples; that of the rigid link \
         has the same peak",
        significant(*cutoff_hz, 3),
        significant(*peak_m_s2, 3),
        100.0 * share
    )]
    Jumps {
        /// Frequency in Hz up to which the motion is followed.
        cutoff_hz: f64,
        /// Largest acceleration of the motion that is followed in m/s².
        peak_m_s2: f64,
        /// By how much that is above the largest of the samples, as a share of it.
        share: f64,
    },
    /// A link so short and stiff that shear, which needs its section, may matter.
    #[error(
        "the link's section is not known everywhere: if it is of metal, shear and rotary inertia, which the \
         theory leaves out, lower mode {} by about {:.0} %",
        mode.number,
        100.0 * mode.share
    )]
    UnknownSection {
        /// The highest mode examined.
        mode: LoweredMode,
    },
}

impl Remark {
    /// A remark on an unusual density above 0.
    pub fn on_density(parameter: &str, kg_m3: f64) -> Option<Self> {
        let is_usual = kg_m3 <= 0.0 || DENSITIES_KG_M3.contains(&kg_m3);
        (!is_usual).then(|| Self::Density { parameter: parameter.to_owned(), kg_m3 })
    }

    /// A remark on a rectangle that is thicker than wide.
    pub fn on_rectangle(parameter: &str, width_m: f64, thickness_m: f64) -> Option<Self> {
        let parameter = parameter.to_owned();
        (thickness_m > width_m).then_some(Self::Rectangle { parameter, width_m, thickness_m })
    }

    /// A remark on a start angle beyond a whole turn.
    pub fn on_start_angle(angle_rad: f64) -> Option<Self> {
        (angle_rad.abs() > TAU).then_some(Self::StartAngle { angle_rad })
    }

    /// A remark on an unusual Young's modulus.
    pub fn on_modulus(parameter: &str, pa: f64) -> Option<Self> {
        let is_usual = MODULI_PA.contains(&pa);
        (!is_usual).then(|| Self::Modulus { parameter: parameter.to_owned(), pa })
    }

    /// Remarks on the first natural frequencies of a link, in rad/s.
    pub fn on_modes(link: &Link, mesh: &Mesh, omegas_rad_s: &[f64]) -> Vec<Self> {
        let first = omegas_rad_s.first().map(|omega| omega / TAU);
        let rare = first.filter(|hertz| !FIRST_FREQUENCIES_HZ.contains(hertz));
        let guessed = Thickness::guessed(link);
        let thick = guessed.and_then(|guess| guess.noticeable(mesh, omegas_rad_s));
        rare.map(|hertz| Self::FirstFrequency { hertz })
            .into_iter()
            .chain(thick.map(|thick| Self::UnknownSection { mode: thick.highest }))
            .collect()
    }

    /// Remarks on a motion that moves the tip by `travel_m`, of which it may stray by `tolerance`.
    pub fn on_motion(link: &Link, motion: &TipMotion, travel_m: f64, tolerance: f64) -> Vec<Self> {
        let length_m = link.length_m();
        let duration = Self::on_duration(motion);
        let travel =
            (travel_m > MOST_TRAVEL * length_m).then_some(Self::Travel { travel_m, length_m });
        let of_samples = Self::on_samples(motion, travel_m, tolerance);
        duration.into_iter().chain(travel).chain(of_samples).collect()
    }

    /// A remark on the duration of a motion.
    pub fn on_duration(motion: &TipMotion) -> Option<Self> {
        let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
        let duration_s = grid.time_s(until) - grid.time_s(from);
        let is_usual = DURATIONS_S.contains(&duration_s);
        (!is_usual).then_some(Self::Duration { duration_s })
    }

    /// A remark on a solution whose tip, followed up to a frequency, is accelerated more than its motion.
    pub fn on_jumps(solution: &Solution) -> Option<Self> {
        let cutoff_hz = solution.band.cutoff_hz.filter(|_| solution.motion.jumps())?;
        let peak_m_s2 = Peaks::of_solution(solution).of(&solution.tip.acceleration_m_s2).value;
        let share = peak_m_s2 / solution.motion.largest_acceleration_m_s2() - 1.0;
        (share > OVERSHOOT).then_some(Self::Jumps { cutoff_hz, peak_m_s2, share })
    }

    /// A remark on the digits of an arm's path that leads its tip over `way_m`, of which it may stray by `tolerance`.
    pub fn on_path(path: &ArmPath, way_m: f64, tolerance: f64) -> Option<Self> {
        let (decimals, step_m) = path.rounded()?;
        let followed = step_m / way_m;
        (tolerance > 0.0 && followed > tolerance).then_some(Self::PathDigits {
            decimals,
            half_step_m: 0.5 * step_m,
            followed,
            tolerance,
        })
    }

    /// A remark on samples that were replaced, if any were.
    pub fn on_dropped(samples: usize) -> Option<Self> {
        (samples > 0).then_some(Self::DroppedOutliers { samples })
    }

    /// Remarks on what the samples of a motion are worth.
    fn on_samples(motion: &TipMotion, travel_m: f64, tolerance: f64) -> impl Iterator<Item = Self> {
        let (grid, recording) = (motion.grid(), motion.recording());
        let jitter = recording.jitter.map(|steps| Self::Jitter { steps, step_s: grid.step_s });
        let [before_m_s, after_m_s] = motion.end_velocities_m_s();
        let moves = recording.moves_by_column.then_some(Self::MovingEnds { before_m_s, after_m_s });
        let uncertain = recording.uncertainty.and_then(|uncertainty| {
            let followed = uncertainty.tolerance_m(grid.len) / travel_m;
            // At 0 all frequencies are solved, whatever the samples are worth.
            let is_raised = tolerance > 0.0 && followed > tolerance;
            (is_raised && recording.lowpass_rad_s.is_none()).then_some(match uncertainty {
                Uncertainty::Rounded { decimals, step_m } => {
                    Self::FewDigits { decimals, half_step_m: 0.5 * step_m, followed, tolerance }
                }
                Uncertainty::Noisy { deviation_m, moved_m } => {
                    Self::Noise { deviation_m, moved_m, followed, tolerance }
                }
            })
        });
        let dropped = Self::on_dropped(recording.dropped);
        jitter.into_iter().chain(dropped).chain(moves).chain(uncertain)
    }

    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Density { .. } => "density",
            Self::Modulus { .. } => "modulus",
            Self::Rectangle { .. } => "rectangle",
            Self::StartAngle { .. } => "start_angle",
            Self::FirstFrequency { .. } => "first_frequency",
            Self::Duration { .. } => "duration",
            Self::Travel { .. } => "way",
            Self::Jitter { .. } => "jitter",
            Self::DroppedOutliers { .. } => "dropped_outliers",
            Self::MovingEnds { .. } => "moving_ends",
            Self::FewDigits { .. } => "few_digits",
            Self::PathDigits { .. } => "path_digits",
            Self::Noise { .. } => "noise",
            Self::Jumps { .. } => "jumps",
            Self::UnknownSection { .. } => "unknown_section",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Density { .. } => "write the unit beside the number, as in \"2.7 g/cm^3\"",
            Self::Modulus { .. } => "write the unit beside the number, as in \"70 GPa\"",
            Self::Rectangle { .. } => "exchange the two if the strip is meant to bend easily",
            Self::StartAngle { .. } => "write the unit beside the number, as in \"-90 deg\"",
            Self::FirstFrequency { .. } => "write the units beside the numbers of the link file",
            Self::Duration { .. } => "name the unit in the column's heading, as in \"time [ms]\"",
            Self::Travel { .. } => {
                "name the unit in the column's heading, as in \"displacement [mm]\""
            }
            Self::Jitter { .. } => "--resample STEP interpolates at another step",
            Self::DroppedOutliers { .. } => {
                "without --drop-outliers the first of them is named and refused"
            }
            Self::MovingEnds { .. } => {
                "--moving-ends says so without this remark; add the rows that bring the tip to rest if it rests"
            }
            Self::FewDigits { .. } => {
                "write the displacement with more decimals, or give --noise if these are exact"
            }
            Self::PathDigits { .. } => {
                "write the path with more decimals; the errors of the input say what that does"
            }
            Self::Noise { .. } => "the errors of the input say what that does to the torque",
            Self::Jumps { .. } => {
                "a profile without jumps, as septic; `flexlink verify` tells how far the torque depends on the step"
            }
            Self::UnknownSection { .. } => {
                "give E and density with section, or with I and area: the share is then estimated"
            }
        }
    }
}
