//! The page: one HTML file that needs nothing else.

mod link_drawing;
mod motion_data;
mod readings;
mod sweep;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use self::link_drawing::link_drawing;
use self::motion_data::motion_data;
use self::readings::{checks, given, inputs, link_readings, readings, remarks, warnings};
use self::sweep::sweep_page;
use super::chart::Figure;
use super::{Figures, View};
use crate::numeric::visible_document;
use crate::result::{Origin, StoredResult, StoredRun};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page of a result, with its figures.
pub fn page(result: &StoredResult, figures: &Figures) -> String {
    let document = match result {
        StoredResult::Run(run) => run_page(run, figures),
        StoredResult::Sweep(sweep) => sweep_page(sweep, figures),
    };
    visible_document(&document.into_string())
}

/// What every page has around its sections; `data` is what the animation plays.
fn document(title: &str, origin: &Markup, sections: &[Section], data: Option<&str>) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(concat!("flexlink ", env!("CARGO_PKG_VERSION")));
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                header class="top" {
                    h1 { (title) }
                    p class="origin" { (origin) }
                    button id="theme" type="button" hidden="" { "Theme" }
                }
                nav class="contents" aria-label="Contents" {
                    ul { @for section in sections { li { a href=(format!("#{}", section.id)) { (section.name) } } } }
                }
                main { @for section in sections { (section.content) } }
                footer {
                    p {
                        "Made by flexlink " (env!("CARGO_PKG_VERSION")) " from the files of the result, \
                         which hold every number. Of each line a figure shows the lowest and the highest \
                         point in each pixel of its width"
                        @if data.is_some() {
                            "; maps have 680 by 120 fields, and the animation shows at most 600 moments of \
                             61 nodes"
                        }
                        "."
                    }
                }
                @if let Some(data) = data {
                    script type="application/json" id="motion" { (PreEscaped(data)) }
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    }
}

struct Section {
    id: &'static str,
    name: &'static str,
    content: Markup,
}

fn run_page(run: &StoredRun, figures: &Figures) -> Markup {
    let origin = &run.origin;
    let title = match origin.title.trim() {
        "" => "A flexible link",
        title => title,
    };
    let view = View::of(run);
    let data = motion_data(&view);
    let told = made_by(origin);
    let mut sections = Vec::new();
    if !run.warnings.is_empty() {
        sections.push(Section {
            id: "warnings",
            name: "Warnings",
            content: warnings(&run.warnings),
        });
    }
    if !run.remarks.is_empty() {
        sections.push(Section { id: "remarks", name: "Remarks", content: remarks(&run.remarks) });
    }
    sections.push(Section { id: "link", name: "Link and results", content: link_section(run) });
    if !run.checks.is_empty() {
        sections.push(Section { id: "checks", name: "Verification", content: checks(&run.checks) });
    }
    if data.is_some() {
        sections.push(Section { id: "animation", name: "Motion", content: animation() });
    }
    let (from, until) = view.span_s();
    let (first, last) = (run.times_s[0], run.times_s[run.times_s.len() - 1]);
    let note = format!(
        "Over time the figures show {} … {} s of the {} … {} s that were computed.",
        given(from, ""),
        given(until, ""),
        given(first, ""),
        given(last, "")
    );
    sections.push(Section {
        id: "figures",
        name: "Figures",
        content: figures_section(figures, &note),
    });
    sections.push(Section { id: "inputs", name: "Inputs", content: inputs(origin) });
    document(title, &told, &sections, data.as_deref())
}

/// Program, command and files.
fn made_by(origin: &Origin) -> Markup {
    let files: Vec<&str> = origin.inputs.iter().map(|input| input.name.as_str()).collect();
    html! { "flexlink " (origin.version) " " (origin.command) " · " (files.join(", ")) }
}

fn link_section(run: &StoredRun) -> Markup {
    html! {
        section id="link" {
            h2 { "Link and results" }
            figure class="drawing" {
                (link_drawing(&run.link))
                figcaption { "Lengths are to scale; thickness grows with the cube root of the bending stiffness, \
                    a dot with that of its mass, up to a limit." }
            }
            div class="columns" { (readings(run)) (link_readings(&run.link)) }
        }
    }
}

fn animation() -> Markup {
    html! {
        section id="animation" class="needs-script" {
            h2 { "The link in motion" }
            figure class="stage" {
                svg id="stage" role="img" aria-label="The link seen from above while it moves"
                    viewBox="0 0 760 420" {}
                figcaption id="stage-caption" {}
            }
            div class="controls" {}
        }
    }
}

fn figures_section(figures: &Figures, note: &str) -> Markup {
    html! {
        section id="figures" {
            h2 { "Figures" }
            @if !note.is_empty() { p { (note) } }
            @for figure in &figures.drawn { (figure_markup(figure)) }
            @if !figures.omitted.is_empty() {
                p { "Not shown:" }
                ul { @for why in &figures.omitted { li { (why) } } }
            }
        }
    }
}

fn figure_markup(figure: &Figure) -> Markup {
    let table = figure.table();
    html! {
        figure class="chart" id=(format!("fig-{}", figure.id)) {
            h3 { (figure.title) }
            (figure.svg())
            figcaption { (figure.caption) }
            @if !table.rows.is_empty() {
                details {
                    summary { "Numbers" }
                    div class="scroll" { table {
                        thead { tr { @for head in &table.head { th scope="col" { (head) } } } }
                        tbody { @for row in &table.rows { tr { @for cell in row { td { (cell) } } } } }
                    } }
                }
            }
        }
    }
}
