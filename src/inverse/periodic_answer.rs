//! The answer over one period, and what the period's finite length costs it.

use std::f64::consts::PI;
use std::sync::Arc;

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::error::InversionError;
use super::period::PeriodicTorque;
use super::spectra::{Forcing, HubSpectra, Joint};
use crate::motion::{TailTerms, TipPeriod};
use crate::numeric::largest;

/// The answer over one period.
pub(super) struct PeriodicAnswer {
    pub(super) period: Arc<TipPeriod>,
    pub(super) hub: HubSpectra,
    pub(super) torque_n_m: Vec<f64>,
    /// Torque of the motor in N m, where there is a drive.
    pub(super) motor_n_m: Option<Vec<f64>>,
    /// Hub angle less that of the rigid link in rad, the images of its slow tail still in it.
    pub(super) excess_rad: Vec<f64>,
}

/// What the cost of a period depends on besides the answer.
pub(super) struct Costed<'a> {
    pub(super) joint: Joint,
    pub(super) length_m: f64,
    /// Whether bending moments are wanted.
    pub(super) moments: bool,
    /// Slow tail of the hub angle, where damping leaves one.
    pub(super) tail: Option<&'a TailTerms>,
    /// Peak of each quantity.
    pub(super) peaks: &'a PerQuantity<f64>,
}

impl PeriodicAnswer {
    /// Solves for it.
    ///
    /// # Errors
    /// As [`Forcing::hub_spectra`].
    pub(super) fn of(forcing: Forcing<'_>, period: Arc<TipPeriod>) -> Result<Self, InversionError> {
        forcing.begin(1, 0);
        let hub = forcing.hub_spectra()?;
        let motor = forcing.motor_spectra(&hub);
        Ok(Self::new(hub, motor.map(|motor| motor.torque_n_m).as_deref(), period))
    }

    /// From amplitudes of the hub, and of the motor's torque in N m.
    pub(super) fn new(
        hub: HubSpectra,
        motor_torque_n_m: Option<&[Complex64]>,
        period: Arc<TipPeriod>,
    ) -> Self {
        let pair = &period.spectrum.pair;
        let torque_n_m = pair.samples(&hub.torque_n_m);
        let excess_rad = pair.samples(&hub.excess_angle_rad);
        let motor_n_m = motor_torque_n_m.map(|torque| pair.samples(torque));
        Self { period, hub, torque_n_m, motor_n_m, excess_rad }
    }

