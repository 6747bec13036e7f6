//! A result as figures, and as a page to look at.

pub mod chart;
mod figures;
mod page;
mod run;
mod sweep;
#[cfg(test)]
mod tests;

pub use figures::Figures;
pub use page::page;
pub use run::View;
