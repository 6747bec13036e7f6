//! Errors of a motion's samples, from the digits of its columns, and between them.
//!
//! A spline through every second sample misses the others by more than a spline through all misses the motion. The
//! ratio is a power of the spacing: the fourth, or a lower one if the samples are too coarse for it, as every fourth
//! sample shows.

use std::ops::Range;

use num_complex::Complex64;

use crate::motion::{Between, Ends, MotionColumns, Recording, TipMotion, Uncertainty};
use crate::numeric::{CubicSpline, FourierPair, SplineEnds, extremes, fast_length, largest};
use crate::recording::Rounding;

/// Limit of samples for a comparison of two rules: with more the acceleration between them is known, and the comparison
/// would need much memory.
const MOST_SAMPLES: usize = 1_000_000;

/// Powers of the spacing with which the error of a spline falls: for a curve with a kink, and for a smooth curve.
const POWERS: (f64, f64) = (2.0, 4.0);

/// Ratio of the power in one octave to the power in the octave below, for a signal with jumps.
const SLOWEST_FALL: f64 = 0.5;

/// Factor on the error of an acceleration between its samples, because it concentrates at the kinks. With 3.5, the true
/// error of the torque reached twice the stated one in 144 random motions.
const LOCAL: f64 = 4.0;

/// Ratio of a spline's error through an acceleration to the error of its frequencies.
const OF_SPLINE: f64 = 0.5;

/// Function from samples (times, values) of a curve to its values at all times.
type Drawn<'a> = &'a dyn Fn(&[f64], &[f64]) -> Vec<f64>;

/// Root mean square and largest error, at the other samples, of curves through every `stride`-th sample, while the
/// values change; `None` for too few samples. It draws two curves through different samples, since one may pass through
/// a kink.
fn missed(
    values: &[f64],
    all: &[f64],
    stride: usize,
    drawn: &dyn Fn(&[usize]) -> Vec<f64>,
) -> Option<[f64; 2]> {
    let last = values.len() - 1;
    let begins = values.iter().position(|value| (value - values[0]).abs() > 0.0).unwrap_or(0);
    let ends = values.iter().rposition(|value| (value - values[last]).abs() > 0.0).unwrap_or(last);
    let (mut squares, mut count, mut largest) = (0.0, 0_usize, 0.0_f64);
    for phase in [0, stride / 2] {
        let is_kept = |k: usize| k % stride == phase || k == 0 || k == last;
        let kept: Vec<usize> = (0..=last).filter(|k| is_kept(*k)).collect();
        if kept.len() < CubicSpline::MIN_POINTS {
            return None;
        }
        let fewer = drawn(&kept);
        for k in (begins..=ends).filter(|k| !is_kept(*k)) {
            let off = (fewer[k] - all[k]).abs();
            squares += off * off;
            largest = largest.max(off);
            count += 1;
        }
    }
    Some([(squares / count.max(1) as f64).sqrt(), largest])
}

/// Root mean square and largest error of a curve through samples, estimated from curves through fewer of them. `drawn`
/// yields the values at the times of all samples; the error falls at least with the power `least_power` of the spacing.
fn errors_of(time_s: &[f64], values: &[f64], least_power: f64, drawn: Drawn<'_>) -> [f64; 2] {
    let all = drawn(time_s, values);
    let few = |kept: &[usize]| {
        let pick = |own: &[f64]| -> Vec<f64> { kept.iter().map(|k| own[*k]).collect() };
        drawn(&pick(time_s), &pick(values))
    };
    let [half, quarter] = [2, 4].map(|stride| missed(values, &all, stride, &few));
    let Some(half) = half else {
        // Without evidence the error may be the whole range.
        let [low, high] = extremes(&all);
        return [high - low; 2];
    };
    [0, 1].map(|norm| {
        let (half, quarter) = (half[norm], quarter.map_or(0.0, |own| own[norm]));
        let power = libm::log2(quarter / half).clamp(least_power, POWERS.1);
        let power = if quarter > 0.0 { power } else { least_power };
        if half > 0.0 { half / libm::pow(2.0, power) } else { 0.0 }
    })
}

/// Standard deviation in m of the error of a spline through displacements, between them.
pub(super) fn of_spline_m(time_s: &[f64], displacement_m: &[f64], ends: SplineEnds) -> f64 {
    let drawn = |times: &[f64], values: &[f64]| {
        let spline = CubicSpline::new(times, values, ends);
        time_s.iter().map(|t| spline.value(*t)).collect()
    };
    errors_of(time_s, displacement_m, POWERS.0, &drawn)[0]
}

