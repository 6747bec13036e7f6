//! The amplitudes of all that is written, on one mesh, and what another mesh changes of it.

use num_complex::Complex64;

use super::accuracy::PerQuantity;
use super::error::InversionError;
use super::spectra::{Forcing, HubSpectra};
use crate::beam::{Mesh, NodalQuantity};
use crate::numeric::{FourierPair, fast_length, largest};

/// Most nodes that stand for all: a wave between two of them is beyond what the mesh follows.
const MOST_NODES: usize = 8;

/// Nodes at which displacements and moments are measured.
#[derive(Debug, Clone)]
pub(super) struct Probes {
    nodes: Vec<usize>,
    with_moments: bool,
}

/// Amplitudes over the band on one mesh.
pub(super) struct Amplitudes {
    pub(super) hub: HubSpectra,
    /// Torque of the motor in N m, where there is a drive.
    pub(super) motor_torque_n_m: Option<Vec<Complex64>>,
    /// Displacement less that of a rigid link, `v − x v_tip/L`, at the probes in m.
    displacement_m: Vec<Vec<Complex64>>,
    /// Bending moment at the probes in N m, where it is asked for.
    moment_n_m: Option<Vec<Vec<Complex64>>>,
    /// A transform with four times the samples that the band needs: enough to tell a peak.
    pair: FourierPair,
}

impl Probes {
    /// Evenly spread nodes of a mesh, the tip left out: it moves as wanted on every mesh.
    pub(super) fn of(mesh: &Mesh, with_moments: bool) -> Self {
        let inner = mesh.nodes_m().len() - 1;
        let count = inner.min(MOST_NODES);
        // The root as well: moments are largest there, and it moves where the hub has a radius.
        let nodes = (0..count).map(|k| k * inner / count).collect();
        Self { nodes, with_moments }
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
        let nodes_m = forcing.dynamics.mesh().nodes_m();
        let mut displacement_m = forcing.nodal_spectra(&probes.nodes, NodalQuantity::Deflection);
        for (row, node) in displacement_m.iter_mut().zip(&probes.nodes) {
            for (deflection, angle) in row.iter_mut().zip(&hub.excess_angle_rad) {
                *deflection += angle * nodes_m[*node];
            }
        }
        let moments = || forcing.nodal_spectra(&probes.nodes, NodalQuantity::Moment);
        let moment_n_m = probes.with_moments.then(moments);
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
            displacement: &self.displacement_m,
            bending_moment: self.moment_n_m.as_deref(),
            motor_torque: self.motor_torque_n_m.as_ref().map(std::slice::from_ref),
        }
    }

    /// Largest difference at any time of each quantity between two answers to the same motion.
    pub(super) fn change_to(&self, other: &Self) -> PerQuantity<f64> {
        self.spectra().zip(&other.spectra(), |from, to| {
            let rows = from.iter().zip(to).map(|(from, to)| {
                let change: Vec<_> = to.iter().zip(from).map(|(to, from)| to - from).collect();
                largest(&self.pair.samples(change))
            });
            rows.fold(0.0, f64::max)
        })
    }

    /// Largest value of each quantity that has no rigid part: torques and moments; the others are
    /// what they differ from those of a rigid link.
    pub(super) fn peaks(&self) -> PerQuantity<f64> {
        let spectra = self.spectra();
        spectra.zip(&spectra, |rows, _| {
            rows.iter().map(|row| largest(&self.pair.samples(row))).fold(0.0, f64::max)
        })
    }
}
