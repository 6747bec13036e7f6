//! Options that several commands share, and the inputs that they name.
#![allow(clippy::doc_markdown, reason = "docs of arguments are help on a terminal")]

pub(crate) mod common;
pub(crate) mod inputs;
pub(crate) mod moves;
pub(crate) mod play;
pub(crate) mod reading;
