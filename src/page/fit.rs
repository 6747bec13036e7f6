//! The page of a fitted link and its figures: values, measured and fitted quantities, and overlays of both.

use maud::{Markup, html};

use super::axis::{Axis, digits};
use super::document::{Section, advice, all_figures, document, inputs, made_by};
use super::figure::{Curve, Figure, Figures, Mark, Stroke};
use super::tables::table;
use super::words::{GLOSSARY, formula};
use crate::fit::{
    Coordinate, FitOutcome, FittedValue, HubEnd, Observable, Overlay, Replaced, Residual, Spacing,
};
use crate::numeric::extremes;
use crate::result::Origin;
use crate::text::{plain, significant};

/// Content of the page of a fit.
#[derive(Debug, Clone)]
pub struct FitReport<'a> {
    /// Files, arguments and title of the link.
    pub origin: Origin,
    /// The fit.
    pub outcome: &'a FitOutcome,
    /// Values of the link file before and after; empty for a fit that is not to be trusted.
    pub replaced: &'a [Replaced],
    /// Name of the written link file, if there is one.
    pub written: Option<&'a str>,
}

/// The page of a fit, with its figures: one self-contained HTML file.
pub fn fit_page(report: &FitReport) -> String {
    let FitReport { origin, outcome, replaced, written } = report;
    let title = match origin.title.trim() {
        "" => "Fitted values".to_owned(),
        title => format!("{title}, fitted"),
    };
    let mut sections: Vec<Section> = warnings(outcome).map(Section::warnings).into_iter().collect();
    if !outcome.undetermined.is_empty() {
        let all = html! {
            ul { @for open in &outcome.undetermined { li { (sentence(&open.to_string())) } } }
        };
        sections.push(Section::new("undetermined", "Not determined", all));
    }
    let figures = figures(outcome);
    sections.push(all_figures(&figures));
    sections.push(Section::glossary(&GLOSSARY, None));
    let values = html! { (values(outcome)) (replacements(replaced, *written)) };
    sections.push(Section::new("values", "Values", values));
    if !outcome.other_answers.is_empty() {
        sections.push(Section::new("answers", "Other answers", other_answers(outcome)));
    }
    if !outcome.correlation.is_empty() && outcome.values.len() > 1 {
        sections.push(Section::new("correlations", "Correlations", correlations(outcome)));
    }
    sections.push(Section::new("measured", "Measured and fitted", measured(outcome)));
    sections.push(Section::new("starts", "Starts", starts(outcome)));
    sections.push(inputs(origin));
    let page = document(&title, &made_by(origin), &sections, "from the fit itself", None);
    figures.worded(&page.into_string())
}

/// Reason why no link file is written, and all warnings.
fn warnings(outcome: &FitOutcome) -> Option<Markup> {
    let misfit = outcome.misfit.as_ref().map(|misfit| (misfit.to_string(), misfit.hint()));
    let others = outcome.warnings().into_iter().map(|other| (other.message, other.hint));
    let all = misfit.into_iter().chain(others);
    let all: Vec<_> = all.map(|(message, hint)| (sentence(&message), hint)).collect();
    advice(&all, true)
}

/// A message with a capital letter and a full stop.
fn sentence(message: &str) -> String {
    let mut letters = message.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string());
    format!("{}{}.", first.unwrap_or_default(), letters.as_str())
}

fn percent(share: f64, digits: usize) -> String {
    with_unit(&shown(100.0 * share, digits), if share.is_finite() { "%" } else { "" })
}

/// A share with its sign, to a hundredth of a per cent.
fn signed(share: f64) -> String {
    if !share.is_finite() {
        return UNKNOWN.to_owned();
    }
    // Adding 0 leaves no negative zero.
    let rounded = (1e4 * share).round() / 100.0 + 0.0;
    format!("{rounded:+.2} %").replace('-', "−")
}

fn with_unit(number: &str, unit: &str) -> String {
    format!("{number} {unit}").trim_end().to_owned()
}

