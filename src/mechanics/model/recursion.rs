//! The model of a link: the recursion, or modal superposition if damping or a reduction needs modes.

use std::sync::Arc;

use num_complex::Complex64;

use super::link_on_mesh::{KeptModes, LinkOnMesh, Model, ModelError};
use super::superposition::Superposition;
use crate::beam::{
    Checkpoints, LoadedMotion, Loads, Mesh, NodalQuantity, NodalTransfer, TipTransfer,
    loaded_motion, nodal_transfer, nodal_transfers_from, tip_transfer, tip_transfers,
};
use crate::link::{Damping, Link};
use crate::modal::MOST_ELEMENTS_OF_ALL_MODES;

/// Largest number of elements of an automatic mesh.
const MOST_ELEMENTS: usize = 8192;

/// The model of a link on a mesh: the recursion, or modal superposition for damping through modes and for a reduction
/// to the first modes.
///
/// # Errors
/// [`ModelError`]: impossible damping, more modes than there are, or a mesh too large for damping that needs all modes.
pub fn model_of(link: &Link, mesh: Mesh, kept: KeptModes) -> Result<Arc<dyn Model>, ModelError> {
    check_size(link, mesh.elements().len(), 1)?;
    model_on(LinkOnMesh::new(link, mesh)?, kept)
}

fn model_on(link: LinkOnMesh, kept: KeptModes) -> Result<Arc<dyn Model>, ModelError> {
    Ok(match kept {
        KeptModes::All if !link.law().is_modal() => Arc::new(Recursion::new(link)),
        kept => Arc::new(Superposition::new(link, kept)?),
    })
}

/// Refuses a mesh too large for damping that needs all its modes, before computing any. `elements` is the number of the
/// finest mesh, which is `times` the number asked for.
///
/// # Errors
/// [`ModelError::TooManyElements`].
pub(crate) fn check_size(link: &Link, elements: usize, times: usize) -> Result<(), ModelError> {
    let needs_all = matches!(link.damping(), Damping::Modal { .. } | Damping::Caughey { .. });
    if needs_all && elements > MOST_ELEMENTS_OF_ALL_MODES {
        let (elements, limit) = (elements / times, MOST_ELEMENTS_OF_ALL_MODES / times);
        return Err(ModelError::TooManyElements { elements, limit });
    }
    Ok(())
}

impl dyn Model + '_ {
    /// The model of this link on elements of half the length.
    ///
    /// # Errors
    /// [`ModelError::TooManyElements`] if damping needs all modes of the finer mesh.
    pub fn refined(&self) -> Result<Arc<dyn Model>, ModelError> {
        model_on(self.on_mesh().refined()?, self.kept_modes())
    }

    /// The model of this link with all modes of the mesh.
    ///
    /// # Errors
    /// Those of [`model_of`].
    pub(crate) fn unreduced(&self) -> Result<Arc<dyn Model>, ModelError> {
        model_on(self.on_mesh().clone(), KeptModes::All)
    }

    /// Largest number of elements for refinement.
    pub(crate) fn most_elements(&self) -> usize {
        if self.law().is_modal() { MOST_ELEMENTS_OF_ALL_MODES } else { MOST_ELEMENTS }
    }
}

/// A link with a local damping law, condensed to its hub element by element: exact, with time linear in the number of
/// elements.
#[derive(Debug, Clone)]
struct Recursion {
    link: LinkOnMesh,
}

impl Recursion {
    /// The recursion over a link's mesh.
    ///
    /// # Panics
    /// If the damping law is modal: the recursion has no modes.
    fn new(link: LinkOnMesh) -> Self {
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

    fn loaded_motion(&self, omega_rad_s: f64, loads: &Loads<Complex64>) -> LoadedMotion<Complex64> {
        let (lambda, factors) = (self.law().lambda(omega_rad_s), self.law().factors(omega_rad_s));
        loaded_motion(self.mesh(), lambda, factors, loads)
    }

    fn tip_transfers(&self, omegas_rad_s: &[f64]) -> Vec<TipTransfer> {
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
        nodal_transfers_from(self.mesh(), &lambdas, nodes, quantity, rows, checkpoints);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{LinkParts, uniform};

    #[test]
    fn damping_of_modes_allows_as_many_elements_as_all_modes_are_computed_of_and_no_more() {
        let limit = MOST_ELEMENTS_OF_ALL_MODES;
        let link = |damping| Link::new(LinkParts { damping, ..uniform() }).unwrap();
        let modal = link(Damping::Modal { ratios: vec![0.02] });
        assert_eq!(check_size(&modal, limit, 2), Ok(()));
        let (elements, limit) = (limit / 2 + 1, limit / 2);
        let error = ModelError::TooManyElements { elements, limit };
        assert_eq!(check_size(&modal, 2 * elements, 2), Err(error));
        assert_eq!(check_size(&link(Damping::None), 9 * elements, 2), Ok(()));
    }
}
