//! Common options of several commands, and the inputs that they name.
#![allow(clippy::doc_markdown, reason = "docs of arguments are help on a terminal")]

pub mod common;
pub mod inputs;
pub mod play;
pub mod play_arm;
pub(crate) mod reading;