/// Every free value before and after.
fn values(outcome: &FitOutcome) -> Markup {
    let unknown = || UNKNOWN.to_owned();
    let amount = |value: &FittedValue, number: Option<String>| {
        let unit = value.unit.as_deref().unwrap_or_default();
        number.map_or("–".to_owned(), |number| with_unit(&number, unit))
    };
    let before = |value: &FittedValue| value.before.map(|b| plain(b).replace('-', "−"));
    let after = |value: &FittedValue| value.after.map(|after| shown(after, 5));
    let interval = |value: &FittedValue, [low, high]: [f64; 2]| {
        let times = value.after.unwrap_or(value.factor);
        let ends = format!("{} … {}", shown(times * low, 4), shown(times * high, 4));
        with_unit(&ends, value.unit.as_deref().unwrap_or("times"))
    };
    let head = [
        "free value",
        "before",
        "after",
        "factor",
        "change",
        "standard error",
        "95 % within",
        "bounds, as factors",
    ];
    let rows = html! {
        @for value in &outcome.values { tr {
            th scope="row" { code { (value.path) } }
            td { (amount(value, before(value))) }
            td { (amount(value, after(value))) }
            td { (shown(value.factor, 5)) }
            td { (signed(value.factor - 1.0)) }
            td { (value.relative_standard_error.map_or_else(unknown, |error| percent(error, 2))) }
            td { (value.relative_interval_95.map_or_else(unknown, |ends| interval(value, ends))) }
            td { (shown(value.bounds[0], 4)) " … " (shown(value.bounds[1], 4))
                @if value.is_at_bound { " " strong { "at its bound" } } }
        } }
    };
    let number = outcome.degrees_of_freedom;
    html! {
        (table(&head, &rows))
        p { "Several values that are free together have one common factor."
            @if outcome.chi_squared.is_none() && number > 0 {
                " The standard errors follow from the differences that remain, with " (number)
                @if number == 1 { " degree" } @else { " degrees" } " of freedom; the 95 % are those of \
                Student's distribution."
            }
            @if let Some(chi_squared) = outcome.chi_squared.filter(|_| number > 0) {
                " chi² is " (shown(chi_squared, 3)) " with " (number)
                @if number == 1 { " degree" } @else { " degrees" } " of freedom."
            }
        }
    }
}

/// Changes of the link file.
fn replacements(replaced: &[Replaced], written: Option<&str>) -> Markup {
    let rows = html! {
        @for Replaced { path, before, after } in replaced {
            tr { th scope="row" { code { (path) } } td { (before) } td { (after) } }
        }
    };
    html! {
        @match written {
            Some(name) => p { (name) " is the link file with these values, all else kept:" },
            None if replaced.is_empty() => p { "No link file is written." },
            None => p { "No link file is written. In the link file this would change:" },
        }
        @if !replaced.is_empty() { (table(&["value", "before", "after"], &rows)) }
    }
}

fn correlations(outcome: &FitOutcome) -> Markup {
    let paths: Vec<&str> = outcome.values.iter().map(|value| value.path.as_str()).collect();
    let head: Vec<&str> = std::iter::once("free value").chain(paths.iter().copied()).collect();
    let rows = html! {
        @for (path, row) in paths.iter().zip(&outcome.correlation) { tr {
            th scope="row" { code { (path) } }
            @for one in row { td { (format!("{one:+.3}").replace('-', "−")) } }
        } }
    };
    html! {
        p { "Errors of two values with a correlation near 1 or −1 go together: the data determine a product or a \
             quotient of the two better than either value." }
        (table(&head, &rows))
    }
}

/// Every measurement with the fitted link's value.
fn measured(outcome: &FitOutcome) -> Markup {
    let is_known = outcome.residuals.iter().any(|residual| residual.uncertainties.is_some());
    let head =
        ["figure", "measured", "value", "fitted", "difference", "uncertainty", "in uncertainties"];
    let head = if is_known { &head[..] } else { &head[..5] };
    let amount = |residual: &Residual, number: f64, digits: usize| {
        with_unit(&shown(number, digits), residual.measured.observable.unit())
    };
    let rows = html! {
        @for (residual, label) in outcome.residuals.iter().zip(labels(outcome)) { tr {
            td { (label) }
            th scope="row" { (residual.measured.observable) }
            td { (amount(residual, residual.measured.value, 5)) }
            td { (amount(residual, residual.fitted, 5)) }
            td { (signed(residual.relative)) }
            @if let Some((u, off)) = residual.measured.uncertainty.zip(residual.uncertainties) {
                td { (amount(residual, u, 2)) }
                td { (format!("{:+.1}", (10.0 * off).round() / 10.0 + 0.0).replace('-', "−"))
                    @if residual.is_outlier { " " strong { "outlier" } } }
            }
        } }
    };
    let responses = html! {
        @for response in &outcome.responses { tr {
            th scope="row" { (response.name) }
            td { (response.frequencies) }
            td { (response.gain.map_or(String::new(), |gain| significant(gain, 4))) }
            td { (percent(response.rms, 2)) }
        } }
    };
    let head_of_records = [
        "record",
        "channel",
        "samples",
        "delay",
        "gain",
        "offset",
        "difference, rms",
        "correlation of neighbours",
    ];
    html! {
        @if !outcome.residuals.is_empty() { (table(head, &rows)) }
        @if !outcome.responses.is_empty() {
            (table(&["response", "frequencies", "gain", "difference, rms"], &responses))
        }
        @if !outcome.records.is_empty() {
            (table(&head_of_records, &records(outcome)))
            p { "The difference is over the root mean square of the channel's samples, about their mean where \
                 the offset is free. The correlation of each difference with the next is about 0 of noise, \
                 near 1 where the model lacks something. An offset without a unit is in that of the samples. \
                 A dash: not free." }
        }
        @if !outcome.decays.is_empty() {
            (table(&["decay", "samples", "mode", "frequency", "damping ratio", "remainder, rms"], &decays(outcome)))
            p { "Frequency and damping ratio of each mode, as the samples of the decay show them. The remainder is over \
                 the root mean square of the samples about their offset and drift." }
        }
        p { "All together are " (percent(outcome.rms_misfit, 2)) " off (root mean square)." }
    }
}

