//! The laws that made-up inputs are held to, one function for each fuzz target. `tests/fuzz.rs` of the
//! program holds inputs to them that are the same every time.

mod any_link;
mod any_motion;
mod compare_csv;
mod link_file;
mod link_text;
mod motion_csv;
mod override_path;
mod quantity;
mod solution_laws;
mod solve;
mod torque_csv;
mod wording;

pub use compare_csv::compare_csv;
pub use link_file::link_file;
pub use motion_csv::motion_csv;
pub use override_path::override_path;
pub use quantity::quantity;
pub use solve::solve;
pub use torque_csv::torque_csv;

/// Whether all samples are finite numbers.
fn finite(samples: &[f64]) -> bool {
    samples.iter().all(|sample| sample.is_finite())
}

/// What comes before the first byte that is no UTF-8.
fn text_of(bytes: &[u8]) -> &str {
    bytes.utf8_chunks().next().map_or("", |chunk| chunk.valid())
}
