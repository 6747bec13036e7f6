//! What a run measured of itself, and the warnings that follow from it.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::accuracy::{PerQuantity, Quantity, QuantityErrors, ShareOf};
use super::analysis::{Analysis, Unwatched};
use super::curves::size;
use super::histories::Histories;
use super::periodic_answer::PeriodicAnswer;
use super::solution::SecondOrderFindings;
use super::spectra::DrivenModel;
use super::warning::Warning;
use crate::beam::Mesh;
use crate::modal::{
    NOTICEABLE, REPORTED_MODES, Thickness, natural_frequencies, real_frequency_zeros,
};
use crate::model::Model;
use crate::motion::{TipMotion, TipSpectrum};
use crate::numeric::{FourierPair, fast_length, largest, magnitude};

/// Amplitude near the Nyquist frequency, over the largest, from which on the user is warned.
const NYQUIST_SHARE: f64 = 1e-3;

/// Share of the torque above the mesh's frequency from which on the user is warned.
const ABOVE_MESH_SHARE: f64 = 1e-2;

/// Error of mesh or modes, and change by half the step, from which on the user is warned.
pub(super) const COARSE: f64 = 1e-2;

/// A lengthened window of more rows, and of more times the motion's own samples, is warned of.
const LONG_ROWS: usize = 50_000;
const LONG_TIMES: f64 = 10.0;

/// Error by the uncertainty of the samples from which on the user is warned.
pub(super) const UNCERTAIN: f64 = 0.1;

/// What the linear model leaves out, over the tip's travel and over the torque's peak, from which on the user is warned.
const INEXACT_TIP: f64 = 1e-2;
const INEXACT_TORQUE: f64 = 5e-2;

/// Change of the torque by second-order terms that were left out from which on the user is warned.
pub(super) const LEFT_OUT: f64 = 1e-4;

/// Change by an iteration, over that by the one before, from which on the user is warned.
pub(super) const SLOW: f64 = 0.7;

/// Change of a peak by twice the tip's tolerance from which on the user is warned.
pub(super) const UNSETTLED: f64 = 0.03;

/// Torque that the window cuts off, and that is left where one period meets the next, over the torque's peak or range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) cut: f64,
    pub(super) seam: f64,
}

/// What a run was given and measured of itself.
pub(super) struct Diagnostics<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) motion: &'a TipMotion,
    pub(super) analysis: &'a Analysis,
    pub(super) answer: &'a PeriodicAnswer,
    pub(super) edge: Edge,
    /// What was counted of the second order.
    pub(super) second_order: Option<SecondOrderFindings>,
    pub(super) histories: &'a Histories,
    /// Distances of the tip over its travel: of the solved one from the wanted one, and of one with all terms.
    pub(super) tip_error: f64,
    pub(super) tip_model_error: Option<f64>,
    pub(super) errors: &'a PerQuantity<QuantityErrors>,
    /// What shear and rotary inertia change of the torque; none of a slender link.
    pub(super) thick: Option<f64>,
}

