use std::f64::consts::TAU;

use num_complex::Complex64;
use thiserror::Error;

use super::accuracy::Quantity;
use super::analysis::Analysis;
use super::model_end::{FastHub, fast_hub, stiffening, thick_link};
use super::solution::Solution;
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::{ThickLink, real_frequency_zeros};
use crate::motion::{Shortfall, TipMotion, TipSpectrum};
use crate::numeric::{largest, significant};

/// Amplitude near the Nyquist frequency, over the largest, from which on the user is warned.
const NYQUIST_SHARE: f64 = 1e-3;

/// Share of the torque above the mesh's frequency from which on the user is warned.
const ABOVE_MESH_SHARE: f64 = 1e-2;

/// Mesh error, and change by half the step, from which on the user is warned.
const COARSE: f64 = 1e-2;

/// Rows, and times the motion's own samples, above which a window that was lengthened is told of.
const LONG_ROWS: usize = 50_000;
const LONG_TIMES: f64 = 10.0;

/// Something that the user must know to believe the answer. Returned, never printed here.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Warning {
    /// The acceleration left the tip moving by what few digits explain; it was taken out.
    #[error(
        "the acceleration integrates to {velocity_m_s:.3e} m/s, {share:.1e} of the peak velocity: \
         taken out by a constant over the motion's own samples"
    )]
    EndVelocityCorrected {
        /// ∫a dt of the samples as given, in m/s.
        velocity_m_s: f64,
        /// The same over the peak velocity.
        share: f64,
    },
    /// The samples do not bring the tip within its tolerance.
    #[error(
        "the tip strays by {share:.1e} of its way from the motion asked for, above \
         analysis.tip_tolerance = {tolerance:e}: {}",
        cause(shortfall)
    )]
    TipMissed {
        /// Largest distance from the wanted motion over its way.
        share: f64,
        /// The tolerance of the tip.
        tolerance: f64,
        /// What the samples lack.
        shortfall: Shortfall,
    },
    /// A quantity that the finite period or the window leaves less exact than asked for.
    #[error(
        "the finite period and the window leave the {} off by {share:.1e} of its peak, above the \
         tolerance {tolerance:e}",
        quantity.name()
    )]
    InexactWindow {
        /// What is off.
        quantity: Quantity,
        /// By how much, over its own peak.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
    },
    /// A quantity that depends on the step of the motion.
    #[error(
        "half the step changes the {} by {share:.1e} of its peak: with analysis.tip_tolerance = 0 \
         every frequency of the samples is solved for, and the step limits it",
        quantity.name()
    )]
    CoarseStep {
        /// What changes most.
        quantity: Quantity,
        /// By how much, over its own peak.
        share: f64,
    },
    /// The written window cuts torque off.
    #[error(
        "the torque outside the written window reaches {share:.1e} of its peak, above the \
         tolerance {tolerance:e}"
    )]
    TorqueCut {
        /// Largest torque outside the window over the peak.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
    },
    /// One period's torque reaches into the next.
    #[error(
        "the torque has decayed to no less than {share:.1e} of its peak half a period \
         ({period_s:.4} s in all) away from the motion, above the tolerance {tolerance:e}"
    )]
    WrapAround {
        /// Torque at the seam of two periods over the peak.
        share: f64,
        /// The analysis tolerance.
        tolerance: f64,
        /// Period P in s.
        period_s: f64,
    },
    /// A torque that does not decay has made the window long.
    #[error(
        "the torque hardly decays: its window was lengthened to {rows} rows, {times:.0} times the \
         motion's own"
    )]
    LongWindow {
        /// Rows of the window.
        rows: usize,
        /// The same over the samples of the motion.
        times: f64,
    },
    /// A payload's inertia or offset blocks the tip at a frequency that the motion contains.
    #[error(
        "at {} Hz no torque moves the tip (lumped inertia or payload), and the motion holds \
         {share:.1e} of its largest amplitude there: the torque grows as 1/(damping)",
        significant(*frequency_hz, 6)
    )]
    BlockedTip {
        /// The zero of torque → tip in Hz.
        frequency_hz: f64,
        /// Amplitude of the acceleration there over its largest.
        share: f64,
    },
    /// The motion changes too fast for its step.
    #[error(
        "the acceleration near the Nyquist frequency ({nyquist_hz:.4} Hz) reaches {share:.1e} of \
         its largest amplitude: jumps or noise that the step does not resolve"
    )]
    NearNyquist {
        /// Largest amplitude above 0.8 of the Nyquist frequency over the largest of all.
        share: f64,
        /// Nyquist frequency in Hz.
        nyquist_hz: f64,
    },
    /// Torque at frequencies that the mesh does not follow.
    #[error(
        "{share:.1e} of the torque (rms) lies above {resolved_hz:.4} Hz, beyond which the mesh is \
         wrong by 1 % and more"
    )]
    AboveMesh {
        /// Root-mean-square torque above the mesh's frequency over that of all.
        share: f64,
        /// Frequency up to which the mesh follows bending waves, in Hz.
        resolved_hz: f64,
    },
    /// More bending than the linear theory of small deflections holds for.
    #[error("{}", Link::large_deflection_words(*share))]
    LargeDeflection {
        /// Largest deflection of the tip from the hub's tangent line over the length.
        share: f64,
    },
    /// Shear and rotary inertia that the model leaves out.
    #[error(transparent)]
    ThickLink(#[from] ThickLink),
    /// A hub that turns as fast as the link vibrates.
    #[error(
        "the hub turns at up to {} rad/s, {share:.2} of the clamped link's first natural frequency: \
         centrifugal stiffening, which the model leaves out, moves the tip by {} of its way",
        significant(*rate_rad_s, 3),
        stiffening(*share)
    )]
    FastHub {
        /// Largest hub rate in rad/s.
        rate_rad_s: f64,
        /// The same over the first natural frequency of the link clamped at its hub.
        share: f64,
    },
    /// A mesh that is too coarse for the motion.
    #[error("the mesh changes the {} by {error:.1e} of its peak (elements halved)", quantity.name())]
    CoarseMesh {
        /// What it changes most.
        quantity: Quantity,
        /// Discretisation error of that over its peak.
        error: f64,
    },
}

