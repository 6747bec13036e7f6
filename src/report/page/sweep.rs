//! The page of a sweep.

use maud::{Markup, html};

use super::document::{Section, document, figures_section, inputs, made_by, table};
use crate::compare::Cell;
use crate::numeric::significant;
use crate::report::Figures;
use crate::result::StoredSweep;

/// Most rows of the table.
const MOST_CASES: usize = 200;

pub(super) fn sweep_page(sweep: &StoredSweep, figures: &Figures) -> Markup {
    let cases = sweep.table.lines.len();
    let varied: Vec<&str> = sweep.table.names().take(sweep.varied).collect();
    let title = format!("Sweep over {}", varied.join(" and "));
    let origin = html! {
        @if let Some(origin) = &sweep.origin { (made_by(origin)) " · " }
        (sweep.name) " · " (cases) @if cases == 1 { " case" } @else { " cases" }
    };
    let mut sections = Vec::new();
    let kinds = Kinds::of(sweep);
    if !kinds.0.is_empty() {
        let section = Section::new("warnings", "Warnings", warnings(&kinds, cases));
        sections.push(Section { class: Some("warnings"), ..section });
    }
    sections.push(figures_section(figures, ""));
    sections.push(Section::new("cases", "Cases", cases_table(sweep)));
    sections.extend(sweep.origin.as_ref().map(inputs));
    document(&title, &origin, &sections, None)
}

/// Kinds of warnings, each with the number of its cases and the row of the first, from 1.
struct Kinds(Vec<(String, usize, usize)>);

impl Kinds {
    fn of(sweep: &StoredSweep) -> Self {
        let mut kinds = Self(Vec::new());
        let [.., warnings, error] = &sweep.table.columns[..] else { return kinds };
        for row in 0..sweep.table.lines.len() {
            if !error.text(row).is_empty() {
                kinds.add("failed", row + 1);
            }
            for kind in warnings.text(row).split(';').filter(|kind| !kind.is_empty()) {
                kinds.add(kind, row + 1);
            }
        }
        kinds
    }

    fn add(&mut self, kind: &str, case: usize) {
        match self.0.iter_mut().find(|(known, ..)| known == kind) {
            Some((_, cases, _)) => *cases += 1,
            None => self.0.push((kind.to_owned(), 1, case)),
        }
    }
}

fn warnings(kinds: &Kinds, cases: usize) -> Markup {
    html! {
        ul { @for (kind, count, first) in &kinds.0 {
            li {
                strong { (kind) } " "
                span class="hint" { (count) " of " (cases) " cases, the first is row " (first) "." }
            }
        } }
    }
}

fn cases_table(sweep: &StoredSweep) -> Markup {
    let cases = sweep.table.lines.len();
    let shown = cases.min(MOST_CASES);
    let cell = |column: usize, row: usize| match sweep.table.columns[column].cell(row) {
        Cell::Number(number) if column < sweep.varied => format!("{number}"),
        Cell::Number(number) => significant(number, 5),
        Cell::Word(word) => word.to_owned(),
    };
    let head: Vec<&str> = sweep.table.names().collect();
    let rows = html! {
        @for row in 0..shown { tr { @for column in 0..head.len() { td { (cell(column, row)) } } } }
    };
    html! {
        p {
            "The column " code { "warnings" } " holds the kinds of the warnings; their full text is in \
             summary.json of the case, which " code { "sweep --outputs" } " writes."
            @if sweep.origin.is_none() {
                " No record lies beside the table, so link, motion and arguments are not known."
            }
        }
        @if shown < cases {
            p { "The first " (shown) " of " (cases) "; " (sweep.name) " holds all." }
        }
        (table(&head, &rows))
    }
}
