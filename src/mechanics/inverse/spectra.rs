//! Amplitudes over the band: the model's transfers times the tip's motion; the size of all quantities over time.

use std::f64::consts::TAU;

use num_complex::Complex64;
use rayon::prelude::*;

use super::accuracy::PerQuantity;
use super::analysis::{Analysis, Stage, Unwatched, Watch};
use crate::beam::{Checkpoints, Mesh, MeshPlan, NodalQuantity};
use crate::link::Drive;
use crate::model::{Model, ModelError};
use crate::motion::TipPeriod;
use crate::numeric::{FourierPair, largest};
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
        let rigid_tip = mesh.rigid_tip();
        let friction = self.model.link().joint().friction();
        let spectrum = &self.period.spectrum;
        // Only a periodic velocity has a spectrum. Friction of any other velocity joins the torque over time.
        let moves = spectrum.mean_m_s2.is_some();
        let (per_rigid_tip, rigid_friction) =
            (1.0 / rigid_tip, if moves { 0.0 } else { friction / rigid_tip });
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
                let excess_rad_s2_m = tip.deflection_s2 * compliance_factor(*omega) * per_rigid_tip;
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
    ///
    /// Losses are not linear: they join the histories, in [`MotorHistories`](super::MotorHistories).
    pub(super) fn motor_spectra(&self, hub: &HubSpectra) -> Option<MotorSpectra> {
        let drive = *self.model.link().drive()?;
        let Drive { joint_stiffness_n_m_rad, rotor_inertia_kg_m2, gear_ratio, .. } = drive;
        let per_rigid_tip = 1.0 / self.model.mesh().rigid_tip();
        let spectrum = &self.period.spectrum;
        let amplitudes = |(k, omega): (usize, &f64)| {
            let torque = hub.torque_n_m[k];
            let bending = hub.excess_angle_rad[k] + torque / joint_stiffness_n_m_rad;
            let [velocity, acceleration] =
                [spectrum.velocity_m_s[k], spectrum.acceleration_m_s2[k]];
            let rate = velocity * per_rigid_tip + bending * Complex64::new(0.0, *omega);
            let turning = acceleration * per_rigid_tip - bending * (omega * omega);
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

/// Most nodes with measured displacements and moments. Waves between two of them are too short for the mesh.
const MOST_NODES: usize = 8;

/// Measured quantities besides torques and the hub's angle and rate.
pub(super) struct Probes {
    /// Nodes with measured displacements and moments.
    pub(super) nodes: Vec<usize>,
    /// True to measure quantities of tables over time: displacements of the nodes, the hub's acceleration.
    tables: bool,
    /// True to measure bending moments along the link.
    moments: bool,
}

impl Probes {
    /// Evenly spread nodes of a mesh, without the tip if it is the output, which moves as wanted on every mesh.
    pub(super) fn of(mesh: &Mesh, plan: &MeshPlan, analysis: &Analysis) -> Self {
        // An automatic mesh must not depend on the choice of measured quantities.
        let tables = analysis.measures_tables() || plan.is_automatic();
        let inner = mesh.nodes_m().len() - 1;
        let count = inner.min(MOST_NODES);
        // Includes the root: moments are largest there, and it moves where the hub has a radius.
        let nodes = (0..count).map(|k| k * inner / count);
        let nodes = nodes.chain((mesh.output() != inner).then_some(inner)).collect();
        Self { nodes, tables, moments: analysis.measures_moments() }
    }

    /// The same places of this mesh on the one whose elements are half as long.
    pub(super) fn refined(&self, mesh: &Mesh) -> Self {
        Self { nodes: self.nodes.iter().map(|node| mesh.refined_node(*node)).collect(), ..*self }
    }

    /// The same quantities at other nodes.
    pub(super) fn at(&self, nodes: &[usize]) -> Self {
        Self { nodes: nodes.to_vec(), ..*self }
    }

    /// Keeps the measured quantities of some values.
    pub(super) fn measured(&self, of: PerQuantity<f64>) -> PerQuantity<f64> {
        PerQuantity {
            hub_acceleration: of.hub_acceleration.filter(|_| self.tables),
            displacement: of.displacement.filter(|_| self.tables),
            bending_moment: of.bending_moment.filter(|_| self.moments),
            ..of
        }
    }
}

/// Amplitudes of all quantities over the band on one mesh.
pub(super) struct Amplitudes {
    pub(super) hub: HubSpectra,
    /// Hub rate in rad/s, and acceleration in rad/s² where tables count, less those of a rigid link.
    pub(super) hub_rate_rad_s: Vec<Complex64>,
    pub(super) hub_acceleration_rad_s2: Option<Vec<Complex64>>,
    pub(super) motor: Option<MotorSpectra>,
    /// Displacement less that of a rigid link, `v − x v_tip/L`, at the probes in m, where tables count.
    pub(super) displacement_m: Option<Vec<Vec<Complex64>>>,
    /// Bending moment at the probes in N m, where moments count.
    pub(super) moment_n_m: Option<Vec<Vec<Complex64>>>,
    pair: FourierPair,
}

impl Amplitudes {
    /// Solves for the amplitudes of all quantities.
    ///
    /// # Errors
    /// As [`DrivenModel::hub_spectra`].
    pub(super) fn of(driven: DrivenModel<'_>, probes: &Probes) -> Result<Self, ModelError> {
        let Probes { tables, moments, .. } = *probes;
        let nodal = usize::from(tables) + usize::from(moments);
        driven.begin(nodal.max(1), 0);
        // The hub takes hardly any time compared to the nodes.
        let watch: &dyn Watch = if nodal > 0 { &Unwatched } else { driven.watch };
        let hub = DrivenModel { watch, ..driven }.hub_spectra()?;
        let motor = driven.motor_spectra(&hub);
        let excess = || hub.excess_angle_rad.iter().zip(driven.omegas_rad_s());
        let hub_rate_rad_s = excess().map(|(e, omega)| e * Complex64::new(0.0, *omega)).collect();
        let accelerations = || excess().map(|(e, omega)| -e * (omega * omega)).collect();
        let hub_acceleration_rad_s2 = tables.then(accelerations);
        let displacements = || {
            let mesh = driven.model.mesh();
            let mut rows = driven.nodal_spectra(&probes.nodes, NodalQuantity::Deflection);
            for (row, node) in rows.iter_mut().zip(&probes.nodes) {
                for (deflection, angle) in row.iter_mut().zip(&hub.excess_angle_rad) {
                    *deflection += angle * mesh.rigid(*node)[0];
                }
            }
            rows
        };
        let displacement_m = tables.then(displacements);
        let moments_n_m = || driven.nodal_spectra(&probes.nodes, NodalQuantity::Moment);
        let moment_n_m = moments.then(moments_n_m);
        Ok(Self {
            hub,
            hub_rate_rad_s,
            hub_acceleration_rad_s2,
            motor,
            displacement_m,
            moment_n_m,
            pair: driven.period.spectrum.band_pair.clone(),
        })
    }

    /// The spectra of each quantity: one, or one for each probe.
    fn spectra(&self) -> PerQuantity<&[Vec<Complex64>]> {
        PerQuantity {
            torque: std::slice::from_ref(&self.hub.torque_n_m),
            hub_angle: std::slice::from_ref(&self.hub.excess_angle_rad),
            hub_rate: std::slice::from_ref(&self.hub_rate_rad_s),
            hub_acceleration: self.hub_acceleration_rad_s2.as_ref().map(std::slice::from_ref),
            displacement: self.displacement_m.as_deref(),
            bending_moment: self.moment_n_m.as_deref(),
            motor_torque: self.motor.as_ref().map(|m| std::slice::from_ref(&m.torque_n_m)),
            motor_rate: self.motor.as_ref().map(|m| std::slice::from_ref(&m.rate_rad_s)),
        }
    }

    /// Largest difference at any time between two answers to the same motion, over the peak of each
    /// quantity.
    pub(super) fn change_to(&self, other: &Self, peaks: &PerQuantity<f64>) -> PerQuantity<f64> {
        let changes = self.spectra().zip(&other.spectra(), |from, to| {
            let rows = from.iter().zip(to).map(|(from, to)| {
                let change: Vec<_> = to.iter().zip(from).map(|(to, from)| to - from).collect();
                self.peak_of(&change)
            });
            rows.fold(0.0, f64::max)
        });
        changes.zip(peaks, |change, peak| if change == 0.0 { 0.0 } else { change / peak })
    }

    fn peak_of(&self, amplitudes: &[Complex64]) -> f64 {
        largest(&self.pair.samples(amplitudes))
    }

    /// Largest distance of the hub angle from its start, in rad.
    fn hub_turn_rad(&self, period: &TipPeriod, length_m: f64) -> f64 {
        let tip = &period.histories;
        let excess_rad = self.pair.samples(&self.hub.excess_angle_rad);
        let (start_m, all) = (tip.start_m(), tip.displacement_m.len());
        let turns = excess_rad.iter().enumerate().filter_map(|(k, excess)| {
            // The sample at or before this time: within a step the tip hardly moves.
            let sample = k * all / excess_rad.len();
            let at_m = tip.displacement_m[sample];
            tip.counts(sample).then(|| ((at_m - start_m) / length_m + excess).abs())
        });
        turns.fold(0.0, f64::max)
    }

    /// Peak of each quantity; the tip's travel for displacements.
    pub(super) fn peaks(&self, period: &TipPeriod, length_m: f64) -> PerQuantity<f64> {
        let of_all = |rows: &Vec<Vec<Complex64>>| {
            rows.iter().map(|row| self.peak_of(row)).fold(0.0, f64::max)
        };
        // The spectrum of a velocity at the ends is without it.
        let [before_m_s, after_m_s] = period.end_velocities_m_s();
        let ends_rad_s = before_m_s.abs().max(after_m_s.abs()) / length_m;
        let with_rigid = |excess: &[Complex64], tip: &[Complex64]| {
            let both: Vec<_> = excess.iter().zip(tip).map(|(e, tip)| e + tip / length_m).collect();
            self.peak_of(&both)
        };
        let (tip, acceleration) = (&period.spectrum, self.hub_acceleration_rad_s2.as_ref());
        let travel_m = || period.histories.largest_travel_m();
        PerQuantity {
            torque: self.peak_of(&self.hub.torque_n_m),
            hub_angle: self.hub_turn_rad(period, length_m),
            hub_rate: with_rigid(&self.hub_rate_rad_s, &tip.velocity_m_s).max(ends_rad_s),
            hub_acceleration: acceleration.map(|a| with_rigid(a, &tip.acceleration_m_s2)),
            displacement: self.displacement_m.is_some().then(travel_m),
            bending_moment: self.moment_n_m.as_ref().map(of_all),
            motor_torque: self.motor.as_ref().map(|motor| self.peak_of(&motor.torque_n_m)),
            motor_rate: self.motor.as_ref().map(|motor| self.peak_of(&motor.rate_rad_s)),
        }
    }
}
