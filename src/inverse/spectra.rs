use num_complex::Complex64;
use rayon::prelude::*;

use super::dynamics::Dynamics;
use super::error::InversionError;
use crate::beam::{NodalQuantity, TipTransfer};
use crate::motion::TipSpectrum;

/// Amplitudes of the acceleration below this share of the largest are not solved for: they lie
/// below the round-off of a transform.
pub(super) const BAND_TOLERANCE: f64 = 1e-15;

/// Frequencies that a thread solves for at a time; no bit depends on it.
const BLOCK: usize = 64;

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

    /// Frequencies in rad/s of the bins that carry spectrum.
    fn omegas_rad_s(&self) -> Vec<f64> {
        let band = band_len(&self.spectrum.acceleration_m_s2);
        (0..band).map(|k| self.spectrum.omega_rad_s(k)).collect()
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
        let omegas = self.omegas_rad_s();
        let solved = |(block, omegas): (usize, &[f64])| {
            let transfers = self.dynamics.tip_transfers(omegas);
            let bins = omegas.iter().zip(&transfers).enumerate();
            bins.map(|(k, (omega, tip))| self.hub_at_bin(block * BLOCK + k, *omega, tip))
                .collect::<Result<Vec<_>, _>>()
        };
        let blocks: Vec<_> = omegas.par_chunks(BLOCK).enumerate().map(solved).collect();
        // The lowest frequency that fails is reported, whichever thread meets one first.
        let blocks: Vec<_> = blocks.into_iter().collect::<Result<_, _>>()?;
        let column = |c: usize| blocks.iter().flatten().map(|bin| bin[c]).collect();
        Ok(HubSpectra {
            torque_n_m: column(0),
            excess_angle_rad: column(1),
            root_moment_n_m: column(2),
        })
    }

    /// Torque, excess angle and root moment at bin `k`, whose frequency is ω.
    fn hub_at_bin(
        &self,
        k: usize,
        omega: f64,
        transfer: &TipTransfer,
    ) -> Result<[Complex64; 3], InversionError> {
        let length_m = self.dynamics.mesh().length_m();
        let felt = self.felt_acceleration(k);
        let excess =
            felt / self.dynamics.law().stiffness_factor(omega) * transfer.lag_s2 / length_m;
        let rate = self.spectrum.velocity_m_s(k) / length_m + Complex64::new(0.0, omega) * excess;
        let torque = transfer.inertia_kg_m * felt + rate * self.friction_n_m_s_rad;
        if !(torque.is_finite() && excess.is_finite()) {
            return Err(InversionError::NotFinite { frequency_hz: omega / std::f64::consts::TAU });
        }
        Ok([torque, excess, transfer.root_inertia_kg_m * felt])
    }

    /// Amplitudes of `quantity` at some nodes over the band, one spectrum for each node.
    ///
    /// Deflections `ŵ_i = −(â + αv̂)/κ · e_i/(λ(L + e_tip))` (eq 21) or bending moments.
    pub(super) fn nodal_spectra(
        &self,
        nodes: &[usize],
        quantity: NodalQuantity,
    ) -> Vec<Vec<Complex64>> {
        let omegas = self.omegas_rad_s();
        let mut spectra = vec![vec![Complex64::ZERO; omegas.len()]; nodes.len()];
        // Each block writes its own columns of every row.
        let mut rows: Vec<_> = spectra.iter_mut().map(|row| row.chunks_mut(BLOCK)).collect();
        let columns =
            |_: &[f64]| -> Vec<_> { rows.iter_mut().filter_map(Iterator::next).collect() };
        let columns: Vec<Vec<&mut [Complex64]>> = omegas.chunks(BLOCK).map(columns).collect();
        let blocks = omegas.par_chunks(BLOCK).zip(columns).enumerate();
        blocks.for_each(|(block, (omegas, mut rows))| {
            self.dynamics.nodal_transfers(omegas, nodes, quantity, &mut rows);
            let factor =
                |(k, omega): (usize, &f64)| self.nodal_factor(block * BLOCK + k, *omega, quantity);
            let factors: Vec<Complex64> = omegas.iter().enumerate().map(factor).collect();
            for (value, factor) in rows.iter_mut().flat_map(|row| row.iter_mut().zip(&factors)) {
                *value *= factor;
            }
        });
        spectra
    }

    /// What the transfer to the nodes is multiplied by at bin `k`, whose frequency is ω.
    fn nodal_factor(&self, k: usize, omega: f64, quantity: NodalQuantity) -> Complex64 {
        let felt = self.felt_acceleration(k);
        match quantity {
            NodalQuantity::Deflection => -felt / self.dynamics.law().stiffness_factor(omega),
            NodalQuantity::Moment => felt,
        }
    }
}
