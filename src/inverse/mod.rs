//! From the tip's motion to the hub torque: the frequency-domain inversion (Bayo 1987, eqs 13-21).

mod analysis;
mod error;
mod inversion;
mod law;
mod nodal;
mod period;
mod refinement;
mod rigid;
mod solution;
mod spectra;
mod warning;

pub use analysis::Analysis;
pub use error::InversionError;
pub use inversion::invert;
pub use law::DampingLaw;
pub use nodal::NodalHistories;
pub use solution::{Accuracy, Band, Solution, TipMotionHistories};
pub use warning::Warning;
