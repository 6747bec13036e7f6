//! Summary from `robust`.

use super::lines::{LABEL, labelled, wrapped};
use crate::link::Arm;
use crate::robust::{
    Help, KeyOutcome, Measure, OverLimit, PlantKind, RobustSummary, WorstPlant, share_words,
};
use crate::text::significant;

/// The summary of a study; `kinds` has the kind of each plant, `written` names the files.
pub(crate) fn robust_text(
    arm: &Arm,
    summary: &RobustSummary,
    kinds: &[PlantKind],
    written: String,
) -> String {
    let count = |kind: PlantKind| kinds.iter().filter(|own| **own == kind).count();
    let lines = [
        ("played", played_line(arm, summary)),
        ("plants", wrapped(summary.plants_words(count).into_iter(), "")),
        ("worst", worst_lines(summary)),
        ("drawn", drawn_lines(summary)),
        ("settles", below_each_other(summary.settling_words().into_iter().flatten())),
        ("keys", keys_line(summary)),
        ("inside", inside_line(summary)),
        ("limits", wrapped(summary.over_limits.iter().map(OverLimit::words), "")),
        ("helps", help_line(summary)),
        ("errors", summary.errors_words().join(&format!(";\n{:LABEL$}", ""))),
        ("written", written),
    ];
    labelled(arm, lines)
}

/// Lines below the first one of a label.
fn below_each_other(lines: impl IntoIterator<Item = String>) -> String {
    lines.into_iter().collect::<Vec<_>>().join(&format!("\n{:LABEL$}", ""))
}

fn played_line(arm: &Arm, summary: &RobustSummary) -> String {
    let what = arm.joint().worded(&summary.played_words(arm.pick(false, true)));
    let [travel, lasts] = [summary.travel_m, summary.duration_s].map(|own| significant(own, 4));
    let moves = format!("the tip travels {travel} m, the command lasts {lasts} s");
    below_each_other([format!("{what};"), moves])
}

/// The plant of a worst measure in words.
fn place(summary: &RobustSummary, worst: &WorstPlant) -> String {
    let values = summary.values_words(&worst.values);
    if values.is_empty() {
        "the link of the file".to_owned()
    } else {
        wrapped(values.into_iter(), "")
    }
}

fn worst_lines(summary: &RobustSummary) -> String {
    let mut lines: Vec<String> = Vec::new();
    for (number, own) in summary.worst.iter().enumerate() {
        lines.push(format!("{} {}", own.measure.word(), summary.both(own.size_m)));
        let next = summary.worst.get(number + 1);
        if next.is_none_or(|next| next.values != own.values) {
            lines.push(format!("at {}", place(summary, own)));
        }
    }
    below_each_other(lines)
}

fn drawn_lines(summary: &RobustSummary) -> String {
    let Some(quantiles) = &summary.quantiles else { return String::new() };
    let cells = quantiles
        .iter()
        .map(|own| [own.median_m, own.p95_m, own.p99_m].map(|own| summary.quantile(own)));
    let cells: Vec<[String; 3]> = cells.collect();
    let [first, second] = [0, 1]
        .map(|column| cells.iter().map(|own| own[column].chars().count()).fold(16, usize::max));
    let line = |name: &str, [p50, p95, p99]: [&str; 3]| {
        format!("{name:<14} {p50:<first$} {p95:<second$} {p99}")
    };
    let head = line("", ["50 % below", "95 % below", "99 % below"]);
    let lines = Measure::ALL.into_iter().zip(&cells);
    let lines =
        lines.map(|(measure, own)| line(measure.word(), own.each_ref().map(|own| &own[..])));
    below_each_other(std::iter::once(head).chain(lines))
}

/// The keys by their share of the tip error, the largest first.
fn keys_line(summary: &RobustSummary) -> String {
    let item = |own: &KeyOutcome| {
        let alone = summary.percent(own.worst[0].size_m);
        let (name, share) = (own.key.name(), share_words(own.share));
        format!("{name} makes {share} of the tip error ({alone} alone)")
    };
    wrapped(summary.by_share().into_iter().map(item), "")
}

fn inside_line(summary: &RobustSummary) -> String {
    let items = summary.keys.iter().filter(|own| !own.inside.is_empty()).map(|own| {
        let worst = own.inside.iter().map(|inside| {
            let (size, at) = (summary.percent(inside.size_m), significant(inside.value, 4));
            format!("{} {size} at {at}", inside.measure.word())
        });
        let indent = format!(",\n{:LABEL$}  ", "");
        let worst = worst.collect::<Vec<_>>().join(&indent);
        format!("{} is not monotone:\n{:LABEL$}  {worst}", own.key.heading(), "")
    });
    below_each_other(items)
}

/// Most characters of a command that helps with its numbers in one line.
const WIDE: usize = 68;

/// Commands that leave a smaller tip error, the best first; without any, that of the others.
fn help_line(summary: &RobustSummary) -> String {
    let (help, helps) = summary.by_help();
    let kept = if helps > 0 { &help[..helps] } else { &help[..] };
    let items = kept.iter().map(|Help { what, tip_error_m, rest_vibration_m, .. }| {
        let [tip, rest] = [*tip_error_m, *rest_vibration_m].map(|m| summary.percent(m));
        let numbers = format!("tip error {tip}, rest {rest}");
        let is_long = what.chars().count() + numbers.chars().count() > WIDE;
        let between = if is_long { format!("\n{:LABEL$}  ", "") } else { " ".to_owned() };
        format!("{what}:{between}{numbers}")
    });
    let none = (helps == 0 && !help.is_empty()).then(|| "nothing of these:".to_owned());
    below_each_other(none.into_iter().chain(items))
}
