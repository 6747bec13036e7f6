//! Output of `fit`.

use crate::fit::{
    ChannelMisfit, DecayMode, FitOutcome, FittedValue, Measured, OtherAnswer, Replaced,
};
use crate::link::Joint;
use crate::text;

/// Correlation above which two values are reported as correlated.
const CORRELATED: f64 = 0.9;

/// A number with this number of digits, or a text for an unknown one.
fn significant(value: f64, digits: usize) -> String {
    if value.is_finite() { text::significant(value, digits) } else { "not known".to_owned() }
}

/// The free values, the values that they replace, the measurements with the fitted values, and correlations.
pub(crate) fn fit_text(joint: &Joint, outcome: &FitOutcome, replaced: &[Replaced]) -> String {
    let heads = ["free value", "factor", "change", "std. error", "95 % within"];
    let paths = outcome.values.iter().map(|value| value.path.chars().count());
    let width = paths.fold(27, usize::max);
    let mut lines = vec![value_row(heads, width)];
    lines.extend(outcome.values.iter().map(|value| value_text(value, width)));
    for OtherAnswer { factors, sum_of_squares } in &outcome.other_answers {
        let factors: Vec<String> = factors.iter().map(|f| significant(*f, 5)).collect();
        let sum = significant(*sum_of_squares, 3);
        lines.push(format!("another answer: factors {}, sum of squares {sum}", factors.join(", ")));
    }
    for Replaced { path, before, after } in replaced {
        lines.push(format!("{path} = {after}, was {before}"));
    }
    let names = outcome.residuals.iter().map(|own| own.measured.observable.to_string());
    let names = names.map(|name| joint.worded(&name));
    let width = names.map(|name| name.chars().count()).fold(30, usize::max);
    let row = |cells: [&str; 4]| row(cells, width);
    if !outcome.residuals.is_empty() {
        lines.push(row(["measured", "value", "fitted", "difference"]));
    }
    for residual in &outcome.residuals {
        let unit = residual.measured.observable.unit();
        let shown =
            |number: f64| format!("{} {unit}", significant(number, 5)).trim_end().to_owned();
        let difference = signed_percent(residual.relative);
        let uncertainties = residual.uncertainties;
        let more = uncertainties
            .filter(|u| u.is_finite())
            .map_or(String::new(), |u| format!(" {} u", signed(u, 1)));
        let name = joint.worded(&residual.measured.observable.to_string());
        let [value, fitted] = [residual.measured.value, residual.fitted].map(shown);
        lines.push(row([&name, &value, &fitted, &(difference + &more)]));
    }
    let number = outcome.degrees_of_freedom;
    if let Some(chi_squared) = outcome.chi_squared.filter(|_| number > 0) {
        let chi_squared = significant(chi_squared, 3);
        lines.push(format!("chi² {chi_squared} with {number} degrees of freedom"));
    }
    for response in &outcome.responses {
        let name = format!("response {}", response.name);
        let count = format!("{} points", response.frequencies);
        let gain = response.gain.map(|gain| format!("gain {}", significant(gain, 4)));
        let rms = format!("{} rms", percent(response.rms));
        lines.push(row([&name, &count, &gain.unwrap_or_default(), &rms]));
    }
    for record in &outcome.records {
        let name = format!("record {}", record.name);
        let count = format!("{} samples", record.samples);
        let delay = record.delay_s.map(|delay| {
            let error = record
                .delay_standard_error_s
                .map_or(String::new(), |error| format!(" ± {}", significant(1e3 * error, 2)));
            format!("delay {}{error} ms", significant(1e3 * delay, 3))
        });
        lines.push(row([&name, &count, "", &delay.unwrap_or_default()]));
        for ChannelMisfit { sensor, gain, offset, rms, .. } in &record.channels {
            let shown = |name, value: &Option<f64>| {
                value.map_or(String::new(), |value| format!("{name} {}", significant(value, 4)))
            };
            let [gain, offset] = [shown("gain", gain), shown("offset", offset)];
            let name = format!("  {}", sensor.word());
            lines.push(row([&name, &gain, &offset, &format!("{} rms", percent(*rms))]));
        }
    }
    for decay in &outcome.decays {
        let name = format!("decay {}: {}", decay.name, decay.column);
        let count = format!("{} samples", decay.samples);
        lines.push(row([&name, &count, "", &format!("{} rms", percent(decay.rms))]));
        for DecayMode { frequency, ratio, .. } in &decay.modes {
            let name = joint.worded(&format!("  {}", frequency.observable));
            let unit = frequency.observable.unit();
            let [hertz, ratio] = [frequency, ratio].map(Measured::shown);
            lines.push(format!("{name:<width$} {hertz} {unit}, damping ratio {ratio}"));
        }
        if !decay.others_hz.is_empty() {
            let hertz = decay.others_hz.iter().map(|hertz| significant(*hertz, 4));
            let hertz = hertz.collect::<Vec<_>>().join(", ");
            lines.push(format!("{:<width$} {hertz} Hz", "  no mode that was asked for"));
        }
    }
    for (k, correlations) in outcome.correlation.iter().enumerate() {
        for (j, correlation) in correlations.iter().enumerate().take(k) {
            if correlation.abs() > CORRELATED {
                let [first, second] = [j, k].map(|k| &outcome.values[k].path);
                lines.push(format!("correlation of {first} and {second}: {correlation:+.3}"));
            }
        }
    }
    lines.join("\n") + "\n"
}

/// A free value, with its interval as factors on the file's value.
fn value_text(value: &FittedValue, width: usize) -> String {
    let error = value.relative_standard_error.map_or("not known".to_owned(), percent);
    let change = signed_percent(value.factor - 1.0);
    let interval = value.relative_interval_95.map_or(String::new(), |interval| {
        // Two digits of the interval's width.
        let width = (interval[1] / interval[0] - 1.0).max(1e-9);
        let digits = (4_usize..12).find(|digits| libm::exp10(2.0 - *digits as f64) < width);
        let [low, high] = interval.map(|end| significant(value.factor * end, digits.unwrap_or(12)));
        format!("{low} … {high}")
    });
    value_row([&value.path, &significant(value.factor, 5), &change, &error, &interval], width)
}

fn value_row([name, factor, change, error, interval]: [&str; 5], width: usize) -> String {
    format!("{name:<width$} {factor:>9} {change:>10} {error:>10} {interval:>19}")
        .trim_end()
        .to_owned()
}

/// A number with its sign; a number that rounds to 0 is not negative.
fn signed(number: f64, decimals: usize) -> String {
    let text = format!("{number:+.decimals$}");
    let is_zero = text.chars().all(|letter| matches!(letter, '-' | '+' | '0' | '.'));
    if is_zero { text.replace('-', "+") } else { text }
}

fn signed_percent(share: f64) -> String {
    let shown = || format!("{} %", signed(100.0 * share, 2));
    if share.is_finite() { shown() } else { "not known".to_owned() }
}

fn percent(share: f64) -> String {
    let shown = || format!("{} %", significant(100.0 * share, 2));
    if share.is_finite() { shown() } else { "not known".to_owned() }
}

fn row([name, a, b, c]: [&str; 4], width: usize) -> String {
    format!("{name:<width$} {a:>13} {b:>13} {c:>18}").trim_end().to_owned()
}
