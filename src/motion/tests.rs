//! What makes a tip motion of sampled columns, and what does not.

use super::{MotionColumn, MotionColumns, MotionError, TipMotion};

const STEP_S: f64 = 0.01;

fn columns(f: impl Fn(f64) -> f64, count: usize) -> (Vec<f64>, Vec<f64>) {
    let time_s: Vec<f64> = (0..count).map(|k| 0.5 + k as f64 * STEP_S).collect();
    let samples = time_s.iter().map(|t| f((t - 0.5) / (STEP_S * (count - 1) as f64)));
    let samples = samples.collect();
    (time_s, samples)
}

fn accelerated(f: impl Fn(f64) -> f64) -> Result<TipMotion, MotionError> {
    let (time_s, samples) = columns(f, 101);
    let acceleration_m_s2 = Some(samples);
    TipMotion::new(MotionColumns { time_s, acceleration_m_s2, ..MotionColumns::default() })
}

/// Least-jerk position and acceleration over a unit time.
fn least_jerk(t: f64) -> (f64, f64) {
    (t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t), 60.0 * t - 180.0 * t * t + 120.0 * t.powi(3))
}

#[test]
fn travel_follows_from_the_acceleration_with_the_square_of_the_step() {
    let motion = accelerated(|t| least_jerk(t).1).unwrap();
    // The sum of t·a misses the integral by Δt²/12 of (t a)' at the end, which is 60.
    let expected = 1.0 - 5.0 * STEP_S * STEP_S;
    assert!((motion.travel_m() - expected).abs() < 1e-6, "travel {}", motion.travel_m());
    assert_eq!(motion.corrected(), None);
    assert_eq!(motion.moving_samples(), (0, 100));
}

#[test]
fn few_digits_are_corrected_and_told_and_a_velocity_is_refused() {
    let rounded = accelerated(|t| (least_jerk(t).1 * 1e3).round() / 1e3 + 4e-4).unwrap();
    let end = rounded.corrected().unwrap();
    assert!((end.velocity_m_s - 4e-4 * 101.0 * STEP_S).abs() < 1e-5, "{end:?}");
    assert!((end.share - end.velocity_m_s / 1.875).abs() < 1e-5, "{end:?}");
    let sum: f64 = rounded.forcing_m_s2().iter().sum();
    assert!((sum * STEP_S).abs() < 1e-13);
    let error = accelerated(|t| least_jerk(t).1 + 0.01).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the motion ends with a velocity of 1.010e-2 m/s, 0.54 % of its peak, but must end at \
         rest: the acceleration must integrate to 0"
    );
}

#[test]
fn a_tip_that_stands_still_is_refused() {
    assert_eq!(accelerated(|_| 0.0), Err(MotionError::NoMotion));
    let (time_s, samples) = columns(|_| 0.3, 8);
    let displacement_m = Some(samples);
    let still = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
    assert_eq!(TipMotion::new(still), Err(MotionError::NoMotion));
}

#[test]
fn columns_that_agree_are_taken_and_one_in_other_units_is_named() {
    let (time_s, displacement) = columns(|t| 0.2 + least_jerk(t).0, 101);
    let (_, acceleration) = columns(|t| least_jerk(t).1, 101);
    let (_, velocity) = columns(|t| 30.0 * t * t * (1.0 - t) * (1.0 - t), 101);
    let both = MotionColumns {
        time_s,
        acceleration_m_s2: Some(acceleration),
        velocity_m_s: Some(velocity),
        displacement_m: Some(displacement),
    };
    let motion = TipMotion::new(both.clone()).unwrap();
    assert!((motion.initial_displacement_m() - 0.2).abs() < 1e-15);
    let mut centimetres = both.clone();
    for d in centimetres.displacement_m.iter_mut().flatten() {
        *d *= 100.0;
    }
    let error = TipMotion::new(centimetres).unwrap_err();
    assert!(matches!(
        error,
        MotionError::Disagree { column: MotionColumn::Displacement, sample: 100, .. }
    ));
    let mut late = both;
    late.velocity_m_s.as_mut().unwrap().rotate_right(5);
    let error = TipMotion::new(late).unwrap_err();
    assert!(matches!(error, MotionError::Disagree { column: MotionColumn::Velocity, .. }));
}

#[test]
fn samples_that_are_no_numbers_are_refused_wherever_they_stand() {
    for bad in [f64::NAN, f64::INFINITY] {
        let (time_s, mut samples) = columns(|t| least_jerk(t).1, 101);
        samples[7] = bad;
        let acceleration_m_s2 = Some(samples);
        let columns = MotionColumns { time_s, acceleration_m_s2, ..Default::default() };
        let error = TipMotion::new(columns).unwrap_err();
        assert_eq!(error.sample(), Some(7));
        assert!(error.to_string().starts_with("acceleration = "), "{error}");
    }
    assert_eq!(accelerated(|t| 1e307 * least_jerk(t).1), Err(MotionError::TooLarge));
    // Every sample and difference is a number, but their transform is not.
    let displacement_m = Some(vec![0.0, 0.0, 3e306, 3e306, 3e306]);
    let time_s = vec![0.0, 1.0, 2.0, 3.0, 4.0];
    let columns = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
    assert_eq!(TipMotion::new(columns), Err(MotionError::TooLarge));
}

#[test]
fn ragged_or_short_columns_are_refused() {
    let (time_s, mut samples) = columns(|t| least_jerk(t).1, 101);
    samples.pop();
    let ragged = MotionColumns { time_s, acceleration_m_s2: Some(samples), ..Default::default() };
    assert_eq!(TipMotion::new(ragged), Err(MotionError::Shape { samples: 101 }));
    let nothing = MotionColumns { time_s: vec![0.0, 1.0, 2.0, 3.0], ..Default::default() };
    assert_eq!(TipMotion::new(nothing), Err(MotionError::Shape { samples: 4 }));
}
