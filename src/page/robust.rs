//! Figures of a study of plants that differ from the link file, and its page.

use std::ops::Range;

use maud::{Markup, html};

use super::axis::{Axis, TIME, raised};
use super::beside::differences;
use super::document::{
    FILES, Section, advice, all_figures, document, inputs, made_by, with_others,
};
use super::figure::{Curve, Figure, Figures, Mark, Stroke};
use super::sweep::links_drawn;
use super::tables::{readings, table};
use super::view::run_stroke;
use super::words::{MEASURES, formula, own, worded_text};
use crate::compare::Cell;
use crate::robust::{
    Help, Inside, KeyOutcome, Measure, OverLimit, PlantKind, StoredRobust, share_words,
};
use crate::text::significant;

/// Classes of marks; the names of each class stand in a row of their own.
const ROWS: [&str; 8] = ["m1", "m2", "m3", "m4", "m5", "m6", "m7", "m8"];

/// Height of a row of names, and of the plot, in pixels.
const ROW: f64 = 14.0;
const PLOT: f64 = 220.0;

/// Figures of the first study, with the others where a figure holds several.
pub(super) fn robust_figures(studies: &[StoredRobust]) -> Figures {
    let (study, others) = (&studies[0], &studies[1..]);
    let mut figures = Figures::default();
    let keys = study.summary.by_share();
    figures.add(envelope(studies));
    figures.extend((keys.len() > 1).then(|| Ok(bars(study, &keys))));
    figures.extend((1..).zip(&keys).map(|(number, own)| Ok(over_key(study, number, own))));
    figures.add(sample(studies));
    if !others.is_empty() {
        let why = "since these figures hold one";
        let alone = format!("values of other studies than {}, {why}", own(&study.name));
        figures.omitted.push(alone);
    }
    figures
}

/// A length in m in percent of the travel.
fn percent(study: &StoredRobust, m: f64) -> f64 {
    100.0 * m / study.summary.travel_m
}

/// A measure of each plant in percent of the travel.
fn of_plants(study: &StoredRobust, measure: Measure) -> impl Fn(usize) -> f64 {
    let (name, per_m) = match measure {
        Measure::TipError => ("tip_error", 100.0),
        Measure::RestVibration => ("rest_vibration", 100.0),
        Measure::Drift => ("drift_m", percent(study, 1.0)),
    };
    let column = study.plants.column(name);
    move |row| column.map_or(f64::NAN, |own| per_m * own.number(row).abs())
}

/// Rows of plants of a kind.
fn rows(study: &StoredRobust, kind: PlantKind) -> impl Iterator<Item = usize> {
    let is_kind = move |row: &usize| study.plants.columns[0].cell(*row) == Cell::Word(kind.word());
    (0..study.plants.lines.len()).filter(is_kind)
}

/// Adds marks, each with its name in a row of its own, and room for these rows at the top.
fn marked<L: Into<String>>(
    figure: Figure,
    marks: impl IntoIterator<Item = (Option<f64>, L)>,
) -> Figure {
    let marks = marks.into_iter().filter_map(|(at, label)| Some((at?, label.into()))).zip(ROWS);
    let marks: Vec<Mark> = marks.map(|((at, label), class)| Mark { at, label, class }).collect();
    let Range { start, end } = figure.y.range;
    let rows = ROW * (marks.len() as f64 + 0.5);
    let y = Axis { range: start..start + (end - start) / (1.0 - rows / PLOT), ..figure.y.clone() };
    Figure { y, marks, ..figure }
}

/// Name of a line, with that of the study if there are several.
fn named(studies: &[StoredRobust], study: &StoredRobust, line: &str) -> String {
    if studies.len() > 1 { format!("{line}, {}", own(&study.name)) } else { line.to_owned() }
}

