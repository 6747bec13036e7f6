//! Results side by side: their inputs and numbers, and the figures that hold one of them alone.

use maud::{Markup, html};

use super::tables::{amount, table, words_and_unit};
use super::tip::strays;
use super::view::{ERROR, View, reading};
use crate::result::{Origin, StoredInput, StoredRun};
use crate::text::significant;

/// The runs of a page side by side; `None` for a single run.
pub(super) fn beside(view: &View) -> Option<Markup> {
    let names: Vec<&str> = view.runs.iter().map(|run| run.name.as_str()).collect();
    let head = [&["quantity"], &names[..]].concat();
    let rows = numbers(view);
    let rows = html! {
        @for (name, cells) in &rows { tr {
            th scope="row" { span class="own" { (name) } }
            @for cell in cells { td { span class="own" { (cell) } } }
        } }
    };
    let origins: Vec<&Origin> = view.runs.iter().map(|run| &run.origin).collect();
    let content = html! {
        (table(&head, &rows))
        (differences(&names, &origins))
        p {
            "Captions, errors, checks and the link are those of " (view.first().name) ", and so are limits, lead and lag in the \
             figures."
        }
    };
    (view.runs.len() > 1).then_some(content)
}

/// Names of numbers, with a cell for each run: of the joints, then of the whole arm, then the tip's error.
fn numbers(view: &View) -> Vec<(String, Vec<String>)> {
    let joints = view.runs.iter().map(|run| run.joints.len()).max().unwrap_or(0);
    let mut rows = Vec::new();
    for joint in 0..joints {
        let of = |run: &'_ StoredRun| run.joints.get(joint).map(|own| own.readings.clone());
        let prefix = if joints > 1 { format!("joint {}: ", joint + 1) } else { String::new() };
        rows.extend(of_all(view, &prefix, of));
    }
    rows.extend(of_all(view, "carriage: ", |run| {
        Some(run.carriage.as_ref()?.joint.readings.clone())
    }));
    // The numbers of a single link are those of its joint.
    rows.extend(of_all(view, "", |run| run.arc.is_none().then(|| run.readings.clone())));
    let strays = strays(view);
    let worst = |run: usize| {
        let own = strays.iter().find(|own| own.run == run);
        own.map_or(String::new(), |own| format!("{} m", significant(own.largest_m(), 4)))
    };
    if !strays.is_empty() {
        let cells = (0..view.runs.len()).map(worst).collect();
        rows.push(("largest distance of the tip from the wanted motion".to_owned(), cells));
    }
    rows
}

/// Numbers that some run has, by name, with a cell for each run.
fn of_all(
    view: &View,
    prefix: &str,
    of: impl Fn(&StoredRun) -> Option<Vec<(String, f64)>>,
) -> Vec<(String, Vec<String>)> {
    let all: Vec<Vec<(String, f64)>> =
        view.runs.iter().map(|run| of(run).unwrap_or_default()).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in all.iter().flatten().filter(|(name, _)| !name.ends_with(ERROR)) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let cell = |own: &Vec<(String, f64)>, name: &str| {
        reading(own, name).map_or(String::new(), |value| amount(name, value))
    };
    let row = |name: &str| {
        (
            format!("{prefix}{}", words_and_unit(name).0),
            all.iter().map(|own| cell(own, name)).collect(),
        )
    };
    names.into_iter().map(row).collect()
}

/// Commands, input files and arguments, which may differ.
pub(super) fn differences(names: &[&str], origins: &[&Origin]) -> Markup {
    let mut roles: Vec<&str> = Vec::new();
    for input in origins.iter().flat_map(|own| &own.inputs) {
        if !roles.contains(&input.role.as_str()) {
            roles.push(&input.role);
        }
    }
    let of = |origin: &Origin, role: &str| {
        origin.inputs.iter().find(|input| input.role == role).cloned()
    };
    let row = |role: &&str| {
        let all: Vec<_> = origins.iter().map(|own| of(own, role)).collect();
        let first = all.iter().flatten().next().map(|input| &input.sha256);
        let is_same = all.iter().flatten().all(|own| Some(&own.sha256) == first);
        let name = |own: &Option<StoredInput>| {
            own.as_ref().map_or("none".to_owned(), |own| match own.sha256.get(..8) {
                Some(start) if !is_same => format!("{} ({start}…)", own.name),
                _ => own.name.clone(),
            })
        };
        let differs = if is_same { "" } else { ", which differ" };
        (format!("{role}{differs}"), all.iter().map(name).collect::<Vec<_>>())
    };
    let rows: Vec<_> = roles.iter().map(row).collect();
    let text = |of: &dyn Fn(&Origin) -> String| origins.iter().map(|own| of(own)).collect();
    let command: Vec<String> = text(&|own| own.command.clone());
    let arguments: Vec<String> = text(&|own| own.arguments.join(" "));
    let last = [("command".to_owned(), command), ("arguments".to_owned(), arguments)];
    let rows = html! {
        @for (name, cells) in rows.iter().chain(&last) { tr {
            th scope="row" { (name) }
            @for cell in cells { td { (cell) } }
        } }
    };
    html! {
        h3 { "Inputs" }
        (table(&[&["input"], names].concat(), &rows))
    }
}

/// Figures and lines that hold a part of the runs alone, with reasons.
pub(super) fn drawn_apart(view: &View) -> Vec<String> {
    let first = view.first();
    let mut apart = Vec::new();
    for other in &view.runs[1..] {
        let kind = |run: &StoredRun| match run.arc {
            Some(_) if run.links[0].link.joint().slides() => "a sliding link",
            Some(_) => "a turning link",
            None => "an arm",
        };
        let [own, of_first] = [other, first].map(kind);
        if own != of_first {
            let what = match (other.arc.is_some(), first.arc.is_some()) {
                (true, true) => "the joint",
                _ => "the tip, and any joint that only one has,",
            };
            let [of_other, of_first_name] = [other, first].map(|run| &run.name);
            apart.push(format!(
                "{what} of {of_other}, since it is {own} and {of_first_name} {of_first}"
            ));
        } else if other.joints.len() != first.joints.len() {
            let [links, of_first] = [other, first].map(|run| run.joints.len());
            apart.push(format!(
                "joints of {} beyond the first {}, since it has {links} and {} {of_first}",
                other.name,
                links.min(of_first),
                first.name
            ));
        }
    }
    if view.runs.len() > 1 {
        let alone = view.pick("mode shapes and the tip under the rigid link's torque", "poses");
        apart.push(format!(
            "waves, animation, {alone} of other results than {}, since these figures hold one",
            first.name
        ));
    }
    apart
}
