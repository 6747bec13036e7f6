//! Natural frequencies and mode shapes of the link, and zeros of torque → tip, from the recursion at real λ.

mod frequencies;
mod inertia;
mod shapes;
mod zeros;

pub use frequencies::{held_frequencies, modes_below, natural_frequencies};
pub use shapes::{ModeShape, mode_shape};
pub use zeros::{real_frequency_zeros, torque_zeros};
