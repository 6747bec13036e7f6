//! The recursion, the natural frequencies and the zeros against the uniform link in closed form.

mod closed_form;
mod frequencies;
mod roots;
mod transfer;
mod zeros;
