//! An axis of a figure: its range, its ticks, and the points to draw along it.

use std::ops::Range;

use crate::fit::Spacing;
use crate::numeric::rounded;
use crate::text::significant;

/// Name of the axis common to all figures over time.
pub(super) const TIME: &str = "time";

/// One axis of a figure: quantity, unit, spacing and range.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Axis {
    /// Name of the quantity: `torque`.
    pub(super) name: String,
    /// Unit of the quantity, empty for a pure number: `N m`.
    pub(super) unit: String,
    pub(super) spacing: Spacing,
    /// First and last number; both above 0 on a logarithmic axis.
    pub(super) range: Range<f64>,
    /// Values of the ticks; empty for round ones.
    pub(super) places: Vec<f64>,
}

/// Parts of x, one per pixel; each keeps the lowest and the highest point of each line.
const PARTS: usize = 680;

/// Approximate number of ticks of a linear axis.
const TICKS: f64 = 6.0;

/// Largest number of decades of a logarithmic axis with a tick for each.
const MOST_DECADES: i32 = 7;

impl Axis {
    /// An axis from the first to the last number of a range.
    pub(super) fn linear(name: &str, unit: &str, range: Range<f64>) -> Self {
        Self { name: name.to_owned(), unit: unit.to_owned(), range, ..Self::default() }
    }

    /// A logarithmic axis over a range above 0.
    pub(super) fn logarithmic(name: &str, unit: &str, range: Range<f64>) -> Self {
        Self { spacing: Spacing::Logarithmic, ..Self::linear(name, unit, range) }
    }

    /// An axis over 0 and all finite `values`, with a margin.
    pub(super) fn around<'a>(
        name: &str,
        unit: &str,
        values: impl Iterator<Item = &'a f64>,
    ) -> Self {
        let (low, high) = values
            .filter(|value| value.is_finite())
            .fold((0.0_f64, 0.0_f64), |(low, high), value| (low.min(*value), high.max(*value)));
        let margin = 0.06 * (high - low);
        let range = match (low < 0.0, high > 0.0) {
            (false, false) => -1.0..1.0,
            (false, true) => 0.0..high + margin,
            (true, false) => low - margin..0.0,
            (true, true) => low - margin..high + margin,
        };
        Self::linear(name, unit, range)
    }

    /// True if its numbers would overflow or underflow in a drawing.
    pub(super) fn is_extreme(&self) -> bool {
        let Range { start, end } = self.range;
        let spread = match self.spacing {
            Spacing::Linear => end - start,
            Spacing::Logarithmic => end / start,
        };
        [start, end, spread].into_iter().any(is_extreme) || end <= start
    }

    /// Position of a number: 0 at the start of the axis, 1 at its end.
    pub(super) fn share(&self, value: f64) -> f64 {
        let Range { start, end } = self.range;
        match self.spacing {
            Spacing::Linear => (value - start) / (end - start),
            Spacing::Logarithmic => libm::log(value / start) / libm::log(end / start),
        }
    }

    /// Name of the spacing in the page's script.
    pub(super) fn spacing_word(&self) -> &'static str {
        match self.spacing {
            Spacing::Linear => "linear",
            Spacing::Logarithmic => "log",
        }
    }

    /// Name and unit: `torque in N m`.
    pub(super) fn title(&self) -> String {
        in_unit(&self.name, &self.unit)
    }

    /// Values and labels of the ticks.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        if !self.places.is_empty() {
            return self.places.iter().map(|value| (*value, short_label(*value))).collect();
        }
        match self.spacing {
            Spacing::Linear => self.linear_ticks(),
            Spacing::Logarithmic => self.decades(),
        }
    }

    #[expect(clippy::cast_possible_truncation, reason = "few ticks, few decades")]
    fn linear_ticks(&self) -> Vec<(f64, String)> {
        let Range { start, end } = self.range;
        let raw = (end - start) / TICKS;
        let exponent = libm::floor(libm::log10(raw)) as i32;
        let power = power_of_ten(exponent);
        let mut steps = [1.0, 2.0, 5.0].into_iter().map(|factor| factor * power);
        let step = steps.find(|step| *step >= 0.999 * raw).unwrap_or(10.0 * power);
        let first = libm::ceil(start / step - 1e-6) as i64;
        let last = libm::floor(end / step + 1e-6) as i64;
        // One digit of the step suffices.
        let decimals = usize::try_from(-libm::floor(libm::log10(step * 1.001)) as i32).unwrap_or(0);
        let label = |value: f64| {
            let largest = start.abs().max(end.abs());
            // Six digits cannot distinguish the ticks of an epoch.
            let is_offset = largest < 1e12 && step < 1e-5 * largest;
            if !(1e-4..1e6).contains(&largest) && !is_offset {
                return if value == 0.0 {
                    "0".to_owned()
                } else {
                    format!("{:e}", rounded(value, 6))
                };
            }
            let text = format!("{value:.decimals$}");
            let is_zero = text.chars().all(|c| matches!(c, '-' | '0' | '.'));
            text.replace('-', if is_zero { "" } else { "−" })
        };
        (first..=last).map(|k| k as f64 * step).map(|value| (value, label(value))).collect()
    }

    #[expect(clippy::cast_possible_truncation, reason = "few decades")]
    fn decades(&self) -> Vec<(f64, String)> {
        let Range { start, end } = self.range;
        let exponents =
            libm::floor(libm::log10(start)) as i32..=libm::ceil(libm::log10(end)) as i32;
        let decades = libm::log10(end / start);
        let between: &[f64] = match decades {
            few if few < 0.7 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
            few if few < 1.6 => &[1.0, 2.0, 3.0, 5.0],
            few if few < 3.1 => &[1.0, 3.0],
            _ => &[1.0],
        };
        let every = 1 + decades as i32 / MOST_DECADES;
        let inside = |value: &f64| (0.999 * start..=1.001 * end).contains(value);
        exponents
            .filter(|exponent| exponent % every == 0)
            .flat_map(|exponent| between.iter().map(move |b| b * power_of_ten(exponent)))
            .filter(inside)
            .map(|value| (value, short_label(value)))
            .collect()
    }
}

