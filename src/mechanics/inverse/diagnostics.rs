//! Measurements of a run, and the warnings that follow from them.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::accuracy::{PerQuantity, Quantity, QuantityErrors, ShareOf, size};
use super::analysis::{Analysis, Unwatched};
use super::histories::Histories;
use super::periodic_answer::PeriodicAnswer;
use super::solution::SecondOrderFindings;
use super::spectra::DrivenModel;
use super::warning::Warning;
use crate::beam::{Mesh, MeshPlan};
use crate::modal::{
    NOTICEABLE, REPORTED_MODES, Thickness, natural_frequencies, reported_blocked, reports_weight,
};
use crate::model::Model;
use crate::motion::{TipMotion, TipSpectrum};
use crate::numeric::{FourierPair, fast_length, largest, magnitude};

/// Warning threshold of the amplitude near the Nyquist frequency, over the largest.
const NYQUIST_SHARE: f64 = 1e-3;

/// Warning threshold of the torque's share above the mesh's frequency.
const ABOVE_MESH_SHARE: f64 = 1e-2;

/// Warning threshold of errors of mesh or modes, and of the change by half the step.
pub(super) const COARSE: f64 = 1e-2;

/// Warning thresholds of a lengthened window: its rows, and its rows over the motion's samples.
const LONG_ROWS: usize = 50_000;
const LONG_TIMES: f64 = 10.0;

/// Warning threshold of the error from uncertain samples.
pub(super) const UNCERTAIN: f64 = 0.1;

/// Warning thresholds of the linear model's errors, over the tip's travel and over the torque's peak.
const INEXACT_TIP: f64 = 1e-2;
const INEXACT_TORQUE: f64 = 5e-2;

/// Warning threshold of the torque's change by omitted second-order terms.
pub(super) const LEFT_OUT: f64 = 1e-4;

/// Warning threshold of the change by an iteration, over the change by the one before.
pub(super) const SLOW: f64 = 0.7;

/// Warning threshold of a peak's change by twice the tip's tolerance.
pub(super) const UNSETTLED: f64 = 0.03;

/// Torque outside the window, and torque where one period meets the next, over the torque's peak or range.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) cut: f64,
    pub(super) seam: f64,
}

/// Input and measurements of a run.
pub(super) struct Diagnostics<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) motion: &'a TipMotion,
    pub(super) analysis: &'a Analysis,
    pub(super) answer: &'a PeriodicAnswer,
    pub(super) edge: Edge,
    /// Second-order terms of the answer.
    pub(super) second_order: Option<SecondOrderFindings>,
    pub(super) histories: &'a Histories,
    /// Distances from the wanted tip over its travel: of the solved tip, and of a tip with all terms.
    pub(super) tip_error: f64,
    pub(super) tip_model_error: Option<f64>,
    pub(super) errors: &'a PerQuantity<QuantityErrors>,
    /// Relative change of the torque by shear and rotary inertia. `None` for a slender link.
    pub(super) thick: Option<f64>,
}

