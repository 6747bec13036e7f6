//! The answer over one period, and its errors from the period's finite length.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::period::PeriodicTorque;
use super::spectra::{DrivenModel, HubSpectra, MotorSpectra};
use crate::link::Link;
use crate::model::ModelError;
use crate::motion::{TailTerms, TipPeriod};
use crate::numeric::largest;

/// The answer over one period.
pub(super) struct PeriodicAnswer {
    pub(super) period: Arc<TipPeriod>,
    pub(super) hub: HubSpectra,
    pub(super) torque_n_m: Vec<f64>,
    /// Torque of the motor in N m, where there is a drive.
    pub(super) motor_n_m: Option<Vec<f64>>,
    /// Hub angle less that of the rigid link in rad and its derivatives, including the images of its slow tail; each
    /// computed on first use.
    excess: [OnceLock<Vec<f64>>; 3],
}

impl PeriodicAnswer {
    /// Solves for the answer.
    ///
    /// # Errors
    /// As [`DrivenModel::hub_spectra`].
    pub(super) fn of(driven: DrivenModel<'_>, period: Arc<TipPeriod>) -> Result<Self, ModelError> {
        driven.begin(1, 0);
        let hub = driven.hub_spectra()?;
        let motor = driven.motor_spectra(&hub);
        Ok(Self::new(hub, motor.as_ref(), period))
    }

    /// The answer from amplitudes of hub and motor.
    pub(super) fn new(
        hub: HubSpectra,
        motor: Option<&MotorSpectra>,
        period: Arc<TipPeriod>,
    ) -> Self {
        let pair = &period.spectrum.pair;
        let torque_n_m = pair.samples(&hub.torque_n_m);
        let motor_n_m = motor.map(|motor| pair.samples(&motor.torque_n_m));
        Self { period, hub, torque_n_m, motor_n_m, excess: [(); 3].map(|()| OnceLock::new()) }
    }

