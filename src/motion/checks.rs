//! What sampled columns must satisfy to be a motion from rest to rest.

use super::error::{MotionColumn, MotionError};

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

/// Refuses displacement samples that begin or end with a velocity.
///
/// The velocity at the end is extrapolated from the two outermost differences, which is exact for
/// a constant acceleration; a gentler start gives it the wrong sign and is at rest, too.
pub(super) fn at_rest(displacement_m: &[f64], step_s: f64) -> Result<(), MotionError> {
    let differences: Vec<f64> = displacement_m.windows(2).map(|d| d[1] - d[0]).collect();
    let peak = crate::numeric::largest(&differences);
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
