//! Numbers of a result that a person reads first, limits and the shortest motion within them, and
//! results read back.

mod arm;
mod arm_play;
mod channels;
mod errors;
mod fit;
mod limits;
mod metrics;
mod noticed;
mod peak;
mod recording;
mod remark;
mod stored;
mod tip_error;
mod torque_table;

pub use arm::{ArmFitProblem, ArmMetrics, JointMetrics, shortest_arm_fit};
pub use arm_play::{ArmPlayMetrics, PlayedJoint};
pub use channels::{ChannelComparison, ChannelFit, Comparison, ComparisonError, NoFit};
pub use errors::{
    BandMeshError, CoarseMesh, HeldModes, LinkZeros, ModesResult, PoseModes, PoseSquares,
    mesh_errors,
};
pub use fit::{Fit, FitError, FitProblem, OpenMotion, shortest_fit};
pub use limits::{Exceeded, LimitedValue, Limits, Reached};
pub use metrics::{Metrics, MotorMetrics, PlayedMetrics, TIMING_LEVEL};
pub use peak::Peak;
pub use recording::{ChannelRecording, SimulatedChannel};
pub use remark::Remark;
pub use stored::{
    LineDifference, Origin, Repeated, RepeatedFile, StoredArm, StoredArmLink, StoredCheck,
    StoredInput, StoredJoint, StoredMotor, StoredNodes, StoredResult, StoredRun, StoredSolution,
    StoredSweep, StoredWarning, line_difference,
};
pub use tip_error::{FollowedTarget, LateTarget, StoredTarget, TargetError, TipError, TipPlaces};
pub use torque_table::TorqueTable;
pub(crate) use torque_table::for_hold;