impl Diagnostics<'_> {
    /// All justified warnings.
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
        let coarse_mesh = errors
            .above(COARSE, |errors| errors.mesh)
            .map(|(quantity, error)| Warning::CoarseMesh { of, quantity, error });
        let few_modes = errors
            .above(COARSE, |errors| errors.modes.unwrap_or(0.0))
            .map(|(quantity, error)| Warning::FewModes { quantity, error });
        let coarse_step = errors
            .above(COARSE, |errors| errors.step.unwrap_or(0.0))
            .map(|(quantity, share)| Warning::CoarseStep { of, quantity, share });
        corrected
            .into_iter()
            .chain(tip_missed)
            .chain((cut > tolerance.max(seam)).then_some(torque_cut))
            .chain((seam > tolerance).then_some(wrap_around))
            .chain(is_long.then_some(Warning::LongWindow { rows, times }))
            .chain(self.inexact_window())
            .chain(blocked_tip(self.model, spectrum, tolerance))
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

    /// Error of the tip over its travel: the tolerance of the analysis, or the accuracy of the samples.
    fn followed(&self) -> f64 {
        let travel_m = self.answer.period.histories.largest_travel_m();
        let of_input = self.answer.period.spectrum.cutoff.input;
        let of_input = of_input.map_or(0.0, |input| input.followed_m / travel_m);
        of_input.max(self.analysis.tip_tolerance())
    }

    /// Warns of a torque that the samples do not determine.
    fn uncertain_input(&self) -> Option<Warning> {
        let torque = self.errors.torque.input.filter(|share| *share > UNCERTAIN)?;
        Some(Warning::UncertainInput { of: self.shares(), share: torque })
    }

    /// Reference of relative errors.
    fn shares(&self) -> ShareOf {
        if self.model.link().has_weight() { ShareOf::Range } else { ShareOf::Peak }
    }

    /// Warns of an iteration that hardly converges, and of omitted second-order terms.
    fn of_second_order(&self) -> impl Iterator<Item = Warning> {
        let slow = self.second_order.and_then(|found| found.iteration.contraction);
        let slow = slow.filter(|factor| *factor > SLOW);
        let slow = slow.map(|contraction| Warning::SlowIteration { contraction });
        let tolerance = self.analysis.tolerance();
        let inexact = self.errors.above(tolerance, |errors| errors.iteration.unwrap_or(0.0));
        let inexact = inexact.map(|(quantity, share)| Warning::InexactIteration {
            of: self.shares(),
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

    /// Warns of the worst quantity beside the torque, which has separate warnings.
    fn inexact_window(&self) -> Option<Warning> {
        let tolerance = self.analysis.tolerance();
        let mut shares = self.errors.of_kind(|errors| errors.window);
        // A window that cuts the torque off also cuts it off at the motor and along the link.
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

    /// Warns of the torque whose peak changes most with a larger tolerance of the tip. Rounding, kinks and step
    /// determine motion below the tolerance; the tip does not determine a torque that depends on it.
    fn unsettled_torque(&self) -> Option<Warning> {
        let cutoff = &self.answer.period.spectrum.cutoff;
        // The error of the input already measures the digits' uncertainty.
        if cutoff.is_set_by_input() || cutoff.looser_rad_s >= cutoff.omega_rad_s {
            return None;
        }
        let driven = self.driven();
        // Only the linear part of the motion loses frequencies; the weight and second-order terms of a bent link stay.
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
        // The sum of the removed amplitudes bounds the change of a peak: mostly that sum is small enough.
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

    /// Warns of a linear model that does not hold.
    fn inexact_model(&self) -> Option<Warning> {
        let (tip, errors) = (self.tip_model_error?, self.errors.torque);
        // The thickness has a separate warning.
        let torque = errors.model? - self.thick.unwrap_or(0.0);
        let counts = tip > INEXACT_TIP || torque > INEXACT_TORQUE;
        counts.then_some(Warning::InexactModel { torque, tip })
    }
}

/// Relative change by shear and rotary inertia, absent from the theory, of a torque with these amplitudes, at least one
/// for each frequency. `None` for a slender link.
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

/// Warns of a noticeable thickness.
pub(super) fn thick_link(share: f64) -> Option<Warning> {
    (share > NOTICEABLE).then_some(Warning::ThickLink { share })
}

/// Frequencies below a limit in rad/s at which no torque moves the output. A link that keeps its direction has its weight
/// there, on a long mesh that of its coarsest mesh.
pub(super) fn blocked_rad_s(model: &dyn Model, limit_rad_s: f64) -> Vec<f64> {
    let (link, mesh) = (model.link(), model.mesh());
    let outward_m_s2 = link.outward_m_s2();
    let is_long = outward_m_s2.is_some() && !reports_weight(mesh, outward_m_s2);
    let coarse = is_long.then(|| Mesh::new(link, &MeshPlan::automatic(link)).ok()).flatten();
    reported_blocked(coarse.as_ref().unwrap_or(mesh), outward_m_s2, limit_rad_s)
}

/// Zeros of torque → output on the real axis, where the motion holds more than the tolerance.
pub(super) fn blocked_tip(
    model: &dyn Model,
    spectrum: &TipSpectrum,
    tolerance: f64,
) -> Vec<Warning> {
    let (magnitudes, peak) = (&spectrum.magnitudes_m_s2, spectrum.largest_m_s2);
    let bins = magnitudes.iter().rposition(|a| *a > tolerance * peak).unwrap_or(0);
    let spacing = spectrum.omegas_rad_s[1];
    let zeros = blocked_rad_s(model, spectrum.omegas_rad_s[bins]);
    let blocked = zeros.into_iter().filter_map(|omega| {
        // Damping shifts the zero off the axis, not along it: the nearest bins hold the content there.
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
