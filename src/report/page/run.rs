//! The page of a run: its link, its numbers, checks, warnings.

use maud::{Markup, html};

use super::document::{Section, document, figures_section, inputs, made_by};
use super::link::{given, link_drawing, motion_data};
use crate::link::{Link, Segment};
use crate::numeric::significant;
use crate::report::{Figures, View};
use crate::result::{StoredCheck, StoredRun, StoredWarning};

pub(super) fn run_page(run: &StoredRun, figures: &Figures) -> Markup {
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

/// Units by the end of a name, the longer before what it ends in.
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

/// What a name such as `peak_torque_n_m` says: words and a unit.
fn words_and_unit(name: &str) -> (String, &'static str) {
    let found = UNITS.iter().find_map(|(end, unit)| Some((name.strip_suffix(end)?, *unit)));
    let (words, unit) = found.unwrap_or((name, ""));
    (words.replace('_', " "), unit)
}

/// A number with its unit, for people.
fn amount(value: f64, unit: &str) -> String {
    format!("{} {unit}", significant(value, 4).replace('-', "−")).trim_end().to_owned()
}

/// The numbers of the summary.
fn readings(run: &StoredRun) -> Markup {
    html! {
        table class="readings" {
            caption { "Results" }
            tbody {
                @for (name, value) in &run.readings {
                    @let (words, unit) = words_and_unit(name);
                    tr { th scope="row" { (words) } td { (amount(*value, unit)) } }
                }
            }
        }
    }
}

/// What the link is made of.
fn link_readings(link: &Link) -> Markup {
    let payload = link.payload();
    let hub = link.hub();
    let mut rows = vec![
        ("length".to_owned(), given(link.length_m(), "m")),
        ("rigid inertia".to_owned(), given(link.rigid_inertia_kg_m2(), "kg m²")),
        ("hub inertia".to_owned(), given(hub.inertia_kg_m2, "kg m²")),
    ];
    if hub.radius_m > 0.0 {
        rows.push(("hub radius".to_owned(), given(hub.radius_m, "m")));
    }
    if hub.viscous_friction_n_m_s_rad > 0.0 {
        rows.push(("hub friction".to_owned(), given(hub.viscous_friction_n_m_s_rad, "N m s/rad")));
    }
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
    html! {
        table class="readings" {
            caption { "Link" }
            tbody {
                @for (name, value) in &rows { tr { th scope="row" { (name) } td { (value) } } }
            }
        }
    }
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
    format!(
        "{}; EI {}; {}",
        given(segment.length_m, "m"),
        ends(stiffness.inner, stiffness.outer, "N m²"),
        ends(mass.inner, mass.outer, "kg/m")
    )
}

fn body_words(mass_kg: f64, inertia_kg_m2: f64) -> String {
    let mass = given(mass_kg, "kg");
    if inertia_kg_m2 > 0.0 { format!("{mass}, {}", given(inertia_kg_m2, "kg m²")) } else { mass }
}

/// Every warning and what to do about it.
fn warnings(warnings: &[StoredWarning]) -> Markup {
    html! {
        section id="warnings" class="warnings" {
            h2 { "Warnings" }
            ul {
                @for warning in warnings {
                    li { strong { (warning.message) } " " span class="hint" { "What helps: " (warning.hint) "." } }
                }
            }
        }
    }
}

/// Every remark and what to do about it.
fn remarks(remarks: &[StoredWarning]) -> Markup {
    html! {
        section id="remarks" {
            h2 { "Remarks" }
            ul {
                @for remark in remarks {
                    li { (remark.message) " " span class="hint" { "What helps: " (remark.hint) "." } }
                }
            }
        }
    }
}

/// The table of `verify`.
fn checks(checks: &[StoredCheck]) -> Markup {
    html! {
        section id="checks" {
            h2 { "Verification" }
            p { "The answer, measured by other means." }
            div class="scroll" {
                table {
                    thead { tr {
                        th scope="col" { "check" } th scope="col" { "found" } th scope="col" { "at most" }
                        th scope="col" { "of" } th scope="col" { "verdict" }
                    } }
                    tbody {
                        @for check in checks {
                            tr {
                                th scope="row" { (check.what) }
                                @match &check.outcome {
                                    Ok((found, bound)) => {
                                        td { (significant(*found, 2)) } td { (significant(*bound, 2)) }
                                    }
                                    Err(reason) => td colspan="2" { "not measured: " (reason) },
                                }
                                td { (check.of) }
                                @if check.passes { td class="pass" { "holds" } } @else { td class="fail" { "fails" } }
                            }
                        }
                    }
                }
            }
        }
    }
}