/// Every channel of every record.
fn records(outcome: &FitOutcome) -> Markup {
    let fitted = |number: Option<f64>, unit: &str| {
        number.map_or("–".to_owned(), |number| with_unit(&shown(number, 4), unit))
    };
    html! {
        @for record in &outcome.records { @for channel in &record.channels { tr {
            th scope="row" { (record.name) }
            td { (channel.sensor.quantity()) }
            td { (record.samples) }
            td { (fitted(record.delay_s, "s")) }
            td { (fitted(channel.gain, "")) }
            td { (fitted(channel.offset, channel.gain.map_or(channel.sensor.unit(), |_| ""))) }
            td { (percent(channel.rms, 2)) }
            td { (shown(channel.autocorrelation, 2)) }
        } } }
    }
}

/// Every mode of every decay.
fn decays(outcome: &FitOutcome) -> Markup {
    html! {
        @for decay in &outcome.decays { @for mode in &decay.modes { tr {
            th scope="row" { (decay.name) ": " (decay.column) }
            td { (decay.samples) }
            td { (mode.frequency.observable) }
            td { (with_unit(&mode.frequency.shown(), mode.frequency.observable.unit())) }
            td { (mode.ratio.shown()) }
            td { (percent(decay.rms, 2)) }
        } } }
    }
}

/// Text for an unknown number.
const UNKNOWN: &str = "not known";

/// Digits for a page.
fn shown(value: f64, count: usize) -> String {
    if value.is_finite() { digits(value, count) } else { UNKNOWN.to_owned() }
}

/// Other values that fit about as well.
fn other_answers(outcome: &FitOutcome) -> Markup {
    let paths = outcome.values.iter().map(|value| value.path.as_str());
    let head: Vec<&str> = paths.chain(["sum of squares"]).collect();
    let rows = html! {
        @for answer in &outcome.other_answers { tr {
            @for factor in &answer.factors { td { (shown(*factor, 5)) } }
            td { (shown(answer.sum_of_squares, 5)) }
        } }
    };
    html! {
        p { "These factors fit the measurements about as well: their sums of squares are less than 3.84 above the \
             least, in units of the variance of the differences." }
        (table(&head, &rows))
    }
}

/// End of each start.
fn starts(outcome: &FitOutcome) -> Markup {
    let factors = |of: &[f64]| of.iter().map(|f| shown(*f, 4)).collect::<Vec<_>>().join(", ");
    let rows = html! {
        @for (number, start) in outcome.starts.iter().enumerate() { tr {
            th scope="row" { @if number == 0 { "the file's values" } @else { (number) } }
            td { (factors(&start.from)) }
            td { (start.to.as_deref().map_or("no link there".to_owned(), factors)) }
            td { (start.sum_of_squares.map_or(String::new(), |sum| shown(sum, 5))) }
            td { (start.iterations) }
        } }
    };
    let head = ["start", "from the factors", "to the factors", "sum of squares", "iterations"];
    html! {
        (table(&head, &rows))
        p { @if outcome.is_from_other_start {
            "A better fit was found from another start than the file's own values. "
        } "From the best of them " (outcome.iterations)
            @if outcome.iterations == 1 { " iteration leads" } @else { " iterations lead" }
            " to the fitted values."
        }
    }
}

/// Largest number of measurements with all numbers at the axis.
const MOST_TICKS: usize = 20;

/// Caption of measurements over frequency or time.
const DOTS: &str = "Dots: measured. Line: the fitted link, its value at each of them.";

/// Caption of a decay.
const DOTS_OF_DECAY: &str =
    "Dots: measured. Line: the vibrations that were identified, on their offset and drift.";