impl Warning {
    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::EndVelocityCorrected { .. } => "end_velocity_corrected",
            Self::TipMissed { .. } => "tip_missed",
            Self::InexactWindow { .. } => "inexact_window",
            Self::CoarseStep { .. } => "coarse_step",
            Self::TorqueCut { .. } => "torque_cut",
            Self::WrapAround { .. } => "wrap_around",
            Self::LongWindow { .. } => "long_window",
            Self::BlockedTip { .. } => "blocked_tip",
            Self::NearNyquist { .. } => "near_nyquist",
            Self::AboveMesh { .. } => "above_mesh",
            Self::LargeDeflection { .. } => "large_deflection",
            Self::ThickLink(thick) => thick.kind(),
            Self::FastHub { .. } => "fast_hub",
            Self::CoarseMesh { .. } => "coarse_mesh",
        }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::EndVelocityCorrected { .. } => "write the trajectory with more digits",
            Self::TipMissed { shortfall: Shortfall::Step(_), .. } => {
                "a motion sampled more finely, or a larger analysis.tip_tolerance"
            }
            Self::TipMissed { shortfall: Shortfall::Noise, .. } => {
                "an analysis.tip_tolerance above the noise, or a motion written with more digits"
            }
            Self::InexactWindow { .. } => "longer rests around the motion, or a looser tolerance",
            Self::CoarseStep { .. } => "an analysis.tip_tolerance above 0, or a smoother motion",
            Self::TorqueCut { .. } => "a longer analysis.lead and analysis.lag, or none of them",
            Self::WrapAround { .. } => "a longer analysis.lag, more damping or a looser tolerance",
            Self::LongWindow { .. } => {
                "damping lets it decay; analysis.lead and analysis.lag bound the window, --every the \
                 tables of the nodes"
            }
            Self::LargeDeflection { .. } | Self::FastHub { .. } => {
                "a slower motion or a stiffer link"
            }
            Self::ThickLink(thick) => thick.hint(),
            Self::BlockedTip { .. } => "a smoother or slower motion avoids the frequency",
            Self::NearNyquist { .. } => "a smoother motion or a shorter step",
            Self::AboveMesh { .. } | Self::CoarseMesh { .. } => {
                "more elements, mesh.elements = \"auto\" or a smoother motion"
            }
        }
    }
}

fn cause(shortfall: &Shortfall) -> String {
    match shortfall {
        Shortfall::Step(step_s) => {
            format!("its step is too long, {} s would do", significant(*step_s, 2))
        }
        Shortfall::Noise => "its samples hold noise or rounding of that size".into(),
    }
}

/// What a run was given and measured of itself.
pub(super) struct Evidence<'a> {
    pub(super) link: &'a Link,
    pub(super) motion: &'a TipMotion,
    pub(super) analysis: &'a Analysis,
    /// Torque outside the written window, over the peak.
    pub(super) cut: f64,
    /// Torque where one period meets the next, over the peak.
    pub(super) seam: f64,
}

