//! What a run found: the numbers that a person reads first; results held against each other, or read
//! back.

mod fit;
mod limits;
mod mesh_error;
mod metrics;
mod peak;
mod played;
mod remark;
mod repetition;
mod stored;
mod tip_error;

pub use fit::{Fit, FitError, FitProblem, OpenMotion, Reached, shortest_fit};
pub use limits::{Exceeded, Held, Limits};
pub use mesh_error::{BandMeshError, CoarseMesh, mesh_error, mesh_errors};
pub use metrics::{Metrics, MotorMetrics, TIMING_LEVEL};
pub use peak::Peak;
pub use played::PlayedMetrics;
pub use remark::Remark;
pub use repetition::{LineDifference, Repeated, RepeatedFile, line_difference};
pub use stored::{
    Origin, StoredCheck, StoredInput, StoredNodes, StoredResult, StoredRun, StoredSolution,
    StoredSweep, StoredWarning,
};
pub use tip_error::{LateTarget, TargetError, TipError};
