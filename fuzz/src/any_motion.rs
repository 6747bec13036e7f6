use arbitrary::{Result, Unstructured};
use flexlink::motion::{MotionColumns, Profile};

use super::any_link::any_size;

/// Samples of a motion at most.
const MOST_SAMPLES: usize = 128;

/// Two motions on the same times, both of accelerations or both of displacements.
pub struct TwoMotions {
    first: MotionColumns,
    second: MotionColumns,
}

impl TwoMotions {
    /// Two profiles of at most 128 samples, at rest before and after, at steps that lie within some
    /// powers of two of `scale_s`.
    ///
    /// # Errors
    /// Those of `u`, which end the input.
    pub fn any(u: &mut Unstructured, scale_s: f64) -> Result<Self> {
        let len = u.int_in_range(16..=MOST_SAMPLES)?;
        let (step_s, distance_m) = (scale_s * any_size(u, 10)?, any_size(u, 10)?);
        let mut profile = |share: f64| {
            let steps = u.int_in_range(4..=len - 1)?;
            let before = u.int_in_range(0..=len - 1 - steps)?;
            let rest = [before, len - 1 - steps - before];
            let profile = u.choose(&Profile::ALL)?;
            Ok(profile.sampled(share * distance_m, step_s, steps, rest))
        };
        let (first, second) = (profile(1.0)?, profile(-0.75)?);
        if u.arbitrary()? {
            Ok(Self { first: displaced(first, step_s), second: displaced(second, step_s) })
        } else {
            Ok(Self { first, second })
        }
    }

    /// The sum of both, each sample times these factors.
    pub fn sum(&self, [first, second]: [f64; 2]) -> MotionColumns {
        let sum = |of: fn(&MotionColumns) -> Option<&Vec<f64>>| -> Option<Vec<f64>> {
            let both = of(&self.first)?.iter().zip(of(&self.second)?);
            Some(both.map(|(a, b)| first * a + second * b).collect())
        };
        MotionColumns {
            time_s: self.first.time_s.clone(),
            acceleration_m_s2: sum(|columns| columns.acceleration_m_s2.as_ref()),
            velocity_m_s: None,
            displacement_m: sum(|columns| columns.displacement_m.as_ref()),
        }
    }
}

/// The displacements of accelerations.
fn displaced(columns: MotionColumns, step_s: f64) -> MotionColumns {
    let (mut speed, mut place) = (0.0, 0.0);
    let moved = |a: f64| {
        place += speed * step_s;
        speed += a * step_s;
        place
    };
    let displacement_m = columns.acceleration_m_s2.map(|a| a.into_iter().map(moved).collect());
    MotionColumns { displacement_m, acceleration_m_s2: None, ..columns }
}
