//! The parts that every page has: head, contents, figures, inputs.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figure::{Figure, Figures};
use crate::result::Origin;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A whole page; `data` is the JSON that the animation plays.
pub(super) fn document(
    title: &str,
    origin: &Markup,
    sections: &[Section],
    data: Option<&str>,
) -> Markup {
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
                main { @for section in sections {
                    section id=(section.id) class=[section.class] {
                        h2 { (section.heading) }
                        (section.content)
                    }
                } }
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

/// A part of a page, which the contents link to.
pub(super) struct Section {
    pub(super) id: &'static str,
    /// Its name in the contents.
    pub(super) name: &'static str,
    pub(super) heading: &'static str,
    pub(super) class: Option<&'static str>,
    pub(super) content: Markup,
}

impl Section {
    pub(super) fn new(id: &'static str, name: &'static str, content: Markup) -> Self {
        Self { id, name, heading: name, class: None, content }
    }

    pub(super) fn warnings(content: Markup) -> Self {
        Self { class: Some("warnings"), ..Self::new("warnings", "Warnings", content) }
    }
}

/// Program, command and files.
pub(super) fn made_by(origin: &Origin) -> Markup {
    let files: Vec<&str> = origin.inputs.iter().map(|input| input.name.as_str()).collect();
    html! { "flexlink " (origin.version) " " (origin.command) " · " (files.join(", ")) }
}

/// A table that scrolls sideways where the page is narrow.
pub(super) fn table<T: AsRef<str>>(head: &[T], rows: &Markup) -> Markup {
    html! {
        div class="scroll" { table {
            thead { tr { @for head in head { th scope="col" { (head.as_ref()) } } } }
            tbody { (rows) }
        } }
    }
}

pub(super) fn figures_section(figures: &Figures, note: &str) -> Section {
    let content = html! {
        @if !note.is_empty() { p { (note) } }
        @for figure in &figures.drawn { (figure_markup(figure)) }
        @if !figures.omitted.is_empty() {
            p { "Not shown:" }
            ul { @for why in &figures.omitted { li { (why) } } }
        }
    };
    Section::new("figures", "Figures", content)
}

fn figure_markup(figure: &Figure) -> Markup {
    let (head, rows) = figure.table();
    let cells = html! { @for row in &rows { tr { @for cell in row { td { (cell) } } } } };
    html! {
        figure class="chart" id=(format!("fig-{}", figure.id)) {
            h3 { (figure.title) }
            (figure.svg())
            figcaption { (figure.caption) }
            @if !rows.is_empty() { details { summary { "Numbers" } (table(&head, &cells)) } }
        }
    }
}

/// Input files with their hashes, and the arguments of the run.
pub(super) fn inputs(origin: &Origin) -> Section {
    let files = html! {
        @for input in &origin.inputs {
            tr { th scope="row" { (input.role) } td { (input.name) } td { code { (input.sha256) } } }
        }
    };
    let content = html! {
        (table(&["input", "file", "SHA-256"], &files))
        @if !origin.arguments.is_empty() {
            p { "Arguments " code { (command_line(&origin.arguments)) } }
        }
    };
    Section::new("inputs", "Inputs", content)
}

/// Arguments as a shell reads them.
fn command_line(arguments: &[String]) -> String {
    let quoted = |argument: &String| match shlex::try_quote(argument) {
        Ok(quoted) => quoted.into_owned(),
        // Only an argument with a NUL cannot be quoted.
        Err(_) => argument.clone(),
    };
    arguments.iter().map(quoted).collect::<Vec<_>>().join(" ")
}
