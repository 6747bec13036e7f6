//! Numbers of a result that a person reads first, limits and the shortest motion within them, and
//! results read back.

mod fit;
mod limits;
mod mesh_error;
mod metrics;
mod peak;
mod remark;
mod repetition;
mod stored;
mod tip_error;

pub use fit::{Fit, FitError, FitProblem, OpenMotion, shortest_fit};
pub use limits::{Exceeded, LimitedValue, Limits, Reached};
pub use mesh_error::{BandMeshError, CoarseMesh, mesh_error, mesh_errors};
pub use metrics::{Metrics, MotorMetrics, PlayedMetrics, TIMING_LEVEL};
pub use peak::Peak;
pub use remark::Remark;
pub use repetition::{LineDifference, Repeated, RepeatedFile, line_difference};
pub use stored::{
    Origin, StoredCheck, StoredInput, StoredNodes, StoredResult, StoredRun, StoredSolution,
    StoredSweep, StoredWarning,
};
pub use tip_error::{LateTarget, TargetError, TipError};
