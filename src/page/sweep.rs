//! The page of a sweep.

use std::collections::HashSet;

use maud::{Markup, html};

use super::document::{FILES, Section, all_figures, document, inputs, made_by};
use super::figure::Figures;
use super::link::{link_drawing, link_readings};
use super::swept::Named;
use super::swept_quantities::from_rest;
use super::tables::{readings, table};
use super::words::{GLOSSARY, own, warning_meaning};
use crate::compare::Cell;
use crate::link::Link;
use crate::result::StoredSweep;
use crate::text::significant;

/// Largest number of rows in the table of cases.
const MOST_CASES: usize = 200;

/// The page of a sweep, with its figures.
pub(super) fn sweep_page(sweep: &StoredSweep, figures: &Figures) -> Markup {
    let cases = sweep.table.lines.len();
    let varied: Vec<&str> = sweep.table.names().take(sweep.units.len()).collect();
    let link =
        sweep.origin.as_ref().map(|origin| origin.title.trim()).filter(|title| !title.is_empty());
    let title = format!(
        "{}Sweep over {}",
        link.map(|title| format!("{title}. ")).unwrap_or_default(),
        varied.join(" and ")
    );
    let origin = html! {
        @if let Some(origin) = &sweep.origin { (made_by(origin)) " · " }
        (own(&sweep.name)) " · " (cases) @if cases == 1 { " case" } @else { " cases" }
    };
    let mut sections = Vec::new();
    let kinds = kinds_of_warnings(sweep);
    if !kinds.is_empty() {
        sections.push(Section::warnings(warnings(&kinds, sweep)));
    }
    sections.push(all_figures(figures));
    sections.extend(
        (!sweep.links.is_empty()).then(|| Section::new("link", "Link", links(&sweep.links))),
    );
    sections.push(Section::glossary(&GLOSSARY, from_rest(sweep)));
    sections.push(Section::new("varied", "What is varied", varied_values(sweep)));
    sections.push(Section::new("cases", "Cases", cases_table(sweep)));
    sections.extend(sweep.origin.as_ref().map(inputs));
    document(&title, &origin, &sections, FILES, None)
}

/// Kinds of warnings, each with the number of its cases and the row of the first, from 1.
fn kinds_of_warnings(sweep: &StoredSweep) -> Vec<(String, usize, usize)> {
    let mut kinds: Vec<(String, usize, usize)> = Vec::new();
    let [.., warnings, error] = &sweep.table.columns[..] else { return kinds };
    for row in 0..sweep.table.lines.len() {
        let failed = (!error.text(row).is_empty()).then_some("failed");
        let warnings = warnings.text(row);
        let warnings = warnings.split(';').filter(|kind| !kind.is_empty());
        for kind in failed.into_iter().chain(warnings) {
            match kinds.iter_mut().find(|(known, ..)| known == kind) {
                Some((_, cases, _)) => *cases += 1,
                None => kinds.push((kind.to_owned(), 1, row + 1)),
            }
        }
    }
    kinds
}

fn warnings(kinds: &[(String, usize, usize)], sweep: &StoredSweep) -> Markup {
    let cases = sweep.table.lines.len();
    let columns = Named::all(sweep);
    let values = |row: usize| {
        columns.iter().map(|column| column.value_words(row)).collect::<Vec<_>>().join(", ")
    };
    html! {
        ul { @for (kind, count, first) in kinds {
            li {
                strong { (kind_words(kind)) } " "
                span class="hint" {
                    (count) " of " (cases) " cases, the first is row " (first) ": " (values(first - 1)) "."
                    @if let Some(meaning) = warning_meaning(kind) { " " (meaning) }
                }
            }
        } }
    }
}

/// A kind of warning in words, with the name of a limit as the figures have it.
fn kind_words(kind: &str) -> String {
    let words = kind.replace('_', " ");
    let Some((kind, key)) = words.split_once(':') else { return words };
    match key.split_once('.') {
        Some(("carriage", key)) if key.contains("carriage") => format!("{kind}: {key}"),
        Some((owner, key)) => {
            let number = owner.trim_start_matches("joint");
            let owner = if number == owner { owner.to_owned() } else { format!("joint {number}") };
            format!("{kind}: {}, {owner}", key.replace("hub ", ""))
        }
        None => format!("{kind}: {key}"),
    }
}

/// Link of the first case, or links of its arm.
fn links(links: &[Link]) -> Markup {
    html! {
        p { "As in the first case." }
        (links_drawn(links))
    }
}

/// A link or the links of an arm, in a drawing and in numbers.
pub(super) fn links_drawn(links: &[Link]) -> Markup {
    html! {
        @if let [link] = links { figure class="drawing" { (link_drawing(link)) } }
        div class="columns" { @for (k, link) in links.iter().enumerate() {
            (readings(&(if links.len() > 1 { format!("Link {}", k + 1) } else { "Link".to_owned() }), &link_readings(link)))
        } }
    }
}

/// Largest number of listed values in a row.
const MOST_VALUES: usize = 12;

/// The varied values, and the number of each.
fn varied_values(sweep: &StoredSweep) -> Markup {
    let row = |named: &Named| {
        let column = named.column;
        let (mut listed, mut seen) = (Vec::new(), HashSet::new());
        for row in 0..sweep.table.lines.len() {
            let text = column.text(row);
            if seen.insert(text.clone()) && listed.len() < MOST_VALUES {
                listed.push(text);
            }
        }
        let (listed, count) = (listed.join(", "), seen.len());
        let more =
            if count > MOST_VALUES { format!(", … ({count} values)") } else { String::new() };
        (named.heading(), own(listed + &more))
    };
    let rows: Vec<_> = Named::all(sweep).iter().map(row).collect();
    readings("Values", &rows)
}

fn cases_table(sweep: &StoredSweep) -> Markup {
    let cases = sweep.table.lines.len();
    let shown = cases.min(MOST_CASES);
    let cell = |column: usize, row: usize| match sweep.table.columns[column].cell(row) {
        Cell::Number(number) if column < sweep.units.len() => format!("{number}"),
        Cell::Number(number) => significant(number, 5),
        Cell::Word(word) => word.to_owned(),
    };
    let head: Vec<String> = sweep.table.names().map(own).collect();
    let rows = html! {
        @for row in 0..shown { tr { @for column in 0..head.len() { td { (own(cell(column, row))) } } } }
    };
    html! {
        p {
            "The column " code { "warnings" } " holds the kinds of the warnings; their full text is in \
             summary.json of the case, which " code { "sweep --outputs" } " writes."
            @if sweep.origin.is_none() {
                " The table has no record beside it, so link, motion and arguments are not known."
            }
        }
        @if shown < cases {
            p { "The first " (shown) " of " (cases) "; " (own(&sweep.name)) " holds all." }
        }
        (table(&head, &rows))
    }
}
