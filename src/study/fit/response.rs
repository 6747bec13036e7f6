//! A measured frequency response: its distance from a link's, its zeros, and both over each other.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use nalgebra::{SMatrix, SVector, Vector3};
use num_complex::Complex64;
use serde::Serialize;
use thiserror::Error;

use super::instruments::{Gain, MOST_UNCERTAIN, Motor};
use super::measurement::{Measured, Observable};
use crate::model::{Model, Sensor};
use crate::numeric::magnitude;
use crate::text::significant;

/// Fewest frequencies of a response.
const FEWEST: usize = 2;

/// Sizes of values whose squares neither overflow nor underflow.
const SIZES: RangeInclusive<f64> = 1e-150..=1e150;

/// Reason why values are no frequency response.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum ResponseError {
    /// There are too few rows.
    #[error("frequencies = {0}, but must be {FEWEST} or more")]
    Few(usize),
    /// Columns differ in length.
    #[error("frequencies and values must be as many")]
    Uneven,
    /// A frequency or a value has no logarithm, or its square overflows or underflows.
    #[error(
        "sample {} = {} Hz, a value of size {}, but must be a frequency above 0 and a size from 1e-150 to 1e150",
        number + 1,
        significant(*hertz, 4),
        significant(*size, 4)
    )]
    Sample {
        /// Number of the sample, from 0.
        number: usize,
        /// The frequency.
        hertz: f64,
        /// Magnitude of the value.
        size: f64,
    },
    /// The uncertainty is not above 0, or is too large for a measurement.
    #[error("uncertainty = {0}, but must be above 0 and below {MOST_UNCERTAIN}: 0.05 is 5 %")]
    Uncertainty(f64),
}

/// Measured frequency response of the link on its free hub.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    name: String,
    sensor: Sensor,
    gain: Gain,
    /// The motor of values per volt; `None` for values per torque.
    pub(super) motor: Option<Motor>,
    slides: bool,
    uncertainty: Option<f64>,
    frequencies_hz: Vec<f64>,
    values: Vec<Complex64>,
}

impl Response {
    /// Makes a response; messages call it `name`. `uncertainty` is that of its real and of its imaginary part, over its
    /// magnitude.
    ///
    /// # Errors
    /// [`ResponseError`]: fewer than two frequencies, a number that is not finite, a value of 0.
    pub fn new(
        name: String,
        (sensor, gain): (Sensor, Gain),
        uncertainty: Option<f64>,
        (frequencies_hz, values): (Vec<f64>, Vec<Complex64>),
    ) -> Result<Self, ResponseError> {
        if frequencies_hz.len() < FEWEST {
            return Err(ResponseError::Few(frequencies_hz.len()));
        }
        if frequencies_hz.len() != values.len() {
            return Err(ResponseError::Uneven);
        }
        let sizes = frequencies_hz.iter().zip(values.iter().map(|value| magnitude(*value)));
        let is_wrong = |(_, (hertz, size)): &(usize, (&f64, f64))| {
            !(hertz.is_finite() && **hertz > 0.0 && SIZES.contains(size))
        };
        if let Some((number, (&hertz, size))) = sizes.enumerate().find(is_wrong) {
            return Err(ResponseError::Sample { number, hertz, size });
        }
        if let Some(wrong) = uncertainty.filter(|u| !(*u > 0.0 && *u < MOST_UNCERTAIN)) {
            return Err(ResponseError::Uncertainty(wrong));
        }
        Ok(Self {
            name,
            sensor,
            gain,
            motor: None,
            slides: false,
            uncertainty,
            frequencies_hz,
            values,
        })
    }

    /// Makes the values relative to volts at a motor, instead of torque.
    #[must_use]
    pub fn per_volt(mut self, motor: &Motor) -> Self {
        let torque_n_m_v = motor.torque_per_volt_n_m_v();
        self.values.iter_mut().for_each(|value| *value /= torque_n_m_v);
        Self { motor: Some(*motor), ..self }
    }

    /// Makes the values relative to the force on a carriage, if the link `slides`.
    #[must_use]
    pub fn on_carriage(self, slides: bool) -> Self {
        Self { slides, ..self }
    }

    /// Name in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The sensor.
    pub(super) fn sensor(&self) -> Sensor {
        self.sensor
    }

    /// Frequency in Hz and value of each sample, in the order of the file.
    pub(super) fn samples(&self) -> impl Iterator<Item = (f64, Complex64)> {
        self.frequencies_hz.iter().copied().zip(self.values.iter().copied())
    }

    /// Relative uncertainty of each value, if known.
    pub fn uncertainty(&self) -> Option<f64> {
        self.uncertainty
    }

