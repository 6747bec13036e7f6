//! Figures of the page of a fit.

use super::axis::Axis;
use super::figure::{Curve, Figure, Figures, Mark, Stroke};
use super::words::formula;
use crate::fit::{Coordinate, FitOutcome, HubEnd, Observable, Overlay, Spacing};

/// Largest number of measurements with all numbers at the axis.
const MOST_TICKS: usize = 20;

/// Caption of measurements over frequency or time.
const DOTS: &str = "Dots: measured. Line: the fitted link, its value at each of them.";

/// Caption of a decay.
const DOTS_OF_DECAY: &str =
    "Dots: measured. Line: the vibrations that were identified, on their offset and drift.";

/// Letter for the kind of each measurement, and its number.
pub(super) fn labels(outcome: &FitOutcome) -> impl Iterator<Item = String> {
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
pub(super) fn figures(outcome: &FitOutcome) -> Figures {
    let mut figures = Figures::default();
    if !outcome.residuals.is_empty() {
        figures.add(Ok(differences(outcome)));
    }
    for (number, overlay) in outcome.overlays.iter().enumerate() {
        figures.add(Ok(over_each_other(overlay, format!("overlay-{}", number + 1), DOTS)));
    }
    for (number, decay) in outcome.decays.iter().enumerate() {
        let id = format!("decay-{}", number + 1);
        figures.add(Ok(over_each_other(&decay.overlay, id, DOTS_OF_DECAY)));
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
    let x = axis(&overlay.x, &[places]);
    let y = axis(&overlay.y, &[measured, fitted]);
    Figure { curves, ..Figure::new(id, name, caption.to_owned(), x, y) }.by(formula::OVERLAY)
}

/// An axis around these numbers.
fn axis(of: &Coordinate, numbers: &[&Vec<f64>]) -> Axis {
    let all = || numbers.iter().flat_map(|numbers| numbers.iter().copied());
    let finite = || all().filter(|number| number.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    match of.spacing {
        Spacing::Logarithmic => {
            let margin = libm::pow(high / low, 0.02).max(1.01);
            Axis::logarithmic(of.name, of.unit, low / margin..high * margin)
        }
        Spacing::Linear => {
            let margin = 0.04 * (high - low).max(f64::MIN_POSITIVE);
            Axis::linear(of.name, of.unit, low - margin..high + margin)
        }
    }
}
