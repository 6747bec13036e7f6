//! Errors of a motion's samples, from the digits of its columns, and between them; bad samples, refused, replaced or
//! remarked.
//!
//! A spline through every second sample misses the others by more than a spline through all misses the motion. The
//! ratio is a power of the spacing: the fourth, or a lower one if the samples are too coarse for it, as every fourth
//! sample shows.

use std::ops::Range;

use num_complex::Complex64;

use super::format::TableFormat;
use super::heading::{
    ANGLE, ANGLES, DISPLACEMENT, Heading, JOINT_TORQUES, PATH_X, PATH_Y, TORQUE, VOLTAGE,
};
use super::input::{Place, TableError};
use super::samples::Samples;
use crate::motion::{Between, Ends, MotionColumns, Recording, TipMotion, Uncertainty};
use crate::numeric::{CubicSpline, FourierPair, SplineEnds, extremes, fast_length, largest};
use crate::recording::{Change, Outlier, Rounding, outliers};
use crate::text::significant;

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

/// Hint for a refused sample.
const BY_OPTION: &str = "correct the sample, or let --drop-outliers replace it by the value that its neighbours predict";

/// A column of a table over time, in SI.
pub(super) struct Judged<'a> {
    pub(super) name: &'a str,
    /// Unit in messages, and its size in SI.
    pub(super) unit: (&'a str, f64),
    pub(super) change: Change,
    /// True if it commands a motor.
    pub(super) is_command: bool,
    pub(super) time_s: &'a [f64],
    pub(super) values: &'a [f64],
}

impl<'a> Judged<'a> {
    /// All columns of a table except the time.
    fn all(samples: &'a Samples) -> impl Iterator<Item = Self> {
        let time = samples.time();
        let columns = samples.headings.iter().zip(&samples.values).enumerate();
        columns.filter(move |(index, _)| time != Some(*index)).filter_map(
            move |(_, (heading, values))| {
                let time_s = &samples.values[time?];
                let unit = (&*heading.unit_text, heading.to_si(1.0));
                let (name, change) = (&heading.name, change(heading));
                let is_command = [TORQUE, VOLTAGE].contains(&heading.quantity)
                    || JOINT_TORQUES.contains(&heading.quantity);
                Some(Self { name, unit, change, is_command, time_s, values })
            },
        )
    }

    /// Samples far from their neighbours' prediction.
    fn outliers(&self) -> Vec<Outlier> {
        outliers(self.time_s, self.values, self.change)
    }

    /// Refuses samples far from their neighbours' prediction.
    pub(super) fn check(&self, file: &str, lines: &[u64]) -> Result<(), TableError> {
        let found = self.outliers();
        let Some(Outlier { sample, expected }) = found.first() else { return Ok(()) };
        let place = Place { file, line: lines.get(*sample).copied() };
        let value = self.values[*sample];
        // Samples without a file have numbers.
        let name = match place.line {
            Some(_) => self.name.to_owned(),
            None => format!("{}[{sample}]", self.name),
        };
        let must = format!(
            "must follow its neighbours: they predict {}, it is {} off",
            self.shown(*expected, 6),
            self.shown((value - expected).abs(), 3)
        );
        let hint = match found.len() - 1 {
            0 => BY_OPTION.to_owned(),
            1 => format!("{BY_OPTION}; one more sample is as bad"),
            more => format!("{BY_OPTION}; {more} more samples are as bad"),
        };
        Err(place.refuse(name, self.shown(value, 6), must).with_hint(hint))
    }

    /// Remark on samples far from their neighbours' prediction. A value that a command also keeps for two samples or
    /// more is a level; a single sample of it is a pulse.
    pub(super) fn doubt(&self, lines: &[u64]) -> Option<String> {
        let found = self.outliers();
        let is_level = |own: &Outlier| {
            let value = self.values[own.sample];
            let is_held = |two: &[f64]| two.iter().all(|other| other.total_cmp(&value).is_eq());
            self.is_command && self.values.windows(2).any(is_held)
        };
        let found: Vec<&Outlier> = found.iter().filter(|own| !is_level(own)).collect();
        let Outlier { sample, expected } = found.first()?;
        let told = format!(
            "line {}: {} = {} does not follow its neighbours, which predict {}",
            lines.get(*sample)?,
            self.name,
            self.shown(self.values[*sample], 6),
            self.shown(*expected, 6)
        );
        Some(match found.len() - 1 {
            0 => told,
            1 => format!("{told}, nor does one more sample"),
            more => format!("{told}, nor do {more} more samples"),
        })
    }

    fn shown(&self, si: f64, digits: usize) -> String {
        let (unit, of_si) = self.unit;
        let number = significant(si / of_si, digits);
        if unit.is_empty() { number } else { format!("{number} {unit}") }
    }
}