    /// The highest frequency in rad/s.
    pub(super) fn highest_rad_s(&self) -> f64 {
        TAU * self.frequencies_hz.iter().copied().fold(0.0, f64::max)
    }

    /// Number of residuals: two a frequency.
    pub(super) fn rows(&self) -> usize {
        2 * self.values.len()
    }

    /// Number of additional free values: the gain.
    pub(super) fn own_free_values(&self) -> usize {
        usize::from(self.gain == Gain::Free)
    }

    /// Ratio of this response to that of a model.
    pub(super) fn fitted(&self, model: &dyn Model) -> ResponseFit {
        let omegas: Vec<f64> = self.frequencies_hz.iter().map(|hertz| hertz * TAU).collect();
        let computed = self.sensor.per_torque(model, &omegas);
        let ratios: Vec<Complex64> =
            computed.iter().zip(&self.values).map(|(computed, value)| computed / value).collect();
        // The sign that makes most phases small.
        let is_turned = self.gain != Gain::Known
            && ratios.iter().map(|ratio| ratio.re / magnitude(*ratio)).sum::<f64>() < 0.0;
        let sign = if is_turned { -1.0 } else { 1.0 };
        let parts = |ratio: &Complex64| {
            [libm::log(magnitude(*ratio)), libm::atan2(sign * ratio.im, sign * ratio.re)]
        };
        let mut misfits: Vec<f64> = ratios.iter().flat_map(parts).collect();
        let mut gain = sign;
        if self.gain == Gain::Free {
            let mean = misfits.iter().step_by(2).sum::<f64>() / self.values.len() as f64;
            misfits.iter_mut().step_by(2).for_each(|misfit| *misfit -= mean);
            gain *= libm::exp(-mean);
        }
        ResponseFit { misfits, gain }
    }
}

/// Ratio of a response to that of a link.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ResponseFit {
    /// Real and imaginary part of `ln(computed/measured)` at each frequency, without the gain.
    pub(super) misfits: Vec<f64>,
    /// Factor on the link's response.
    gain: f64,
}

impl Response {
    /// Gain and phase over ascending frequencies, of the values and of a link with these misfits; with a free gain in
    /// the scale of the values.
    pub(super) fn overlays(&self, misfits: &[f64]) -> [Overlay; 2] {
        let mut order: Vec<usize> = (0..self.values.len()).collect();
        order.sort_by(|a, b| self.frequencies_hz[*a].total_cmp(&self.frequencies_hz[*b]));
        let of = |number: &dyn Fn(usize) -> f64| order.iter().map(|k| number(*k)).collect();
        let places: Vec<f64> = of(&|k| self.frequencies_hz[k]);
        let measured: Vec<f64> = of(&|k| magnitude(self.values[k]));
        let gain: Vec<f64> = of(&|k| magnitude(self.values[k]) * libm::exp(misfits[2 * k]));
        // The fitted phase is smooth; the measured one follows it despite its noise.
        let phase = of(&|k| {
            let value = self.values[k];
            (libm::atan2(value.im, value.re) + misfits[2 * k + 1]).to_degrees()
        });
        let phase = unwrapped(phase);
        let ahead: Vec<f64> = of(&|k| misfits[2 * k + 1].to_degrees());
        let measured_phase = phase.iter().zip(&ahead).map(|(fitted, ahead)| fitted - ahead);
        let quantity = self.sensor.quantity();
        let known = self.sensor.unit_per_effort(self.slides);
        let unit = if self.gain == Gain::Free { "" } else { known };
        let effort = if self.slides { "force" } else { "torque" };
        let from_volts = self.motor.map_or("", |_| ", from volts");
        let overlay = |y: Coordinate, measured, fitted| Overlay {
            name: format!("{}: {quantity} per {effort}{from_volts}, {}", self.name, y.name),
            x: Coordinate::logarithmic("frequency", "Hz"),
            y,
            places: places.clone(),
            measured,
            fitted,
        };
        [
            overlay(Coordinate::logarithmic("gain", unit), measured, gain),
            overlay(Coordinate::linear("phase", "°"), measured_phase.collect(), phase),
        ]
    }
}

/// Angles in degrees without jumps of more than half a turn. The first is from −200 to 160: half a turn, as for a hub
/// that follows its torque as a rigid body, counts as a lag.
fn unwrapped(mut angles: Vec<f64>) -> Vec<f64> {
    for k in 1..angles.len() {
        angles[k] -= 360.0 * ((angles[k] - angles[k - 1]) / 360.0).round();
    }
    let first = angles.first().copied().unwrap_or_default();
    let turns = ((first + 200.0) / 360.0).floor();
    angles.iter().map(|angle| angle - 360.0 * turns).collect()
}

