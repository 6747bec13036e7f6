//! Tables of a page: names and values, modes, errors, limits, checks.

use std::f64::consts::TAU;

use maud::{Markup, html};

use super::axis::digits;
use super::link::given;
use super::view::{ERROR, Single, View};
use crate::modal::{
    DampingLaw, PoseHub, REPORTED_MODES, REPORTED_ZEROS, natural_frequencies, torque_zeros,
};
use crate::response::damping_ratios;
use crate::result::{Check, StoredCarriage, StoredRun};
use crate::text::{after, before, digits_beyond, significant};

/// A table that scrolls sideways on a narrow page.
pub(super) fn table<T: AsRef<str>>(head: &[T], rows: &Markup) -> Markup {
    html! {
        div class="scroll" { table {
            thead { tr { @for head in head { th scope="col" { (head.as_ref()) } } } }
            tbody { (rows) }
        } }
    }
}

/// Units by the suffix of a name; a longer suffix comes before a suffix that it ends in.
const UNITS: [(&str, &str); 18] = [
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
    ("_n", "N"),
    ("_s", "s"),
    ("_w", "W"),
    ("_a", "A"),
    ("_v", "V"),
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

/// A number of the summary with its unit.
pub(super) fn amount(name: &str, value: f64) -> String {
    // Their signs need words.
    match name {
        "lead_s" if value < 0.0 => {
            return before(value, 4) + " the tip has set out";
        }
        "lead_s" => return before(value, 4) + " the tip moves",
        "lag_s" if value < 0.0 => return after(value, 4) + " the tip stops",
        "lag_s" => return after(value, 4) + " the tip has stopped",
        _ => {}
    }
    // A count has no decimals.
    let is_count = name.ends_with("iterations");
    let number = if is_count { value.to_string() } else { digits(value, 4) };
    format!("{number} {}", words_and_unit(name).1).trim_end().to_owned()
}

/// Numbers of the summary in words and units, without the errors.
pub(super) fn results(readings: &[(String, f64)]) -> Vec<(String, String)> {
    let rows = readings.iter().filter(|(name, _)| !name.ends_with(ERROR));
    rows.map(|(name, value)| (words_and_unit(name).0, amount(name, *value))).collect()
}

/// Numbers of a whole run, without those of an arm's carriage, which stand apart.
pub(super) fn of_whole(run: &StoredRun) -> Vec<(String, f64)> {
    let readings = run.readings.iter();
    readings.filter(|(name, _)| !name.starts_with("carriage_")).cloned().collect()
}

/// Numbers of an arm's carriage. Of its places only what the grid of the answer resolves is shown.
pub(super) fn of_carriage(carriage: &StoredCarriage) -> Vec<(String, f64)> {
    const RESOLVED: f64 = 1e-6;
    let joint = &carriage.joint;
    let noise_m = RESOLVED * joint.reading("peak_carriage_travel_m").unwrap_or(0.0);
    let is_noise =
        |name: &str, value: f64| ["start_m", "end_m"].contains(&name) && value.abs() < noise_m;
    let shown = |(name, value): &(String, f64)| {
        (name.clone(), if is_noise(name, *value) { 0.0 } else { *value })
    };
    joint.readings.iter().map(shown).collect()
}

/// Numbers of an arm's joints, with a column each; empty without numbers.
pub(super) fn joints(arm: &StoredRun) -> Markup {
    let names = distinct(arm.joints.iter().flat_map(|joint| &joint.readings));
    let head = (1..=arm.joints.len()).map(|number| format!("joint {number}"));
    let head: Vec<String> = ["quantity".to_owned()].into_iter().chain(head).collect();
    let rows = html! {
        @for name in &names { tr {
            th scope="row" { (words_and_unit(name).0.replace("hub ", "")) }
            @for joint in &arm.joints {
                td { @if let Some(value) = joint.reading(name) { (amount(name, value)) } }
            }
        } }
    };
    html! { @if !names.is_empty() { (table(&head, &rows)) } }
}

/// Distinct names of numbers, in their order.
fn distinct<'a>(numbers: impl Iterator<Item = &'a (String, f64)>) -> Vec<&'a str> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in numbers {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    names
}

/// Natural frequencies in Hz with their damping ratios, and the first zeros.
pub(super) fn modes(run: Single) -> Markup {
    let frequencies = natural_frequencies(&run.arc.mesh, REPORTED_MODES);
    let ratios = DampingLaw::of(run.link, &run.arc.mesh)
        .map(|law| damping_ratios((run.link, &run.arc.mesh, &law), PoseHub::Free, &frequencies));
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
    let zeros: Vec<String> = torque_zeros(&run.arc.mesh, REPORTED_ZEROS)
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

/// Error of each quantity of each joint, with a column for each kind, and the reference of the errors.
pub(super) fn errors(view: &View) -> Option<Markup> {
    let (is_arm, has_weight) = (view.is_arm(), view.has_weight());
    let carriage = view.first().carriage.iter().map(|own| &own.joint);
    let joints = view.first().joints.iter().chain(carriage).enumerate();
    let all: Vec<_> = joints.flat_map(|(k, j)| j.errors.iter().map(move |of| (k, of))).collect();
    let kinds = distinct(all.iter().flat_map(|(_, (_, kinds))| kinds));
    let size = if has_weight { "range" } else { "peak" };
    let joint = view.pick("hub", "joint");
    let words = |quantity: &str| quantity.replace("hub", joint).replace('_', " ");
    let of = |quantity: &str| match quantity {
        "tip" => "the tip's travel".to_owned(),
        _ => format!("the {size} of the {}", words(quantity)),
    };
    let (number, share) = view.pick((&[][..], &["share of"][..]), (&["joint"], &[]));
    let head = [&["quantity"], number, &kinds, share].concat();
    let rows = html! {
        @for (k, (quantity, errors)) in &all { tr {
            th scope="row" { (words(quantity)) }
            @if is_arm { td { @if *k < view.first().joints.len() { (k + 1) } @else { "carriage" } } }
            @for kind in &kinds {
                td { @if let Some((_, error)) = errors.iter().find(|(own, _)| own == kind) { (significant(*error, 2)) } }
            }
            @if !is_arm { td { (of(quantity)) } }
        } }
    };
    let content = html! {
        p { "Possible error of each quantity, as a share" (view.pick(String::new(), format!(" of its own {size}"))) "." }
        (table(&head, &rows))
    };
    (!all.is_empty()).then_some(content)
}

/// Table of `verify`, if present.
pub(super) fn checks(checks: &[Check]) -> Option<Markup> {
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
    let content = html! {
        p { "The answer, checked by independent methods." }
        (table(&["check", "found", "at most", "of", "verdict"], &rows))
    };
    (!checks.is_empty()).then_some(content)
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
        let page = checks(&[check]).unwrap().into_string();
        assert!(page.contains(">1.04</td><td>1.0</td>"), "{page}");
    }
}
