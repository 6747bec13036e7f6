//! Direct dynamics: torque in, motion out, in the time domain and independent of the Fourier
//! transform of the inversion.

#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of samples are computed as numbers that are checked to be small and positive"
)]

mod energy;
mod equations;
mod exponential;
mod feedback;
mod forcing;
mod history;
mod hysteretic;
mod play;
mod play_error;
mod reference;
mod residual;
mod selection;
mod simulation;
mod stepper;
mod straight;
#[cfg(test)]
mod tests;
mod torque;
mod warning;

pub use energy::{EnergyAccount, EnergyBalance};
pub use feedback::{Feedback, FeedbackError};
pub use forcing::Interpolation;
pub use history::HistoryError;
pub use play::Play;
pub use play_error::PlayError;
pub use reference::HubReference;
pub use residual::ResidualVibration;
pub use selection::ModeSelection;
pub use simulation::{Simulation, SimulationError, simulate, simulate_on};
pub use torque::Torque;
pub use warning::SimulationWarning;
