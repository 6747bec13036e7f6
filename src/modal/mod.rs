//! Natural frequencies and modes of the link, from the recursion at real λ or all at once by dense
//! algebra, and zeros of torque → tip.

mod basis;
mod caughey;
mod complete;
mod frequencies;
mod hub_spring;
mod inertia;
mod law;
mod shape;
mod thickness;
mod zeros;

pub use basis::ModalBasis;
pub use caughey::CaugheySeries;
pub use complete::{AllModesError, MOST_ELEMENTS_OF_ALL_MODES};
pub use frequencies::{
    REPORTED_MODES, clamped_frequency_below, held_frequencies, natural_frequencies,
};
pub use hub_spring::modes_below;
pub use inertia::{carries_rotary_inertia, flexible_modes, hub_moves_mass};
pub use law::{DampingError, DampingLaw};
pub use shape::{Mode, Shape, mode};
pub use thickness::{LoweredMode, NOTICEABLE, ThickLink, Thickness};
pub use zeros::{REPORTED_ZEROS, real_frequency_zeros, torque_zeros};