/// Errors of the integral of a velocity.
pub(super) fn of_velocity(time_s: &[f64], velocity_m_s: &[f64]) -> Between {
    let drawn = |times: &[f64], values: &[f64]| {
        let spline = CubicSpline::new(times, values, SplineEnds::NotAKnot);
        let integral = CubicSpline::new(times, &spline.integral(), SplineEnds::NotAKnot);
        time_s.iter().map(|t| integral.value(*t)).collect()
    };
    let [_, displacement_m] = errors_of(time_s, velocity_m_s, POWERS.0, &drawn);
    // At a kink of the velocity the error exceeds the estimate from every second sample.
    Between { spline_m: displacement_m, displacement_m, ..Between::default() }
}

/// Errors of the two integrals of an acceleration along its spline.
pub(super) fn of_spline_of_acceleration(
    time_s: &[f64],
    acceleration_m_s2: &[f64],
    deviation: f64,
) -> Between {
    let drawn = |times: &[f64], values: &[f64]| {
        let spline = |values: &[f64]| CubicSpline::new(times, values, SplineEnds::NotAKnot);
        let velocity = spline(values).integral();
        // The tip is at rest at its end.
        let excess = velocity[times.len() - 1] / (times[times.len() - 1] - times[0]);
        let at_rest: Vec<f64> =
            velocity.iter().zip(times).map(|(v, t)| v - excess * (t - times[0])).collect();
        let place = spline(&spline(&at_rest).integral());
        time_s.iter().map(|t| place.value(*t)).collect()
    };
    let [_, displacement_m] = errors_of(time_s, acceleration_m_s2, POWERS.1, &drawn);
    let lasts_s = time_s[time_s.len() - 1] - time_s[0];
    let velocity_m_s = 2.0 * displacement_m / lasts_s;
    let spline = CubicSpline::new(time_s, acceleration_m_s2, SplineEnds::NotAKnot);
    let step_s = lasts_s / (time_s.len() - 1) as f64;
    let uniform = |k: usize| spline.value(time_s[0] + k as f64 * step_s);
    let uniform: Vec<f64> = (0..time_s.len()).map(uniform).collect();
    let acceleration_m_s2 = OF_SPLINE * beyond_samples(&uniform, None, deviation);
    Between { displacement_m, velocity_m_s, acceleration_m_s2, ..Between::default() }
}

/// Errors of an acceleration between its samples: the effect of its frequencies beyond them, and of another rule of
/// integration. Its samples have noise of the standard deviation `deviation`.
pub(super) fn of_acceleration(
    motion: &TipMotion,
    acceleration_m_s2: &[f64],
    deviation: f64,
) -> Between {
    let grid = motion.grid();
    if motion.is_from_displacement() || grid.len > MOST_SAMPLES {
        return Between::default();
    }
    let acceleration = beyond_samples(acceleration_m_s2, motion.cycles(), deviation);
    if motion.ends() == Ends::Periodic {
        return Between { acceleration_m_s2: acceleration, ..Between::default() };
    }
    let (first, last) = motion.moving_samples();
    let time_s: Vec<f64> = (0..grid.len).map(|k| k as f64 * grid.step_s).collect();
    let integral = |values: &[f64]| -> Vec<f64> {
        CubicSpline::new(&time_s, values, SplineEnds::NotAKnot).integral()
    };
    let [before_m_s, after_m_s] = motion.end_velocities_m_s();
    let mut velocity_m_s = integral(acceleration_m_s2);
    let left_m_s = velocity_m_s[grid.len - 1] - (after_m_s - before_m_s);
    let lasts = (last - first).max(1) as f64;
    for (k, velocity) in velocity_m_s.iter_mut().enumerate() {
        let share = (k.clamp(first, last) - first) as f64 / lasts;
        *velocity += before_m_s - share * left_m_s;
    }
    let displacement_m = integral(&velocity_m_s);
    let target = motion.target(grid.time_s(0), grid.end_s());
    let own_m = target.displacement_m();
    let off_m = |(a, b): (&f64, &f64)| (a - (b - own_m[0])).abs();
    let displacement_m = displacement_m.iter().zip(own_m).map(off_m).fold(0.0, f64::max);
    // A velocity error from one end to the other moves the tip by about half of it.
    let velocity_m_s = 2.0 * displacement_m / (lasts * grid.step_s);
    Between { displacement_m, velocity_m_s, acceleration_m_s2: acceleration, ..Between::default() }
}

