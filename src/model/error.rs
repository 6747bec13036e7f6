use thiserror::Error;

use crate::modal::{AllModesError, DampingError, MOST_ELEMENTS_OF_ALL_MODES};
use crate::numeric::significant;

/// Why a valid link has no model on its mesh, or a model no finite answer.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// Damping that cannot be.
    #[error(transparent)]
    Damping(#[from] DampingError),
    /// A reduction to more modes than there are.
    #[error("analysis.modes = {asked}, but must be at most {found}: the mesh has no more modes")]
    NotSoManyModes {
        /// Modes asked for.
        asked: usize,
        /// Flexible modes of the mesh.
        found: usize,
    },
    /// Damping by modes on a mesh too large for all of them.
    #[error(
        "the mesh = {elements} elements, but must be at most {limit} for modal damping: it needs \
         all modes, and dense algebra grows with the cube of their number"
    )]
    TooManyElements {
        /// Elements of the mesh.
        elements: usize,
        /// Elements possible.
        limit: usize,
    },
    /// A frequency at which no torque moves the tip at all, or numbers beyond double precision.
    #[error(
        "the torque at {} Hz = not a finite number, but must be one",
        significant(*frequency_hz, 6)
    )]
    NotFinite {
        /// The frequency in Hz.
        frequency_hz: f64,
    },
}

impl ModelError {
    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Damping(error) => error.hint(),
            Self::NotSoManyModes { .. } => "keep fewer modes, or give the mesh more elements",
            Self::TooManyElements { .. } => {
                "fewer elements, or hysteretic or rayleigh damping, which have no such limit"
            }
            Self::NotFinite { .. } => {
                "no torque moves the tip there (a payload's inertia without damping, or damping that \
                 no wave survives), the mesh is far too coarse, or the inputs are too large for \
                 double precision"
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