    /// Samples of the period as seen from the middle of the rest.
    pub(super) fn periodic<'a>(&self, samples: &'a [f64]) -> PeriodicTorque<'a> {
        let spectrum = &self.period.spectrum;
        PeriodicTorque { samples, before: spectrum.seam, reach: spectrum.seam_reach() }
    }

    /// What is left of each quantity where one period meets the next, over its peak: what the finite
    /// period costs it.
    pub(super) fn left_at_seam(&self, costed: &Costed<'_>) -> PerQuantity<f64> {
        let Costed { joint, length_m, moments, tail, peaks } = *costed;
        let keeps_all = self.period.spectrum.cutoff.keeps_all();
        let share = |samples: &[f64]| {
            let periodic = self.periodic(samples);
            let ringing = if keeps_all { self.ringing(samples) } else { 0.0 };
            periodic.at_seam().max(ringing) / periodic.peak()
        };
        let mut hub = self.hub_left(tail);
        let [_, mut torque_rate, _] = self.differences(&self.around_seam(&self.torque_n_m));
        if keeps_all {
            let spectrum = &self.period.spectrum;
            let ringing = |amplitudes: &[Complex64], order: usize| {
                self.ringing(&spectrum.pair.samples(spectrum.derivative(amplitudes, order)))
            };
            let angle_rad = self.hub_angle_amplitudes_rad(length_m);
            for (order, left) in hub.iter_mut().enumerate() {
                *left = left.max(ringing(&angle_rad, order));
            }
            torque_rate = torque_rate.max(ringing(&self.hub.torque_n_m, 1));
        }
        let moment = || share(&self.period.spectrum.pair.samples(&self.hub.root_moment_n_m));
        let motor_rate = joint
            .drive
            .map(|drive| drive.gear_ratio * (hub[1] + torque_rate / drive.joint_stiffness_n_m_rad));
        let over = |left: Option<f64>, peak: Option<f64>| {
            left.zip(peak).map(|(left, peak)| if left == 0.0 { 0.0 } else { left / peak })
        };
        PerQuantity {
            torque: share(&self.torque_n_m),
            hub_angle: hub[0] / peaks.hub_angle,
            hub_rate: hub[1] / peaks.hub_rate,
            hub_acceleration: over(Some(hub[2]), peaks.hub_acceleration),
            // The tip stays where it is wanted, and the hub on its axis: between them no node is off by
            // more than the hub's turn moves a rigid link.
            displacement: over(Some(hub[0] * length_m), peaks.displacement),
            bending_moment: moments.then(moment),
            motor_torque: self.motor_n_m.as_deref().map(share),
            motor_rate: over(motor_rate, peaks.motor_rate),
        }
    }

    /// What is left of hub angle, rate and acceleration at the seam beyond the slow tail, in rad, rad/s
    /// and rad/s².
    fn hub_left(&self, tail: Option<&TailTerms>) -> [f64; 3] {
        let left_rad = match tail {
            Some(tail) => self.period.images().residuals_at_seam(&self.excess_rad, tail),
            None => self.around_seam(&self.excess_rad),
        };
        self.differences(&left_rad)
    }

    /// Amplitudes of the hub angle in rad, that at zero frequency left out.
    fn hub_angle_amplitudes_rad(&self, length_m: f64) -> Vec<Complex64> {
        let spectrum = &self.period.spectrum;
        let tip = spectrum.acceleration_m_s2.iter().zip(&spectrum.omegas_rad_s);
        let bins = self.hub.excess_angle_rad.iter().zip(tip).skip(1);
        let angles = bins.map(|(excess, (a, omega))| excess - a / (omega * omega * length_m));
        std::iter::once(Complex64::ZERO).chain(angles).collect()
    }

    /// What the images of a quantity that alternates from sample to sample add to it, at most. Where all
    /// frequencies are kept, a spectrum ends at the Nyquist frequency with a jump or a kink, and rings so;
    /// differences over many samples do not see it.
    ///
    /// At the seam the images of a kink, c/t², add up. Those of a jump cancel there:
    ///
    /// ```text
    /// Σ_m c/(t + mP) = c π/P cot(πt/P)
    /// ```
    ///
    /// They are told by their slope, −c π²/P²: within the period its own image taken off, they add 2c/P at
    /// most.
    fn ringing(&self, samples: &[f64]) -> f64 {
        let spectrum = &self.period.spectrum;
        let (len, reach) = (samples.len(), spectrum.seam_reach());
        let at = |k: usize| samples[(spectrum.seam + len + k - reach) % len];
        let alternating: Vec<f64> = (1..2 * reach)
            .map(|k| {
                let sign = if k % 2 == 0 { 0.25 } else { -0.25 };
                sign * (2.0 * at(k) - at(k - 1) - at(k + 1))
            })
            .collect();
        let last = alternating.len() - 1;
        let slope = (alternating[last] - alternating[0]).abs() / last as f64;
        largest(&alternating).max(2.0 / (PI * PI) * slope * len as f64)
    }

    fn around_seam(&self, samples: &[f64]) -> Vec<f64> {
        let (places, _) = self.period.spectrum.around_seam();
        places.into_iter().map(|(k, _)| samples[k]).collect()
    }

    /// Largest magnitude of values around the seam and of their first two derivatives by time.
    fn differences(&self, values: &[f64]) -> [f64; 3] {
        let (_, spacing_s) = self.period.spectrum.around_seam();
        let derived = |values: &[f64]| -> Vec<f64> {
            values.windows(2).map(|pair| (pair[1] - pair[0]) / spacing_s).collect()
        };
        let rates = derived(values);
        let accelerations = derived(&rates);
        [values, &rates, &accelerations].map(largest)
    }
}
