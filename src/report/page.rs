//! The parts that every page has, and the page of a run.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::figure::{Figure, Figures};
use super::link::{given, link_drawing, motion_data};
use super::view::View;
use crate::link::{Link, Segment};
use crate::result::{Origin, StoredCheck, StoredRun, StoredWarning};
use crate::text::significant;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The files of a result, which hold more than its page.
pub(super) const FILES: &str = "from the files of the result, which hold every number";

/// A whole page, made from a `source`; `data` is the JSON that the animation plays.
pub(super) fn document(
    title: &str,
    origin: &Markup,
    sections: &[Section],
    source: &str,
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
                        "Made by flexlink " (env!("CARGO_PKG_VERSION")) " " (source) ". Of each line a figure shows the lowest and the highest \
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
    let files = if files.is_empty() { "no input files".to_owned() } else { files.join(", ") };
    html! { "flexlink " (origin.version) " " (origin.command) " · " (files) }
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
        @if origin.inputs.is_empty() {
            p { "No input files: a program made link and motion from numbers." }
        } @else { (table(&["input", "file", "SHA-256"], &files)) }
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

pub(super) fn run_page(run: &StoredRun, figures: &Figures) -> Markup {
    let origin = &run.origin;
    let title = match origin.title.trim() {
        "" => "A flexible link",
        title => title,
    };
    let view = View::of(run);
    let data = motion_data(&view);
    let mut sections = Vec::new();
    if !run.warnings.is_empty() {
        sections.push(Section::warnings(advice(&run.warnings, true)));
    }
    if !run.remarks.is_empty() {
        sections.push(Section::new("remarks", "Remarks", advice(&run.remarks, false)));
    }
    sections.push(Section::new("link", "Link and results", link_section(run)));
    if !run.checks.is_empty() {
        sections.push(Section::new("checks", "Verification", checks(&run.checks)));
    }
    if data.is_some() {
        let (heading, class) = ("The link in motion", Some("needs-script"));
        let section = Section::new("animation", "Motion", animation("The link while it moves"));
        sections.push(Section { heading, class, ..section });
    }
    let (from, until) = view.span_s();
    let [from, until, first, last] =
        [from, until, run.times_s[0], run.times_s[run.times_s.len() - 1]].map(|t| given(t, ""));
    let note = format!(
        "Over time the figures show {from} … {until} s of the {first} … {last} s that were computed."
    );
    sections.push(figures_section(figures, &note));
    sections.push(inputs(origin));
    document(title, &made_by(origin), &sections, FILES, data.as_deref())
}

fn link_section(run: &StoredRun) -> Markup {
    html! {
        figure class="drawing" {
            (link_drawing(&run.link))
            figcaption { "Lengths are to scale; thickness grows with the cube root of the bending stiffness, \
                a dot with that of its mass, up to a limit." }
        }
        div class="columns" {
            (readings("Results", &results(&run.readings)))
            (readings("Link", &link_readings(&run.link)))
        }
    }
}

/// What the page's script plays the motion in.
pub(super) fn animation(label: &str) -> Markup {
    html! {
        figure class="stage" {
            svg id="stage" role="img" aria-label=(label)
                viewBox="0 0 760 420" {}
            figcaption id="stage-caption" {}
        }
        div class="controls" {}
    }
}

/// Units by the suffix of a name; a longer suffix comes before one that it ends in.
const UNITS: [(&str, &str); 15] = [
    ("_n_m_s_rad", "N m s/rad"),
    ("_kg_m2", "kg m²"),
    ("_rad_s2", "rad/s²"),
    ("_m_s2", "m/s²"),
    ("_rad_s", "rad/s"),
    ("_n_m2", "N m²"),
    ("_kg_m", "kg/m"),
    ("_per_s", "1/s"),
    ("_m_s", "m/s"),
    ("_n_m", "N m"),
    ("_rad", "rad"),
    ("_hz", "Hz"),
    ("_m", "m"),
    ("_s", "s"),
    ("_w", "W"),
];

/// Words and unit of a name such as `peak_torque_n_m`.
pub(super) fn words_and_unit(name: &str) -> (String, &'static str) {
    let found = UNITS.iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, *unit)));
    let (words, unit) = found.unwrap_or((name, ""));
    (words.replace('_', " "), unit)
}

/// A table of names and values.
pub(super) fn readings(caption: &str, rows: &[(String, String)]) -> Markup {
    html! {
        table class="readings" {
            caption { (caption) }
            tbody {
                @for (name, value) in rows { tr { th scope="row" { (name) } td { (value) } } }
            }
        }
    }
}

/// Numbers of the summary in words and units.
pub(super) fn results(readings: &[(String, f64)]) -> Vec<(String, String)> {
    let row = |(name, value): &(String, f64)| {
        let (words, unit) = words_and_unit(name);
        // A count has no decimals.
        let digits =
            if name.ends_with("iterations") { value.to_string() } else { significant(*value, 4) };
        let amount = format!("{} {unit}", digits.replace('-', "−"));
        (words, amount.trim_end().to_owned())
    };
    readings.iter().map(row).collect()
}