/// Root mean square of a signal's content above the Nyquist frequency, while the signal lasts. The signal is one cycle
/// of `cycles` samples, or lies between rests. Octaves beyond are assumed to fall like the highest one from the one
/// below, both without white noise of this standard deviation.
fn beyond_samples(values: &[f64], cycles: Option<usize>, deviation: f64) -> f64 {
    let pair = FourierPair::new(cycles.unwrap_or_else(|| fast_length(values.len())));
    // Ratio of the period to the duration of the signal.
    let (samples, share): (Vec<f64>, f64) = if let Some(len) = cycles {
        (values.iter().copied().cycle().take(len).collect(), 1.0)
    } else {
        let rest = std::iter::repeat_n(0.0, pair.len() - values.len());
        let begins = values.iter().position(|value| *value != 0.0).unwrap_or(0);
        let ends = values.iter().rposition(|value| *value != 0.0).unwrap_or(0);
        let share = pair.len() as f64 / (ends + 1 - begins) as f64;
        (values.iter().copied().chain(rest).collect(), share)
    };
    let amplitudes = pair.amplitudes(samples);
    let top = amplitudes.len();
    let power =
        |octave: Range<usize>| -> f64 { amplitudes[octave].iter().map(Complex64::norm_sqr).sum() };
    let [upper, lower] = [(top / 2..top, 0.5), (top / 4..top / 2, 0.25)].map(|(octave, noise)| {
        let own = 2.0 * share * power(octave);
        (own - noise * deviation * deviation).max(0.0)
    });
    if upper == 0.0 {
        return 0.0;
    }
    let fall = (upper / lower).min(SLOWEST_FALL);
    LOCAL * (upper * fall / (1.0 - fall)).sqrt()
}

/// Number of slope changes of an exact acceleration: two at each of the four jumps of a trapezoid.
const MOST_KINKS: usize = 8;

/// Change of the slope, over the largest sample, below which it is round-off.
const KINK: f64 = 1e-9;

/// Quality of a motion from the digits of the column that defines it, and of the velocities at its ends.
pub(super) fn digits_of(
    columns: &MotionColumns,
    in_place: Option<Uncertainty>,
    [acceleration, velocity]: [Option<Rounding>; 2],
) -> Recording {
    let integrated = |column: &Option<Vec<f64>>, rounding: Option<Rounding>, times| {
        let is_rounded = !column.as_deref().is_some_and(has_few_kinks);
        let of = |Rounding { decimals, step }| Uncertainty::Integrated { times, decimals, step };
        rounding.filter(|_| is_rounded).map(of)
    };
    let once = integrated(&columns.velocity_m_s, velocity, 1);
    let uncertainty = match (&columns.acceleration_m_s2, &columns.displacement_m) {
        (Some(_), _) => integrated(&columns.acceleration_m_s2, acceleration, 2),
        (None, Some(_)) => in_place,
        (None, None) => once,
    };
    let velocity_m_s = once.map(|own| own.deviation());
    Recording { uncertainty, velocity_m_s, ..Recording::default() }
}

/// True for samples on few straight lines, such as those of a bang-bang or a trapezoid: few decimals represent them
/// exactly. The slope of rounded samples changes at every last decimal that they cross.
fn has_few_kinks(samples: &[f64]) -> bool {
    let round_off = KINK * largest(samples);
    let bends = |three: &&[f64]| (three[2] - 2.0 * three[1] + three[0]).abs() > round_off;
    samples.windows(3).filter(bends).count() <= MOST_KINKS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_splines_error_is_told_by_every_second_sample() {
        let septic = |u: f64| u.powi(4) * (35.0 - 84.0 * u + 70.0 * u * u - 20.0 * u.powi(3));
        for count in [10_u32, 16, 25, 40, 80] {
            let jitter = |k: u32| 0.2 * f64::from((k * 7919) % 101) / 50.0 - 0.2;
            let inner = (1..count).map(|k| (f64::from(k) + jitter(k)) / f64::from(count));
            let time_s: Vec<f64> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
            let places_m: Vec<f64> = time_s.iter().map(|t| septic(*t)).collect();
            let spline = CubicSpline::new(&time_s, &places_m, SplineEnds::Clamped);
            let fine = (0..=4000).map(|k| f64::from(k) / 4000.0);
            let squares: f64 = fine.map(|t| (spline.value(t) - septic(t)).powi(2)).sum();
            let true_m = (squares / 4001.0).sqrt();
            let told_m = of_spline_m(&time_s, &places_m, SplineEnds::Clamped);
            assert!((0.5..3.0).contains(&(told_m / true_m)), "{count}: {told_m} of {true_m}");
        }
    }

    #[test]
    fn lines_with_jumps_are_exact_and_a_rounded_slope_is_not() {
        let trapezoid: Vec<f64> = (0..100)
            .map(|k| match k {
                10..30 => 2.5,
                70..90 => -2.5,
                _ => 0.0,
            })
            .collect();
        assert!(has_few_kinks(&trapezoid));
        let ramps: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(50 - i32::abs(k - 50))).collect();
        assert!(has_few_kinks(&ramps));
        let rounded: Vec<f64> = (0..100).map(|k| (0.137 * f64::from(k)).round()).collect();
        assert!(!has_few_kinks(&rounded));
    }
}
