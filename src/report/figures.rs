use super::chart::Figure;
use super::run::{View, run_figures};
use super::sweep::sweep_figures;
use crate::result::StoredResult;

/// Figures of a result, and what could not be shown and why.
#[derive(Debug, Clone, Default)]
pub struct Figures {
    /// In the order of a page.
    pub drawn: Vec<Figure>,
    /// What is missing: `waves, since no nodal displacements were written`.
    pub omitted: Vec<String>,
}

impl Figures {
    /// All figures of a result.
    pub fn of(result: &StoredResult) -> Self {
        match result {
            StoredResult::Run(run) => run_figures(&View::of(run)),
            StoredResult::Sweep(sweep) => sweep_figures(sweep),
        }
    }

    pub(super) fn add(&mut self, figure: Result<Figure, String>) {
        match figure {
            Ok(figure) if figure.is_extreme() => {
                let why = "since its numbers are too large or too small to be drawn";
                self.omitted.push(format!("{}, {why}", figure.title));
            }
            Ok(figure) => self.drawn.push(figure),
            Err(why) => self.omitted.push(why),
        }
    }
}
