//! Results side by side: their inputs and numbers, and the figures that hold one of them alone.

use maud::{Markup, html};

use super::tables::{amount, of_carriage, of_whole, table, words_and_unit};
use super::tip::strays;
use super::view::{ERROR, View, reading};
use super::words::own;
use crate::link::Joint;
use crate::result::{Origin, QUANTITIES, StoredInput, StoredRun};
use crate::text::significant;

/// The runs of a page side by side; `None` for a single run.
pub(super) fn beside(view: &View) -> Option<Markup> {
    let names: Vec<String> = view.runs.iter().map(|run| own(&run.name)).collect();
    let head = [&["quantity".to_owned()], &names[..]].concat();
    let rows = numbers(view);
    // Each number has the words of its own joint.
    let rows = html! {
        @for (name, cells) in &rows { tr {
            th scope="row" { (own(name)) }
            @for cell in cells { td { (own(cell)) } }
        } }
    };
    let origins: Vec<&Origin> = view.runs.iter().map(|run| &run.origin).collect();
    let content = html! {
        (table(&head, &rows))
        (differences(&names, &origins))
        p {
            "Captions, errors, checks and the link are those of " (names[0]) ", and so are limits, lead and lag in the \
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
        // The numbers of a single link hold those of its tip, too.
        let of = |run: &StoredRun| {
            let readings = run.joints.get(joint)?.readings.iter();
            let own = readings.filter(|(name, _)| run.arc.is_none() || is_of_joint(name));
            Some(own.cloned().collect())
        };
        let prefix = if joints > 1 { format!("joint {}: ", joint + 1) } else { String::new() };
        rows.extend(of_all(view, &prefix, of));
    }
    rows.extend(of_all(view, "carriage: ", |run| Some(of_carriage(run.carriage.as_ref()?))));
    rows.extend(of_all(view, "", |run| Some(of_tip(run))));
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

/// True for a number of a joint, of its link or its motor.
fn is_of_joint(name: &str) -> bool {
    let is_column = |column: String| column == name || Joint::CARRIAGE.named(&column) == name;
    QUANTITIES.iter().any(|quantity| is_column(quantity.column(None)))
}

/// Numbers of a whole run, by the same names for a solution and a simulation, a link and an arm.
fn of_tip(run: &StoredRun) -> Vec<(String, f64)> {
    let readings = of_whole(run).into_iter().filter(|(name, _)| !is_of_joint(name));
    let mut readings: Vec<(String, f64)> = readings
        .map(|(name, value)| {
            (if name == "travel_m" { "tip_travel_m".to_owned() } else { name }, value)
        })
        .collect();
    let farthest = run.arc.as_ref().filter(|_| reading(&readings, "farthest_m").is_none());
    readings.extend(farthest.map(|arc| ("farthest_m".to_owned(), arc.tip.largest_travel_m())));
    readings
}

/// Numbers that some run has, by name, with a cell for each run. The words of the `prefix` are not repeated.
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
        let words = words_and_unit(name).0;
        let words = if prefix.is_empty() {
            words
        } else {
            words.replace("hub ", "").replace("carriage ", "")
        };
        (format!("{prefix}{words}"), all.iter().map(|own| cell(own, name)).collect())
    };
    names.into_iter().map(row).collect()
}

/// Commands, input files and arguments, which may differ.
pub(super) fn differences(names: &[String], origins: &[&Origin]) -> Markup {
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
            @for cell in cells { td { (own(cell)) } }
        } }
    };
    html! {
        h3 { "Inputs" }
        (table(&[&["input".to_owned()], names].concat(), &rows))
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
        let [of_own, of_first] = [other, first].map(kind);
        if of_own != of_first {
            let what = match (other.arc.is_some(), first.arc.is_some()) {
                (true, true) => "the joint",
                _ => "the tip, and any joint that only one has,",
            };
            let [of_other, of_first_name] = [other, first].map(|run| own(&run.name));
            apart.push(format!(
                "{what} of {of_other}, since it is {of_own} and {of_first_name} {of_first}"
            ));
        } else if other.joints.len() != first.joints.len() {
            let [links, of_first] = [other, first].map(|run| run.joints.len());
            apart.push(format!(
                "joints of {} beyond the first {}, since it has {links} and {} {of_first}",
                own(&other.name),
                links.min(of_first),
                own(&first.name)
            ));
        }
    }
    if view.runs.len() > 1 {
        let alone = view.pick("mode shapes and the tip under the rigid link's torque", "poses");
        apart.push(format!(
            "waves, animation, {alone} of other results than {}, since these figures hold one",
            own(&first.name)
        ));
        let has_rigid = |run: &&StoredRun| {
            let joint = view.joint(run, 0);
            joint.is_some_and(|joint| joint.rigid_torque_n_m.is_some())
        };
        let mut rigid = view.runs.iter().filter(has_rigid);
        if let (Some(drawn), Some(_)) = (rigid.next(), rigid.next()) {
            let lines = view.pick("rigid links", "rigid arms");
            let name = own(&drawn.name);
            let why = "since these figures hold one";
            apart.push(format!("the {lines} of other results than {name}, {why}"));
        }
    }
    apart
}
