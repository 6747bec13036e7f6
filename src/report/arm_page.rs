//! The page of an arm: what stands in it beside its figures.

use maud::{Markup, html};

use super::arm::{Shown, has_weight};
use super::arm_motion::Motion;
use super::figure::Figures;
use super::link::given;
use super::page::{FILES, Section, advice, animation, document, inputs, made_by, parted_figures};
use super::tables::{checks, link_readings, readings, results, table, words_and_unit};
use crate::result::{StoredArm, StoredWarning};
use crate::text::significant;

/// The page of the first of an arm's runs, with the others beside it.
pub(super) fn arm_page(arms: &[StoredArm], figures: &Figures) -> Markup {
    let shown = Shown::of(arms);
    let first = shown.first;
    let title = match first.origin.title.trim() {
        "" => "An arm of flexible links",
        title => title,
    };
    let mut sections = Vec::new();
    let warnings = told(arms, |arm| &arm.warnings);
    if !warnings.is_empty() {
        sections.push(Section::warnings(advice(&warnings, true)));
    }
    let motion = Motion::of(&shown);
    let data = motion.as_ref().map(|motion| motion.json(&shown));
    let (times, (from, until)) = (&first.times_s, shown.span_s);
    let [from, until, start, end] =
        [from, until, times[0], times[times.len() - 1]].map(|t| given(t, ""));
    let note = format!(
        "Over time the figures show {from} … {until} s of the {start} … {end} s that were computed."
    );
    let [leading, more] = parted_figures("Torques, tip and joints", figures, &note);
    sections.extend(leading);
    if let Some(motion) = &motion {
        let (heading, class) = ("The arm in motion", Some("needs-script"));
        let section = Section::new("animation", "Motion", animation("The arm while it moves"));
        sections.push(Section { heading, class, ..section });
        sections.push(Section::new("arm", "Poses", motion.drawing(&shown)));
    }
    sections.extend(more);
    let remarks = told(arms, |arm| &arm.remarks);
    if !remarks.is_empty() {
        sections.push(Section::new("remarks", "Remarks", advice(&remarks, false)));
    }
    sections.push(Section::glossary());
    sections.push(Section::new("results", "Results", tables(arms, &shown)));
    if first.joints.iter().any(|joint| !joint.errors.is_empty()) {
        sections.push(Section::new("errors", "Errors", errors(first)));
    }
    if !first.checks.is_empty() {
        sections.push(Section::new("checks", "Verification", checks(&first.checks)));
    }
    sections.extend(arms.iter().take(1).map(|arm| inputs(&arm.origin)));
    let origin = html! {
        @for (k, arm) in arms.iter().enumerate() {
            @if k > 0 { br; }
            @if arms.len() > 1 { strong { (arm.name) } " " }
            (made_by(&arm.origin))
        }
    };
    document(title, &origin, &sections, FILES, data.as_deref())
}

/// Warnings or remarks of all runs; those of several with the name of theirs.
fn told(arms: &[StoredArm], of: fn(&StoredArm) -> &Vec<StoredWarning>) -> Vec<StoredWarning> {
    let named = |arm: &StoredArm, warning: &StoredWarning| match arms.len() {
        1 => warning.clone(),
        _ => StoredWarning {
            message: format!("{}: {}", arm.name, warning.message),
            ..warning.clone()
        },
    };
    arms.iter().flat_map(|arm| of(arm).iter().map(move |warning| named(arm, warning))).collect()
}

fn tables(arms: &[StoredArm], shown: &Shown) -> Markup {
    let first = shown.first;
    let last = first.links.len() - 1;
    let link = |k: usize| {
        let mut rows = link_readings(&first.links[k].link);
        let body = rows.iter_mut().filter(|(name, _)| name == "payload" && k < last);
        body.for_each(|(name, _)| "body at its tip".clone_into(name));
        readings(&format!("Link {}{}", k + 1, shown.name_of(k)), &rows)
    };
    html! {
        div class="columns" { @for arm in arms { div {
            @if arms.len() > 1 { h3 { (arm.name) } }
            (joints(arm))
        } } }
        div class="columns" {
            @if !first.readings.is_empty() { (readings("Whole arm", &results(&first.readings))) }
            @for k in 0..first.links.len() { (link(k)) }
        }
    }
}

/// The numbers of the joints, a column each; nothing where there are none.
fn joints(arm: &StoredArm) -> Markup {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in arm.joints.iter().flat_map(|joint| &joint.readings) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let head = (1..=arm.joints.len()).map(|number| format!("joint {number}"));
    let head: Vec<String> = ["quantity".to_owned()].into_iter().chain(head).collect();
    let rows = html! {
        @for name in &names {
            @let (words, unit) = words_and_unit(name);
            tr {
                th scope="row" { (words) }
                @for joint in &arm.joints {
                    td { @if let Some(value) = joint.reading(name) {
                        (format!("{} {unit}", significant(value, 4).replace('-', "−")).trim_end())
                    } }
                }
            }
        }
    };
    html! { @if !names.is_empty() { (table(&head, &rows)) } }
}

/// What each quantity of each joint may be off by.
fn errors(arm: &StoredArm) -> Markup {
    let all = || {
        arm.joints.iter().enumerate().flat_map(|(k, joint)| {
            joint.errors.iter().map(move |(quantity, kinds)| (k, quantity, kinds))
        })
    };
    let mut head = vec!["quantity", "joint"];
    for (_, _, kinds) in all() {
        for (kind, _) in kinds {
            if !head.contains(&kind.as_str()) {
                head.push(kind);
            }
        }
    }
    let rows = html! {
        @for (k, quantity, kinds) in all() { tr {
            th scope="row" { (quantity.replace("hub", "joint").replace('_', " ")) }
            td { (k + 1) }
            @for kind in &head[2..] {
                td { @if let Some((_, error)) = kinds.iter().find(|(own, _)| own == kind) {
                    (significant(*error, 2))
                } }
            }
        } }
    };
    let of = if has_weight(arm) { "range" } else { "peak" };
    html! {
        p { "What each quantity may be off by, as a share of its own " (of) "." }
        (table(&head, &rows))
    }
}