/// Letter for the kind of each measurement, and its number.
fn labels(outcome: &FitOutcome) -> impl Iterator<Item = String> {
    let of = |[free, held]: [&str; 2], end: HubEnd, mode: usize| match end {
        HubEnd::Free => format!("{free}{mode}"),
        HubEnd::Held => format!("{held}{mode}"),
    };
    outcome.residuals.iter().map(move |residual| match &residual.measured.observable {
        Observable::Frequency { mode, hub } => of(["f", "h"], *hub, *mode),
        Observable::ArmFrequency(own) => of(["f", "h"], own.joints, own.mode),
        Observable::Zero { zero } => format!("z{zero}"),
        Observable::Damping { mode, hub } => of(["d", "dh"], *hub, *mode),
        Observable::ArmDamping(own) => of(["d", "dh"], own.joints, own.mode),
    })
}

/// Differences of values, then measurements over frequency or time.
fn figures(outcome: &FitOutcome) -> Figures {
    let mut figures = Figures::default();
    figures.extend((!outcome.residuals.is_empty()).then(|| Ok(differences(outcome))));
    for (number, overlay) in (1..).zip(&outcome.overlays) {
        figures.add(Ok(over_each_other(overlay, format!("overlay-{number}"), DOTS)));
    }
    for (number, decay) in (1..).zip(&outcome.decays) {
        figures.add(Ok(over_each_other(&decay.overlay, format!("decay-{number}"), DOTS_OF_DECAY)));
    }
    figures
}

/// Fitted minus measured over measured value, each with one uncertainty.
fn differences(outcome: &FitOutcome) -> Figure {
    let count = outcome.residuals.len();
    let at = |k: usize| (k + 1) as f64;
    let shares: Vec<f64> = outcome.residuals.iter().map(|r| 100.0 * r.relative).collect();
    let places: Vec<f64> = (0..count).map(at).collect();
    let mut curves = vec![Curve::new("difference", Stroke::Points(1), &places, &shares)];
    let bars: Vec<(f64, f64)> = outcome
        .residuals
        .iter()
        .enumerate()
        .filter_map(|(k, r)| Some((k, r.measured.uncertainty? / r.measured.value)))
        .flat_map(|(k, share)| {
            let ends = [-100.0, 100.0].map(|u| (at(k), shares[k] + u * share));
            ends.into_iter().chain([(f64::NAN, f64::NAN)])
        })
        .collect();
    let has_bars = !bars.is_empty();
    if has_bars {
        let name = "one uncertainty either way".to_owned();
        curves.push(Curve { name, stroke: Stroke::Bars(1), points: bars });
    }
    let known = if has_bars {
        "The bars are one uncertainty either way: they should cross 0 in two cases of three."
    } else {
        "The uncertainties are not known."
    };
    let caption = format!(
        "The fitted link's value less the measured one, over the measured one. {known} f: natural \
         frequencies, h: with the hub or the joints held, z: zeros of the hub angle, d: damping ratios, dh: with the hub \
         or the joints held; each with its number."
    );
    let ticks = if count <= MOST_TICKS { places } else { Vec::new() };
    let x = Axis { places: ticks, ..Axis::linear("measurement", "", 0.5..count as f64 + 0.5) };
    let marks = labels(outcome).enumerate();
    let marks = marks.map(|(k, label)| Mark { at: at(k), label, class: "mode" }).collect();
    let figure = Figure::of_curves(
        "differences",
        "Differences",
        caption,
        x,
        ("fitted less measured", "%"),
        curves,
    );
    // Room for the names of the marks at the top.
    let range = figure.y.range.clone();
    let high = range.end + 0.15 * (range.end - range.start);
    let y = Axis { range: range.start..high, ..figure.y.clone() };
    Figure { y, marks, ..figure }.by(formula::DIFFERENCES)
}

/// Measured values as dots, fitted ones as a line.
fn over_each_other(overlay: &Overlay, id: String, caption: &str) -> Figure {
    let Overlay { name, places, measured, fitted, .. } = overlay;
    let curves = vec![
        Curve::new("measured", Stroke::Points(2), places, measured),
        Curve::new("fitted", Stroke::Thin(1), places, fitted),
    ];
    let x = axis_around(&overlay.x, &[places]);
    let y = axis_around(&overlay.y, &[measured, fitted]);
    Figure { curves, ..Figure::new(id, name, caption.to_owned(), x, y) }.by(formula::OVERLAY)
}

/// An axis around these numbers.
fn axis_around(of: &Coordinate, numbers: &[&Vec<f64>]) -> Axis {
    let all = numbers.iter().copied().flatten().copied();
    let finite: Vec<f64> = all.filter(|number| number.is_finite()).collect();
    let [low, high] = extremes(&finite);
    let range = match of.spacing {
        Spacing::Logarithmic => {
            let margin = libm::pow(high / low, 0.02).max(1.01);
            low / margin..high * margin
        }
        Spacing::Linear => {
            let margin = 0.04 * (high - low).max(f64::MIN_POSITIVE);
            low - margin..high + margin
        }
    };
    Axis { spacing: of.spacing, ..Axis::linear(of.name, of.unit, range) }
}
