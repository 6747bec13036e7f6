//! The page: one HTML file that needs nothing else.

mod document;
mod link;
mod run;
mod sweep;

use crate::numeric::visible_document;
use crate::report::Figures;
use crate::result::StoredResult;

/// The page of a result, with its figures.
pub fn page(result: &StoredResult, figures: &Figures) -> String {
    let document = match result {
        StoredResult::Run(run) => run::run_page(run, figures),
        StoredResult::Sweep(sweep) => sweep::sweep_page(sweep, figures),
    };
    visible_document(&document.into_string())
}
