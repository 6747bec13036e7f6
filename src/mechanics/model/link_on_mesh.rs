use std::fmt::Debug;
use std::sync::Arc;

use num_complex::Complex64;
use thiserror::Error;

use crate::beam::{
    Checkpoints, LoadedMotion, Loads, Mesh, NodalQuantity, NodalTransfer, TipTransfer,
};
use crate::link::Link;
use crate::modal::{AllModesError, DampingError, DampingLaw, MOST_ELEMENTS_OF_ALL_MODES};
use crate::text::significant;

/// A link on a mesh, and its damping law with all its numbers. A clone shares the link.
#[derive(Debug, Clone)]
pub struct LinkOnMesh {
    link: Arc<Link>,
    mesh: Mesh,
    law: DampingLaw,
}

impl LinkOnMesh {
    /// Computes the numbers of the link's damping law from the modes of `mesh`.
    ///
    /// # Errors
    /// [`ModelError::Damping`].
    pub fn new(link: &Link, mesh: Mesh) -> Result<Self, ModelError> {
        let law = DampingLaw::of(link, &mesh)?;
        Ok(Self { link: Arc::new(link.clone()), mesh, law })
    }

    /// This link on elements of half the length. Damping through modes follows the modes of the finer mesh, so that the
    /// mesh error includes the change of its coefficients.
    ///
    /// # Errors
    /// [`ModelError::Damping`].
    pub(super) fn refined(&self) -> Result<Self, ModelError> {
        let mesh = self.mesh.refined();
        let law = DampingLaw::on_finer(&self.link, &mesh)?;
        Ok(Self { link: Arc::clone(&self.link), mesh, law })
    }

    /// The link.
    pub fn link(&self) -> &Link {
        &self.link
    }

    /// The mesh.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The damping law with all its numbers.
    pub fn law(&self) -> &DampingLaw {
        &self.law
    }
}

/// Modes of the mesh that a model contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeptModes {
    /// All modes.
    All,
    /// The rigid rotation and the first flexible ones (Bayo 1987, section 5).
    First(usize),
}

/// Transfers from the tip of a link at a frequency ω ≥ 0 in rad/s, for e^{+iωt}.
///
/// The transfers exclude friction and drive of the joint, which act on the hub's motion.
pub trait Model: Debug + Send + Sync {
    /// The link, its mesh and its damping.
    fn on_mesh(&self) -> &LinkOnMesh;

    /// Modes that the model contains.
    fn kept_modes(&self) -> KeptModes {
        KeptModes::All
    }

    /// Moment at the root in kg m by which modal damping opposes the motion of the link, per acceleration of the tip.
    fn root_damping_kg_m(&self, _omega_rad_s: f64) -> Complex64 {
        Complex64::ZERO
    }

    /// Transfers from the tip to torque and hub angle at ω.
    fn tip_transfer(&self, omega_rad_s: f64) -> TipTransfer;

    /// Transfers from the tip to every node at ω.
    fn nodal_transfer(&self, omega_rad_s: f64) -> NodalTransfer;

    /// Torque and deflections that keep the tip on the chord under loads at ω.
    ///
    /// # Panics
    /// If loads and nodes differ in number.
    fn loaded_motion(&self, omega_rad_s: f64, loads: &Loads<Complex64>) -> LoadedMotion<Complex64>;

    /// [`Model::tip_transfer`] at many ω.
    fn tip_transfers(&self, omegas_rad_s: &[f64]) -> Vec<TipTransfer> {
        omegas_rad_s.iter().map(|omega| self.tip_transfer(*omega)).collect()
    }

    /// [`Model::nodal_transfer`] at many ω: a row for each of `nodes` with a value for each ω. With the same
    /// checkpoints, further calls at the same ω pass only through a part of the mesh. Only this crate can construct
    /// checkpoints, and so call this method.
    ///
    /// # Panics
    /// If the mesh lacks a node, a row is shorter than `omegas_rad_s`, or the nodes of a further call are not in the
    /// checkpoints.
    fn nodal_transfers(
        &self,
        omegas_rad_s: &[f64],
        nodes: &[usize],
        quantity: NodalQuantity,
        rows: &mut [&mut [Complex64]],
        _: &mut Checkpoints,
    ) {
        for (column, omega) in omegas_rad_s.iter().enumerate() {
            let transfer = self.nodal_transfer(*omega);
            for (row, node) in rows.iter_mut().zip(nodes) {
                row[column] = transfer.values(quantity)[*node];
            }
        }
    }

    /// The link.
    fn link(&self) -> &Link {
        self.on_mesh().link()
    }

    /// The mesh.
    fn mesh(&self) -> &Mesh {
        self.on_mesh().mesh()
    }

    /// The damping law with all its numbers.
    fn law(&self) -> &DampingLaw {
        self.on_mesh().law()
    }
}

/// Reason why a valid link has no model on its mesh, or a model no finite answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The numbers of the damping contradict each other or the link.
    #[error(transparent)]
    Damping(#[from] DampingError),
    /// A reduction keeps more modes than there are.
    #[error("analysis.modes = {asked}, but must be at most {found}: the mesh has no more modes")]
    NotSoManyModes {
        /// Modes to keep.
        asked: usize,
        /// Number of flexible modes of the mesh.
        found: usize,
    },
    /// Damping by modes needs all modes of a mesh that is too large.
    #[error(
        "the mesh has {elements} elements, but must have at most {limit} for modal damping, which needs all modes: \
         dense algebra grows with the cube of their number"
    )]
    TooManyElements {
        /// Number of elements of the mesh.
        elements: usize,
        /// Largest possible number of elements.
        limit: usize,
    },
    /// No torque moves the tip at this frequency, or numbers exceed double precision.
    #[error("the torque at {} Hz is not a finite number", significant(*frequency_hz, 6))]
    NotFinite {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
}

impl ModelError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Damping(error) => error.hint(),
            Self::NotSoManyModes { .. } => "keep fewer modes, or give the mesh more elements",
            Self::TooManyElements { .. } => {
                "use fewer elements, or hysteretic or rayleigh damping, which have no such limit"
            }
            Self::NotFinite { .. } => {
                "look for a payload's inertia without damping, damping that absorbs every wave, a mesh far too \
                 coarse, or inputs too large for double precision"
            }
        }
    }
}

impl From<AllModesError> for ModelError {
    fn from(error: AllModesError) -> Self {
        match error {
            AllModesError::TooManyElements { elements } => {
                Self::TooManyElements { elements, limit: MOST_ELEMENTS_OF_ALL_MODES }
            }
            AllModesError::NotFinite => Self::NotFinite { frequency_hz: 0.0 },
        }
    }
}
