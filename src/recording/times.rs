//! Times that are not quite uniform.

use crate::numeric::TimeGrid;

/// Largest distance of a time from the uniform grid, in steps, up to which a motion is interpolated unasked.
pub const LARGEST_JITTER: f64 = 0.05;

/// Jitter in steps up to which times count as uniform where the tip does not show it.
const UNIFORM: f64 = 1e-3;

/// What jitter may move the tip by, over its travel, without being noticed.
const UNNOTICED: f64 = 2e-7;

/// Largest distance of times in s from the uniform grid that fits them best, in steps, where the motion is to
/// be interpolated: it is more than the digits of the times explain, changes the displacement, if that is
/// given, noticeably, and is at most [`LARGEST_JITTER`].
pub fn jitter(time_s: &[f64], displacement_m: Option<&[f64]>) -> Option<f64> {
    if time_s.len() < 2 {
        return None;
    }
    let [from_ends, steps] = TimeGrid::jitter(time_s);
    let is_noticed =
        from_ends > UNIFORM || displacement_m.is_some_and(|d| share(d) * from_ends > UNNOTICED);
    (is_noticed && steps <= LARGEST_JITTER).then_some(steps)
}

/// What the tip moves by in one step at most, over its travel.
fn share(displacement_m: &[f64]) -> f64 {
    let step_m = displacement_m.windows(2).map(|d| (d[1] - d[0]).abs()).fold(0.0, f64::max);
    let start_m = displacement_m.first().copied().unwrap_or(0.0);
    let travel_m = displacement_m.iter().map(|d| (d - start_m).abs()).fold(0.0, f64::max);
    if travel_m > 0.0 { step_m / travel_m } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_as_they_are_where_their_digits_say_so_and_the_tip_shows_it() {
        let times = |decimals: i32, jitter: f64| -> Vec<f64> {
            let unit = 10.0_f64.powi(decimals);
            let off = |k: i32| if k % 3 == 1 { jitter } else { 0.0 };
            (0..=500).map(|k| ((f64::from(k) / 300.0 + off(k)) * unit).round() / unit).collect()
        };
        let ramp: Vec<f64> = (0..=500).map(|k| f64::from(k) / 500.0).collect();
        assert_eq!(jitter(&times(4, 0.0), Some(&ramp)), None, "rounded times");
        assert_eq!(jitter(&times(12, 1e-12), Some(&ramp)), None);
        let found = jitter(&times(12, 1e-6), Some(&ramp)).unwrap();
        assert!((found - 2e-4).abs() < 1e-5, "{found}");
        assert_eq!(jitter(&times(12, 1e-6), None), None, "an acceleration is integrated twice");
        assert!(jitter(&times(12, 1e-4), None).is_some());
        assert_eq!(jitter(&times(12, 3e-4), Some(&ramp)), None, "left to be refused");
    }
}