/// All warnings that a solution and the evidence give reason for.
pub(super) fn warnings(evidence: &Evidence<'_>, solution: &Solution) -> Vec<Warning> {
    let Evidence { link, motion, analysis, cut, seam } = *evidence;
    let tolerance = analysis.tolerance();
    let (mesh, spectrum) = (solution.mesh(), &solution.spectrum);
    let corrected = motion.corrected().map(|end| Warning::EndVelocityCorrected {
        velocity_m_s: end.velocity_m_s,
        share: end.share,
    });
    let tip_missed = spectrum.cutoff.shortfall.map(|shortfall| Warning::TipMissed {
        share: solution.accuracy.tip,
        tolerance: analysis.tip_tolerance(),
        shortfall,
    });
    let period_s = spectrum.period_s();
    let wrap_around = Warning::WrapAround { share: seam, tolerance, period_s };
    let torque_cut = Warning::TorqueCut { share: cut, tolerance };
    let (rows, given) = (solution.grid.len, evidence.motion.grid().len);
    let times = rows as f64 / given as f64;
    let is_long = seam > tolerance && rows > LONG_ROWS && times > LONG_TIMES;
    let (quantity, error) = solution.accuracy.of_kind(|errors| errors.mesh).worst();
    corrected
        .into_iter()
        .chain(tip_missed)
        .chain((cut > tolerance.max(seam)).then_some(torque_cut))
        .chain((seam > tolerance).then_some(wrap_around))
        .chain(is_long.then_some(Warning::LongWindow { rows, times }))
        .chain(inexact_window(solution, tolerance))
        .chain(blocked_tip(mesh, spectrum, tolerance))
        .chain(near_nyquist(spectrum))
        .chain(above_mesh(mesh, spectrum, &solution.torque_amplitudes_n_m))
        .chain((error > COARSE).then_some(Warning::CoarseMesh { quantity, error }))
        .chain(coarse_step(solution))
        .chain(large_deflection(solution))
        .chain(thick_link(link, solution).map(Warning::ThickLink))
        .chain(
            fast_hub(solution)
                .map(|FastHub { rate_rad_s, share }| Warning::FastHub { rate_rad_s, share }),
        )
        .collect()
}

/// The worst of the quantities beside the torque, of which the torque's own warnings do not tell.
fn inexact_window(solution: &Solution, tolerance: f64) -> Option<Warning> {
    let mut shares = solution.accuracy.of_kind(|errors| errors.window);
    // A torque that is cut off is cut off at the motor and along the link as well.
    if shares.torque > tolerance {
        (shares.motor_torque, shares.bending_moment) = (None, None);
    }
    shares.torque = 0.0;
    let (quantity, share) = shares.worst();
    (share > tolerance).then_some(Warning::InexactWindow { quantity, share, tolerance })
}

fn coarse_step(solution: &Solution) -> Option<Warning> {
    let steps = solution.accuracy.of_kind(|errors| errors.step.unwrap_or(0.0));
    let (quantity, share) = steps.worst();
    (share > COARSE).then_some(Warning::CoarseStep { quantity, share })
}

fn large_deflection(solution: &Solution) -> Option<Warning> {
    let peak_m = largest(&solution.tip_deflection_m());
    let share = peak_m / solution.mesh().length_m();
    (share > Link::LARGE_DEFLECTION).then_some(Warning::LargeDeflection { share })
}

/// Zeros of torque → tip on the real axis, where the motion holds more than the tolerance.
fn blocked_tip(mesh: &Mesh, spectrum: &TipSpectrum, tolerance: f64) -> Vec<Warning> {
    let (magnitudes, peak) = (&spectrum.magnitudes_m_s2, spectrum.largest_m_s2);
    let bins = magnitudes.iter().rposition(|a| *a > tolerance * peak).unwrap_or(0);
    let spacing = spectrum.omegas_rad_s[1];
    let zeros = real_frequency_zeros(mesh, spectrum.omegas_rad_s[bins]);
    let blocked = zeros.into_iter().filter_map(|omega| {
        // Damping shifts the zero off the axis, not along it; the nearest bins tell the content.
        let below = ((omega / spacing) as usize).min(magnitudes.len() - 2);
        let share = largest(&magnitudes[below..below + 2]) / peak;
        let frequency_hz = omega / TAU;
        (share > tolerance).then_some(Warning::BlockedTip { frequency_hz, share })
    });
    blocked.collect()
}

fn near_nyquist(spectrum: &TipSpectrum) -> Option<Warning> {
    if !spectrum.cutoff.keeps_all() {
        return None;
    }
    let magnitudes = &spectrum.magnitudes_m_s2;
    let from = magnitudes.len() * 4 / 5;
    let share = largest(&magnitudes[from..]) / spectrum.largest_m_s2;
    let nyquist_hz = spectrum.omegas_rad_s[magnitudes.len() - 1] / TAU;
    (share > NYQUIST_SHARE).then_some(Warning::NearNyquist { share, nyquist_hz })
}

fn above_mesh(mesh: &Mesh, spectrum: &TipSpectrum, torque: &[Complex64]) -> Option<Warning> {
    let resolved = mesh.resolved_frequency_rad_s();
    let power = |torque: &[Complex64]| torque.iter().map(Complex64::norm_sqr).sum::<f64>();
    let omegas = &spectrum.omegas_rad_s[..torque.len()];
    let above = omegas.iter().position(|omega| *omega > resolved)?;
    let share = (power(&torque[above..]) / power(torque)).sqrt();
    let resolved_hz = resolved / TAU;
    (share > ABOVE_MESH_SHARE).then_some(Warning::AboveMesh { share, resolved_hz })
}
