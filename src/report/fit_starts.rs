//! The starts of a fit, and where each of them led.

use maud::{Markup, html};

use super::tables::table;
use crate::fit::FitOutcome;
use crate::text::significant;

/// Of a number that is none.
pub(super) const UNKNOWN: &str = "not known";

/// Digits as a page shows them.
pub(super) fn shown(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return UNKNOWN.to_owned();
    }
    significant(value, digits).replace('-', "−")
}

/// Other values that fit about as well.
pub(super) fn other_answers(outcome: &FitOutcome) -> Markup {
    let paths = outcome.values.iter().map(|value| value.path.as_str());
    let head: Vec<&str> = paths.chain(["sum of squares"]).collect();
    let rows = html! {
        @for answer in &outcome.other_answers { tr {
            @for factor in &answer.factors { td { (shown(*factor, 5)) } }
            td { (shown(answer.sum_of_squares, 5)) }
        } }
    };
    html! {
        p { "These factors fit the measurements about as well: their sums of squares are less than 3.84 above the \
             least, in units of the variance of the differences." }
        (table(&head, &rows))
    }
}

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
