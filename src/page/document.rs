//! Common parts of all pages, and the page of a run.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest as _, Sha256};

use super::beside::beside;
use super::figure::{Figure, Figures};
use super::link::{given, link_drawing, link_readings};
use super::motion::Motion;
use super::picture;
use super::tables::{
    checks, errors, joints, modes, of_carriage, of_whole, readings, results, table,
};
use super::view::View;
use super::words::{GLOSSARY, acts, glossary, own};
use crate::link::Link;
use crate::result::{Notice, Origin, StoredRun};

const STYLE: &str = concat!(include_str!("drawing.css"), include_str!("page.css"));
const SCRIPT: &str = include_str!("page.js");

/// Security policy that allows only the page's style and script, by their hashes, and pictures that it contains or
/// makes.
fn security_policy() -> String {
    let hash = |text: &str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)));
    format!(
        "default-src 'none'; style-src {}; script-src {}; img-src data: blob:; base-uri 'none'; form-action 'none'",
        hash(STYLE),
        hash(SCRIPT)
    )
}

/// Description of a result's files, which contain more than its page.
pub(super) const FILES: &str = "from the files of the result, which hold every number";

/// A whole page, made from a `source`; `data` is the JSON for the animation.
pub(super) fn document(
    title: &str,
    origin: &Markup,
    sections: &[Section],
    source: &str,
    data: Option<&str>,
) -> Markup {
    let title = own(title);
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(security_policy());
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
                        "Made by flexlink " (env!("CARGO_PKG_VERSION")) " " (source) ". Of each line a figure shows the lowest and the highest \
                         point in each pixel of its width"
                        @if data.is_some() {
                            "; maps have 680 by 120 fields, the animation and the CSV files of maps at most 600 \
                             moments of 61 nodes"
                        }
                        "."
                    }
                }
                @if let Some(data) = data {
                    script type="application/json" id="motion" { (PreEscaped(data)) }
                }
                script type="text/plain" id="figure-style" { (PreEscaped(picture::STYLE)) }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    }
}

/// A part of a page with an entry in the contents.
pub(super) struct Section {
    pub(super) id: &'static str,
    /// Name in the contents.
    pub(super) name: &'static str,
    pub(super) heading: &'static str,
    pub(super) class: Option<&'static str>,
    pub(super) content: Markup,
}

impl Section {
    /// The glossary, folded; `from_rest` as in [`acts`].
    pub(super) fn glossary(words: &[(&str, &str)], from_rest: Option<bool>) -> Self {
        Self::new("glossary", "Glossary", glossary(words, acts(from_rest)))
    }

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
    let files = if files.is_empty() { "no input files".to_owned() } else { files.join(", ") };
    html! { "flexlink " (origin.version) " " (origin.command) " · " (own(files)) }
}

/// Figures of a page, and missing ones with reasons.
fn figures_section(
    (id, name): (&'static str, &'static str),
    figures: &[&Figure],
    omitted: &[String],
    note: &str,
) -> Section {
    let content = html! {
        @if !note.is_empty() { p { (note) } }
        @for figure in figures { (figure_markup(figure)) }
        @if !omitted.is_empty() {
            div {
                p { "Not shown:" }
                ul { @for why in omitted { li { (why) } } }
            }
        }
    };
    Section { class: Some("figures"), ..Section::new(id, name, content) }
}

/// All figures in one section.
pub(super) fn all_figures(figures: &Figures) -> Section {
    let drawn: Vec<&Figure> = figures.drawn.iter().collect();
    figures_section(("figures", "Figures"), &drawn, &figures.omitted, "")
}

/// Sections of the leading figures and of the others; `None` without figures.
fn parted_figures(first: &'static str, figures: &Figures, note: &str) -> [Option<Section>; 2] {
    let (leading, other): (Vec<&Figure>, Vec<&Figure>) =
        figures.drawn.iter().partition(|figure| figure.leads());
    let has_more = !other.is_empty() || !figures.omitted.is_empty();
    let more = || figures_section(("figures", "More figures"), &other, &figures.omitted, "");
    let first = || figures_section(("first", first), &leading, &[], note);
    [(!leading.is_empty()).then(first), has_more.then(more)]
}