/// Distance of a fitted link's response from a measured one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ResponseMisfit {
    /// File of the response.
    pub name: String,
    /// Measured sensor.
    pub transfer: Sensor,
    /// Number of frequencies.
    pub frequencies: usize,
    /// Factor from SI to the values, 1 or −1 for a free sign; `None` if it was known.
    pub gain: Option<f64>,
    /// Root mean square of the relative differences of real and imaginary parts.
    pub rms: f64,
}

impl ResponseMisfit {
    pub(super) fn of(response: &Response, ResponseFit { misfits, gain }: &ResponseFit) -> Self {
        let frequencies = response.values.len();
        let sum: f64 = misfits.iter().map(|misfit| misfit * misfit).sum();
        let rms = (sum / misfits.len() as f64).sqrt();
        let gain = (response.gain != Gain::Known).then_some(*gain);
        Self { name: response.name.clone(), transfer: response.sensor, frequencies, gain, rms }
    }
}

/// Spacing of the numbers on an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Spacing {
    /// Even spacing.
    #[default]
    Linear,
    /// Logarithmic spacing; all numbers are above 0.
    Logarithmic,
}

/// A quantity along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Coordinate {
    /// Name of the quantity: `frequency`.
    pub name: &'static str,
    /// Unit: `Hz`; empty for a number without unit.
    pub unit: &'static str,
    /// Spacing of the numbers.
    pub spacing: Spacing,
}

impl Coordinate {
    /// A quantity with even spacing.
    pub fn linear(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, spacing: Spacing::Linear }
    }

    /// A quantity above 0 with logarithmic spacing.
    pub fn logarithmic(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, spacing: Spacing::Logarithmic }
    }
}

/// One quantity over frequency or time, as measured and of the fitted link.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// File and quantity: `frf.csv: hub angle per torque, gain`.
    pub name: String,
    /// Quantity of the horizontal axis.
    pub x: Coordinate,
    /// The quantity.
    pub y: Coordinate,
    /// Places along x, ascending.
    pub places: Vec<f64>,
    /// The measured value at each place.
    pub measured: Vec<f64>,
    /// The fitted link's value at each place.
    pub fitted: Vec<f64>,
}

/// Smallest ratio of both shoulders of a dip to its bottom: 6 dB.
const DEPTH: f64 = 2.0;

/// Number of samples on each side of a dip's bottom for a zero, if its flanks have no more.
const LEAST_REACH: usize = 3;

/// Largest damping ratio of a zero that appears as a dip.
const MOST_DAMPED: f64 = 0.2;

impl Response {
    /// Zeros from the dips, the lowest with the number `first`. Every closed loop around the hub has the zeros of
    /// torque → hub angle, whatever the controller, but its poles are not the link's. Around a dip a quotient of two
    /// polynomials of order 2 in the frequency is fitted to the samples, with differences relative to each. The zero is
    /// the magnitude of the numerator's root. Its uncertainty follows from that of the samples.
    pub fn zeros(&self, first: usize) -> Vec<Measured> {
        let mut samples: Vec<_> = self.samples().collect();
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Deeper than five uncertainties up and down can make a plateau; 12 dB always suffice.
        let reach = (5.0 * self.uncertainty().unwrap_or(0.0)).min(0.6);
        let depth = DEPTH.max((1.0 + reach) / (1.0 - reach));
        let bottoms = 1..samples.len().saturating_sub(1);
        let bottoms = bottoms.filter_map(|k| Dip::at(&samples, k, depth));
        let roots = bottoms.filter_map(|dip| dip.root(self.uncertainty()));
        let zero = |(k, (value, uncertainty))| Measured {
            observable: Observable::Zero { zero: first + k },
            value,
            uncertainty,
        };
        roots.enumerate().map(zero).collect()
    }
}

/// The samples around a minimum of the gain: frequency in Hz, value.
struct Dip<'a> {
    bottom_hz: f64,
    around: &'a [(f64, Complex64)],
}

impl<'a> Dip<'a> {
    /// The dip with its bottom at this sample, if it has this depth.
    fn at(samples: &'a [(f64, Complex64)], bottom: usize, depth: f64) -> Option<Self> {
        let gain = |k: usize| magnitude(samples[k].1);
        let least = gain(bottom);
        // Of equal bottoms the last one counts.
        let left = (0..bottom).rev().map(gain).take_while(|gain| *gain >= least);
        let right = (bottom + 1..samples.len()).map(gain).take_while(|gain| *gain > least);
        let shoulder = left.fold(least, f64::max).min(right.fold(least, f64::max));
        if shoulder < depth * least {
            return None;
        }
        // Farther up the flanks the poles beside the dip distort the response.
        let most = (least * shoulder).sqrt();
        let near = |k: &usize| gain(*k) <= most;
        let left = (0..bottom).rev().take_while(near).count().max(LEAST_REACH);
        let right = (bottom + 1..samples.len()).take_while(near).count().max(LEAST_REACH);
        let last = (bottom + right).min(samples.len() - 1);
        let around = &samples[bottom.saturating_sub(left)..=last];
        Some(Self { bottom_hz: samples[bottom].0, around })
    }