impl Diagnostics<'_> {
    /// All warnings that there is reason for.
    pub(super) fn warnings(&self) -> Vec<Warning> {
        let Self { model, motion, answer, errors, .. } = *self;
        let (mesh, tolerance) = (model.mesh(), self.analysis.tolerance());
        let spectrum = &answer.period.spectrum;
        let (Edge { cut, seam }, of) = (self.edge, self.shares());
        let corrected = motion.corrected().map(|end| Warning::EndVelocityCorrected {
            velocity_m_s: end.velocity_m_s,
            share: end.share,
        });
        let tip_missed = spectrum.cutoff.shortfall.map(|shortfall| Warning::TipMissed {
            share: self.tip_error,
            tolerance: self.followed(),
            shortfall,
        });
        let period_s = spectrum.period_s();
        let wrap_around = Warning::WrapAround { of, share: seam, tolerance, period_s };
        let torque_cut = Warning::TorqueCut { of, share: cut, tolerance };
        let (rows, given) = (self.histories.grid.len, motion.grid().len);
        let times = rows as f64 / given as f64;
        let is_long = seam > tolerance && rows > LONG_ROWS && times > LONG_TIMES;
        let coarse = |kind: fn(QuantityErrors) -> f64| {
            Some(errors.of_kind(kind).worst()).filter(|(_, error)| *error > COARSE)
        };
        let coarse_mesh = coarse(|errors| errors.mesh)
            .map(|(quantity, error)| Warning::CoarseMesh { of, quantity, error });
        let few_modes = coarse(|errors| errors.modes.unwrap_or(0.0))
            .map(|(quantity, error)| Warning::FewModes { quantity, error });
        let coarse_step = coarse(|errors| errors.step.unwrap_or(0.0))
            .map(|(quantity, share)| Warning::CoarseStep { of, quantity, share });
        corrected
            .into_iter()
            .chain(tip_missed)
            .chain((cut > tolerance.max(seam)).then_some(torque_cut))
            .chain((seam > tolerance).then_some(wrap_around))
            .chain(is_long.then_some(Warning::LongWindow { rows, times }))
            .chain(self.inexact_window())
            .chain(blocked_tip(mesh, spectrum, tolerance))
            .chain(near_nyquist(spectrum).filter(|_| !spectrum.cutoff.is_set_by_input()))
            .chain(above_mesh(mesh, spectrum, &answer.moving_torque_n_m(model.link())))
            .chain(coarse_mesh)
            .chain(few_modes)
            .chain(self.unsettled_torque())
            .chain(self.uncertain_input())
            .chain(coarse_step)
            .chain(self.of_second_order())
            .chain(self.inexact_model())
            .chain(self.thick.and_then(thick_link))
            .collect()
    }

    /// Share of its travel that the tip is followed to: that of the analysis, or what the samples are worth.
    fn followed(&self) -> f64 {
        let travel_m = self.answer.period.histories.largest_travel_m();
        let of_input = self.answer.period.spectrum.cutoff.input;
        let of_input = of_input.map_or(0.0, |input| input.followed_m / travel_m);
        of_input.max(self.analysis.tip_tolerance())
    }

    /// The torque that the samples do not determine.
    fn uncertain_input(&self) -> Option<Warning> {
        let torque = self.errors.torque.input.filter(|share| *share > UNCERTAIN)?;
        Some(Warning::UncertainInput { of: self.shares(), share: torque })
    }

    /// What errors are shares of.
    fn shares(&self) -> ShareOf {
        if self.model.link().has_weight() { ShareOf::Range } else { ShareOf::Peak }
    }

    /// An iteration that hardly converges, and second-order terms that were not counted.
    fn of_second_order(&self) -> impl Iterator<Item = Warning> {
        let slow = self.second_order.and_then(|found| found.iteration.contraction);
        let slow = slow.filter(|factor| *factor > SLOW);
        let slow = slow.map(|contraction| Warning::SlowIteration { contraction });
        let tolerance = self.analysis.tolerance();
        let iteration = self.errors.of_kind(|errors| errors.iteration.unwrap_or(0.0));
        let inexact = Some(iteration.worst()).filter(|(_, error)| *error > tolerance);
        let inexact = inexact.map(|(quantity, share)| Warning::InexactIteration {
            quantity,
            share,
            tolerance,
        });
        let left_out = self.second_order.and_then(|found| found.left_out);
        let left_out = left_out.filter(|share| share.is_none_or(|share| share > LEFT_OUT));
        slow.into_iter()
            .chain(inexact)
            .chain(left_out.map(|share| Warning::SecondOrderLeftOut { share }))
    }

    fn driven(&self) -> DrivenModel<'_> {
        DrivenModel { model: self.model, period: &self.answer.period, watch: &Unwatched }
    }

    /// The worst of the quantities beside the torque, which has warnings of its own.
    fn inexact_window(&self) -> Option<Warning> {
        let tolerance = self.analysis.tolerance();
        let mut shares = self.errors.of_kind(|errors| errors.window);
        // A torque that is cut off is cut off at the motor and along the link as well.
        if shares.torque > tolerance {
            (shares.motor_torque, shares.bending_moment) = (None, None);
        }
        shares.torque = 0.0;
        let (quantity, share) = shares.worst();
        (share > tolerance).then_some(Warning::InexactWindow {
            of: self.shares(),
            quantity,
            share,
            tolerance,
        })
    }

    /// The torque whose peak changes most where the tip's tolerance is larger. Rounding, kinks and step
    /// determine what is below the tolerance; a torque that depends on it is not determined by the tip.
    fn unsettled_torque(&self) -> Option<Warning> {
        let cutoff = &self.answer.period.spectrum.cutoff;
        // What the digits leave open is measured as the error of the input.
        if cutoff.is_set_by_input() || cutoff.looser_rad_s >= cutoff.omega_rad_s {
            return None;
        }
        let driven = self.driven();
        // What of the motion is taken away; of a bent link its weight stays, and what its second order adds.
        let linear = match self.second_order {
            None => None,
            Some(_) => Some(driven.hub_spectra().ok()?),
        };
        let looser = |amplitudes: &[Complex64], linear: &[Complex64]| -> Vec<Complex64> {
            let mut looser = amplitudes.to_vec();
            let bins = looser.iter_mut().zip(linear).zip(driven.omegas_rad_s());
            for ((own, linear), omega) in bins {
                *own -= linear * (1.0 - cutoff.weight_of_looser(*omega));
            }
            looser
        };
        let has_weight = self.model.link().has_weight();
        let measured = |quantity, amplitudes: &[Complex64], linear: Option<&[Complex64]>| {
            let pair = FourierPair::new(fast_length(8 * amplitudes.len()));
            let samples = pair.samples(amplitudes);
            let looser = looser(amplitudes, linear.unwrap_or(amplitudes));
            (
                quantity,
                largest(&samples),
                largest(&pair.samples(looser)),
                size(&samples, has_weight),
            )
        };
        // No peak changes by more than the sum of what is taken away: mostly that sum is small enough.
        let torque = &self.answer.hub.torque_n_m;
        let bins = torque.iter().zip(driven.omegas_rad_s());
        let taken = bins.map(|(a, omega)| match cutoff.weight_of_looser(*omega) {
            1.0 => 0.0,
            kept => 2.0 * (1.0 - kept) * magnitude(*a),
        });
        let may_change =
            taken.sum::<f64>() > UNSETTLED * size(&self.histories.torque_n_m, has_weight);
        let of_linear = linear.as_ref().map(|hub| &hub.torque_n_m[..]);
        let torque = may_change.then(|| measured(Quantity::Torque, torque, of_linear));
        let motor = driven.motor_spectra(&self.answer.hub);
        let linear = linear.as_ref().and_then(|hub| driven.motor_spectra(hub));
        let of_linear = linear.as_ref().map(|motor| &motor.torque_n_m[..]);
        let motor =
            motor.map(|motor| measured(Quantity::MotorTorque, &motor.torque_n_m, of_linear));
        let change = |(_, peak_n_m, looser_n_m, size_n_m): &(Quantity, f64, f64, f64)| {
            (looser_n_m - peak_n_m).abs() / size_n_m
        };
        let (quantity, peak_n_m, looser_n_m, _) = motor
            .into_iter()
            .chain(torque)
            .max_by(|a, b| change(a).total_cmp(&change(b)))
            .filter(|measured| change(measured) > UNSETTLED)?;
        Some(Warning::UnsettledTorque { quantity, peak_n_m, looser_n_m })
    }

    /// The linear model where it does not hold.
    fn inexact_model(&self) -> Option<Warning> {
        let (tip, errors) = (self.tip_model_error?, self.errors.torque);
        // The thickness has a warning of its own.
        let torque = errors.model? - self.thick.unwrap_or(0.0);
        let counts = tip > INEXACT_TIP || torque > INEXACT_TORQUE;
        counts.then_some(Warning::InexactModel { torque, tip })
    }
}

