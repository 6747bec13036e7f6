use num_complex::Complex64;

use super::analysis::Analysis;
use super::error::InversionError;
use super::superposition::Superposition;
use crate::beam::{
    Mesh, NodalQuantity, NodalTransfer, TipTransfer, TipTransfers, nodal_transfer, nodal_transfers,
    tip_transfer, tip_transfers,
};
use crate::link::{Damping, Link};
use crate::modal::{DampingLaw, MOST_ELEMENTS_OF_ALL_MODES};

/// The link on a mesh with its damping: what it answers at one frequency.
///
/// A link with a local damping law is condensed by the recursion. Modal laws, and a link reduced to
/// few modes, are summed up mode by mode:
///
/// ```text
/// x/T = φ₀p₀/(−ω²) + Σ φ_k p_k/(ω_k² − ω² + 2iζ_kω_kω)            (Bayo 1987, eqs 11 and 12)
/// ```
#[derive(Debug, Clone)]
pub struct Dynamics {
    mesh: Mesh,
    damping: Damping,
    law: DampingLaw,
    kept: KeptModes,
    modes: Option<Superposition>,
}

/// Elements that an automatic mesh is not refined beyond.
const MOST_ELEMENTS: usize = 8192;

/// How many modes of the mesh answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeptModes {
    /// All of them.
    All,
    /// The rigid rotation and the first flexible ones (Bayo 1987, section 5).
    First(usize),
}

impl KeptModes {
    /// What an analysis asks for.
    pub fn of(analysis: &Analysis) -> Self {
        analysis.modes().map_or(Self::All, Self::First)
    }
}

impl Dynamics {
    /// Prepares the answers of a link on a mesh.
    ///
    /// # Errors
    /// Damping that cannot be, more modes than there are, or a mesh too large for all its modes
    /// where damping needs them.
    pub fn new(link: &Link, mesh: Mesh, kept: KeptModes) -> Result<Self, InversionError> {
        Self::check_size(link, mesh.elements().len(), 1)?;
        let law = DampingLaw::of(link.damping(), &mesh)?;
        Self::on(mesh, link.damping().clone(), law, kept)
    }

    /// Refuses a mesh too large for damping that needs all its modes, before any is sought;
    /// `elements` of the finest mesh, which has `times` those of the one asked for.
    pub(super) fn check_size(
        link: &Link,
        elements: usize,
        times: usize,
    ) -> Result<(), InversionError> {
        let needs_all = matches!(link.damping(), Damping::Modal { .. } | Damping::Caughey { .. });
        if needs_all && elements > MOST_ELEMENTS_OF_ALL_MODES {
            let (elements, limit) = (elements / times, MOST_ELEMENTS_OF_ALL_MODES / times);
            return Err(InversionError::TooManyElements { elements, limit });
        }
        Ok(())
    }

    fn on(
        mesh: Mesh,
        damping: Damping,
        law: DampingLaw,
        kept: KeptModes,
    ) -> Result<Self, InversionError> {
        let modes = match kept {
            KeptModes::All if !law.is_modal() => None,
            KeptModes::All => Some(Superposition::of_all(&mesh)?),
            KeptModes::First(count) => Some(Superposition::of_first(&mesh, count)?),
        };
        Ok(Self { mesh, damping, law, kept, modes })
    }

    /// The same link on elements of half the length. Damping through modes follows the modes of the
    /// finer mesh, so that the mesh error counts what its coefficients change.
    ///
    /// # Errors
    /// [`InversionError::TooManyElements`] where damping needs all modes of the finer mesh.
    pub(super) fn refined(&self) -> Result<Self, InversionError> {
        let mesh = self.mesh.refined();
        let law = DampingLaw::on_finer(&self.damping, &mesh)?;
        Self::on(mesh, self.damping.clone(), law, self.kept)
    }

    /// The same link with all modes of the mesh.
    ///
    /// # Errors
    /// As [`Dynamics::new`].
    pub(super) fn unreduced(&self) -> Result<Self, InversionError> {
        Self::on(self.mesh.clone(), self.damping.clone(), self.law.clone(), KeptModes::All)
    }

    /// How many modes answer.
    pub fn kept_modes(&self) -> KeptModes {
        self.kept
    }

    /// Elements that the mesh may be refined to.
    pub(super) fn most_elements(&self) -> usize {
        if self.law.is_modal() { MOST_ELEMENTS_OF_ALL_MODES } else { MOST_ELEMENTS }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        &self.law
    }

    /// Transfers from the tip to torque and hub angle at ω ≥ 0.
    pub fn tip_transfer(&self, omega_rad_s: f64) -> TipTransfer {
        match &self.modes {
            None => tip_transfer(&self.mesh, self.law.lambda(omega_rad_s)),
            Some(modes) => modes.tip_transfer(self, omega_rad_s),
        }
    }

    /// Transfers from the tip to every node at ω ≥ 0.
    pub fn nodal_transfer(&self, omega_rad_s: f64) -> NodalTransfer {
        match &self.modes {
            None => nodal_transfer(&self.mesh, self.law.lambda(omega_rad_s)),
            Some(modes) => modes.nodal_transfer(self, omega_rad_s),
        }
    }

    /// [`Dynamics::tip_transfer`] at many ω ≥ 0.
    pub fn tip_transfers(&self, omegas_rad_s: &[f64]) -> TipTransfers {
        match &self.modes {
            None => tip_transfers(&self.mesh, &self.lambdas(omegas_rad_s)),
            Some(modes) => omegas_rad_s.iter().map(|w| modes.tip_transfer(self, *w)).collect(),
        }
    }

    /// [`Dynamics::nodal_transfer`] at many ω ≥ 0: a row for each of `nodes`, in it a value for
    /// each ω.
    ///
    /// # Panics
    /// If a node is not one of the mesh, or a row is shorter than `omegas_rad_s`.
    pub fn nodal_transfers(
        &self,
        omegas_rad_s: &[f64],
        nodes: &[usize],
        quantity: NodalQuantity,
        rows: &mut [&mut [Complex64]],
    ) {
        let Some(modes) = &self.modes else {
            let lambdas = self.lambdas(omegas_rad_s);
            return nodal_transfers(&self.mesh, &lambdas, nodes, quantity, rows);
        };
        for (column, omega) in omegas_rad_s.iter().enumerate() {
            let transfer = modes.nodal_transfer(self, *omega);
            for (row, node) in rows.iter_mut().zip(nodes) {
                row[column] = transfer.values(quantity)[*node];
            }
        }
    }

    fn lambdas(&self, omegas_rad_s: &[f64]) -> Vec<Complex64> {
        let lambda = self.law.lambdas();
        omegas_rad_s.iter().map(|omega| lambda(*omega)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{LinkParts, uniform};

    #[test]
    fn damping_of_modes_allows_as_many_elements_as_all_modes_are_sought_of_and_no_more() {
        let limit = MOST_ELEMENTS_OF_ALL_MODES;
        let link = |damping| Link::new(LinkParts { damping, ..uniform() }).unwrap();
        let modal = link(Damping::Modal { ratios: vec![0.02] });
        assert_eq!(Dynamics::check_size(&modal, limit, 2), Ok(()));
        let (elements, limit) = (limit / 2 + 1, limit / 2);
        let error = InversionError::TooManyElements { elements, limit };
        assert_eq!(Dynamics::check_size(&modal, 2 * elements, 2), Err(error));
        assert_eq!(Dynamics::check_size(&link(Damping::None), 9 * elements, 2), Ok(()));
    }
}
