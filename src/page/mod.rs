//! A result, or a fit, as figures and as a page.

mod axis;
mod bending;
mod colour_map;
mod document;
mod drawing;
mod figure;
mod figures;
mod fit;
mod fit_figures;
mod frequency;
mod limited;
mod link;
mod motion;
mod sweep;
mod sweep_page;
mod tables;
#[cfg(test)]
mod tests;
mod tip;
mod view;
mod words;

pub use figure::{Figure, Figures};
pub use figures::page;
pub use fit::{FitReport, fit_page};