/// Kind of change of a column's quantity.
fn change(heading: &Heading) -> Change {
    let places = [DISPLACEMENT, ANGLE, PATH_X, PATH_Y];
    let is_place = places.contains(&heading.quantity) || ANGLES.contains(&heading.quantity);
    if is_place { Change::Continuous } else { Change::Jumping }
}

/// Refuses bad samples of a motion or a path, or, with the option to drop them, replaces them by their neighbours'
/// prediction and counts them.
pub(super) fn settle(
    samples: &mut Samples,
    file: &str,
    format: &TableFormat,
) -> Result<(), TableError> {
    if format.drop_outliers {
        let found: Vec<Vec<Outlier>> = Judged::all(samples).map(|own| own.outliers()).collect();
        let time = samples.time();
        let columns = samples.values.iter_mut().enumerate();
        let columns = columns.filter(|(index, _)| time != Some(*index));
        for ((_, values), found) in columns.zip(&found) {
            for Outlier { sample, expected } in found {
                values[*sample] = *expected;
            }
        }
        samples.reading.dropped = found.iter().map(Vec::len).sum();
        return Ok(());
    }
    Judged::all(samples).try_for_each(|own| own.check(file, &samples.lines))
}

/// Records a remark on samples of a torque, a reference or a record that do not follow their neighbours. They are
/// allowed, because a command may have a pulse of one step, and a record a shock.
pub(super) fn doubt(samples: &mut Samples) {
    let all: Vec<String> =
        Judged::all(samples).filter_map(|own| own.doubt(&samples.lines)).collect();
    samples.reading.doubt = (!all.is_empty()).then(|| all.join("; "));
}

#[cfg(test)]
mod tests {
    use super::super::format::TableFormat;
    use super::super::motion::read_motion_table_as;
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

    /// A table of a wave with a bad sample in one column.
    fn file(heading: &str, columns: usize, bad: Option<(usize, f64)>) -> String {
        let row = |k: usize| {
            let wave = |column: usize| {
                let off = bad.filter(|_| k == 50 && bad.is_some_and(|bad| bad.0 == column));
                100.0 * libm::sin(0.05 * k as f64 + column as f64) + off.map_or(0.0, |bad| bad.1)
            };
            let values: Vec<String> = (0..columns).map(|c| format!("{:.3}", wave(c))).collect();
            format!("{:.2},{}\n", 0.01 * k as f64, values.join(","))
        };
        format!("{heading}\n{}", (0..=100).map(row).collect::<String>())
    }

    #[test]
    fn a_bad_sample_is_refused_with_line_value_and_distance_or_replaced() {
        let drop = TableFormat { drop_outliers: true, ..TableFormat::default() };
        for heading in ["time,displacement [mm]", "time,angle [deg]", "time,velocity [mm/s]"] {
            let read = |bad, format: &TableFormat| {
                let file = file(heading, 1, bad);
                read_motion_table_as("m.csv", file.as_bytes(), &[1.0], format)
            };
            let good = read(None, &TableFormat::default()).unwrap();
            let error = read(Some((0, 2.0)), &TableFormat::default()).unwrap_err().to_string();
            let (name, unit) = heading[5..].split_once(" [").unwrap();
            let unit = unit.trim_end_matches(']');
            let expected = format!(
                "m.csv:52: {name} = 61.8470 {unit}, but must follow its neighbours: they predict 59.84"
            );
            assert!(error.starts_with(&expected), "{error}");
            assert!(error.ends_with(&format!("2.00 {unit} off")), "{error}");
            let mended = read(Some((0, 2.0)), &drop).unwrap();
            assert_eq!((good.reading().dropped(), mended.reading().dropped()), (0, 1));
            let [a, b] = [&good, &mended].map(|table| {
                let columns = table.columns().unwrap();
                columns.displacement_m.clone().or(columns.velocity_m_s.clone()).unwrap()
            });
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 2e-5), "off");
        }
    }

    #[test]
    fn a_bad_sample_of_a_path_is_refused_in_any_column() {
        let heading = "time,x [mm],y [mm],angle3 [deg]";
        for (column, name) in [(0, "x"), (1, "y"), (2, "angle3")] {
            let file = file(heading, 3, Some((column, -3.0)));
            let read = |format: &TableFormat| {
                read_motion_table_as("p.csv", file.as_bytes(), &[1.0; 3], format)
            };
            let error = read(&TableFormat::default()).unwrap_err().to_string();
            assert!(error.starts_with(&format!("p.csv:52: {name} = ")), "{error}");
            let drop = TableFormat { drop_outliers: true, ..TableFormat::default() };
            assert_eq!(read(&drop).unwrap().reading().dropped(), 1);
        }
    }
}
