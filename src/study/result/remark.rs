//! Values of a link file, a motion or a solution that are possible but rare.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use thiserror::Error;

use super::metrics::{Acting, JointMetrics, Metrics, timing_errors_s};
use super::peak::Peaks;
use crate::beam::Mesh;
use crate::inverse::{JointMotion, Solution};
use crate::link::{Arm, Link};
use crate::modal::{LoweredMode, Thickness};
use crate::motion::{Motion, Uncertainty};
use crate::text::significant;

/// Remedy for the weight of a link on a carriage without a direction.
pub const NO_DIRECTION: &str = "set start_angle: the weight then counts";

/// Densities of solids in kg/m³: the lightest foams and osmium, with little beside.
pub(super) const DENSITIES_KG_M3: RangeInclusive<f64> = 25.0..=25_000.0;

/// Moduli of solids in Pa: soft rubber and diamond, with little beside.
pub(super) const MODULI_PA: RangeInclusive<f64> = 1e6..=2e12;

/// First natural frequencies in Hz of links that are turned: a boom in space and a needle.
pub(super) const FIRST_FREQUENCIES_HZ: RangeInclusive<f64> = 0.02..=1e5;

/// Durations of motions in s: motors are not faster, and slower motions bend no link.
pub(super) const DURATIONS_S: RangeInclusive<f64> = 1e-3..=500.0;

/// A value that is possible but rare, often a slip of units. It neither stops a run nor counts as a
/// warning.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum Remark {
    /// A density outside the range of solids.
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
    /// A modulus outside the range of solids.
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
        "{parameter}: thickness = {} m is above width = {} m: the link bends across its stiffer side",
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
        /// Time in s from the last sample at rest to the first one at rest again.
        duration_s: f64,
    },
    /// A travel of more than a full turn.
    #[error(
        "the tip moves by {} m, {} turns of a link of {} m: probably length in another unit",
        significant(*travel_m, 4),
        significant(travel_m / (TAU * length_m), 3),
        significant(*length_m, 4)
    )]
    Travel {
        /// Largest distance of the tip from its start, in m.
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
        "{samples} {} replaced by the values that {} neighbours predict",
        if *samples == 1 { "sample was" } else { "samples were" },
        if *samples == 1 { "its" } else { "their" }
    )]
    DroppedOutliers {
        /// Number of the samples.
        samples: usize,
    },
    /// A tip that moves at its ends because a velocity column says so.
    #[error(
        "the tip moves at {} m/s before its motion and at {} m/s after it, as the velocity column states",
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
        /// Accuracy of the followed tip, as a share of its travel.
        followed: f64,
        /// Accuracy for exact samples.
        tolerance: f64,
    },
    /// A velocity or an acceleration with few digits.
    #[error(
        "the {column} has {decimals} decimals, ±{half_step:.1e} {}: the tip is followed to {followed:.1e} of its travel \
         instead of {tolerance:e}",
        if column == "velocity" { "m/s" } else { "m/s²" }
    )]
    IntegratedDigits {
        /// The column: `velocity` or `acceleration`.
        column: String,
        /// Number of decimals in the unit of the file.
        decimals: i32,
        /// Half of the last decimal in m/s or m/s².
        half_step: f64,
        /// Accuracy of the followed tip, as a share of its travel.
        followed: f64,
        /// Accuracy for exact samples.
        tolerance: f64,
    },
    /// A path with few digits.
    #[error(
        "the path has {decimals} decimals, ±{half_step_m:.1e} m: the tip is followed to {followed:.1e} of its travel \
         instead of {tolerance:e}"
    )]
    PathDigits {
        /// Number of decimals in the unit of the file.
        decimals: i32,
        /// Half of the last decimal in m.
        half_step_m: f64,
        /// Accuracy of the followed tip, as a share of its travel.
        followed: f64,
        /// Accuracy for exact samples.
        tolerance: f64,
    },
    /// A displacement with noise.
    #[error(
        "noise of {deviation_m:.1e} m: the tip is followed to {followed:.1e} of its travel instead of \
         {tolerance:e}, and each rest at an end is replaced by its mean, up to {moved_m:.1e} m from the data"
    )]
    Noise {
        /// Standard deviation in m.
        deviation_m: f64,
        /// Largest distance of a rest from the data in m.
        moved_m: f64,
        /// Accuracy of the followed tip, as a share of its travel.
        followed: f64,
        /// Accuracy for exact samples.
        tolerance: f64,
    },
    /// An acceleration that jumps: the followed motion overshoots in its band of frequencies.
    #[error(
        "the acceleration jumps: followed to {} Hz it peaks at {} m/s², {:.0} % above its samples; the rigid link's \
         acceleration has the same peak",
        significant(*cutoff_hz, 3),
        significant(*peak_m_s2, 3),
        100.0 * share
    )]
    Jumps {
        /// Highest frequency in Hz of the followed motion.
        cutoff_hz: f64,
        /// Largest acceleration of the followed motion in m/s².
        peak_m_s2: f64,
        /// Excess over the largest sample, as a share of this sample.
        share: f64,
    },
    /// A torque whose start and end the samples of the motion hardly determine.
    #[error(
        "{}the samples leave the torque uncertain by {} % of its {}: its start is uncertain by {} s, its end by {} s",
        joint.map_or_else(String::new, |joint| format!("joint {joint}: ")),
        significant(100.0 * share, 2),
        if *of_range { "range" } else { "peak" },
        significant(*lead_s, 2),
        significant(*lag_s, 2)
    )]
    Timing {
        /// Number of the joint of an arm, from 1.
        joint: Option<usize>,
        /// Error of the torque by the samples, over its peak, or with gravity its range.
        share: f64,
        /// True with gravity.
        of_range: bool,
        /// Error of the lead in s.
        lead_s: f64,
        /// Error of the lag in s.
        lag_s: f64,
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
    /// Columns of a sweep that leave the weight out.
    #[error("periods and zeros in the table are those without gravity")]
    WithoutWeight {
        /// True for a link on a carriage.
        slides: bool,
        /// True for a link that keeps a known direction.
        is_directed: bool,
    },
}

