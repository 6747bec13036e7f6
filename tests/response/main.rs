//! What `simulate` promises.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

mod round_trip;
