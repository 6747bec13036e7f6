#![expect(clippy::inline_always, reason = "code for wider vectors must be inlined into its caller")]

use std::f64::consts::TAU;

use num_complex::Complex64;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use super::watch::{Stage, Watch};
use crate::beam::{Checkpoints, NodalQuantity, TipTransfers};
use crate::link::Drive;
use crate::model::{Model, ModelError};
use crate::motion::TipSpectrum;

/// Frequencies that a thread solves for at a time, the hub's alone, where there are other threads; no
/// bit depends on it.
const HUB_BLOCK: usize = 256;

/// The same of the only thread.
const HUB_BLOCK_ALONE: usize = 512;

/// The same with the nodes, which are many numbers for each frequency.
const NODAL_BLOCK: usize = 64;

/// What a motion asks of a link, as far as the spectrum goes.
#[derive(Clone, Copy)]
pub(super) struct Forcing<'a> {
    pub(super) model: &'a dyn Model,
    pub(super) spectrum: &'a TipSpectrum,
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
    /// The lowest frequency in Hz at which no torque moves the tip, but for rounding: what stands
    /// there is of any size.
    pub(super) blocked_hz: Option<f64>,
}

/// Amplitudes at the motor, on its own side of the gear.
pub(super) struct MotorSpectra {
    /// Torque in N m.
    pub(super) torque_n_m: Vec<Complex64>,
    /// Rate in rad/s.
    pub(super) rate_rad_s: Vec<Complex64>,
}

/// What the tip's motion is multiplied by at one frequency.
struct HubTransfer {
    /// Torque of the link and of what bending adds to the joint's friction, per felt acceleration,
    /// in kg m.
    inertia_kg_m: Complex64,
    /// Excess of the hub angle per felt acceleration in rad s²/m.
    excess_rad_s2_m: Complex64,
}

fn hub_block() -> usize {
    if is_alone() { HUB_BLOCK_ALONE } else { HUB_BLOCK }
}

/// Fewest blocks that a thread takes: all of them where there is no other to share them with.
fn fewest_blocks() -> usize {
    if is_alone() { usize::MAX } else { 1 }
}

fn is_alone() -> bool {
    rayon::current_num_threads() == 1
}

/// Transfers to the tip at some frequencies, from bin `first` on, that the motion is to excite.
struct Excited<'a> {
    forcing: Forcing<'a>,
    first: usize,
    omegas: &'a [f64],
    tip_transfers: &'a TipTransfers,
    rows: HubRows<'a>,
}

/// Where the amplitudes at these frequencies belong.
struct HubRows<'a> {
    torque: &'a mut [Complex64],
    excess: &'a mut [Complex64],
    root: &'a mut [Complex64],
}

impl WithSimd for Excited<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { forcing, first, omegas, tip_transfers, rows } = self;
        let len = omegas.len();
        let bins = first..first + len;
        let accelerations = &forcing.spectrum.acceleration_m_s2[bins.clone()];
        let velocities = &forcing.spectrum.velocity_m_s[bins];
        let inertias = &tip_transfers.inertia_kg_m[..len];
        let root_inertias = &tip_transfers.root_inertia_kg_m[..len];
        let lags = &tip_transfers.deflection_s2[..len];
        let HubRows { torque, excess, root } = rows;
        let (torque, excess, root) = (&mut torque[..len], &mut excess[..len], &mut root[..len]);
        let drag = forcing.model.law().mass_rate_per_s();
        let rigid_friction =
            forcing.model.link().joint().friction_n_m_s_rad / forcing.model.mesh().length_m();
        let hub_transfer = forcing.hub_transfer();
        for k in 0..len {
            let felt = accelerations[k] + velocities[k] * drag;
            let hub = hub_transfer(omegas[k], inertias[k], lags[k]);
            torque[k] = hub.inertia_kg_m * felt + velocities[k] * rigid_friction;
            excess[k] = hub.excess_rad_s2_m * felt;
            root[k] = root_inertias[k] * felt;
        }
    }
}

