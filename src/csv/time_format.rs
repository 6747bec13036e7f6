use rayon::prelude::*;

use super::number::NumberFormat;

/// How far a written time may stand from the grid when read back, in s.
const TOLERANCE_S: f64 = 1e-12;
/// The same in steps, which a step of less than 10 ns asks for: its times are to stay apart.
const TOLERANCE: f64 = 1e-4;
/// Most decimals before the shortest text takes over.
const MAX_DECIMALS: usize = 15;
/// Powers of ten, each exact.
const POWERS: [f64; MAX_DECIMALS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
/// Below this every whole number is exact.
const EXACT_INTEGERS: f64 = 9_007_199_254_740_992.0;

/// Times that a thread looks at where there are many.
const TIMES_AT_ONCE: usize = 1 << 14;

/// Fewest decimals with which each of `len` times reads back within 1e-12 s and 1e-4 of their step.
///
/// A number of decimals that does not fit is usually found out by the first few times, so that all
/// of them are gone through about once.
///
/// ```
/// use flexlink::csv::{NumberFormat, time_format};
/// assert_eq!(time_format(|k| 0.002 * k as f64, 1000), NumberFormat::Fixed(3));
/// ```
pub fn time_format(time: impl Fn(usize) -> f64 + Sync, len: usize) -> NumberFormat {
    let tolerance_s = tolerance_s(&time, len);
    (0..=MAX_DECIMALS)
        .find(|&decimals| {
            let times = (0..len).into_par_iter().with_min_len(TIMES_AT_ONCE);
            times.all(|k| reads_back(time(k), decimals, tolerance_s))
        })
        .map_or(NumberFormat::Shortest, NumberFormat::Fixed)
}

fn tolerance_s(time: impl Fn(usize) -> f64, len: usize) -> f64 {
    if len < 2 {
        return TOLERANCE_S;
    }
    let step_s = (time(len - 1) - time(0)).abs() / (len - 1) as f64;
    TOLERANCE_S.min(TOLERANCE * step_s)
}

/// Whether `time` with this many decimals reads back within the tolerance.
///
/// A whole number below 2⁵³ over an exact power of ten is rounded once, as a reader of the decimal
/// text rounds it; beyond, the text itself is written and read.
fn reads_back(time: f64, decimals: usize, tolerance_s: f64) -> bool {
    let last_digits = (time * POWERS[decimals]).round();
    let read = if last_digits.abs() < EXACT_INTEGERS {
        last_digits / POWERS[decimals]
    } else {
        format!("{time:.decimals$}").parse().unwrap_or(f64::NAN)
    };
    (read - time).abs() <= tolerance_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::TimeGrid;

    /// The definition, without a short way: write all, read all.
    fn fits(grid: &TimeGrid, decimals: usize) -> bool {
        let allowed_s = 1e-12_f64.min(1e-4 * grid.duration_s() / (grid.len - 1) as f64);
        (0..grid.len).all(|k| {
            let text = format!("{:.decimals$}", grid.time_s(k));
            (text.parse::<f64>().unwrap() - grid.time_s(k)).abs() <= allowed_s
        })
    }

    fn grid(origin_s: f64, step_s: f64, first: i64, len: usize) -> TimeGrid {
        TimeGrid { origin_s, step_s, first, len }
    }

    #[test]
    fn the_decimals_are_the_fewest_that_read_back() {
        for grid in [
            grid(0.0, 0.001, -700, 3000),
            grid(0.0, 0.25, 0, 9),
            grid(5.0, 1.0, -3, 9),
            grid(0.125, 0.01, 0, 500),
            grid(0.0, 1.0 / 1024.0, -5, 2000),
            grid(0.0, 1.0 / 3.0, 0, 100),
            grid(0.0, 0.88 / 880.0, 0, 881),
            grid(0.0, 1e-6, 0, 5000),
            grid(4.0e4, 0.001, 0, 5000),
            grid(1.7e9, 0.001, 0, 3000),
            grid(0.0, 1e-13, 0, 50),
            grid(0.0, 1e-12, 1, 50),
        ] {
            let expected = (0..=15).find(|&d| fits(&grid, d));
            let expected = expected.map_or(NumberFormat::Shortest, NumberFormat::Fixed);
            assert_eq!(time_format(|k| grid.time_s(k), grid.len), expected, "{grid:?}");
        }
    }

    #[test]
    fn a_late_sample_may_ask_for_more_decimals() {
        let time = |k: usize| if k == 999_999 { 0.125 } else { 0.0 };
        assert_eq!(time_format(time, 1_000_000), NumberFormat::Fixed(3));
    }

    #[test]
    fn times_that_are_too_close_for_decimals_take_the_shortest_text_and_stay_apart() {
        assert_eq!(time_format(|k| 1e-18 * k as f64, 4), NumberFormat::Shortest);
        for step_s in [1e-13, 0.3e-14, 1e-18, 1e-300] {
            let format = time_format(|k| step_s * k as f64, 50);
            let text = |k: usize| {
                let mut text = Vec::new();
                format.write(&mut text, step_s * k as f64);
                String::from_utf8(text).unwrap()
            };
            let read = |k: usize| text(k).parse::<f64>().unwrap() / step_s;
            for k in 0..50 {
                assert!((read(k) - k as f64).abs() < 1e-3, "{step_s:e}: {}", text(k));
            }
        }
    }
}