impl Remark {
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
            Self::IntegratedDigits { .. } => "integrated_digits",
            Self::PathDigits { .. } => "path_digits",
            Self::Noise { .. } => "noise",
            Self::Jumps { .. } => "jumps",
            Self::Timing { .. } => "timing",
            Self::UnknownSection { .. } => "unknown_section",
            Self::WithoutWeight { .. } => "without_weight",
        }
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Density { .. } => "write the unit beside the number, as in \"2.7 g/cm^3\"",
            Self::Modulus { .. } => "write the unit beside the number, as in \"70 GPa\"",
            Self::Rectangle { .. } => "exchange the two if the strip is meant to bend easily",
            Self::StartAngle { .. } => "write the unit beside the number, as in \"-90 deg\"",
            Self::FirstFrequency { .. } => "write the units beside the numbers of the link file",
            Self::Duration { .. } => "name the unit in the column's heading, as in \"time [ms]\"",
            Self::Travel { .. } => {
                "name the unit in the column's heading, as in \"displacement [mm]\" or \"angle [deg]\", or in `trajectory` as in --distance '90 deg'"
            }
            Self::Jitter { .. } => "--resample STEP interpolates at another step",
            Self::DroppedOutliers { .. } => "leave --drop-outliers out to see the first of them",
            Self::MovingEnds { .. } => {
                "confirm it with --moving-ends, or add the rows that bring the tip to rest"
            }
            Self::FewDigits { .. } => {
                "write the displacement with more decimals, or give --noise if these are exact"
            }
            Self::IntegratedDigits { .. } => {
                "write more decimals; if these are exact, add zeros at the end: 0.500000000"
            }
            Self::PathDigits { .. } => {
                "write the path with more decimals, or give --noise if these are exact; the errors of the input show the \
                 effect"
            }
            Self::Noise { .. } => "see the errors of the input for the effect on the torque",
            Self::Jumps { .. } => {
                "use a profile without jumps, such as septic; `flexlink verify` measures how far the torque depends \
                 on the step"
            }
            Self::Timing { joint: Some(_), .. } => "use a path with more digits or less noise",
            Self::Timing { .. } => {
                "use a displacement with less noise or more digits, or its acceleration"
            }
            Self::UnknownSection { .. } => {
                "set E and density with section, or with I and area: the share is then estimated"
            }
            Self::WithoutWeight { slides: false, .. } => {
                "modes --at ANGLE prints those with the weight in one direction"
            }
            Self::WithoutWeight { is_directed: false, .. } => NO_DIRECTION,
            Self::WithoutWeight { .. } => "modes prints those with the weight",
        }
    }
}

/// Least excess of a jumping acceleration over its samples that causes a remark, as a share.
const OVERSHOOT: f64 = 0.05;

/// Usual travel of the tip relative to the length: a full turn.
const MOST_TRAVEL: f64 = TAU;

