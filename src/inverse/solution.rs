use std::f64::consts::TAU;

use num_complex::Complex64;

use super::dynamics::Dynamics;
use super::spectra::{Forcing, band_len};
use super::warning::Warning;
use crate::beam::Mesh;
use crate::modal::DampingLaw;
use crate::motion::{TipMotionHistories, TipSpectrum};
use crate::numeric::TimeGrid;

/// How exact a solution is, each number relative to the peak torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Discretisation error of the torque, measured on halved elements.
    pub mesh_error: f64,
    /// Largest torque outside the written window, or where one period meets the next.
    pub edge_error: f64,
    /// What a reduction to few modes changes of the torque of all modes of the mesh; none for a
    /// link that is not reduced.
    pub truncation_error: Option<f64>,
}

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
    /// Nyquist frequency in Hz.
    pub nyquist_hz: f64,
}

impl Band {
    pub(super) fn of(spectrum: &TipSpectrum) -> Self {
        let frequencies = band_len(&spectrum.acceleration_m_s2);
        let hertz = |k| spectrum.omega_rad_s(k) / TAU;
        Self {
            period_s: spectrum.period_s(),
            fft_length: spectrum.pair.len(),
            frequencies,
            highest_hz: hertz(frequencies - 1),
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
    /// Hub acceleration in rad/s².
    pub hub_acceleration_rad_s2: Vec<f64>,
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
    pub dynamics: Dynamics,
    /// Lowest natural frequencies in rad/s, the rigid rotation left out.
    pub natural_frequencies_rad_s: Vec<f64>,
    /// Lowest zeros of torque → tip in 1/s.
    pub zeros_per_s: Vec<f64>,
    /// How exact the torque is.
    pub accuracy: Accuracy,
    /// Frequencies that were solved for.
    pub band: Band,
    /// What the user must know.
    pub warnings: Vec<Warning>,
    /// Amplitudes of the torque in N m over the band.
    pub(super) torque_amplitudes_n_m: Vec<Complex64>,
    pub(super) spectrum: TipSpectrum,
    pub(super) friction_n_m_s_rad: f64,
}

impl Solution {
    pub(super) fn forcing(&self) -> Forcing<'_> {
        Forcing {
            dynamics: &self.dynamics,
            friction_n_m_s_rad: self.friction_n_m_s_rad,
            spectrum: &self.spectrum,
        }
    }

    /// The mesh that the answer was computed on.
    pub fn mesh(&self) -> &Mesh {
        self.dynamics.mesh()
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        self.dynamics.law()
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
    let len = period.len() as i64;
    let at = |k: usize| (grid.first + k as i64).rem_euclid(len) as usize;
    (0..grid.len).map(|k| period[at(k)]).collect()
}
