//! Direct dynamics: torque in, motion out, in the time domain and independent of the Fourier
//! transform of the inversion.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples are computed as numbers that are checked to be small and positive"
)]

mod energy;
mod equations;
mod error;
mod feedback;
mod history;
mod play;
mod play_error;
mod record;
mod replay;
mod residual;
mod selection;
mod simulation;
mod stepper;
mod warning;

pub use energy::{EnergyAccount, EnergyBalance};
pub use error::SimulationError;
pub use feedback::{Feedback, FeedbackError};
pub use history::{HistoryError, HubReference, Torque};
pub use play::{Interpolation, Play};
pub use play_error::PlayError;
pub use residual::ResidualVibration;
pub use selection::ModeSelection;
pub use simulation::{Simulation, simulate, simulate_on};
pub use warning::SimulationWarning;
