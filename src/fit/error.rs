use thiserror::Error;

use super::measurement::Observable;
use crate::link::ParameterError;

/// Why no link can be fitted.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LinkFitError<E> {
    /// The file's own values make no link.
    #[error("{0}")]
    Link(E),
    /// The plan of the mesh is not the link's.
    #[error("{0}")]
    Plan(#[from] ParameterError),
    /// The link has not as many modes as were measured.
    #[error("{0} was measured, but the link has no such mode")]
    NoMode(Observable),
    /// The link has no response or history on a fine mesh.
    #[error(
        "the link has nothing to compare with the measurements: its hub moves no mass, or its damping by \
         modes allows no mesh that is fine enough"
    )]
    NoModel,
    /// Responses and records are computed at the hub.
    #[error(
        "[drive] is in the link file, but responses and records are those of the link at its hub, without it"
    )]
    Drive,
    /// The damping of the link is zero or has another law.
    #[error("{0} was measured, but the link has no damping: [damping] must give one")]
    NoDamping(Observable),
}
