//! From what a run measured to what its user must know.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::accuracy::Quantity;
use super::analysis::Analysis;
use super::model_end::{FastHub, fast_hub, thick_link};
use super::solution::Solution;
use super::warning::Warning;
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::real_frequency_zeros;
use crate::motion::{TipMotion, TipSpectrum};
use crate::numeric::{FourierPair, fast_length, largest, magnitude};

/// Amplitude near the Nyquist frequency, over the largest, from which on the user is warned.
const NYQUIST_SHARE: f64 = 1e-3;

/// Share of the torque above the mesh's frequency from which on the user is warned.
const ABOVE_MESH_SHARE: f64 = 1e-2;

/// Error of mesh or modes, and change by half the step, from which on the user is warned.
const COARSE: f64 = 1e-2;

/// A lengthened window of more rows, and of more times the motion's own samples, is warned of.
const LONG_ROWS: usize = 50_000;
const LONG_TIMES: f64 = 10.0;

/// Change of a peak by twice the tip's tolerance from which on the user is warned.
const UNSETTLED: f64 = 0.03;

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
        .chain(above_mesh(mesh, spectrum, &solution.hub.torque_n_m))
        .chain((error > COARSE).then_some(Warning::CoarseMesh { quantity, error }))
        .chain(few_modes(solution))
        .chain(unsettled_torque(solution))
        .chain(coarse_step(solution))
        .chain(large_deflection(solution))
        .chain(thick_link(link, solution).map(|share| Warning::ThickLink { share }))
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

/// The torque whose peak changes most where the tip's tolerance is larger. What is below the tolerance
/// is at the mercy of rounding, kinks and step; a torque that hangs on it is not told by the tip.
fn unsettled_torque(solution: &Solution) -> Option<Warning> {
    let cutoff = &solution.spectrum.cutoff;
    if cutoff.looser_rad_s >= cutoff.omega_rad_s {
        return None;
    }
    let forcing = solution.forcing();
    let looser = |amplitudes: &[Complex64]| -> Vec<Complex64> {
        let bins = amplitudes.iter().zip(forcing.omegas_rad_s());
        bins.map(|(a, omega)| a * cutoff.weight_of_looser(*omega)).collect()
    };
    let measured = |quantity, amplitudes: &[Complex64]| {
        let pair = FourierPair::new(fast_length(8 * amplitudes.len()));
        let peak_n_m = |amplitudes| largest(&pair.samples(amplitudes));
        (quantity, peak_n_m(amplitudes), peak_n_m(&looser(amplitudes)))
    };
    // No peak changes by more than the sum of what is taken away: mostly that is enough to know.
    let torque = &solution.hub.torque_n_m;
    let bins = torque.iter().zip(forcing.omegas_rad_s());
    let taken = bins.map(|(a, omega)| match cutoff.weight_of_looser(*omega) {
        1.0 => 0.0,
        kept => 2.0 * (1.0 - kept) * magnitude(*a),
    });
    let may_change = taken.sum::<f64>() > UNSETTLED * largest(&solution.torque_n_m);
    let torque = may_change.then(|| measured(Quantity::Torque, torque));
    let motor = forcing.motor_spectra(&solution.hub);
    let motor = motor.map(|motor| measured(Quantity::MotorTorque, &motor.torque_n_m));
    let change =
        |(_, peak_n_m, looser_n_m): &(Quantity, f64, f64)| (looser_n_m / peak_n_m - 1.0).abs();
    let (quantity, peak_n_m, looser_n_m) = motor
        .into_iter()
        .chain(torque)
        .max_by(|a, b| change(a).total_cmp(&change(b)))
        .filter(|measured| change(measured) > UNSETTLED)?;
    Some(Warning::UnsettledTorque { quantity, peak_n_m, looser_n_m })
}

fn few_modes(solution: &Solution) -> Option<Warning> {
    let modes = solution.accuracy.of_kind(|errors| errors.modes.unwrap_or(0.0));
    let (quantity, error) = modes.worst();
    (error > COARSE).then_some(Warning::FewModes { quantity, error })
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
