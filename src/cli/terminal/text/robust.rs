//! Summary from `robust`.

use super::compare::counted;
use super::lines::{LABEL, labelled, wrapped};
use crate::link::Arm;
use crate::robust::{
    Distribution, Help, Hold, How, Key, Measure, PlantKind, RobustSummary, WorstPlant,
};
use crate::text::significant;

/// Largest tip error of a command that helps, over that of the study.
const HELPS: f64 = 0.95;

/// The summary of a study; `kinds` has the kind of each plant, `written` names the files.
pub(crate) fn robust_text(
    arm: &Arm,
    summary: &RobustSummary,
    kinds: &[PlantKind],
    written: String,
) -> String {
    let lines = [
        ("played", played_line(arm, summary)),
        ("plants", plants_line(summary, kinds)),
        ("worst", worst_lines(summary)),
        ("drawn", drawn_lines(summary)),
        ("settles", settling_line(summary)),
        ("keys", keys_line(summary)),
        ("inside", inside_line(summary)),
        ("limits", limits_line(summary)),
        ("helps", help_line(summary)),
        ("errors", errors_line(summary)),
        ("written", written),
    ];
    labelled(arm, lines)
}

/// A length as a share of the travel: `2.3 %`.
fn percent(m: f64, summary: &RobustSummary) -> String {
    format!("{} %", significant(100.0 * m / summary.travel_m, 3))
}

/// A share of a whole: `68 %`.
fn share(own: f64) -> String {
    format!("{} %", significant(100.0 * own, 2))
}

/// The same with the length.
fn both(m: f64, summary: &RobustSummary) -> String {
    format!("{} ({} m)", percent(m, summary), significant(m, 3))
}

fn played_line(arm: &Arm, summary: &RobustSummary) -> String {
    let effort = arm.joint().worded("torque");
    let position = arm.pick(arm.joint().worded("hub angle"), "angles of the joints".to_owned());
    let of = match &*summary.command {
        "inverse" => "of solve".to_owned(),
        "rigid" => "of rigid links".to_owned(),
        shaper => format!("of rigid links, shaped by {shaper}"),
    };
    let what = match summary.play {
        Hold::Position => format!("{position} {of}, held exactly"),
        Hold::Effort => format!("{effort} {of}, without feedback"),
        Hold::Feedback => {
            let gains = summary.feedback.iter().map(|(kp, kd)| format!("{kp},{kd}"));
            format!("{effort} {of}, with feedback {}", gains.collect::<Vec<_>>().join(","))
        }
    };
    let [travel, lasts] = [summary.travel_m, summary.duration_s].map(|own| significant(own, 4));
    format!("{what};\n{:LABEL$}the tip travels {travel} m, the command lasts {lasts} s", "")
}

fn plants_line(summary: &RobustSummary, kinds: &[PlantKind]) -> String {
    let count = |kind: PlantKind| kinds.iter().filter(|own| **own == kind).count();
    let drawn = match summary.sample.distribution {
        Distribution::Uniform => "uniform",
        Distribution::Normal => "normal",
    };
    let drawn = if summary.sample.fitted.is_some() { "from the fit" } else { drawn };
    let mut parts = vec![
        format!("{} on {}", count(PlantKind::Key), counted(summary.keys.len(), "key")),
        counted(count(PlantKind::Corner), "corner"),
    ];
    if summary.sample.runs > 0 {
        let seed = summary.sample.seed;
        parts.push(format!("{} drawn ({drawn}, seed {seed})", summary.sample.runs));
    }
    if summary.drawn_again > 0 {
        parts.push(format!("{} drawn again", summary.drawn_again));
    }
    wrapped(std::iter::once(format!("{} in all", summary.plants)).chain(parts), "")
}

/// A value of a key in its unit.
fn value(key: &Key, value: f64) -> String {
    let number = significant(value, 4);
    match &key.how {
        How::Factor => format!("{}* = {number}", key.path),
        How::Delay => format!("{} = {number} s", key.path),
        How::Value(unit) => format!("{} = {number} {unit}", key.path).trim_end().to_owned(),
    }
}

/// The plant of a worst measure in words.
fn place(summary: &RobustSummary, worst: &WorstPlant) -> String {
    let values = summary.keys().zip(&worst.values);
    let values = values.filter_map(|(key, own)| Some(value(key, (*own)?)));
    let values: Vec<String> = values.collect();
    if values.is_empty() {
        "the link of the file".to_owned()
    } else {
        wrapped(values.into_iter(), "")
    }
}

fn worst_lines(summary: &RobustSummary) -> String {
    let indent = format!("\n{:LABEL$}", "");
    let mut lines: Vec<String> = Vec::new();
    for (number, own) in summary.worst.iter().enumerate() {
        let size = both(own.size_m, summary);
        lines.push(format!("{} {size}", own.measure.word()));
        let next = summary.worst.get(number + 1);
        if next.is_none_or(|next| next.values != own.values) {
            lines.push(format!("at {}", place(summary, own)));
        }
    }
    lines.join(&indent)
}

