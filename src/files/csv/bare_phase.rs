//! Unit of a response's phases whose heading has none.

use std::f64::consts::{PI, TAU};

use crate::text::significant;

/// Margin for rounding in rad.
const ROUNDING: f64 = 0.05;

/// Radians in a degree.
pub(super) const DEGREE: f64 = PI / 180.0;

/// A row of a response above 0 Hz.
#[derive(Debug, Clone, Copy)]
pub(super) struct PolarRow {
    pub(super) hertz: f64,
    pub(super) gain: f64,
    /// Phase as written.
    pub(super) phase: f64,
}

/// Factor from phases without a unit to radians, and a note on it.
///
/// Phases are radians, as in SI, unless this is impossible. Wrapped radians stay within a turn, and unwrapped radians
/// change by at most half a turn from one frequency to the next. If unwrapped radians are possible, the gain decides: a
/// resonance, a delay of a fraction of its period and noise turn a response about as much as they change the logarithm
/// of its gain. Degrees mistaken for radians turn it 57 times as much; the bound is the geometric mean of 1 and 57.
pub(super) fn bare_phase(mut rows: Vec<PolarRow>) -> (f64, String) {
    rows.sort_by(|a, b| a.hertz.total_cmp(&b.hertz));
    let most = rows.iter().map(|row| row.phase.abs()).fold(0.0, f64::max);
    let steps = || rows.windows(2).map(|pair| (pair[1].phase - pair[0].phase).abs());
    let step = steps().fold(0.0, f64::max);
    let turned: f64 = steps().sum();
    let changes = rows.windows(2).map(|pair| libm::log(pair[1].gain / pair[0].gain).abs());
    let changed: f64 = changes.sum();
    let why = if most <= TAU + ROUNDING {
        None
    } else if step > PI + ROUNDING {
        let [most, step] = [most, step].map(|number| significant(number, 3));
        Some(format!("radians up to {most} do not turn by {step} between two rows"))
    } else if turned * DEGREE.sqrt() > changed {
        Some("radians would turn far more than the gain changes".to_owned())
    } else {
        None
    };
    match why {
        None => {
            (1.0, "phase in radians: its heading names no unit, as phase [deg] does".to_owned())
        }
        Some(why) => (DEGREE, format!("phase in degrees: its heading names no unit, and {why}")),
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;

    /// Phases in rad and gains of two resonances with a zero between them and a delay, from 1 to 20 Hz.
    fn rows(count: u32, delay_s: f64) -> Vec<PolarRow> {
        let row = |k: u32| {
            let hertz = 1.0 + 19.0 * f64::from(k) / f64::from(count - 1);
            let s = Complex64::new(0.0, hertz);
            let pair = |own: f64| s * s + 0.04 * own * s + own * own;
            let turned = Complex64::cis(-TAU * hertz * delay_s);
            let value = pair(7.0) / (s * s * pair(5.0) * pair(12.0)) * turned;
            PolarRow { hertz, gain: value.norm(), phase: value.arg() }
        };
        (0..count).map(row).collect()
    }

    fn unwrapped(mut rows: Vec<PolarRow>) -> Vec<PolarRow> {
        for k in 1..rows.len() {
            let step = rows[k].phase - rows[k - 1].phase;
            rows[k].phase -= TAU * (step / TAU).round();
        }
        rows
    }

    fn is_degrees(rows: Vec<PolarRow>) -> bool {
        bare_phase(rows).0 < 1.0
    }

    /// Wrapped and unwrapped, with few rows and with so many that no step of the degrees exceeds π, in any order.
    #[test]
    fn radians_and_degrees_are_told_apart() {
        for count in [12, 60, 400, 5000] {
            for delay_s in [0.0, 0.02, 0.2] {
                for mut own in [rows(count, delay_s), unwrapped(rows(count, delay_s))] {
                    own.reverse();
                    let degrees =
                        own.iter().map(|row| PolarRow { phase: row.phase / DEGREE, ..*row });
                    assert!(is_degrees(degrees.collect()), "{count} {delay_s}");
                    assert!(!is_degrees(own), "{count} {delay_s}");
                }
            }
        }
    }

    /// Ambiguous numbers are SI; the note names the unit.
    #[test]
    fn what_may_be_both_is_radians() {
        let own = rows(60, 0.0).into_iter().filter(|row| row.hertz < 3.0);
        let degrees: Vec<_> = own.map(|row| PolarRow { phase: row.phase + 3.0, ..row }).collect();
        let (factor, said) = bare_phase(degrees);
        assert_eq!(factor.to_bits(), 1.0_f64.to_bits());
        assert!(said.contains("radians") && said.contains("phase [deg]"), "{said}");
    }
}