/// Share of a lead or a lag that its error must exceed to cause a remark.
const SURE: f64 = 0.05;

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

    /// A remark on a sweep of an arm with weight, unless its columns have the weight.
    pub fn on_weight(arm: &Arm, reports_weight: bool) -> Option<Self> {
        let slides = arm.joint().slides();
        let is_directed = arm.alone().is_some_and(|link| link.direction_rad().is_some());
        let without = Self::WithoutWeight { slides, is_directed };
        (arm.has_weight() && !reports_weight).then_some(without)
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

    /// Remarks on a motion that moves the tip by `travel_m`; the tip may stray by the share `tolerance` of it.
    pub fn on_motion(arm: &Arm, motion: &Motion, travel_m: f64, tolerance: f64) -> Vec<Self> {
        let length_m = arm.length_m();
        let slides = arm.joint().slides();
        let duration = Self::on_duration(motion);
        let travel = (travel_m > MOST_TRAVEL * length_m && !slides)
            .then_some(Self::Travel { travel_m, length_m });
        let of_samples = Self::on_samples(motion, travel_m, tolerance);
        duration.into_iter().chain(travel).chain(of_samples).collect()
    }

    /// A remark on the duration of a motion.
    pub fn on_duration(motion: &Motion) -> Option<Self> {
        let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
        let duration_s = grid.time_s(until) - grid.time_s(from);
        let is_usual = DURATIONS_S.contains(&duration_s);
        (!is_usual).then_some(Self::Duration { duration_s })
    }

    /// A remark on a solution whose tip, followed up to a frequency, accelerates more than its motion.
    pub fn on_jumps(solution: &Solution) -> Option<Self> {
        let motion = solution.motion.tip().filter(|motion| motion.jumps())?;
        let cutoff_hz = solution.band.cutoff_hz?;
        let peak_m_s2 = Peaks::in_solution(solution).of(&solution.tip[0].acceleration_m_s2).value;
        let share = peak_m_s2 / motion.largest_acceleration_m_s2() - 1.0;
        (share > OVERSHOOT).then_some(Self::Jumps { cutoff_hz, peak_m_s2, share })
    }

    /// Remarks on the times of torques that the samples of the motion leave uncertain.
    pub fn on_timing(solution: &Solution) -> Vec<Self> {
        if solution.joints.iter().all(|joint| joint.errors.torque.input.is_none()) {
            return Vec::new();
        }
        let joints = solution.joints.iter().zip(Metrics::of(solution).joints);
        let of = |(joint, metrics): (&JointMotion, JointMetrics)| {
            let share = joint.errors.torque.input?;
            let torque = (&joint.torque_n_m[..], metrics.peak_torque_n_m);
            let [lead_s, lag_s] = timing_errors_s(&solution.grid, share, |level| {
                Acting::in_solution(solution, torque, level)
            });
            // Errors count only above a considerable share of lead or lag.
            let is_noticed =
                lead_s > SURE * metrics.lead_s?.abs() || lag_s > SURE * metrics.lag_s?.abs();
            let joint = metrics.joint.map(|number| number + 1);
            let of_range = solution.arm.has_weight();
            is_noticed.then_some(Self::Timing { joint, share, of_range, lead_s, lag_s })
        };
        joints.filter_map(of).collect()
    }

    /// Remarks on the accuracy of the samples of a motion.
    fn on_samples(motion: &Motion, travel_m: f64, tolerance: f64) -> impl Iterator<Item = Self> {
        let (grid, recording, tip) = (motion.grid(), motion.recording(), motion.tip());
        let jitter = recording.jitter.map(|steps| Self::Jitter { steps, step_s: grid.step_s });
        let moves = tip.filter(|_| recording.moves_by_column).map(|motion| {
            let [before_m_s, after_m_s] = motion.end_velocities_m_s();
            Self::MovingEnds { before_m_s, after_m_s }
        });
        let uncertain = recording.uncertainty.and_then(|uncertainty| {
            let followed_m = match (uncertainty, tip) {
                (Uncertainty::Integrated { .. }, Some(tip)) => {
                    tip.cutoff(tolerance).followed_m()?
                }
                _ => uncertainty.tolerance_m(grid.len),
            };
            let followed = followed_m / travel_m;
            // At 0 the solver uses all frequencies, whatever the accuracy of the samples.
            let is_raised = tolerance > 0.0 && followed > tolerance;
            (is_raised && recording.lowpass_rad_s.is_none()).then_some(match uncertainty {
                Uncertainty::Rounded { decimals, step_m } => {
                    let half_step_m = 0.5 * step_m;
                    match tip {
                        Some(_) => Self::FewDigits { decimals, half_step_m, followed, tolerance },
                        None => Self::PathDigits { decimals, half_step_m, followed, tolerance },
                    }
                }
                Uncertainty::Noisy { deviation_m, moved_m } => {
                    Self::Noise { deviation_m, moved_m, followed, tolerance }
                }
                Uncertainty::Integrated { times, decimals, step } => {
                    let column = if times == 1 { "velocity" } else { "acceleration" }.to_owned();
                    let half_step = 0.5 * step;
                    Self::IntegratedDigits { column, decimals, half_step, followed, tolerance }
                }
            })
        });
        let samples = recording.dropped;
        let dropped = (samples > 0).then_some(Self::DroppedOutliers { samples });
        jitter.into_iter().chain(dropped).chain(moves).chain(uncertain)
    }
}