fn drawn_lines(summary: &RobustSummary) -> String {
    let Some(quantiles) = &summary.quantiles else { return String::new() };
    let line = |(measure, own): (Measure, &crate::robust::Quantiles)| {
        let [p50, p95, p99] = [own.median_m, own.p95_m, own.p99_m].map(|[at, error]| {
            let [at, error] = [at, error].map(|m| 100.0 * m / summary.travel_m);
            format!("{} ± {} %", significant(at, 3), significant(error, 1))
        });
        format!("{:<14} {p50:<16} {p95:<16} {p99}", measure.word())
    };
    let head = format!("{:<14} {:<16} {:<16} 99 % below", "", "50 % below", "95 % below");
    let lines = Measure::ALL.into_iter().zip(quantiles).map(line);
    std::iter::once(head).chain(lines).collect::<Vec<_>>().join(&format!("\n{:LABEL$}", ""))
}

fn settling_line(summary: &RobustSummary) -> String {
    if summary.sample.runs == 0 {
        return String::new();
    }
    let band = both(summary.band_m, summary);
    match summary.settling_p95_s {
        Some(after_s) => {
            let after = significant(after_s, 3);
            format!(
                "95 % of the drawn plants stay within {band}\n{:LABEL$}from {after} s after the motion on",
                ""
            )
        }
        None => format!(
            "more than 5 % of the drawn plants do not stay within {band}\n{:LABEL$}in 10 periods after the motion",
            ""
        ),
    }
}

/// The keys by their share of the tip error, the largest first.
fn keys_line(summary: &RobustSummary) -> String {
    let mut keys: Vec<_> = summary.keys.iter().collect();
    keys.sort_by(|a, b| b.share.total_cmp(&a.share));
    let item = |own: &&crate::robust::KeyOutcome| {
        let name = match own.key.how {
            How::Factor => format!("{}*", own.key.path),
            _ => own.key.path.clone(),
        };
        let alone = percent(own.worst[0].size_m, summary);
        format!("{name} makes {} of the tip error ({alone} alone)", share(own.share))
    };
    wrapped(keys.iter().map(item), "")
}

fn inside_line(summary: &RobustSummary) -> String {
    let items = summary.keys.iter().filter(|own| !own.inside.is_empty()).map(|own| {
        let worst = own.inside.iter().map(|inside| {
            let (size, at) = (percent(inside.size_m, summary), significant(inside.value, 4));
            format!("{} {size} at {at}", inside.measure.word())
        });
        let indent = format!(",\n{:LABEL$}  ", "");
        let worst = worst.collect::<Vec<_>>().join(&indent);
        format!("{} is not monotone:\n{:LABEL$}  {worst}", own.key.heading(), "")
    });
    items.collect::<Vec<_>>().join(&format!("\n{:LABEL$}", ""))
}

fn limits_line(summary: &RobustSummary) -> String {
    let items = summary.over_limits.iter().map(|own| {
        let joint = own.joint.map_or(String::new(), |joint| format!("joint {}: ", joint + 1));
        let [limit, largest] = [own.limit, own.largest].map(|number| significant(number, 4));
        let share = share(own.share);
        format!(
            "{joint}{share} of the drawn plants exceed {} = {limit} {} (up to {largest})",
            own.key, own.unit
        )
    });
    wrapped(items, "")
}

/// Commands that leave a smaller tip error, the best first; without any, that of the others.
fn help_line(summary: &RobustSummary) -> String {
    let mut help: Vec<&Help> = summary.help.iter().collect();
    help.sort_by(|a, b| a.tip_error_m.total_cmp(&b.tip_error_m));
    let helps = help.iter().filter(|own| own.tip_error_m < HELPS * summary.worst_m()).count();
    let kept = if helps > 0 { &help[..helps] } else { &help[..] };
    let items = kept.iter().map(|Help { what, tip_error_m, rest_vibration_m, .. }| {
        let [tip, rest] = [*tip_error_m, *rest_vibration_m].map(|m| percent(m, summary));
        format!("{what}: tip error {tip}, rest {rest}")
    });
    let none = (helps == 0 && !help.is_empty()).then(|| "nothing of these:".to_owned());
    none.into_iter().chain(items).collect::<Vec<_>>().join(&format!("\n{:LABEL$}", ""))
}

fn errors_line(summary: &RobustSummary) -> String {
    let errors = summary.errors;
    let share = |m: f64| format!("{:.1e}", m / summary.travel_m);
    let common = if errors.common_m > 0.0 {
        let text = "taken off: the nominal link, as its damping differs in time";
        format!(";\n{:LABEL$}{} {text}", "", share(errors.common_m))
    } else {
        String::new()
    };
    format!(
        "plays {} of the travel (nominal and worst plant, in full){common}",
        share(errors.play_m)
    )
}