/// Lowest and highest error over time, of all studies.
fn envelope(studies: &[StoredRobust]) -> Result<Figure, String> {
    let study = &studies[0];
    let summary = &study.summary;
    let runs = summary.sample.runs;
    if runs == 0 {
        return Err("the error over time, since no plant is drawn: --runs is 0".to_owned());
    }
    let sizes =
        if study.links.len() > 1 { " The errors are distances, without a sign." } else { "" };
    let mut caption =
        format!("Lowest and highest error of the tip among the {runs} drawn plants.{sizes}");
    let line = |k: usize, own: &StoredRobust, side: usize| {
        // A row of the legend holds the lines of two studies.
        let words = if studies.len() > 1 {
            ["lowest", "highest"]
        } else {
            ["lowest error", "highest error"]
        };
        let name = named(studies, own, words[side]);
        let colour = 2 - side;
        let stroke = if k == 0 { Stroke::Solid(colour) } else { Stroke::Dashed(2 * k + colour) };
        Curve::new(&name, stroke, &own.times_s, &own.envelope_m[side])
    };
    // A study without drawn plants has no envelope.
    let drawn = studies.iter().enumerate().filter(|(_, own)| own.summary.sample.runs > 0);
    let lines = drawn.clone().flat_map(|(k, own)| [1, 0].map(|side| line(k % 3, own, side)));
    let mut curves: Vec<Curve> = lines.collect();
    let band = format!("settling band {}", summary.both(summary.band_m));
    match Curve::limit((summary.band_m, &band), 0.0, 3, &curves) {
        Some(line) => curves.push(line),
        None => caption = format!("{caption} The {band} is beyond the figure."),
    }
    let end_s = summary.end_s;
    let marks = [
        (Some(end_s), "end of the motion"),
        (summary.nominal.period_s.map(|period_s| end_s + period_s), "one period later"),
        (summary.settling_p95_s.map(|after_s| end_s + after_s), "95 % settled"),
    ];
    let times = drawn.flat_map(|(_, own)| own.times_s.iter().copied());
    let (from, until) =
        times.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(t), high.max(t)));
    let x = Axis::linear(TIME, "s", from..until);
    let title = "Error of the tip over time";
    let figure = Figure::of_curves("envelope", title, caption, x, ("error", "m"), curves);
    Ok(marked(figure, marks).by(formula::ENVELOPE))
}

/// Errors that each key makes alone, the largest share first.
fn bars(study: &StoredRobust, keys: &[&KeyOutcome]) -> Figure {
    let places: Vec<f64> = (1..).take(keys.len()).map(f64::from).collect();
    let curve = |(measure, stroke): (Measure, Stroke)| {
        let sizes = keys.iter().map(|own| percent(study, own.worst[measure as usize].size_m));
        Curve::new(measure.word(), stroke, &places, &sizes.collect::<Vec<_>>())
    };
    let strokes = [Stroke::Columns(1), Stroke::Points(2), Stroke::Points(3)];
    let curves = Measure::ALL.into_iter().zip(strokes).map(curve).collect();
    let labels: Vec<String> = keys.iter().map(|outcome| own(outcome.key.name())).collect();
    let label =
        |(name, own): (&String, &&KeyOutcome)| format!("{name}: {}", share_words(own.share));
    let shares = labels.iter().zip(keys).map(label);
    let marks: Vec<_> = places.iter().map(|at| Some(*at)).zip(shares).collect();
    let named = places.iter().zip(&labels).map(|(number, name)| format!("{number}: {name}"));
    let caption = format!(
        "Largest errors that each value makes alone, the others as in the file. The percentages are shares of the tip \
         error. {}.",
        named.collect::<Vec<_>>().join(", ")
    );
    let range = 0.5..keys.len() as f64 + 0.5;
    let x = Axis { places, ..Axis::linear("key", "", range) };
    let title = "Which value it is";
    let figure = Figure::of_curves("keys", title, caption, x, ("error of the travel", "%"), curves);
    marked(figure, marks).by(formula::STRAYS)
}

