use num_complex::Complex64;

use super::link_on_mesh::{LinkOnMesh, Model};
use crate::beam::{
    Checkpoints, NodalQuantity, NodalTransfer, TipTransfer, TipTransfers, nodal_transfer,
    nodal_transfers, tip_transfer, tip_transfers,
};

/// A link with a local damping law, condensed to its hub element by element: exact, and linear in the
/// number of elements.
#[derive(Debug, Clone)]
pub struct Recursion {
    link: LinkOnMesh,
}

impl Recursion {
    /// The recursion over a link's mesh.
    ///
    /// # Panics
    /// If the damping law is modal: the recursion knows no modes.
    pub fn new(link: LinkOnMesh) -> Self {
        assert!(!link.law().is_modal(), "a modal law needs modal superposition");
        Self { link }
    }

    fn lambdas(&self, omegas_rad_s: &[f64]) -> Vec<Complex64> {
        let lambda = self.law().lambdas();
        omegas_rad_s.iter().map(|omega| lambda(*omega)).collect()
    }
}

impl Model for Recursion {
    fn on_mesh(&self) -> &LinkOnMesh {
        &self.link
    }

    fn tip_transfer(&self, omega_rad_s: f64) -> TipTransfer {
        tip_transfer(self.mesh(), self.law().lambda(omega_rad_s))
    }

    fn nodal_transfer(&self, omega_rad_s: f64) -> NodalTransfer {
        nodal_transfer(self.mesh(), self.law().lambda(omega_rad_s))
    }

    fn tip_transfers(&self, omegas_rad_s: &[f64]) -> TipTransfers {
        tip_transfers(self.mesh(), &self.lambdas(omegas_rad_s))
    }

    fn nodal_transfers(
        &self,
        omegas_rad_s: &[f64],
        nodes: &[usize],
        quantity: NodalQuantity,
        rows: &mut [&mut [Complex64]],
        checkpoints: &mut Checkpoints,
    ) {
        let lambdas = self.lambdas(omegas_rad_s);
        nodal_transfers(self.mesh(), &lambdas, nodes, quantity, rows, checkpoints);
    }
}
