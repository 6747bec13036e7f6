//! Numbers of a result that a person reads first, limits and the shortest motion within them, and results from
//! folders.

mod channels;
mod drive_unit;
mod errors;
mod fit;
mod limits;
mod metrics;
mod modes;
mod peak;
mod quantities;
mod remark;
mod set_points;
mod stored;
mod tip_error;

pub use channels::{
    ChannelComparison, ChannelFit, ChannelRecording, Comparison, ComparisonError, NoFit,
    SimulatedChannel,
};
pub use drive_unit::{DriveUnit, SetPoint, UnitChoice};
pub use errors::{BandMeshError, CoarseMesh, Refined, mesh_errors};
pub use fit::{Along, Fit, FitError, FitProblem, OpenMotion, shortest_fit, solved};
pub use limits::{Check, Exceeded, LimitedValue, Limits, Reached, reached};
pub use metrics::{
    JointMetrics, Metrics, MotorMetrics, MotorPeaks, PlayedJoint, PlayedMetrics, TIMING_LEVEL,
};
pub use modes::{LinkZeros, ModesResult, Setting};
pub use peak::Peak;
pub(crate) use quantities::by_name;
pub use quantities::{JointQuantity, QUANTITIES, Shown, Unit};
pub use remark::{NO_DIRECTION, Remark};
pub(crate) use set_points::for_hold;
pub use set_points::{Held, SetPointColumn, SetPointError, SetPoints, Side};
pub use stored::{
    LineDifference, Notice, Origin, Repeated, RepeatedFile, StoredArc, StoredCarriage, StoredInput,
    StoredJoint, StoredLink, StoredMotor, StoredNodes, StoredRun, StoredSweep, line_difference,
};
pub use tip_error::{FollowedTarget, LateTarget, StoredTarget, TargetError, TipError, TipPlaces};
