//! What sampled columns must satisfy to be a motion from rest to rest on a uniform grid.

use super::error::{MotionColumn, MotionError};

/// Largest deviation of a time from the grid, in steps.
const TIME_TOLERANCE: f64 = 1e-3;

/// Times rounded to decimals of at most this share of a step may be off by half a decimal, too: a
/// rate of 60 Hz written in whole milliseconds.
const DECIMAL_SHARE: f64 = 0.1;

/// End velocity, relative to the peak velocity, up to which displacement samples count as at rest.
const REST_TOLERANCE: f64 = 1e-2;

/// Share of a column's peak that two columns may differ by.
const AGREEMENT_TOLERANCE: f64 = 1e-3;

/// Refuses a column with a sample that is not a finite number.
pub(super) fn finite(column: &'static str, samples: Option<&Vec<f64>>) -> Result<(), MotionError> {
    let samples = samples.map(Vec::as_slice).unwrap_or_default();
    match samples.iter().position(|x| !x.is_finite()) {
        Some(sample) => Err(MotionError::NotFinite { sample, column, found: samples[sample] }),
        None => Ok(()),
    }
}

/// The step of a uniform time column in s.
pub(super) fn uniform_step(time_s: &[f64]) -> Result<f64, MotionError> {
    let (start, last) = (time_s[0], time_s.len() - 1);
    let step_s = (time_s[last] - start) / last as f64;
    let decimal_s = last_decimal(time_s);
    let rounding_s = if decimal_s <= DECIMAL_SHARE * step_s { 0.5 * decimal_s } else { 0.0 };
    let slack_s = (TIME_TOLERANCE * step_s).max(1.001 * rounding_s);
    let is_off = |k: usize| {
        let grid = start + k as f64 * step_s;
        exceeds((time_s[k] - grid).abs(), slack_s)
    };
    if step_s > 0.0 && !(0..=last).any(is_off) {
        return Ok(step_s);
    }
    // One missing row shifts the mean step; the commonest one tells which row is to blame.
    let mut steps: Vec<f64> = time_s.windows(2).map(|t| t[1] - t[0]).collect();
    let usual = *steps.clone().select_nth_unstable_by(last / 2, f64::total_cmp).1;
    steps.insert(0, usual);
    let strays = |k: &usize| exceeds((steps[*k] - usual).abs(), 2.0 * slack_s.abs());
    let sample =
        (1..=last).find(strays).or_else(|| (1..=last).find(|k| is_off(*k))).unwrap_or(last);
    Err(MotionError::NotUniform {
        sample,
        found_s: time_s[sample],
        expected_s: time_s[sample - 1] + usual,
        step_s: usual,
    })
}

/// The decimal unit that all times are whole multiples of, 1 s or below.
fn last_decimal(time_s: &[f64]) -> f64 {
    let is_whole = |scale: f64| {
        time_s.iter().all(|t| {
            let scaled = t * scale;
            (scaled - scaled.round()).abs() <= 1e-6
        })
    };
    (0..12)
        .map(|decimals| 10.0_f64.powi(decimals))
        .find(|scale| is_whole(*scale))
        .map_or(0.0, f64::recip)
}

/// Whether a distance is above its limit; one that is not a number is, too.
fn exceeds(distance: f64, limit: f64) -> bool {
    distance > limit || distance.is_nan()
}

/// Refuses displacement samples that begin or end with a velocity.
///
/// The velocity at the end is extrapolated from the two outermost differences, which is exact for
/// a constant acceleration; a gentler start gives it the wrong sign and is at rest, too.
pub(super) fn at_rest(displacement_m: &[f64], step_s: f64) -> Result<(), MotionError> {
    let differences: Vec<f64> = displacement_m.windows(2).map(|d| d[1] - d[0]).collect();
    let peak = differences.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    let last = differences.len() - 1;
    let ends =
        [(0, differences[0], differences[1]), (last + 1, differences[last], differences[last - 1])];
    for (sample, outer, inner) in ends {
        let velocity = 1.5 * outer - 0.5 * inner;
        if velocity * outer > 0.0 && velocity.abs() > REST_TOLERANCE * peak {
            return Err(MotionError::MovingAtEnd {
                sample,
                velocity_m_s: velocity / step_s,
                share: velocity.abs() / peak,
            });
        }
    }
    Ok(())
}

