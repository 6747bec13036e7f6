//! The amplitudes of all that is written, on one mesh, and what another mesh changes of it.

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::error::InversionError;
use super::spectra::{Forcing, HubSpectra};
use crate::beam::{Mesh, NodalQuantity};
use crate::numeric::{FourierPair, fast_length, largest};

/// Most nodes that stand for all: a wave between two of them is beyond what the mesh follows.
const MOST_NODES: usize = 8;

/// Which quantities along the link are measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct AlongLink {
    pub(super) displacements: bool,
    pub(super) moments: bool,
}

/// Nodes at which displacements and moments are measured.
#[derive(Debug, Clone)]
pub(super) struct Probes {
    nodes: Vec<usize>,
    measured: AlongLink,
}

/// Amplitudes over the band on one mesh.
pub(super) struct Amplitudes {
    pub(super) hub: HubSpectra,
    /// Torque of the motor in N m, where there is a drive.
    pub(super) motor_torque_n_m: Option<Vec<Complex64>>,
    /// Displacement less that of a rigid link, `v − x v_tip/L`, at the probes in m, where it is asked
    /// for.
    displacement_m: Option<Vec<Vec<Complex64>>>,
    /// Bending moment at the probes in N m, where it is asked for.
    moment_n_m: Option<Vec<Vec<Complex64>>>,
    /// A transform with four times the samples that the band needs: enough to tell a peak.
    pair: FourierPair,
}

impl Probes {
    /// Evenly spread nodes of a mesh, the tip left out: it moves as wanted on every mesh.
    pub(super) fn of(mesh: &Mesh, measured: AlongLink) -> Self {
        let inner = mesh.nodes_m().len() - 1;
        let count = inner.min(MOST_NODES);
        // The root as well: moments are largest there, and it moves where the hub has a radius.
        let nodes = (0..count).map(|k| k * inner / count).collect();
        Self { nodes, measured }
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
    pub(super) fn of(forcing: Forcing<'_>, probes: &Probes) -> Result<Self, InversionError> {
        let hub = forcing.hub_spectra()?;
        let motor_torque_n_m = forcing.motor_torque_n_m(&hub);
        let displacements = || {
            let nodes_m = forcing.dynamics.mesh().nodes_m();
            let mut rows = forcing.nodal_spectra(&probes.nodes, NodalQuantity::Deflection);
            for (row, node) in rows.iter_mut().zip(&probes.nodes) {
                for (deflection, angle) in row.iter_mut().zip(&hub.excess_angle_rad) {
                    *deflection += angle * nodes_m[*node];
                }
            }
            rows
        };
        let displacement_m = probes.measured.displacements.then(displacements);
        let moments = || forcing.nodal_spectra(&probes.nodes, NodalQuantity::Moment);
        let moment_n_m = probes.measured.moments.then(moments);
        let coarse = fast_length(8 * hub.torque_n_m.len());
        let whole = &forcing.spectrum.pair;
        let pair = if coarse < whole.len() { FourierPair::new(coarse) } else { whole.clone() };
        Ok(Self { hub, motor_torque_n_m, displacement_m, moment_n_m, pair })
    }

    /// What stands for each quantity: one spectrum, or one for each probe.
    fn spectra(&self) -> PerQuantity<&[Vec<Complex64>]> {
        PerQuantity {
            torque: std::slice::from_ref(&self.hub.torque_n_m),
            hub_angle: std::slice::from_ref(&self.hub.excess_angle_rad),
            displacement: self.displacement_m.as_deref(),
            bending_moment: self.moment_n_m.as_deref(),
            motor_torque: self.motor_torque_n_m.as_ref().map(std::slice::from_ref),
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

    /// Peaks of torques and moments. Of the others `hub_angle` and `displacement` are the peaks: these
    /// amplitudes are what they differ by from those of a rigid link.
    pub(super) fn peaks(&self, hub_angle: f64, displacement: f64) -> PerQuantity<f64> {
        let of_all = |rows: &Vec<Vec<Complex64>>| {
            rows.iter().map(|row| self.peak_of(row)).fold(0.0, f64::max)
        };
        PerQuantity {
            torque: self.peak_of(&self.hub.torque_n_m),
            hub_angle,
            displacement: self.displacement_m.is_some().then_some(displacement),
            bending_moment: self.moment_n_m.as_ref().map(of_all),
            motor_torque: self.motor_torque_n_m.as_deref().map(|row| self.peak_of(row)),
        }
    }
}
