//! Natural frequencies and modes of the link, by the recursion at real λ or all at once by dense algebra, and zeros of
//! torque → tip.

mod basis;
mod frequencies;
mod law;
mod pose;
mod shape;
mod thickness;

pub use basis::{AllModesError, MOST_ELEMENTS_OF_ALL_MODES, ModalBasis};
pub use frequencies::{
    REPORTED_MODES, REPORTED_ZEROS, held_frequencies, modes_below, natural_frequencies,
    real_frequency_zeros, torque_zeros,
};
pub(crate) use frequencies::{
    TORQUE_WEIGHTS, deflection_weights, flexible_modes, hub_moves_mass, second_order_share,
};
pub use law::{CaugheySeries, DampingError, DampingLaw};
pub(crate) use pose::root_pull;
pub use pose::{
    MOST_ELEMENTS_OF_A_POSE, PoseHub, WeighedLink, buckling_share, pose_modes, pose_zeros,
    reported_blocked, reported_frequencies, reported_zeros, reports_weight,
};
pub use shape::{Mode, Shape, mode};
pub use thickness::{LoweredMode, NOTICEABLE, ThickLink, Thickness};
