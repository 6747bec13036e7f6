use num_complex::Complex64;
use rayon::prelude::*;

use super::dynamics::Dynamics;
use super::error::InversionError;
use crate::beam::NodalTransfer;
use crate::motion::TipSpectrum;

/// Amplitudes of the acceleration below this share of the largest are not solved for: they lie
/// below the round-off of a transform.
pub(super) const BAND_TOLERANCE: f64 = 1e-15;

/// What a motion asks of a link, as far as the spectrum goes.
pub(super) struct Forcing<'a> {
    pub(super) dynamics: &'a Dynamics,
    pub(super) friction_n_m_s_rad: f64,
    pub(super) spectrum: &'a TipSpectrum,
}

/// Amplitudes at the hub, from zero frequency to the end of the band.
pub(super) struct HubSpectra {
    /// Torque T̂ in N m.
    pub(super) torque_n_m: Vec<Complex64>,
    /// Hub angle less that of the rigid link, θ̂ − v̂/L, in rad.
    pub(super) excess_angle_rad: Vec<Complex64>,
    /// Moment of the hub on the link's root in N m.
    pub(super) root_moment_n_m: Vec<Complex64>,
}

/// Number of bins from zero frequency on that carry spectrum.
pub(super) fn band_len(acceleration: &[Complex64]) -> usize {
    let peak = acceleration.iter().fold(0.0_f64, |m, a| m.max(a.norm()));
    let carries = |a: &Complex64| a.norm() > BAND_TOLERANCE * peak;
    acceleration.iter().rposition(carries).map_or(1, |last| last + 1)
}

impl Forcing<'_> {
    /// Acceleration that the mass feels at bin `k`, â + αv̂, in m/s².
    fn felt_acceleration(&self, k: usize) -> Complex64 {
        let spectrum = self.spectrum;
        spectrum.acceleration_m_s2[k]
            + spectrum.velocity_m_s(k) * self.dynamics.law().mass_rate_per_s()
    }

    /// Bins that carry spectrum.
    fn band(&self) -> std::ops::Range<usize> {
        0..band_len(&self.spectrum.acceleration_m_s2)
    }

    /// Torque and hub angle over the band.
    ///
    /// ```text
    /// T̂ = (T/a_tip)(â + αv̂) + b·(v̂/L + iω θ̃̂)                         (Bayo 1987, eq 20)
    /// θ̃̂ = θ̂ − v̂_tip/L = (â + αv̂)/κ · e_tip/(λ L (L + e_tip))          (eq 21)
    /// ```
    ///
    /// # Errors
    /// [`InversionError::NotFinite`].
    pub(super) fn hub_spectra(&self) -> Result<HubSpectra, InversionError> {
        let length_m = self.dynamics.mesh().length_m();
        let at_bin = |k: usize| {
            let omega = self.spectrum.omega_rad_s(k);
            let transfer = self.dynamics.tip_transfer(omega);
            let felt = self.felt_acceleration(k);
            let excess =
                felt / self.dynamics.law().stiffness_factor(omega) * transfer.lag_s2 / length_m;
            let rate =
                self.spectrum.velocity_m_s(k) / length_m + Complex64::new(0.0, omega) * excess;
            let torque = transfer.inertia_kg_m * felt + rate * self.friction_n_m_s_rad;
            if !(torque.is_finite() && excess.is_finite()) {
                return Err(InversionError::NotFinite {
                    frequency_hz: omega / std::f64::consts::TAU,
                });
            }
            Ok([torque, excess, transfer.root_inertia_kg_m * felt])
        };
        let bins: Vec<[Complex64; 3]> =
            self.band().into_par_iter().map(at_bin).collect::<Result<_, _>>()?;
        let column = |c: usize| bins.iter().map(|bin| bin[c]).collect();
        Ok(HubSpectra {
            torque_n_m: column(0),
            excess_angle_rad: column(1),
            root_moment_n_m: column(2),
        })
    }

    /// Amplitudes of `quantity` at some nodes over the band, one spectrum for each node.
    ///
    /// Deflections `ŵ_i = −(â + αv̂)/κ · e_i/(λ(L + e_tip))` (eq 21) or bending moments.
    pub(super) fn nodal_spectra(&self, nodes: &[usize], quantity: Nodal) -> Vec<Vec<Complex64>> {
        let at_bin = |k: usize| {
            let omega = self.spectrum.omega_rad_s(k);
            let NodalTransfer { lags_s2, moments_kg_m, .. } = self.dynamics.nodal_transfer(omega);
            let felt = self.felt_acceleration(k);
            let (factor, transfers) = match quantity {
                Nodal::Deflection => (-felt / self.dynamics.law().stiffness_factor(omega), lags_s2),
                Nodal::Moment => (felt, moments_kg_m),
            };
            nodes.iter().map(|node| transfers[*node] * factor).collect::<Vec<_>>()
        };
        let bins: Vec<Vec<Complex64>> = self.band().into_par_iter().map(at_bin).collect();
        (0..nodes.len()).map(|node| bins.iter().map(|bin| bin[node]).collect()).collect()
    }
}

/// A quantity at the nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Nodal {
    /// Deflection w from the hub's tangent line.
    Deflection,
    /// Moment of the inner on the outer part.
    Moment,
}