/// The share by which shear and rotary inertia, which the theory leaves out, change a torque of these amplitudes, one for
/// each frequency at least; none of a slender link.
pub(super) fn thick_share(
    model: &dyn Model,
    omegas_rad_s: &[f64],
    torque_n_m: &[Complex64],
) -> Option<f64> {
    let (thickness, mesh) = (Thickness::known(model.link()), model.mesh());
    if thickness.is_slender(mesh, REPORTED_MODES) {
        return None;
    }
    let modes = natural_frequencies(mesh, REPORTED_MODES);
    let torque = (omegas_rad_s, &torque_n_m[..omegas_rad_s.len()]);
    Some(thickness.torque_change(mesh, model.law(), &modes, torque))
}

/// A warning of a thickness that is noticeable.
pub(super) fn thick_link(share: f64) -> Option<Warning> {
    (share > NOTICEABLE).then_some(Warning::ThickLink { share })
}

/// Zeros of torque → tip on the real axis, where the motion holds more than the tolerance.
pub(super) fn blocked_tip(mesh: &Mesh, spectrum: &TipSpectrum, tolerance: f64) -> Vec<Warning> {
    let (magnitudes, peak) = (&spectrum.magnitudes_m_s2, spectrum.largest_m_s2);
    let bins = magnitudes.iter().rposition(|a| *a > tolerance * peak).unwrap_or(0);
    let spacing = spectrum.omegas_rad_s[1];
    let zeros = real_frequency_zeros(mesh, spectrum.omegas_rad_s[bins]);
    let blocked = zeros.into_iter().filter_map(|omega| {
        // Damping shifts the zero off the axis, not along it; the nearest bins hold the content there.
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
