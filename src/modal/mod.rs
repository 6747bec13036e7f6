//! Natural frequencies of the link and zeros of torque → tip, from the recursion at real λ.

mod frequencies;
mod zeros;

pub use frequencies::{modes_below, natural_frequencies};
pub use zeros::{real_frequency_zeros, torque_zeros};