/// The parts of the link.
pub(super) fn link_readings(link: &Link) -> Vec<(String, String)> {
    let (hub, payload) = (link.hub(), link.payload());
    let friction = hub.viscous_friction_n_m_s_rad;
    let rows = [
        ("length", Some(given(link.length_m(), "m"))),
        ("rigid inertia", Some(given(link.rigid_inertia_kg_m2(), "kg m²"))),
        ("hub inertia", Some(given(hub.inertia_kg_m2, "kg m²"))),
        ("hub radius", (hub.radius_m > 0.0).then(|| given(hub.radius_m, "m"))),
        ("hub friction", (friction > 0.0).then(|| given(friction, "N m s/rad"))),
    ];
    let rows = rows.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let mut rows: Vec<(String, String)> = rows.collect();
    for (k, segment) in link.segments().iter().enumerate() {
        let name = segment.name.clone().unwrap_or_else(|| k.to_string());
        rows.push((format!("segment {name}"), segment_words(segment)));
    }
    for mass in link.masses() {
        let place = format!("mass at {}", given(mass.at_m, "m"));
        rows.push((place, body_words(mass.mass_kg, mass.inertia_kg_m2)));
    }
    if payload.mass_kg > 0.0 || payload.inertia_kg_m2 > 0.0 {
        let mut words = body_words(payload.mass_kg, payload.inertia_kg_m2);
        if payload.offset_m.abs() > 0.0 {
            words = format!("{words}, {} beyond the tip", given(payload.offset_m, "m"));
        }
        rows.push(("payload".to_owned(), words));
    }
    rows.push(("damping".to_owned(), link.damping().name().to_owned()));
    if let Some(gravity) = link.gravity() {
        let [along_x, along_y] = gravity.acceleration_m_s2.map(|part| given(part, "m/s²"));
        rows.push(("gravity".to_owned(), format!("{along_x} along x, {along_y} along y")));
        let start = gravity.start_angle_rad.map(|angle| given(angle, "rad"));
        let start = start.unwrap_or_else(|| "that of the motion".into());
        rows.push(("start angle".to_owned(), start));
    }
    rows
}

fn segment_words(segment: &Segment) -> String {
    let ends = |inner: f64, outer: f64, unit: &str| {
        if inner.total_cmp(&outer).is_eq() {
            given(inner, unit)
        } else {
            format!("{} … {}", given(inner, ""), given(outer, unit))
        }
    };
    let (stiffness, mass) = (segment.bending_stiffness_n_m2, segment.mass_per_length_kg_m);
    let slender = format!(
        "{}; EI {}; {}",
        given(segment.length_m, "m"),
        ends(stiffness.inner, stiffness.outer, "N m²"),
        ends(mass.inner, mass.outer, "kg/m")
    );
    let Some(thick) = segment.timoshenko else { return slender };
    let (shear, rotary) = (thick.shear_stiffness_n, thick.rotary_inertia_per_length_kg_m);
    format!(
        "{slender}; κGA {}; ρI {}",
        ends(shear.inner, shear.outer, "N"),
        ends(rotary.inner, rotary.outer, "kg m")
    )
}

fn body_words(mass_kg: f64, inertia_kg_m2: f64) -> String {
    let mass = given(mass_kg, "kg");
    if inertia_kg_m2 > 0.0 { format!("{mass}, {}", given(inertia_kg_m2, "kg m²")) } else { mass }
}

/// Every warning or remark and what to do about it.
pub(super) fn advice(list: &[StoredWarning], is_strong: bool) -> Markup {
    html! {
        ul { @for StoredWarning { message, hint, .. } in list {
            li {
                @if is_strong { strong { (message) } } @else { (message) }
                " " span class="hint" { "What helps: " (hint) "." }
            }
        } }
    }
}

/// The table of `verify`.
pub(super) fn checks(checks: &[StoredCheck]) -> Markup {
    let rows = html! {
        @for check in checks { tr {
            th scope="row" { (check.what) }
            @match check.found.zip(check.bound) {
                Some((found, bound)) => { td { (significant(found, 2)) } td { (significant(bound, 2)) } }
                None => td colspan="2" {
                    "not measured: " (check.reason.as_deref().unwrap_or("no finite number was found"))
                },
            }
            td { (check.of) }
            @if !check.passes {
                td class="fail" { "fails" }
            } @else if check.found.is_some() {
                td class="pass" { "holds" }
            } @else {
                td { "not made" }
            }
        } }
    };
    html! {
        p { "The answer, measured by other means." }
        (table(&["check", "found", "at most", "of", "verdict"], &rows))
    }
}
