//! Amplitudes over the band: the model's transfers times the tip's motion.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rayon::prelude::*;

use super::analysis::{Stage, Watch};
use crate::beam::{Checkpoints, NodalQuantity};
use crate::link::Drive;
use crate::model::{Model, ModelError};
use crate::motion::TipPeriod;
use crate::system::end_if_stopped;

/// Number of frequencies that a thread solves at a time at the hub alone; no bit of the results depends on it.
const HUB_BLOCK: usize = 256;

/// Number of frequencies with the nodes, which need many numbers for each frequency.
const NODAL_BLOCK: usize = 64;

/// A model, and the motion of its tip over a period.
#[derive(Clone, Copy)]
pub(super) struct DrivenModel<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) period: &'a TipPeriod,
    pub(super) watch: &'a dyn Watch,
}

/// Amplitudes at the hub, from zero frequency to the end of the band.
#[derive(Debug, Clone)]
pub(super) struct HubSpectra {
    /// Torque T̂ in N m.
    pub(super) torque_n_m: Vec<Complex64>,
    /// Hub angle less that of the rigid link, θ̂ − v̂/L, in rad.
    pub(super) excess_angle_rad: Vec<Complex64>,
    /// Moment of the hub on the link's root in N m.
    pub(super) root_moment_n_m: Vec<Complex64>,
    /// The lowest frequency in Hz where torques move the tip by rounding alone; the amplitudes there are meaningless.
    pub(super) blocked_hz: Option<f64>,
}

/// Amplitudes at the motor, on its side of the gear.
pub(super) struct MotorSpectra {
    /// Torque in N m.
    pub(super) torque_n_m: Vec<Complex64>,
    /// Rate in rad/s.
    pub(super) rate_rad_s: Vec<Complex64>,
}

