use num_complex::Complex64;
use rayon::prelude::*;

use super::solution::{Solution, cut};
use crate::beam::{NodalHistories, NodalQuantity};

/// Spectra that are held at a time; nodes beyond are solved in further blocks, so that thinned
/// histories need little memory.
const BLOCK_BYTES: usize = 1 << 27;

impl Solution {
    /// Deflection w in m from the hub's tangent line at `nodes`, every `every`-th sample.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or `every` is 0.
    pub fn deflections_m(&self, nodes: &[usize], every: usize) -> NodalHistories {
        self.nodal(nodes, every, NodalQuantity::Deflection)
    }

    /// Total displacement `v = xθ + w` in m (Bayo 1987, eq 1) where `deflections` were computed.
    pub fn displacements_m(&self, deflections: &NodalHistories, every: usize) -> NodalHistories {
        let nodes_m = self.mesh().nodes_m();
        let angles: Vec<f64> = self.hub_angle_rad.iter().copied().step_by(every).collect();
        let total = |(node, w): (&usize, &Vec<f64>)| {
            w.iter().zip(&angles).map(|(w, theta)| nodes_m[*node] * theta + w).collect()
        };
        let samples = deflections.nodes.iter().zip(&deflections.samples).map(total).collect();
        NodalHistories { samples, ..deflections.clone() }
    }

    /// Bending moment in N m at `nodes`, every `every`-th sample: what the part of the link towards
    /// the hub exerts on the part towards the tip, positive as the torque is, so that
    /// `EI w'' = −m`. A lumped inertia at a node counts as outer.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or `every` is 0.
    pub fn moments_n_m(&self, nodes: &[usize], every: usize) -> NodalHistories {
        self.nodal(nodes, every, NodalQuantity::Moment)
    }

    fn nodal(&self, nodes: &[usize], every: usize, quantity: NodalQuantity) -> NodalHistories {
        let history = |amplitudes| -> Vec<f64> {
            let period = cut(&self.spectrum.pair.samples(amplitudes), &self.grid);
            period.iter().step_by(every).copied().collect()
        };
        let mut samples = Vec::with_capacity(nodes.len());
        let block = (BLOCK_BYTES / (size_of::<Complex64>() * self.band.frequencies)).max(1);
        for nodes in nodes.chunks(block) {
            let spectra = self.forcing().nodal_spectra(nodes, quantity);
            samples.par_extend(spectra.into_par_iter().map(history));
        }
        NodalHistories { nodes: nodes.to_vec(), grid: self.grid.thinned(every), samples }
    }
}