    /// Amplitudes of the torque, without the mean that holds a weight.
    pub(super) fn moving_torque_n_m(&self, link: &Link) -> Cow<'_, [Complex64]> {
        let mut amplitudes = Cow::Borrowed(&self.hub.torque_n_m[..]);
        if link.has_weight() {
            amplitudes.to_mut()[0] = Complex64::ZERO;
        }
        amplitudes
    }

    /// Samples of the `order`-th derivative of the hub angle less that of the rigid link, in rad/sⁿ.
    ///
    /// # Panics
    /// Beyond the second derivative.
    pub(super) fn excess(&self, order: usize) -> &[f64] {
        self.excess[order].get_or_init(|| self.derivative(&self.hub.excess_angle_rad, order))
    }

    /// Samples of the period, as a period that begins in the middle of the rest.
    pub(super) fn periodic<'a>(&self, samples: &'a [f64]) -> PeriodicTorque<'a> {
        let spectrum = &self.period.spectrum;
        PeriodicTorque { samples, before: spectrum.seam, reach: spectrum.seam_reach() }
    }

    /// Remainder of samples where the period meets the next, over their peak.
    pub(super) fn left_of(&self, samples: &[f64]) -> f64 {
        let periodic = self.periodic(samples);
        periodic.at_seam().max(self.ringing(samples)) / periodic.peak()
    }

    /// Remainder of each quantity where one period meets the next, over its peak: its error from the finite period.
    /// `tail` is the slow tail of the hub angle, where damping causes one.
    pub(super) fn left_at_seam(
        &self,
        link: &Link,
        tail: Option<&TailTerms>,
        peaks: &PerQuantity<f64>,
    ) -> PerQuantity<f64> {
        let rigid_tip = link.rigid_tip();
        let hub = self.hub_left(tail, rigid_tip);
        let [hub_rad, hub_rad_s] = [0, 1].map(&hub);
        let moment = || self.left_of(&self.period.spectrum.pair.samples(&self.hub.root_moment_n_m));
        let motor_rate = link.drive().map(|drive| {
            let torque_rate = self.derivative(&self.hub.torque_n_m, 1);
            let torque_rate =
                self.farthest_at_seam(&torque_rate, &[]).max(self.ringing(&torque_rate));
            drive.gear_ratio * (hub_rad_s + torque_rate / drive.joint_stiffness_n_m_rad)
        });
        let over = |left: f64, peak: f64| if left == 0.0 { 0.0 } else { left / peak };
        PerQuantity {
            torque: self.left_of(&self.torque_n_m),
            hub_angle: hub_rad / peaks.hub_angle,
            hub_rate: hub_rad_s / peaks.hub_rate,
            hub_acceleration: peaks.hub_acceleration.map(|peak| over(hub(2), peak)),
            // The tip stays at its wanted place, and the hub on its axis: the error of a node between them is at most
            // that of a rigid link turned like the hub.
            displacement: peaks.displacement.map(|peak| over(hub_rad * rigid_tip, peak)),
            bending_moment: peaks.bending_moment.map(|_| moment()),
            motor_torque: self.motor_n_m.as_deref().map(|samples| self.left_of(samples)),
            motor_rate: motor_rate.zip(peaks.motor_rate).map(|(left, peak)| over(left, peak)),
        }
    }

    /// Remainder of the n-th derivative of the hub angle at the seam beyond the slow tail, in rad/sⁿ, as a function of
    /// n from 0 to 2.
    fn hub_left(&self, tail: Option<&TailTerms>, rigid_tip: f64) -> impl Fn(usize) -> f64 {
        let (places, spacing_s) = self.period.spectrum.around_seam();
        let excess_rad: Vec<f64> = places.iter().map(|(k, _)| self.excess(0)[*k]).collect();
        let left_rad = match tail {
            Some(tail) => self.period.images().residuals_at_seam(self.excess(0), tail),
            None => excess_rad.clone(),
        };
        // The tail is smooth: its derivatives are differences over many samples.
        let tail_rad: Vec<f64> = excess_rad.iter().zip(&left_rad).map(|(e, l)| e - l).collect();
        let angle_rad = self.rings().then(|| self.hub_angle_amplitudes_rad(rigid_tip));
        move |order| {
            let difference = |three: &[f64]| match order {
                1 => 0.5 * (three[2] - three[0]) / spacing_s,
                _ => (three[2] - 2.0 * three[1] + three[0]) / spacing_s.powi(2),
            };
            let left = if order == 0 {
                largest(&left_rad)
            } else {
                let tail: Vec<f64> = tail_rad.windows(3).map(difference).collect();
                self.farthest_at_seam(self.excess(order), &tail)
            };
            let ringing = |angle: &Vec<Complex64>| self.ringing(&self.derivative(angle, order));
            left.max(angle_rad.as_ref().map_or(0.0, ringing))
        }
    }

    /// Samples of the `order`-th derivative by time of a quantity with `amplitudes`.
    pub(super) fn derivative(&self, amplitudes: &[Complex64], order: usize) -> Vec<f64> {
        let spectrum = &self.period.spectrum;
        spectrum.pair.samples(spectrum.derivative(amplitudes, order))
    }

    /// Largest distance of samples around the seam from a smooth tail at the places there except the first and the
    /// last; without a tail, from zero.
    fn farthest_at_seam(&self, samples: &[f64], tail: &[f64]) -> f64 {
        let (places, _) = self.period.spectrum.around_seam();
        let len = samples.len();
        let stride = (places[1].0 + len - places[0].0) % len;
        let inner = places[1..places.len() - 1].windows(2).enumerate();
        let around = inner.flat_map(|(n, ends)| {
            let [from, to] = [n, n + 1].map(|n| tail.get(n).copied().unwrap_or(0.0));
            let first = ends[0].0;
            (0..=stride).map(move |k| {
                let tail = from + (to - from) * k as f64 / stride as f64;
                (samples[(first + k) % len] - tail).abs()
            })
        });
        around.fold(0.0, f64::max)
    }

    /// Amplitudes of the hub angle in rad, 0 at zero frequency.
    fn hub_angle_amplitudes_rad(&self, rigid_tip: f64) -> Vec<Complex64> {
        let spectrum = &self.period.spectrum;
        let tip = spectrum.acceleration_m_s2.iter().zip(&spectrum.omegas_rad_s);
        let bins = self.hub.excess_angle_rad.iter().zip(tip).skip(1);
        let angles = bins.map(|(excess, (a, omega))| excess - a / (omega * omega * rigid_tip));
        std::iter::once(Complex64::ZERO).chain(angles).collect()
    }

    /// True if the solver keeps all frequencies: a spectrum that ends at the Nyquist frequency with a jump or a kink
    /// rings there.
    fn rings(&self) -> bool {
        self.period.spectrum.cutoff.keeps_all()
    }

    /// Approximate sum of the images of a ringing quantity, which alternates from sample to sample; 0 without ringing.
    /// Differences over many samples miss it.
    ///
    /// At the seam the images of a kink, c/t², add up. The images of a jump cancel there:
    ///
    /// ```text
    /// Σ_m c/(t + mP) = c π/P cot(πt/P)
    /// ```
    ///
    /// Their slope at the seam is −c π²/P². Without the term m = 0, the sum is 2c/P at most.
    fn ringing(&self, samples: &[f64]) -> f64 {
        if !self.rings() {
            return 0.0;
        }
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
        largest(&alternating) + 2.0 / (PI * PI) * slope * len as f64
    }
}
