//! Direct dynamics: torque or hub motion in, motion out, in the time domain and independent of the Fourier
//! transform of the inversion.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples are computed as numbers that are checked to be small and positive"
)]

mod arm_space;
mod balance;
mod bent;
mod chain;
mod checks;
mod driver;
mod driving;
mod error;
mod history;
mod linear;
mod link_ratios;
mod link_space;
mod linkage;
mod losses;
mod modes;
mod play;
mod played;
mod pose;
mod pose_modes;
mod radau;
mod residual;
mod sensed;
mod shape;
mod simulation;
mod state;
mod state_space;
mod stepper;
mod tip;

pub use bent::{BentPlay, JointMotion};
pub use checks::{EnergyAccount, EnergyBalance, PlayError};
pub use driving::{CycleError, Interpolation};
pub use error::{SimulationError, SimulationWarning};
pub use history::{Feedback, HistoryError, HubReference, Torque};
pub use link_ratios::damping_ratios;
pub use link_space::link_state_space;
pub use modes::ModeSelection;
pub use play::{Input, Play, PlayProgress};
pub use played::{ModalPlay, Played, PlayedBy, PlayedLink};
pub use pose::{ArmPose, ArmResponse, PoseError, Start, TorqueResponse, reached};
pub use pose_modes::{
    ArmModes, ArmResponses, ArmShapes, PoseMode, SettledModes, arm_modes, arm_responses,
};
pub(crate) use pose_modes::{MORE_ORDERS, MOST_REFINEMENTS};
pub use residual::{PlayedModelError, ResidualVibration};
pub(crate) use sensed::{Driven, sensed};
pub(crate) use simulation::simulate_on;
pub use simulation::{MovedJoint, move_arm, simulate};
pub use state::{LinkState, State};
pub use state_space::{ModeChoice, Signal, StateSpace, StateSpaceScope};
pub use tip::{PlayedTip, Ringing, TipCourse, simulate_once, simulate_tip};
