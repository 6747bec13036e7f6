//! Tables of a page: numbers, checks, warnings, inputs.

use maud::{Markup, html};

use crate::link::{Link, Segment};
use crate::numeric::significant;
use crate::result::{Origin, StoredCheck, StoredRun, StoredWarning};

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

/// A number as it was given, without the zeros behind it.
pub(super) fn given(value: f64, unit: &str) -> String {
    let digits = significant(value, 4);
    let short = match digits.split_once('.') {
        Some((whole, decimals)) if !decimals.contains('e') => {
            let decimals = decimals.trim_end_matches('0');
            if decimals.is_empty() { whole.to_owned() } else { format!("{whole}.{decimals}") }
        }
        _ => digits,
    };
    format!("{short} {unit}").replace('-', "−").trim_end().to_owned()
}

/// The numbers of the summary.
pub(super) fn readings(run: &StoredRun) -> Markup {
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
pub(super) fn link_readings(link: &Link) -> Markup {
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
pub(super) fn warnings(warnings: &[StoredWarning]) -> Markup {
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
pub(super) fn remarks(remarks: &[StoredWarning]) -> Markup {
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
pub(super) fn checks(checks: &[StoredCheck]) -> Markup {
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

/// What went in: files with their hashes, and arguments that changed them.
pub(super) fn inputs(origin: &Origin) -> Markup {
    html! {
        section id="inputs" {
            h2 { "Inputs" }
            div class="scroll" {
                table {
                    thead { tr { th scope="col" { "input" } th scope="col" { "file" } th scope="col" { "SHA-256" } } }
                    tbody {
                        @for input in &origin.inputs {
                            tr {
                                th scope="row" { (input.role) } td { (input.name) }
                                td { code { (input.sha256) } }
                            }
                        }
                    }
                }
            }
            @if !origin.arguments.is_empty() {
                p { "Arguments " code { (command_line(&origin.arguments)) } }
            }
        }
    }
}

/// Arguments as a shell reads them.
fn command_line(arguments: &[String]) -> String {
    let quoted = |argument: &String| match shlex::try_quote(argument) {
        Ok(quoted) => quoted.into_owned(),
        // No shell takes a NUL.
        Err(_) => argument.clone(),
    };
    arguments.iter().map(quoted).collect::<Vec<_>>().join(" ")
}
