//! Tables of a page: names and values, parts of a link, modes, errors, limits, checks.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::link::given;
use crate::link::{Damping, Drive, Link, Segment};
use crate::modal::{
    DampingLaw, PoseHub, REPORTED_MODES, REPORTED_ZEROS, natural_frequencies, torque_zeros,
};
use crate::response::damping_ratios;
use crate::result::{Check, StoredRun};
use crate::text::{digits_beyond, significant};

/// A table that scrolls sideways where the page is narrow.
pub(super) fn table<T: AsRef<str>>(head: &[T], rows: &Markup) -> Markup {
    html! {
        div class="scroll" { table {
            thead { tr { @for head in head { th scope="col" { (head.as_ref()) } } } }
            tbody { (rows) }
        } }
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

/// End of the names of errors, which have a table of their own.
const ERROR: &str = "_error";

/// Numbers of the summary in words and units, but for the errors.
pub(super) fn results(readings: &[(String, f64)]) -> Vec<(String, String)> {
    let row = |(name, value): &(String, f64)| {
        let (words, unit) = words_and_unit(name);
        // A count has no decimals.
        let digits =
            if name.ends_with("iterations") { value.to_string() } else { significant(*value, 4) };
        let amount = format!("{} {unit}", digits.replace('-', "−"));
        (words, amount.trim_end().to_owned())
    };
    readings.iter().filter(|(name, _)| !name.ends_with(ERROR)).map(row).collect()
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
    rows.push(("damping".to_owned(), damping_words(link.damping())));
    rows.extend(link.drive().map(|drive| ("drive".to_owned(), drive_words(drive))));
    if let Some(gravity) = link.gravity() {
        let [along_x, along_y] = gravity.acceleration_m_s2.map(|part| given(part, "m/s²"));
        rows.push(("gravity".to_owned(), format!("{along_x} along x, {along_y} along y")));
        let start = gravity.start_angle_rad.map(|angle| given(angle, "rad"));
        let start = start.unwrap_or_else(|| "that of the motion".into());
        rows.push(("start angle".to_owned(), start));
    }
    rows
}

fn drive_words(drive: &Drive) -> String {
    let (ratio, rotor) = (given(drive.gear_ratio, ""), given(drive.rotor_inertia_kg_m2, "kg m²"));
    let stiffness = drive.joint_stiffness_n_m_rad;
    let joint = if stiffness.is_finite() { given(stiffness, "N m/rad") } else { "stiff".into() };
    format!("gear ratio {ratio}; rotor {rotor}; joint {joint}")
}

/// A damping law with its numbers, where it is given by them.
fn damping_words(damping: &Damping) -> String {
    let name = damping.name();
    let list = |ratios: &[f64]| ratios.iter().map(|r| given(*r, "")).collect::<Vec<_>>().join(", ");
    match damping {
        Damping::Hysteretic { ratio } => format!("{name}, ratio {}", given(*ratio, "")),
        Damping::Modal { ratios } => format!("{name}, ratios {}", list(ratios)),
        Damping::Rayleigh { alpha_per_s, beta_s } => {
            format!("{name}, α {}, β {}", given(*alpha_per_s, "1/s"), given(*beta_s, "s"))
        }
        _ => name.to_owned(),
    }
}

/// Natural frequencies in Hz with their damping ratios, and the first zeros.
pub(super) fn modes(run: &StoredRun) -> Markup {
    let frequencies = natural_frequencies(&run.mesh, REPORTED_MODES);
    let ratios = DampingLaw::of(&run.link, &run.mesh)
        .map(|law| damping_ratios((&run.link, &run.mesh, &law), PoseHub::Free, &frequencies));
    let ratio = |k: usize| match &ratios {
        Err(_) => "not known".to_owned(),
        Ok(all) if all[k].is_nan() => "none: it does not vibrate".to_owned(),
        Ok(all) => given(all[k], ""),
    };
    let rows = html! {
        @for (k, omega) in frequencies.iter().enumerate() { tr {
            th scope="row" { (k + 1) }
            td { (significant(omega / TAU, 4)) }
            td { (significant(TAU / omega, 4)) }
            td { (ratio(k)) }
        } }
    };
    let zeros: Vec<String> = torque_zeros(&run.mesh, REPORTED_ZEROS)
        .iter()
        .map(|zero| format!("±{}", significant(*zero, 4)))
        .collect();
    html! {
        @if !frequencies.is_empty() {
            h3 { "Modes, the hub free" @if run.link.has_weight() { ", without gravity" } }
            (table(&["mode", "frequency in Hz", "period in s", "damping ratio"], &rows))
        }
        @if !zeros.is_empty() { p { "Real zeros of torque → tip: " (zeros.join(", ")) " 1/s." } }
    }
}

/// Heading of the tip's error, which is of no kind: what it is off by is known at every moment.
const WANTED: &str = "from the wanted motion";

/// Kinds of errors, the last part of their names.
const KINDS: [&str; 8] =
    ["mesh", "window", "step", "iteration", "modes", "input", "model", "refinement"];

/// What each quantity may be off by, a column for each kind, and what that is a share of.
pub(super) fn errors(run: &StoredRun) -> Markup {
    let mut kinds: Vec<&str> = Vec::new();
    let mut found: Vec<(&str, Vec<(&str, f64)>)> = Vec::new();
    for (name, error) in &run.readings {
        let Some(name) = name.strip_suffix(ERROR) else { continue };
        let of_kind = |kind: &&&str| name.ends_with(&format!("_{kind}"));
        let kind = KINDS.iter().find(of_kind).copied().unwrap_or(WANTED);
        let quantity =
            name.strip_suffix(kind).map_or(name, |quantity| quantity.trim_end_matches('_'));
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
        match found.iter_mut().find(|(own, _)| *own == quantity) {
            Some((_, errors)) => errors.push((kind, *error)),
            None => found.push((quantity, vec![(kind, *error)])),
        }
    }
    let of = |quantity: &str| match quantity {
        "tip" => "the tip's travel".to_owned(),
        _ if run.link.has_weight() => format!("the range of the {}", quantity.replace('_', " ")),
        _ => format!("the peak of the {}", quantity.replace('_', " ")),
    };
    let head: Vec<&str> =
        ["quantity"].into_iter().chain(kinds.iter().copied()).chain(["share of"]).collect();
    let rows = html! {
        @for (quantity, errors) in &found { tr {
            th scope="row" { (quantity.replace('_', " ")) }
            @for kind in &kinds {
                td { @if let Some((_, error)) = errors.iter().find(|(own, _)| own == kind) { (significant(*error, 2)) } }
            }
            td { (of(quantity)) }
        } }
    };
    html! {
        @if !found.is_empty() {
            h3 { "Errors" }
            p { "What each quantity may be off by, as a share." }
            (table(&head, &rows))
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

/// The table of `verify`.
pub(super) fn checks(checks: &[Check]) -> Markup {
    let rows = html! {
        @for check in checks { tr {
            th scope="row" { (check.what) }
            @match check.found.zip(check.bound) {
                Some((found, bound)) => {
                    td { (significant(found, digits_beyond(found, bound))) }
                    td { (significant(bound, 2)) }
                }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_check_that_fails_by_little_shows_a_number_beyond_its_bound() {
        let check = Check {
            name: "limit_hub_rate".to_owned(),
            what: "limits.hub_rate".to_owned(),
            of: "the limit".to_owned(),
            found: Some(1.036),
            bound: Some(1.0),
            reason: None,
            passes: false,
            hint: "",
        };
        let page = checks(&[check]).into_string();
        assert!(page.contains(">1.04</td><td>1.0</td>"), "{page}");
    }
}
