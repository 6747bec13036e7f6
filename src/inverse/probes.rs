//! The amplitudes of all that is written, on one mesh, and what another mesh changes of it.

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::spectra::{Forcing, HubSpectra, MotorSpectra};
use super::watch::{Unwatched, Watch};
use crate::beam::{Mesh, NodalQuantity};
use crate::model::ModelError;
use crate::motion::{TipHistories, TipSpectrum};
use crate::numeric::{FourierPair, fast_length, largest};

/// Most nodes that stand for all: a wave between two of them is beyond what the mesh follows.
const MOST_NODES: usize = 8;

/// Which quantities are measured besides torques and the hub's angle and rate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wanted {
    /// What tables over time hold: displacements of the nodes, the hub's acceleration.
    pub(super) tables: bool,
    /// Bending moments along the link.
    pub(super) moments: bool,
}

/// Nodes at which displacements and moments are measured.
#[derive(Debug, Clone)]
pub(super) struct Probes {
    nodes: Vec<usize>,
    wanted: Wanted,
}

/// Amplitudes over the band on one mesh.
pub(super) struct Amplitudes {
    pub(super) hub: HubSpectra,
    /// Hub rate in rad/s, and acceleration in rad/s² where it is wanted, less those of a rigid link.
    hub_rate_rad_s: Vec<Complex64>,
    hub_acceleration_rad_s2: Option<Vec<Complex64>>,
    /// Torque of the motor in N m and its rate in rad/s, where there is a drive.
    pub(super) motor: Option<MotorSpectra>,
    /// Displacement less that of a rigid link, `v − x v_tip/L`, at the probes in m, where it is
    /// wanted.
    displacement_m: Option<Vec<Vec<Complex64>>>,
    /// Bending moment at the probes in N m, where it is wanted.
    moment_n_m: Option<Vec<Vec<Complex64>>>,
    /// A transform with twice the samples that the band needs: a peak at the cut-off is found to within a
    /// seventh of itself, at the end of the roll-off to within three tenths.
    pair: FourierPair,
}

impl Probes {
    /// Evenly spread nodes of a mesh, the tip left out: it moves as wanted on every mesh.
    pub(super) fn of(mesh: &Mesh, wanted: Wanted) -> Self {
        let inner = mesh.nodes_m().len() - 1;
        let count = inner.min(MOST_NODES);
        // The root as well: moments are largest there, and it moves where the hub has a radius.
        let nodes = (0..count).map(|k| k * inner / count).collect();
        Self { nodes, wanted }
    }

    /// The same places on the mesh whose elements are half as long.
    pub(super) fn refined(&self) -> Self {
        Self { nodes: self.nodes.iter().map(|node| 2 * node).collect(), ..*self }
    }
}

impl Amplitudes {
    /// Solves for all of them.
    ///
    /// # Errors
    /// As [`Forcing::hub_spectra`].
    pub(super) fn of(forcing: Forcing<'_>, probes: &Probes) -> Result<Self, ModelError> {
        let Wanted { tables, moments } = probes.wanted;
        let nodal = usize::from(tables) + usize::from(moments);
        forcing.begin(nodal.max(1), 0);
        // Beside the nodes the hub takes next to no time.
        let watch: &dyn Watch = if nodal > 0 { &Unwatched } else { forcing.watch };
        let hub = Forcing { watch, ..forcing }.hub_spectra()?;
        let motor = forcing.motor_spectra(&hub);
        let excess = || hub.excess_angle_rad.iter().zip(forcing.omegas_rad_s());
        let hub_rate_rad_s = excess().map(|(e, omega)| e * Complex64::new(0.0, *omega)).collect();
        let accelerations = || excess().map(|(e, omega)| -e * (omega * omega)).collect();
        let hub_acceleration_rad_s2 = tables.then(accelerations);
        let displacements = || {
            let nodes_m = forcing.model.mesh().nodes_m();
            let mut rows = forcing.nodal_spectra(&probes.nodes, NodalQuantity::Deflection);
            for (row, node) in rows.iter_mut().zip(&probes.nodes) {
                for (deflection, angle) in row.iter_mut().zip(&hub.excess_angle_rad) {
                    *deflection += angle * nodes_m[*node];
                }
            }
            rows
        };
        let displacement_m = tables.then(displacements);
        let moments_n_m = || forcing.nodal_spectra(&probes.nodes, NodalQuantity::Moment);
        let moment_n_m = moments.then(moments_n_m);
        let coarse = fast_length(4 * hub.torque_n_m.len());
        let whole = &forcing.spectrum.pair;
        let pair = if coarse < whole.len() { FourierPair::new(coarse) } else { whole.clone() };
        Ok(Self {
            hub,
            hub_rate_rad_s,
            hub_acceleration_rad_s2,
            motor,
            displacement_m,
            moment_n_m,
            pair,
        })
    }

    /// What stands for each quantity: one spectrum, or one for each probe.
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

    /// Largest difference at any time of each quantity between two answers to the same motion.
    pub(super) fn change_to(&self, other: &Self) -> PerQuantity<f64> {
        self.spectra().zip(&other.spectra(), |from, to| {
            let rows = from.iter().zip(to).map(|(from, to)| {
                let change: Vec<_> = to.iter().zip(from).map(|(to, from)| to - from).collect();
                self.peak_of(&change)
            });
            rows.fold(0.0, f64::max)
        })
    }

    fn peak_of(&self, amplitudes: &[Complex64]) -> f64 {
        largest(&self.pair.samples(amplitudes))
    }

    /// Largest distance of the hub angle from where it starts, in rad.
    fn hub_turn_rad(&self, tip: &TipHistories, length_m: f64) -> f64 {
        let excess_rad = self.pair.samples(&self.hub.excess_angle_rad);
        let (start_m, all) = (tip.start_m(), tip.displacement_m.len());
        let turns = excess_rad.iter().enumerate().map(|(k, excess)| {
            // The sample at or before this time: within a step the tip does not go far.
            let at_m = tip.displacement_m[k * all / excess_rad.len()];
            ((at_m - start_m) / length_m + excess).abs()
        });
        turns.fold(0.0, f64::max)
    }

    /// Peak of each quantity; the tip's way stands for the farthest that a node goes.
    pub(super) fn peaks(
        &self,
        tip: &TipSpectrum,
        histories: &TipHistories,
        length_m: f64,
    ) -> PerQuantity<f64> {
        let of_all = |rows: &Vec<Vec<Complex64>>| {
            rows.iter().map(|row| self.peak_of(row)).fold(0.0, f64::max)
        };
        let with_rigid = |excess: &[Complex64], tip: &[Complex64]| {
            let both: Vec<_> = excess.iter().zip(tip).map(|(e, tip)| e + tip / length_m).collect();
            self.peak_of(&both)
        };
        let acceleration = self.hub_acceleration_rad_s2.as_ref();
        PerQuantity {
            torque: self.peak_of(&self.hub.torque_n_m),
            hub_angle: self.hub_turn_rad(histories, length_m),
            hub_rate: with_rigid(&self.hub_rate_rad_s, &tip.velocity_m_s),
            hub_acceleration: acceleration.map(|a| with_rigid(a, &tip.acceleration_m_s2)),
            displacement: self.displacement_m.is_some().then(|| histories.largest_travel_m()),
            bending_moment: self.moment_n_m.as_ref().map(of_all),
            motor_torque: self.motor.as_ref().map(|motor| self.peak_of(&motor.torque_n_m)),
            motor_rate: self.motor.as_ref().map(|motor| self.peak_of(&motor.rate_rad_s)),
        }
    }
}
