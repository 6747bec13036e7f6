//! Torque in, motion out, in the time domain and independent of the FFT.

mod history;
mod reference;
#[cfg(test)]
mod tests;
mod torque;

pub use history::HistoryError;
pub use reference::HubReference;
pub use torque::Torque;
