//! What the fuzz targets share: the laws that every text and every link keeps.

mod any_link;
mod any_motion;
mod link_file;
mod solution_laws;
mod wording;

pub use any_link::{any_drive, any_link, any_size};
pub use any_motion::TwoMotions;
pub use link_file::link_file;
pub use solution_laws::{bending, check_finite, check_linear, check_rigid};
pub use wording::check_words;

/// Whether all samples are finite numbers.
pub fn finite(samples: &[f64]) -> bool {
    samples.iter().all(|sample| sample.is_finite())
}