/// Refuses a column that contradicts what another column makes of it.
///
/// Besides a share of the peak it may be off by `jump`, what the quantity changes in one step: a
/// jump of its derivative between two samples is not told more exactly.
pub(super) fn agree(
    column: MotionColumn,
    found: &[f64],
    expected: &[f64],
    jump: f64,
    from_acceleration: bool,
) -> Result<(), MotionError> {
    let peak = expected.iter().fold(0.0_f64, |m, x| m.max((x - expected[0]).abs()));
    let allowed = AGREEMENT_TOLERANCE * peak + jump;
    let distance = |k: &usize| (found[*k] - expected[*k]).abs();
    let worst = (0..found.len()).max_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    if distance(&worst) <= allowed {
        return Ok(());
    }
    Err(MotionError::Disagree {
        sample: worst,
        column,
        found: found[worst],
        expected: expected[worst],
        from_acceleration,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(time_s: &[f64]) -> String {
        uniform_step(time_s).unwrap_err().to_string()
    }

    #[test]
    fn times_with_few_digits_are_uniform_and_keep_the_mean_step() {
        let third = |k: i32| (f64::from(k) / 300.0 * 1e6).round() / 1e6;
        let times: Vec<f64> = (0..301).map(third).collect();
        assert!((uniform_step(&times).unwrap() - 1.0 / 300.0).abs() < 1e-15);
    }

    #[test]
    fn ordinary_rates_in_few_decimals_are_uniform() {
        for (rate, decimals) in [(60.0, 3), (60.0, 4), (240.0, 4), (300.0, 5), (1000.0, 3)] {
            let unit = 10.0_f64.powi(decimals);
            let rounded = |k: i32| (f64::from(k) / rate * unit).round() / unit;
            let times: Vec<f64> = (0..=600).map(rounded).collect();
            let step_s = uniform_step(&times).unwrap();
            assert!((step_s * rate - 1.0).abs() < 1e-3, "{rate} Hz in {decimals} decimals");
        }
        // In whole seconds a jitter cannot be told from rounding, so it is none.
        assert!(uniform_step(&[0.0, 1.0, 2.0, 4.0, 5.0]).is_err());
    }

    #[test]
    fn a_missing_row_and_a_stray_time_are_named() {
        let mut times: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.5).collect();
        times.remove(7);
        assert_eq!(
            refusal(&times),
            "time = 4 s, but must be 3.5 s: the samples before and after stand 0.5 s apart"
        );
        let times = [0.0, 1.0, 2.25, 3.0, 4.0, 5.0];
        assert!(refusal(&times).starts_with("time = 2.25 s, but must be 2 s"));
    }

    #[test]
    fn a_steady_drift_of_the_step_is_refused() {
        let times: Vec<f64> = (0..100).map(|k| f64::from(k) + 1e-5 * f64::from(k * k)).collect();
        assert!(uniform_step(&times).is_err());
    }

    #[test]
    fn gentle_starts_are_at_rest_and_ramps_are_not() {
        let sampled =
            |f: fn(f64) -> f64| (0..=10).map(|k| f(f64::from(k) / 10.0)).collect::<Vec<_>>();
        // Minimum jerk and bang-bang, both coarse.
        let gentle = [
            sampled(|t| t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t)),
            sampled(|t| if t < 0.5 { 2.0 * t * t } else { 1.0 - 2.0 * (1.0 - t) * (1.0 - t) }),
        ];
        for motion in gentle {
            assert_eq!(at_rest(&motion, 0.1), Ok(()));
        }
        let error = at_rest(&sampled(|t| t), 0.1).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the motion starts with a velocity of 1.000e0 m/s, 100.00 % of its peak, but must be \
             at rest there"
        );
        let half = at_rest(&sampled(|t| t * t), 0.1).unwrap_err();
        assert_eq!(half.sample(), Some(10));
    }
}