impl DrivenModel<'_> {
    /// Frequencies in rad/s of the bins that carry spectrum.
    pub(super) fn omegas_rad_s(&self) -> &[f64] {
        &self.period.spectrum.omegas_rad_s[..self.period.spectrum.band_len()]
    }

    /// Reports the start of `sweeps` sweeps over the band, `done` of them finished.
    pub(super) fn begin(&self, sweeps: usize, done: usize) {
        let elements = self.model.mesh().elements().len();
        let band = self.period.spectrum.band_len();
        self.watch.begin(Stage::Solve { elements }, sweeps * band);
        self.watch.advance(done * band);
    }

    /// Torque and hub angle over the band.
    ///
    /// ```text
    /// T̂ = (T/a_tip)(â + αv̂) + b·(v̂/L + iω θ̃̂)                         (Bayo 1987, eq 20)
    /// θ̃̂ = θ̂ − v̂_tip/L = (â + αv̂)/κ · e_tip/(λ L (L + e_tip))          (eq 21)
    /// ```
    ///
    /// For a tip that moves at its ends, the torque lacks `b v/L`.
    ///
    /// # Errors
    /// [`ModelError::NotFinite`] names the lowest frequency that fails.
    pub(super) fn hub_spectra(&self) -> Result<HubSpectra, ModelError> {
        let omegas = self.omegas_rad_s();
        let zeros = || vec![Complex64::ZERO; omegas.len()];
        let [mut torque_n_m, mut excess_angle_rad, mut root_moment_n_m] =
            [zeros(), zeros(), zeros()];
        let law = self.model.law();
        let (drag, compliance_factor) = (law.mass_rate_per_s(), law.compliance_factor());
        let mesh = self.model.mesh();
        let length_m = mesh.length_m();
        let friction = self.model.link().joint().friction_n_m_s_rad;
        let spectrum = &self.period.spectrum;
        // Only a periodic velocity has a spectrum. Friction of any other velocity joins the torque over time.
        let moves = spectrum.mean_m_s2.is_some();
        let (per_length, rigid_friction) =
            (1.0 / length_m, if moves { 0.0 } else { friction / length_m });
        let rows = torque_n_m
            .par_chunks_mut(HUB_BLOCK)
            .zip(excess_angle_rad.par_chunks_mut(HUB_BLOCK))
            .zip(root_moment_n_m.par_chunks_mut(HUB_BLOCK));
        let blocks = omegas.par_chunks(HUB_BLOCK).zip(rows).enumerate();
        let lowest_blocked = blocks.filter_map(|(block, (omegas, ((torque, excess), root)))| {
            end_if_stopped();
            let transfers = self.model.tip_transfers(omegas);
            let first = block * HUB_BLOCK;
            for (k, (omega, tip)) in omegas.iter().zip(&transfers).enumerate() {
                let velocity = spectrum.velocity_m_s[first + k];
                let damped = spectrum.acceleration_m_s2[first + k] + velocity * drag;
                let excess_rad_s2_m = tip.deflection_s2 * compliance_factor(*omega) * per_length;
                let rate = Complex64::new(-omega * excess_rad_s2_m.im, omega * excess_rad_s2_m.re);
                let inertia_kg_m = tip.inertia_kg_m + rate * friction;
                torque[k] = inertia_kg_m * damped + velocity * rigid_friction;
                excess[k] = excess_rad_s2_m * damped;
                root[k] = tip.root_inertia_kg_m * damped;
            }
            self.watch.advance(omegas.len());
            transfers.iter().position(|tip| tip.is_blocked(mesh)).map(|k| first + k)
        });
        let lowest_blocked = lowest_blocked.min();
        let frequency_hz = |bin: usize| omegas[bin] / TAU;
        let mut bins = torque_n_m.iter().zip(&excess_angle_rad);
        let is_lost = |(t, e): (&Complex64, &Complex64)| !(t.is_finite() && e.is_finite());
        if let Some(bin) = bins.position(is_lost) {
            return Err(ModelError::NotFinite { frequency_hz: frequency_hz(bin) });
        }
        let blocked_hz = lowest_blocked.map(frequency_hz);
        Ok(HubSpectra { torque_n_m, excess_angle_rad, root_moment_n_m, blocked_hz })
    }

    /// The motor at the hub's frequencies, where there is a drive.
    ///
    /// ```text
    /// φ̇ = n (θ̇ + Ṫ/k),   θ̇̂ = v̂/L + iω θ̃̂
    /// T̂_m = T̂/n + J φ̈
    /// ```
    pub(super) fn motor_spectra(&self, hub: &HubSpectra) -> Option<MotorSpectra> {
        let drive = self.model.link().joint().drive?;
        let Drive { joint_stiffness_n_m_rad, rotor_inertia_kg_m2, gear_ratio } = drive;
        let per_length = 1.0 / self.model.mesh().length_m();
        let spectrum = &self.period.spectrum;
        let amplitudes = |(k, omega): (usize, &f64)| {
            let torque = hub.torque_n_m[k];
            let bending = hub.excess_angle_rad[k] + torque / joint_stiffness_n_m_rad;
            let [velocity, acceleration] =
                [spectrum.velocity_m_s[k], spectrum.acceleration_m_s2[k]];
            let rate = velocity * per_length + bending * Complex64::new(0.0, *omega);
            let turning = acceleration * per_length - bending * (omega * omega);
            let inertia = rotor_inertia_kg_m2 * gear_ratio;
            (torque / gear_ratio + turning * inertia, rate * gear_ratio)
        };
        let bins = spectrum.omegas_rad_s[..hub.torque_n_m.len()].iter().enumerate();
        let (torque_n_m, rate_rad_s) = bins.map(amplitudes).unzip();
        Some(MotorSpectra { torque_n_m, rate_rad_s })
    }

    /// Amplitudes of `quantity` at some nodes over the band, one spectrum for each node.
    ///
    /// Deflections `ŵ_i = −(â + αv̂)/κ · e_i/(λ(L + e_tip))` (eq 21) or bending moments.
    pub(super) fn nodal_spectra(
        &self,
        nodes: &[usize],
        quantity: NodalQuantity,
    ) -> Vec<Vec<Complex64>> {
        let advance = |bins| self.watch.advance(bins);
        self.nodal_spectra_from(&mut self.checkpoints([]), nodes, quantity, advance)
    }

    /// Checkpoints for [`DrivenModel::nodal_spectra_from`] of a first group of nodes and these further ones.
    pub(super) fn checkpoints<'b>(
        &self,
        further: impl IntoIterator<Item = &'b [usize]>,
    ) -> Vec<Checkpoints> {
        let checkpoints = Checkpoints::of(self.model.mesh(), further);
        vec![checkpoints; self.omegas_rad_s().len().div_ceil(NODAL_BLOCK)]
    }

    /// [`DrivenModel::nodal_spectra`] for one of several groups of nodes; `advance` receives the number of bins since
    /// its last call.
    pub(super) fn nodal_spectra_from(
        &self,
        checkpoints: &mut [Checkpoints],
        nodes: &[usize],
        quantity: NodalQuantity,
        advance: impl Fn(usize) + Sync,
    ) -> Vec<Vec<Complex64>> {
        let omegas = self.omegas_rad_s();
        let mut spectra = vec![vec![Complex64::ZERO; omegas.len()]; nodes.len()];
        // Each block writes its own columns of every row.
        let mut rows: Vec<_> = spectra.iter_mut().map(|row| row.chunks_mut(NODAL_BLOCK)).collect();
        let columns =
            |_: &[f64]| -> Vec<_> { rows.iter_mut().filter_map(Iterator::next).collect() };
        let columns: Vec<Vec<&mut [Complex64]>> = omegas.chunks(NODAL_BLOCK).map(columns).collect();
        let blocks = omegas.par_chunks(NODAL_BLOCK).zip(columns).zip(checkpoints).enumerate();
        blocks.for_each(|(block, ((omegas, mut rows), checkpoints))| {
            end_if_stopped();
            self.model.nodal_transfers(omegas, nodes, quantity, &mut rows, checkpoints);
            let factors: Vec<Complex64> = omegas
                .iter()
                .enumerate()
                .map(|(k, omega)| self.nodal_factor(block * NODAL_BLOCK + k, *omega, quantity))
                .collect();
            for (value, factor) in rows.iter_mut().flat_map(|row| row.iter_mut().zip(&factors)) {
                *value *= factor;
            }
            advance(omegas.len());
        });
        spectra
    }

    /// Factor from the transfer to the nodes to their amplitudes at bin `k` of frequency ω: `â + αv̂`, over −κ for
    /// deflections.
    fn nodal_factor(&self, k: usize, omega: f64, quantity: NodalQuantity) -> Complex64 {
        let (spectrum, law) = (&self.period.spectrum, self.model.law());
        let damped =
            spectrum.acceleration_m_s2[k] + spectrum.velocity_m_s[k] * law.mass_rate_per_s();
        match quantity {
            NodalQuantity::Deflection => -damped / law.stiffness_factor(omega),
            NodalQuantity::Moment => damped,
        }
    }
}
