//! The recursion, the natural frequencies and the zeros against the uniform link in closed form.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

pub(crate) mod closed_form;
mod frequencies;
mod published;
mod thick_torque;
mod thickness;
mod timoshenko;
mod transfer;
mod zeros;
