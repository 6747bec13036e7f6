//! The starts of a fit, and where each of them led.

use maud::{Markup, html};

use super::fit::shown;
use super::tables::table;
use crate::fit::FitOutcome;

/// Where each start ended.
pub(super) fn starts(outcome: &FitOutcome) -> Markup {
    let factors = |of: &[f64]| of.iter().map(|f| shown(*f, 4)).collect::<Vec<_>>().join(", ");
    let rows = html! {
        @for (number, start) in outcome.starts.iter().enumerate() { tr {
            th scope="row" { @if number == 0 { "the file's values" } @else { (number) } }
            td { (factors(&start.from)) }
            td { (start.to.as_deref().map_or("no link there".to_owned(), factors)) }
            td { (start.sum_of_squares.map_or(String::new(), |sum| shown(sum, 5))) }
            td { (start.iterations) }
        } }
    };
    let head = ["start", "from the factors", "to the factors", "sum of squares", "iterations"];
    html! {
        (table(&head, &rows))
        p { @if outcome.is_from_other_start {
            "A better fit was found from another start than the file's own values. "
        } "From the best of them " (outcome.iterations)
            @if outcome.iterations == 1 { " iteration leads" } @else { " iterations lead" }
            " to the fitted values."
        }
    }
}
