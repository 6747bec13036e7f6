use std::f64::consts::TAU;
use std::sync::{Arc, OnceLock};

use num_complex::Complex64;

use super::accuracy::Accuracy;
use super::spectra::{Forcing, HubSpectra};
use super::warning::Warning;
use super::watch::Unwatched;
use crate::beam::Mesh;
use crate::modal::{DampingLaw, natural_frequencies, torque_zeros};
use crate::model::Model;
use crate::motion::{TailTerms, TipMotionHistories, TipPeriod, TipSpectrum, tail_sum};
use crate::numeric::TimeGrid;

/// Frequencies that were solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Period P in s.
    pub period_s: f64,
    /// Samples of the period: the length of the Fourier transform.
    pub fft_length: usize,
    /// Frequencies solved for, zero included.
    pub frequencies: usize,
    /// The highest of them in Hz.
    pub highest_hz: f64,
    /// Frequency in Hz up to which the motion is followed as it is, and from which it rolls off; none
    /// where every frequency of the samples is solved for.
    pub cutoff_hz: Option<f64>,
    /// Nyquist frequency in Hz.
    pub nyquist_hz: f64,
}

impl Band {
    pub(super) fn of(spectrum: &TipSpectrum) -> Self {
        let frequencies = spectrum.band_len();
        let hertz = |k: usize| spectrum.omegas_rad_s[k] / TAU;
        Self {
            period_s: spectrum.period_s(),
            fft_length: spectrum.pair.len(),
            frequencies,
            highest_hz: hertz(frequencies - 1),
            cutoff_hz: (!spectrum.cutoff.keeps_all()).then(|| spectrum.cutoff.omega_rad_s / TAU),
            nyquist_hz: hertz(spectrum.pair.len() / 2),
        }
    }
}

/// The answer: what the hub must do so that the tip moves as wanted.
///
/// All histories stand on [`Solution::grid`], the trajectory's samples with lead and lag added
/// where its own rest is too short.
#[derive(Clone)]
pub struct Solution {
    /// Times of all histories.
    pub grid: TimeGrid,
    /// Torque T at the hub in N m.
    pub torque_n_m: Vec<f64>,
    /// Torque in N m that the same link would need, were it rigid.
    pub rigid_torque_n_m: Vec<f64>,
    /// Hub angle θ in rad.
    pub hub_angle_rad: Vec<f64>,
    /// Hub rate in rad/s.
    pub hub_rate_rad_s: Vec<f64>,
    /// Hub angle in rad of the rigid link, `v_tip/L`.
    pub rigid_hub_angle_rad: Vec<f64>,
    /// Moment in N m that the hub exerts on the link's root.
    pub root_moment_n_m: Vec<f64>,
    /// Motion of the tip.
    pub tip: TipMotionHistories,
    /// Numbers of the grid's samples between which the tip moves: the last at rest before the
    /// motion and the first at rest after it.
    pub moving: (usize, usize),
    /// The link on the mesh that the answer was computed on.
    pub model: Arc<dyn Model>,
    /// First zero of torque → tip in 1/s; none where the mesh has none.
    pub first_zero_per_s: Option<f64>,
    /// How exact each quantity is.
    pub accuracy: Accuracy,
    /// Frequencies that were solved for.
    pub band: Band,
    /// What the user must know.
    pub warnings: Vec<Warning>,
    /// Amplitudes at the hub over the band.
    pub(super) hub: HubSpectra,
    /// Found when it is asked for: a sweep has no use for it.
    pub(super) hub_acceleration_rad_s2: OnceLock<Vec<f64>>,
    pub(super) spectrum: Arc<TipSpectrum>,
    pub(super) period: Arc<TipPeriod>,
    /// The hub angle's slow tail, where damping leaves one.
    pub(super) hub_tail: Option<TailTerms>,
}