/// Errors over one key, the others as in the file.
fn over_key(study: &StoredRobust, number: usize, outcome: &KeyOutcome) -> Figure {
    let (key, summary) = (&outcome.key, &study.summary);
    let place = 1 + summary.keys().position(|other| other == key).unwrap_or(0);
    // The first row is that of the file.
    let nominal = 0;
    let values = &study.plants.columns[1..=summary.keys.len()];
    let is_alone = |row: &usize| {
        let others = values.iter().enumerate().filter(|(k, _)| k + 1 != place);
        others.into_iter().all(|(_, column)| column.cell(*row) == column.cell(nominal))
    };
    let alone = rows(study, PlantKind::Key).filter(is_alone).chain([nominal]);
    let mut alone: Vec<(f64, usize)> =
        alone.map(|row| (values[place - 1].number(row), row)).collect();
    alone.retain(|(value, _)| value.is_finite());
    alone.sort_by(|a, b| a.0.total_cmp(&b.0));
    alone.dedup_by(|a, b| a.0.total_cmp(&b.0).is_eq());
    let curve = |(measure, colour): (Measure, usize)| {
        let size = of_plants(study, measure);
        let points = alone.iter().map(|(value, row)| (*value, size(*row))).collect();
        Curve { name: measure.word().to_owned(), stroke: Stroke::Dotted(colour), points }
    };
    let curves = Measure::ALL.into_iter().zip(1..).map(curve).collect();
    let ends = alone.first().zip(alone.last()).map_or(key.ends, |(low, high)| [low.0, high.0]);
    let margin = 0.03 * (ends[1] - ends[0]);
    let [name, unit] = [key.name(), raised(key.unit())].map(own);
    let x = Axis::linear(&name, &unit, ends[0] - margin..ends[1] + margin);
    let worst = outcome.worst[0];
    let file = key.nominal.map_or("The file has no such value".to_owned(), |nominal| {
        format!("The file has {}", own(key.amount(nominal)))
    });
    let (size, at) = (summary.percent(worst.size_m), own(key.amount(worst.value)));
    let inside = inside_words(study, outcome);
    let caption = format!(
        "All other values as in the file. {file}; the tip error is largest at {at}: {size}.{}",
        if inside.is_empty() { String::new() } else { format!(" Not monotone: {inside}.") }
    );
    let marks = [(key.nominal, "in the file"), (Some(worst.value), "worst")];
    let title = format!("Over {name}");
    let id = format!("key-{number}");
    let figure = Figure::of_curves(id, &title, caption, x, ("error of the travel", "%"), curves);
    marked(figure, marks).by(formula::STRAYS)
}

/// Share of the drawn plants below each tip error, of all studies.
fn sample(studies: &[StoredRobust]) -> Result<Figure, String> {
    let study = &studies[0];
    let sizes = |own: &StoredRobust| {
        let size = of_plants(own, Measure::TipError);
        let mut sizes: Vec<f64> = rows(own, PlantKind::Sample).map(size).collect();
        sizes.sort_by(f64::total_cmp);
        sizes
    };
    let all: Vec<(usize, &StoredRobust, Vec<f64>)> =
        studies.iter().enumerate().map(|(k, own)| (k, own, sizes(own))).collect();
    let Some(quantiles) = study.summary.quantiles.filter(|_| all[0].2.len() > 1) else {
        return Err("the distribution, since fewer than two plants are drawn".to_owned());
    };
    let curve = |(k, own, sizes): &(usize, &StoredRobust, Vec<f64>)| {
        let last = (sizes.len() - 1) as f64;
        let shares: Vec<f64> = (0..sizes.len()).map(|k| 100.0 * k as f64 / last).collect();
        Curve::new(&named(studies, own, "plants below"), run_stroke(*k), sizes, &shares)
    };
    let curves = all.iter().filter(|(.., sizes)| sizes.len() > 1).map(curve).collect();
    let of_one =
        if studies.len() > 1 { format!(" of {}", own(&study.name)) } else { String::new() };
    let caption = format!(
        "Share of the {} drawn plants whose tip error is smaller, with the quantiles{of_one}.",
        all[0].2.len()
    );
    let [of_tip, ..] = quantiles;
    let marks = [(of_tip.median_m, "50 %"), (of_tip.p95_m, "95 %"), (of_tip.p99_m, "99 %")];
    let marks = marks.map(|((at_m, _), label)| {
        let at = percent(study, at_m);
        (Some(at), format!("{label} below {} %", significant(at, 3)))
    });
    let x = Axis::around("tip error", "%", all.iter().flat_map(|(.., sizes)| sizes));
    let title = "Distribution of the tip error";
    let figure = Figure::of_curves("sample", title, caption, x, ("plants below", "%"), curves);
    Ok(marked(figure, marks).by(formula::SAMPLE))
}

