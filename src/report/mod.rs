//! A result as figures, and as a page to look at.

mod bending;
pub mod chart;
mod figures;
mod frequency;
mod page;
mod sweep;
#[cfg(test)]
mod tests;
mod view;

pub use chart::Figures;
pub use page::page;
pub use view::View;