impl Solution {
    pub(super) fn forcing(&self) -> Forcing<'_> {
        Forcing { model: &*self.model, spectrum: &self.spectrum, watch: &Unwatched }
    }

    /// The mesh that the answer was computed on.
    pub fn mesh(&self) -> &Mesh {
        self.model.mesh()
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        self.model.law()
    }

    /// The first `count` natural frequencies in rad/s, the rigid rotation left out.
    pub fn natural_frequencies_rad_s(&self, count: usize) -> Vec<f64> {
        natural_frequencies(self.mesh(), count)
    }

    /// The first `count` zeros of torque → tip in 1/s.
    pub fn zeros_per_s(&self, count: usize) -> Vec<f64> {
        torque_zeros(self.mesh(), count)
    }

    /// Hub acceleration in rad/s².
    pub fn hub_acceleration_rad_s2(&self) -> &Vec<f64> {
        self.hub_acceleration_rad_s2.get_or_init(|| {
            let hub = HubMotion {
                period: &self.period,
                excess_amplitudes_rad: &self.hub.excess_angle_rad,
                tail: self.hub_tail,
                per_length: 1.0 / self.mesh().length_m(),
            };
            hub.on(&self.grid, &self.tip.acceleration_m_s2, 2)
        })
    }

    /// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m.
    pub fn tip_deflection_m(&self) -> Vec<f64> {
        let length_m = self.mesh().length_m();
        let rigid_and_real = self.rigid_hub_angle_rad.iter().zip(&self.hub_angle_rad);
        rigid_and_real.map(|(rigid, real)| length_m * (rigid - real)).collect()
    }
}

/// The samples of a period that `grid` covers.
pub(super) fn cut(period: &[f64], grid: &TimeGrid) -> Vec<f64> {
    let mut samples = Vec::with_capacity(grid.len);
    for stretch in stretches(period, grid) {
        samples.extend_from_slice(stretch);
    }
    samples
}

/// What `grid` covers of a period, one after the other.
fn stretches<'a, T>(period: &'a [T], grid: &TimeGrid) -> impl Iterator<Item = &'a [T]> {
    let (mut first, mut left) = (grid.in_period(0, period.len()), grid.len);
    std::iter::from_fn(move || {
        let last = period.len().min(first + left);
        let stretch = &period[first..last];
        (first, left) = (0, left - stretch.len());
        (!stretch.is_empty()).then_some(stretch)
    })
}

/// The hub angle over a period: the tip's motion over the length, and what bending adds.
pub(super) struct HubMotion<'a> {
    pub(super) period: &'a TipPeriod,
    pub(super) excess_amplitudes_rad: &'a [Complex64],
    pub(super) tail: Option<TailTerms>,
    pub(super) per_length: f64,
}

impl HubMotion<'_> {
    /// Its `order`-th derivative on a grid, `tip` being that of the tip there.
    pub(super) fn on(&self, grid: &TimeGrid, tip: &[f64], order: usize) -> Vec<f64> {
        let spectrum = &self.period.spectrum;
        let derivative = spectrum.derivative(self.excess_amplitudes_rad, order);
        self.of_period(&spectrum.pair.samples(derivative), grid, tip, order)
    }

    /// The same, where the derivative of the excess is known over the period.
    pub(super) fn of_period(
        &self,
        excess: &[f64],
        grid: &TimeGrid,
        tip: &[f64],
        order: usize,
    ) -> Vec<f64> {
        let mut motion = cut(excess, grid);
        self.take_images_off(grid, order, 1.0, &mut motion);
        for (excess, tip) in motion.iter_mut().zip(tip) {
            *excess += tip * self.per_length;
        }
        motion
    }

    /// Takes what other periods add to the `order`-th derivative, times a factor, off samples of a grid.
    pub(super) fn take_images_off(
        &self,
        grid: &TimeGrid,
        order: usize,
        factor: f64,
        samples: &mut [f64],
    ) {
        let Some(tail) = self.tail.filter(|_| factor != 0.0) else { return };
        let tail = tail.map(|s| factor * s);
        let images = self.period.images().history(order);
        let mut rest = samples;
        for stretch in stretches(images, grid) {
            let (these, others) = rest.split_at_mut(stretch.len());
            for (sample, terms) in these.iter_mut().zip(stretch) {
                *sample -= tail_sum(&tail, terms);
            }
            rest = others;
        }
    }
}