/// A text in the words of the joint of its study, which may differ from that of the first.
fn in_its_words(study: &StoredRobust, text: &str) -> String {
    own(study.links.first().map_or_else(|| text.to_owned(), |link| worded_text(link, text, "")))
}

/// Worst and drawn plants of all studies, and their inputs, side by side.
fn beside(studies: &[StoredRobust]) -> Markup {
    let names: Vec<String> = studies.iter().map(|study| own(&study.name)).collect();
    let head = [&["measure".to_owned()], &names[..]].concat();
    let played = |study: &StoredRobust| {
        in_its_words(study, &study.summary.played_words(study.links.len() > 1))
    };
    let worst = |own: &StoredRobust, measure: Measure| {
        let found = own.summary.worst.iter().find(|own| own.measure == measure);
        found.map_or(String::new(), |found| own.summary.both(found.size_m))
    };
    let below = |own: &StoredRobust, measure: Measure| {
        let quantile = own.summary.quantiles.map(|all| all[measure as usize].p95_m);
        quantile.map_or(String::new(), |found| own.summary.quantile(found))
    };
    let rows = html! {
        @for measure in Measure::ALL {
            tr {
                th scope="row" { "worst " (measure.word()) }
                @for own in studies { td { (worst(own, measure)) } }
            }
            tr {
                th scope="row" { (measure.word()) " of 95 % of the drawn plants" }
                @for own in studies { td { (below(own, measure)) } }
            }
        }
        tr {
            th scope="row" { "played" }
            @for study in studies { td { (played(study)) } }
        }
    };
    let origins: Vec<_> = studies.iter().map(|own| &own.origin).collect();
    html! { (table(&head, &rows)) (differences(&names, &origins)) }
}

/// The page of the first study, with its figures and the others beside it.
pub(super) fn robust_page(studies: &[StoredRobust], figures: &Figures) -> Markup {
    let study = &studies[0];
    let title = match study.origin.title.trim() {
        "" => "Uncertain values".to_owned(),
        title => format!("{title}, with uncertain values"),
    };
    let told = studies.iter().flat_map(|study| {
        let of = if studies.len() > 1 { format!("{}: ", study.name) } else { String::new() };
        let in_words = |text: &str| in_its_words(study, text);
        let told = study.warnings.iter();
        told.map(move |told| (own(of.clone() + &in_words(&told.message)), in_words(&told.hint)))
    });
    let warnings = advice(&told.collect::<Vec<_>>(), true).map(Section::warnings);
    let beside = (studies.len() > 1).then(|| beside(studies));
    let beside = beside.map(|content| Section::new("beside", "Side by side", content));
    let sections = [
        Some(all_figures(figures)),
        Some(Section::new("link", "Link", links_drawn(&study.links))),
        Some(Section::glossary(&MEASURES, None)),
        beside,
        Some(Section::new("results", "Results", results(study))),
        Some(Section::new("keys", "Values", keys(study))),
        Some(inputs(&study.origin)),
    ];
    let sections: Vec<Section> =
        warnings.into_iter().chain(sections.into_iter().flatten()).collect();
    let origin = html! {
        @for (k, study) in studies.iter().enumerate() {
            @if k > 0 { br; }
            @if studies.len() > 1 { strong { (own(&study.name)) } " " }
            (made_by(&study.origin))
        }
    };
    let title = with_others(&title, studies[1..].iter().map(|own| &own.name));
    document(&title, &origin, &sections, FILES, None)
}