fn figure_markup(figure: &Figure) -> Markup {
    let (head, rows) = figure.table();
    let cells = html! { @for row in &rows { tr { @for cell in row { td { (cell) } } } } };
    html! {
        figure class="chart" id=(format!("fig-{}", figure.id)) {
            h3 { (figure.title) }
            (figure.svg())
            figcaption { (figure.caption) }
            details class="formula" { summary { "Formula" } p { (figure.formula) } }
            @if !rows.is_empty() {
                details class="numbers" {
                    summary { "Numbers" }
                    (table(&head, &cells))
                    @if let Some((drawn, all)) = figure.thinned() {
                        p { "The CSV file has the " (drawn) " points that are drawn of " (all) "." }
                    }
                }
            }
        }
    }
}

/// Input files with their hashes, and the arguments of the run.
pub(super) fn inputs(origin: &Origin) -> Section {
    let files = html! {
        @for input in &origin.inputs {
            tr { th scope="row" { (input.role) } td { (own(&input.name)) } td { code { (input.sha256) } } }
        }
    };
    let content = html! {
        @if origin.inputs.is_empty() {
            p { "No input files: a program made link and motion from numbers." }
        } @else { (table(&["input", "file", "SHA-256"], &files)) }
        @if !origin.arguments.is_empty() {
            p { "Arguments " code { (command_line(&origin.arguments)) } }
        }
    };
    Section::new("inputs", "Inputs", content)
}

/// Arguments, quoted for a shell.
fn command_line(arguments: &[String]) -> String {
    let quoted = |argument: &String| match shlex::try_quote(argument) {
        Ok(quoted) => quoted.into_owned(),
        // Only an argument with a NUL cannot be quoted.
        Err(_) => argument.clone(),
    };
    arguments.iter().map(quoted).collect::<Vec<_>>().join(" ")
}

/// The page of the first of an arm's runs, with the others beside it. A link is an arm of one link.
pub(super) fn run_page(view: &View, figures: &Figures) -> Markup {
    let first = view.first();
    let untitled = view.pick("A flexible link", "An arm of flexible links");
    let leading = view.pick("Torque, tip and hub", "Torques, tip and joints");
    let heading = view.pick("The link in motion", "The arm in motion");
    let label = view.pick("The link while it moves", "The arm while it moves");
    let title = Some(first.origin.title.trim()).filter(|title| !title.is_empty());
    let (times, (from, until)) = (&first.times_s, view.span_s);
    let [from, until, start, end] =
        [from, until, times[0], times[times.len() - 1]].map(|t| given(t, ""));
    let note = format!(
        "Over time the figures show {from} … {until} s of the {start} … {end} s that were computed."
    );
    let [leading, more] = parted_figures(leading, figures, &note);
    let motion = Motion::of(view);
    let animated = motion.is_some().then(|| {
        let section = Section::new("animation", "Motion", animation(label));
        Section { heading, class: Some("needs-script"), ..section }
    });
    let poses = motion.as_ref().filter(|_| view.is_arm());
    let poses = poses.map(|motion| motion.drawing(view));
    // The errors of a link are among its results.
    let errors = errors(view);
    let (among_results, errors) = view.pick((errors.clone(), None), (None, errors));
    let tables = tables(view, among_results.as_ref());
    let named = |id, name, content: Option<Markup>| Some(Section::new(id, name, content?));
    let sections = [
        advice(&told(view, |arm| &arm.warnings), true).map(Section::warnings),
        leading,
        animated,
        named("arm", "Poses", poses),
        more,
        named("remarks", "Remarks", advice(&told(view, |arm| &arm.remarks), false)),
        named("link", "Link", view.link.map(|run| drawing(run.link))),
        Some(Section::glossary(&GLOSSARY, Some(view.is_arm() || view.has_weight()))),
        beside(view).map(|content| Section::new("beside", "Side by side", content)),
        Some(Section::new("results", "Results", tables)),
        named("errors", "Errors", errors),
        named("checks", "Verification", checks(&first.checks)),
        Some(inputs(&first.origin)),
    ];
    let sections: Vec<Section> = sections.into_iter().flatten().collect();
    let origin = html! {
        @for (k, arm) in view.runs.iter().enumerate() {
            @if k > 0 { br; }
            @if view.runs.len() > 1 { strong { (own(&arm.name)) } " " }
            (made_by(&arm.origin))
        }
    };
    let data = motion.map(|motion| motion.json(view));
    let title = with_others(title.unwrap_or(untitled), view.runs[1..].iter().map(|run| &run.name));
    document(&title, &origin, &sections, FILES, data.as_deref())
}