    /// Frequency of the zero in Hz and its uncertainty; `None` if the phase does not rise as at a zero of a link.
    fn root(&self, uncertainty: Option<f64>) -> Option<(f64, Option<f64>)> {
        let (lowest, highest) = (self.around.first()?.0, self.around.last()?.0);
        let width = highest - lowest;
        // Numerator minus value times denominator, over the value: `(c + bx + ax²)/G − dx − ex² = 1`.
        let powers = |x: Complex64| Vector3::new(Complex64::from(1.0), x, x * x);
        let row = |(hertz, value): &(f64, Complex64)| {
            let x = Complex64::from((hertz - self.bottom_hz) / width);
            let [zeroth, first, second] = powers(x).map(|power| power / value).into();
            SVector::from([zeroth, first, second, -x, -x * x])
        };
        let mut normal = SMatrix::<Complex64, 5, 5>::zeros();
        let mut right = SVector::<Complex64, 5>::zeros();
        for row in self.around.iter().map(row) {
            normal += row.conjugate() * row.transpose();
            right += row.conjugate();
        }
        let inverse = normal.try_inverse()?;
        let [c, b, a, ..] = (inverse * right).data.0[0];
        let inverse = inverse.fixed_view::<3, 3>(0, 0);
        // The smaller root, in a form without cancellation.
        let root_of = (b * b - 4.0 * a * c).sqrt();
        let signed = if (b.conj() * root_of).re < 0.0 { -root_of } else { root_of };
        let x = -2.0 * c / (b + signed);
        let zero = Complex64::from(self.bottom_hz) + x * width;
        let slope = magnitude(b + 2.0 * a * x) / width;
        // Variance of the numerator at the zero, `φᵀ C φ̄` with the covariance C of its coefficients.
        let at_zero = powers(x).conjugate();
        let spread = at_zero.dotc(&(inverse * at_zero)).re.sqrt() / slope;
        let uncertainty_hz = uncertainty.map(|own| own * spread);
        let is_inside = zero.re > lowest && zero.re < highest;
        let least_hz = -2.0 * uncertainty_hz.unwrap_or(0.01 * width);
        let is_zero = zero.im > least_hz && zero.im < MOST_DAMPED * zero.re;
        (is_inside && is_zero).then(|| (magnitude(zero), uncertainty_hz))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A response in disorder that turns through half a turn and back, with a factor of 40. The link explains it except
    /// for 0.1 in the logarithm and 0.2 rad.
    #[test]
    fn overlays_are_smooth_and_differ_by_the_misfits() {
        let phases: [f64; 5] = [-3.0, 3.1, 2.0, 3.1, -3.0];
        let order = [4, 1, 0, 3, 2];
        let hertz = order.map(|k| 1.0 + f64::from(k));
        let value = |k: i32| {
            let phase = phases[usize::try_from(k).unwrap()];
            Complex64::new(libm::cos(phase), libm::sin(phase)) * 40.0
        };
        let rows = (hertz.to_vec(), order.map(value).to_vec());
        let kind = (Sensor::HubRate, Gain::Free);
        let response = Response::new("frf.csv".to_owned(), kind, None, rows).unwrap();
        let misfits: Vec<f64> = (0..5).flat_map(|_| [0.1, 0.2]).collect();
        let [gain, phase] = response.overlays(&misfits);
        assert_eq!(gain.name, "frf.csv: hub rate per torque, gain");
        assert_eq!((gain.y.unit, phase.y.unit), ("", "°"));
        let motor = Motor::new(0.04, 8.0, 1.0).unwrap();
        let [of_volts, _] = response.clone().per_volt(&motor).overlays(&misfits);
        assert_eq!(of_volts.name, "frf.csv: hub rate per torque, from volts, gain");
        assert_eq!(gain.places, [1.0, 2.0, 3.0, 4.0, 5.0]);
        for k in 0..5 {
            assert!((gain.fitted[k] / gain.measured[k] - libm::exp(0.1)).abs() < 1e-12);
            let ahead = phase.fitted[k] - phase.measured[k];
            assert!((ahead - 0.2_f64.to_degrees()).abs() < 1e-9);
        }
        let steps = phase.measured.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        assert!(steps.fold(0.0, f64::max) < 90.0, "{:?}", phase.measured);
        assert!(phase.measured.iter().all(|angle| angle.abs() < 260.0), "{:?}", phase.measured);
    }
}