/// The numbers of the study.
fn results(study: &StoredRobust) -> Markup {
    let summary = &study.summary;
    let count = |kind| rows(study, kind).count();
    let settles = summary.settling_words().map(|parts| parts.join(" "));
    let rows = [
        ("played", Some(summary.played_words(study.links.len() > 1))),
        ("travel of the tip", Some(format!("{} m", significant(summary.travel_m, 4)))),
        ("duration of the command", Some(format!("{} s", significant(summary.duration_s, 4)))),
        ("plants", Some(summary.plants_words(count).join(", "))),
        ("settling", settles),
        ("errors", Some(summary.errors_words().join("; "))),
    ];
    let rows = rows.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?)));
    let rows: Vec<(String, String)> = rows.collect();
    let worst = html! {
        @for own in &summary.worst { tr {
            th scope="row" { (own.measure.word()) }
            td { (summary.both(own.size_m)) }
            td {
                @let values = summary.values_words(&own.values);
                @if values.is_empty() { "the link of the file" } @else { code { (values.join(", ")) } }
            }
        } }
    };
    let drawn = html! {
        @for (measure, own) in Measure::ALL.into_iter().zip(summary.quantiles.iter().flatten()) { tr {
            th scope="row" { (measure.word()) }
            @for quantile in [own.median_m, own.p95_m, own.p99_m] { td { (summary.quantile(quantile)) } }
        } }
    };
    let (help, helps) = summary.by_help();
    let help = html! {
        @for Help { what, tip_error_m, rest_vibration_m, drift_m } in help { tr {
            th scope="row" { code { (what) } }
            @for size_m in [tip_error_m, rest_vibration_m, drift_m] { td { (summary.percent(*size_m)) } }
        } }
    };
    html! {
        (readings("Study", &rows))
        h3 { "Worst of all plants" }
        (table(&["measure", "size", "at"], &worst))
        @if summary.quantiles.is_some() {
            h3 { "Drawn plants" }
            (table(&["measure", "50 % below", "95 % below", "99 % below"], &drawn))
            p { "Of the travel, each with the standard error by the number of plants." }
        }
        @if !summary.over_limits.is_empty() {
            h3 { "Limits" }
            ul { @for own in summary.over_limits.iter().map(OverLimit::words) { li { (own) "." } } }
        }
        @if !summary.help.is_empty() {
            h3 { "Other commands" }
            (table(&["command", "tip error", "rest vibration", "drift"], &help))
            p {
                "At the worst of the corners and of the ends of each value, of the travel. "
                @if helps == 0 { "None leaves less than 95 % of the worst tip error." }
                @else { "The first " @if helps > 1 { (helps) " help." } @else { "helps." } }
            }
        }
    }
}

/// The keys with their intervals and errors, the largest share first.
fn keys(study: &StoredRobust) -> Markup {
    let summary = &study.summary;
    let head = [
        "key",
        "interval",
        "in the file",
        "share",
        "tip error alone",
        "at",
        "rest vibration alone",
        "drift alone",
        "worst inside",
    ];
    let amount = |own: &KeyOutcome, value: f64| html! { code { (own.key.amount(value)) } };
    let rows = html! {
        @for own in summary.by_share() { tr {
            @let [tip, rest, drift] = own.worst;
            @let [low, high] = own.key.ends;
            th scope="row" { code { (own.key.name()) } }
            td { (amount(own, low)) " … " (amount(own, high)) }
            td { @match own.key.nominal { Some(value) => (amount(own, value)), None => "none" } }
            td { (share_words(own.share)) }
            td { (summary.percent(tip.size_m)) }
            td { (amount(own, tip.value)) }
            td { (summary.percent(rest.size_m)) }
            td { (summary.percent(drift.size_m)) }
            td { (inside_words(study, own)) }
        } }
    };
    html! {
        p { "Each value alone, the others as in the file. The share is that of the sum of all tip errors alone." }
        (table(&head, &rows))
    }
}

/// Worst values inside the interval of a key.
fn inside_words(study: &StoredRobust, outcome: &KeyOutcome) -> String {
    let words = |inside: &Inside| {
        let at = own(outcome.key.amount(inside.value));
        let size = study.summary.percent(inside.size_m);
        format!("{} {size} at {at}", inside.measure.word())
    };
    outcome.inside.iter().map(words).collect::<Vec<_>>().join(", ")
}
