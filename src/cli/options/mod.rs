//! Common options of several commands, and the inputs that they name.
#![allow(clippy::doc_markdown, reason = "docs of arguments are help on a terminal")]

pub mod common;
pub mod inputs;
pub mod moves;
pub mod play;
pub mod reading;