impl Forcing<'_> {
    /// Acceleration that the mass feels at bin `k`, â + αv̂, in m/s².
    pub(super) fn felt_acceleration(&self, k: usize) -> Complex64 {
        let spectrum = self.spectrum;
        let drag = self.model.law().mass_rate_per_s();
        spectrum.acceleration_m_s2[k] + spectrum.velocity_m_s[k] * drag
    }

    /// Frequencies in rad/s of the bins that carry spectrum.
    pub(super) fn omegas_rad_s(&self) -> &[f64] {
        &self.spectrum.omegas_rad_s[..self.spectrum.band_len()]
    }

    /// Tells that so many sweeps over the band begin, and how many of them are done.
    pub(super) fn begin(&self, sweeps: usize, done: usize) {
        let (elements, band) = (self.model.mesh().elements().len(), self.spectrum.band_len());
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
    /// # Errors
    /// [`ModelError::NotFinite`] names the lowest frequency that fails.
    pub(super) fn hub_spectra(&self) -> Result<HubSpectra, ModelError> {
        let omegas = self.omegas_rad_s();
        let zeros = || vec![Complex64::ZERO; omegas.len()];
        let [mut torque_n_m, mut excess_angle_rad, mut root_moment_n_m] =
            [zeros(), zeros(), zeros()];
        let block_len = hub_block();
        let rows = torque_n_m
            .par_chunks_mut(block_len)
            .zip(excess_angle_rad.par_chunks_mut(block_len))
            .zip(root_moment_n_m.par_chunks_mut(block_len));
        let blocks = omegas.par_chunks(block_len).zip(rows).enumerate();
        let lowest_blocked = blocks.with_min_len(fewest_blocks()).filter_map(
            |(block, (omegas, ((torque, excess), root)))| {
                let tip = self.model.tip_transfers(omegas);
                let first = block * block_len;
                let (forcing, tip_transfers) = (*self, &tip);
                let rows = HubRows { torque, excess, root };
                Arch::new().dispatch(Excited { forcing, first, omegas, tip_transfers, rows });
                self.watch.advance(omegas.len());
                tip.first_blocked(self.model.mesh()).map(|k| first + k)
            },
        );
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

    /// What the inertia and the lag of a transfer to the tip at ω mean at the hub.
    fn hub_transfer(&self) -> impl Fn(f64, Complex64, Complex64) -> HubTransfer {
        let compliance_factor = self.model.law().compliance_factor();
        let per_length = 1.0 / self.model.mesh().length_m();
        let friction = self.model.link().joint().friction_n_m_s_rad;
        #[inline(always)]
        move |omega, inertia_kg_m, deflection_s2| {
            let excess_rad_s2_m = deflection_s2 * compliance_factor(omega) * per_length;
            let rate = Complex64::new(-omega * excess_rad_s2_m.im, omega * excess_rad_s2_m.re);
            let inertia_kg_m = inertia_kg_m + rate * friction;
            HubTransfer { inertia_kg_m, excess_rad_s2_m }
        }
    }

    /// The motor over the band, where there is a drive.
    ///
    /// ```text
    /// φ̇ = n (θ̇ + Ṫ/k),   θ̇̂ = v̂/L + iω θ̃̂
    /// T̂_m = T̂/n + J φ̈
    /// ```
    pub(super) fn motor_spectra(&self, hub: &HubSpectra) -> Option<MotorSpectra> {
        let drive = self.model.link().joint().drive?;
        let Drive { joint_stiffness_n_m_rad, rotor_inertia_kg_m2, gear_ratio } = drive;
        let per_length = 1.0 / self.model.mesh().length_m();
        let amplitudes = |(k, omega): (usize, &f64)| {
            let torque = hub.torque_n_m[k];
            let bending = hub.excess_angle_rad[k] + torque / joint_stiffness_n_m_rad;
            let [velocity, acceleration] =
                [self.spectrum.velocity_m_s[k], self.spectrum.acceleration_m_s2[k]];
            let rate = velocity * per_length + bending * Complex64::new(0.0, *omega);
            let turning = acceleration * per_length - bending * (omega * omega);
            let inertia = rotor_inertia_kg_m2 * gear_ratio;
            (torque / gear_ratio + turning * inertia, rate * gear_ratio)
        };
        let bins = self.omegas_rad_s().iter().enumerate();
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

    /// Checkpoints for [`Forcing::nodal_spectra_from`] of a first group of nodes and these further ones.
    pub(super) fn checkpoints<'b>(
        &self,
        further: impl IntoIterator<Item = &'b [usize]>,
    ) -> Vec<Checkpoints> {
        let checkpoints = Checkpoints::of(self.model.mesh(), further);
        vec![checkpoints; self.omegas_rad_s().len().div_ceil(NODAL_BLOCK)]
    }

    /// [`Forcing::nodal_spectra`] of one of several groups of nodes; `advance` gets how many bins are done
    /// since its last call.
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
        blocks.with_min_len(fewest_blocks()).for_each(
            |(block, ((omegas, mut rows), checkpoints))| {
                self.model.nodal_transfers(omegas, nodes, quantity, &mut rows, checkpoints);
                let factor = |(k, omega): (usize, &f64)| {
                    self.nodal_factor(block * NODAL_BLOCK + k, *omega, quantity)
                };
                let factors: Vec<Complex64> = omegas.iter().enumerate().map(factor).collect();
                for (value, factor) in rows.iter_mut().flat_map(|row| row.iter_mut().zip(&factors))
                {
                    *value *= factor;
                }
                advance(omegas.len());
            },
        );
        spectra
    }

    /// What the transfer to the nodes is multiplied by at bin `k`, whose frequency is ω.
    fn nodal_factor(&self, k: usize, omega: f64, quantity: NodalQuantity) -> Complex64 {
        let felt = self.felt_acceleration(k);
        match quantity {
            NodalQuantity::Deflection => -felt / self.model.law().stiffness_factor(omega),
            NodalQuantity::Moment => felt,
        }
    }
}