/// A unit of a link file with raised exponents: `N m²`.
pub(super) fn raised(unit: &str) -> String {
    unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")
}

/// Name and unit of a quantity: `torque in N m`.
pub(super) fn in_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} in {unit}") }
}

/// Numbers of the points, out of `len`, to draw for lines over the same x. All if they are few; otherwise the lowest
/// and the highest of every line in each part of x, so that no peak is lost.
pub(super) fn drawn_points(
    lines: &[&[(f64, f64)]],
    len: usize,
) -> impl Iterator<Item = usize> + use<> {
    let part = if len <= 2 * PARTS { 1 } else { len.div_ceil(PARTS) };
    let mut kept: Vec<usize> = if part == 1 { (0..len).collect() } else { vec![0, len - 1] };
    for start in (0..len).step_by(part).filter(|_| part > 1) {
        let inside = || start..(start + part).min(len);
        for line in lines {
            let by_height = |a: &usize, b: &usize| line[*a].1.total_cmp(&line[*b].1);
            kept.extend(inside().min_by(by_height).into_iter().chain(inside().max_by(by_height)));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter()
}

/// Text of a number with `count` significant digits on a page.
pub(super) fn digits(value: f64, count: usize) -> String {
    significant(value, count).replace('-', "−")
}

/// Decimal if short, otherwise with an exponent.
fn short_label(value: f64) -> String {
    let value = rounded(value, 4);
    if value == 0.0 || (1e-3..1e5).contains(&value.abs()) {
        format!("{value}").replace('-', "−")
    } else {
        format!("{value:e}")
    }
}

/// True if a number is too large, or too close to 0 but not 0, for a drawing.
pub(super) fn is_extreme(value: f64) -> bool {
    let size = value.abs();
    !(size <= 0.0 || (1e-300..=1e300).contains(&size))
}

fn power_of_ten(exponent: i32) -> f64 {
    libm::pow(10.0, f64::from(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round_and_inside() {
        let axis = |range| Axis::linear("torque", "N m", range);
        assert_eq!(labels(&axis(-1.5..1.5)), ["−1.5", "−1.0", "−0.5", "0.0", "0.5", "1.0", "1.5"]);
        assert_eq!(labels(&axis(0.0..0.05)), ["0.00", "0.01", "0.02", "0.03", "0.04", "0.05"]);
        assert_eq!(labels(&axis(0.0..0.6)), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6"]);
        assert_eq!(labels(&axis(97.0..412.0)), ["100", "200", "300", "400"]);
        assert_eq!(
            labels(&axis(1_772_620_000.2..1_772_620_001.5))[..2],
            ["1772620000.5", "1772620001.0"]
        );
        assert_eq!(labels(&axis(0.0..3e-7))[..2], ["0", "5e-8"]);
        assert_eq!(labels(&axis(0.0..3e-7)).last().unwrap(), "3e-7");
    }

    #[test]
    fn decades_have_their_ticks() {
        let axis = |range| Axis::logarithmic("frequency", "Hz", range);
        assert_eq!(labels(&axis(0.19..500.0)), ["1", "10", "100"]);
        assert_eq!(labels(&axis(0.5..8.0)), ["0.5", "1", "2", "3", "5"]);
        assert_eq!(labels(&axis(1e-9..1e9)).len(), 7);
        assert!((axis(1.0..100.0).share(10.0) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn an_axis_holds_its_values_and_zero() {
        let around = |values: &[f64]| Axis::around("a", "", values.iter()).range;
        assert_eq!(around(&[]), -1.0..1.0);
        assert_eq!(around(&[0.0, f64::NAN]), -1.0..1.0);
        assert!(around(&[1.0, 2.0]).start.abs() < 1e-15);
        assert!(around(&[-1.0, 2.0]).contains(&2.1));
        assert!(around(&[-1.0]).contains(&-1.05));
    }

    #[test]
    fn an_axis_of_denormals_or_of_the_largest_numbers_is_extreme() {
        let around = |values: &[f64]| Axis::around("a", "", values.iter());
        for values in [&[5e-324][..], &[1e-310, -1e-312], &[1.7e308, -1.7e308], &[1e301]] {
            assert!(around(values).is_extreme(), "{values:?}");
        }
        for values in [&[][..], &[0.0], &[1e-299], &[-1e299, 5e-324], &[1.0, 2.0]] {
            assert!(!around(values).is_extreme(), "{values:?}");
            assert!(around(values).ticks().len() < 20);
        }
        assert!(Axis::logarithmic("f", "Hz", 1e-200..1e200).is_extreme());
        assert!(Axis::logarithmic("f", "Hz", f64::INFINITY..0.0).is_extreme());
        assert!(!Axis::logarithmic("f", "Hz", 1e-9..1e9).is_extreme());
    }

    #[test]
    fn of_many_points_the_ends_and_the_peaks_of_every_line_are_drawn() {
        let wave = |k: u32, slow: f64| (f64::from(k), libm::sin(f64::from(k) * slow));
        let mut line: Vec<(f64, f64)> = (0..100_000).map(|k| wave(k, 1e-4)).collect();
        let other: Vec<(f64, f64)> = (0..100_000).map(|k| wave(k, 3e-4)).collect();
        line[54_321].1 = 7.0;
        line[54_322].1 = -9.0;
        let kept: Vec<usize> = drawn_points(&[&line, &other], line.len()).collect();
        assert!(kept.len() <= 4 * PARTS + 2, "{}", kept.len());
        assert!(kept.windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 99_999));
        assert!(kept.contains(&54_321) && kept.contains(&54_322));
        assert_eq!(drawn_points(&[&line[..100]], 100).count(), 100);
    }
}