/// The title of a page, with the names of the results beside the first.
pub(super) fn with_others<'a>(title: &str, others: impl Iterator<Item = &'a String>) -> String {
    let names: Vec<&str> = others.map(String::as_str).collect();
    if names.is_empty() {
        title.to_owned()
    } else {
        format!("{title}, beside {}", names.join(", "))
    }
}

/// Warnings or remarks of all runs, which have the words of their joints, each with its hint; for several runs with the
/// name of the run.
fn told(view: &View, of: fn(&StoredRun) -> &Vec<Notice>) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for arm in view.runs {
        let name = format!("{}: ", arm.name);
        let name = if view.runs.len() > 1 { &name } else { "" };
        all.extend(
            of(arm).iter().map(|told| (own(name.to_owned() + &told.message), own(&told.hint))),
        );
    }
    all
}

/// All warnings or remarks with their hints, if there are any.
pub(super) fn advice(list: &[(String, String)], is_strong: bool) -> Option<Markup> {
    let content = html! {
        ul { @for (message, hint) in list {
            li {
                @if is_strong { strong { (message) } } @else { (message) }
                " " span class="hint" { "What helps: " (hint) "." }
            }
        } }
    };
    (!list.is_empty()).then_some(content)
}

fn drawing(link: &Link) -> Markup {
    html! {
        figure class="drawing" {
            (link_drawing(link))
            figcaption { "Lengths are to scale; thickness grows with the cube root of the bending stiffness, \
                a dot with that of its mass, up to a limit." }
        }
    }
}

fn tables(view: &View, errors: Option<&Markup>) -> Markup {
    let first = view.first();
    let is_arm = view.is_arm();
    let last = first.links.len() - 1;
    let link = |k: usize| {
        let mut rows = link_readings(&first.links[k].link);
        let body = rows.iter_mut().filter(|(name, _)| name == "payload" && k < last);
        body.for_each(|(name, _)| "body at its tip".clone_into(name));
        let number = view.pick(String::new(), format!(" {}", view.number_of(k)));
        readings(&format!("Link{number}"), &rows)
    };
    html! {
        @if is_arm { (joints(first)) }
        div class="columns" {
            @if !first.readings.is_empty() {
                (readings(view.pick("Results", "Whole arm"), &results(&of_whole(first))))
            }
            @if let Some(carriage) = &first.carriage {
                (readings("Carriage", &results(&of_carriage(carriage))))
            }
            @for k in 0..=last { (link(k)) }
        }
        @if let Some(run) = view.link { (modes(run)) }
        @if let Some(errors) = errors { h3 { "Errors" } (errors) }
    }
}

/// Stage of the page's script for the motion.
fn animation(label: &str) -> Markup {
    html! {
        figure class="stage" {
            svg id="stage" role="img" aria-label=(label)
                viewBox="0 0 760 420" {}
            figcaption id="stage-caption" {}
        }
        div class="controls" {}
    }
}
