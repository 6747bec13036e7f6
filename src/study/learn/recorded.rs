//! The error of a measured tip on the grid of its wanted motion.

use std::f64::consts::PI;

use super::error::{LEAST_TRAVEL, LearnError, MOST_TRAVEL};
use crate::inverse::Solution;
use crate::motion::Ends;
use crate::numeric::{CubicSpline, SplineEnds, TimeCurve, TimeGrid, extremes};
use crate::result::{ChannelRecording, SimulatedChannel};

/// Fewest rows at rest before and after the motion.
const AT_REST: usize = 8;

/// Largest range of the measured tip before the motion, and way after it in at most the time of the motion, over the travel.
const RESTS_BEFORE: f64 = 0.1;
const RESTS_AFTER: f64 = 0.2;

/// Time after the motion, over that of the motion, that a recording must have.
const LEAST_AFTER: f64 = 0.1;

/// Largest root mean square that the wanted motion, shifted and scaled, leaves of the recording.
const OTHER: f64 = 0.5;

/// Longest shift that is searched, over the duration of the motion, and trials to each side.
const LONGEST: f64 = 0.25;
const TRIALS: i32 = 64;

/// Largest share of the error that a shift leaves if it explains the error.
const EXPLAINED: f64 = 0.3;

/// Most rows of which the shift is searched.
const MOST_ROWS: usize = 2000;

/// Error of a recording: wanted less measured tip.
#[derive(Debug, Clone, PartialEq)]
pub struct Recorded {
    /// Times of the error.
    pub grid: TimeGrid,
    /// Error along each axis in m.
    pub error_m: Vec<Vec<f64>>,
    /// Measured less wanted place at rest before the motion, along each axis in m. The error has none of it.
    pub offset_m: Vec<f64>,
    /// Straight lines through the last quarter of the error at rest along each axis: the end in m, and the slope in m per sample.
    rest_m: Vec<[f64; 2]>,
    /// Way of the mean tip after the motion, in at most the time of the motion, over the travel.
    pub moves_after: f64,
    /// Number of the first sample after the motion.
    after: usize,
    /// Number of the first sample of the motion.
    before: usize,
}

/// The wanted tip at any time, then what the motion of an arm prescribes beside it: the directions of the links from the
/// third on in rad, and the place of the carriage in m.
pub(super) struct Wanted {
    curves: Vec<TimeCurve>,
}

impl Wanted {
    pub(super) fn of(solution: &Solution) -> Self {
        let curve = |at_m: &Vec<f64>| TimeCurve::new(solution.grid, at_m, SplineEnds::Clamped);
        let tip = solution.tip.iter().map(|axis| &axis.displacement_m);
        let outer = solution.shapes().skip(2).map(|shape| &shape.chord[0]);
        let carriage = solution.joints.iter().skip(solution.links.len());
        let all = tip.chain(outer).chain(carriage.map(|own| &own.angle_rad));
        Self { curves: all.map(curve).collect() }
    }

    /// Number of the quantities.
    pub(super) fn len(&self) -> usize {
        self.curves.len()
    }

    pub(super) fn at_m(&self, axis: usize, time_s: f64) -> f64 {
        self.curves[axis].value(time_s)
    }
}

/// Rows of a recording on the clock of the motion.
struct Rows {
    time_s: Vec<f64>,
    /// Measured tip along each axis in m.
    at_m: Vec<Vec<f64>>,
}

impl Recorded {
    /// The error of a recording under a solution's motion. `shift_s` is the time of the recording less that of the motion;
    /// without it, a shift beyond `lag_s` that explains the error is refused.
    ///
    /// # Errors
    /// [`LearnError`].
    pub fn of(
        solution: &Solution,
        recording: &ChannelRecording,
        (shift_s, lag_s): (Option<f64>, f64),
    ) -> Result<Self, LearnError> {
        if solution.motion.ends() != Ends::AtRest {
            return Err(LearnError::Moves);
        }
        let mut rows = Rows::of(solution, recording, shift_s.unwrap_or(0.0))?;
        let wanted = Wanted::of(solution);
        let grid = &solution.grid;
        let motion_s = [solution.moving.0, solution.moving.1].map(|k| grid.time_s(k));
        let lasts_s = motion_s[1] - motion_s[0];
        let first = rows.time_s.partition_point(|time_s| *time_s < motion_s[0]);
        let after = rows.time_s.partition_point(|time_s| *time_s <= motion_s[1]);
        let recorded_s = [rows.time_s[0], rows.time_s[rows.time_s.len() - 1]];
        if recorded_s[0] > motion_s[0] || recorded_s[1] < motion_s[1] {
            return Err(LearnError::TooShort { recorded_s, motion_s });
        }
        let found = [first, rows.time_s.len() - after];
        if let Some(place) = found.iter().position(|rows| *rows < AT_REST) {
            let (is_before, found) = (place == 0, found[place]);
            return Err(LearnError::FewAtRest { is_before, found, least: AT_REST });
        }
        if recorded_s[1] < motion_s[1] + LEAST_AFTER * lasts_s {
            let until_s = motion_s[1] + LEAST_AFTER * lasts_s;
            return Err(LearnError::TooShortRest { end_s: recorded_s[1], until_s });
        }
        let travel_m = solution.tip_travel_m();
        let offset_m = rows.offset_m(&wanted, first / 2, travel_m)?;
        for (at_m, offset_m) in rows.at_m.iter_mut().zip(&offset_m) {
            for own in at_m.iter_mut() {
                *own -= offset_m;
            }
        }
        let compared = Compared::of(&rows, &wanted, [motion_s[0], motion_s[1] + 0.5 * lasts_s]);
        compared.check(lasts_s, shift_s.is_none().then_some(lag_s))?;
        let moves_after = rows.way_after(travel_m, (motion_s[1], lasts_s))?;
        let own = Self::on_grid(&rows, &wanted, (solution, motion_s), offset_m);
        Ok(Self { moves_after, ..own })
    }

    /// The error at the samples of the solution, and as long after it as the motion lasts.
    fn on_grid(
        rows: &Rows,
        wanted: &Wanted,
        (solution, motion_s): (&Solution, [f64; 2]),
        offset_m: Vec<f64>,
    ) -> Self {
        let grid = solution.grid;
        let last_s = rows.time_s[rows.time_s.len() - 1];
        let from_s = rows.time_s[0].max(grid.time_s(0));
        let until_s = last_s.min(grid.end_s() + motion_s[1] - motion_s[0]);
        let number = |time_s: f64| (time_s - grid.origin_s) / grid.step_s;
        let first = (number(from_s) - 1e-6).ceil();
        let len = (number(until_s) + 1e-6).floor() - first + 1.0;
        #[expect(clippy::cast_possible_truncation, reason = "times of a recording")]
        #[expect(clippy::cast_sign_loss, reason = "the recording lasts longer than the motion")]
        let own = TimeGrid { first: first as i64, len: len as usize, ..grid };
        let time_s: Vec<f64> = (0..own.len).map(|k| own.time_s(k)).collect();
        let errors = rows.at_m.iter().enumerate().map(|(axis, at_m)| {
            let spline = CubicSpline::new(&rows.time_s, at_m, SplineEnds::NotAKnot);
            let error = |time_s: &f64| wanted.at_m(axis, *time_s) - spline.value(*time_s);
            time_s.iter().map(error).collect::<Vec<f64>>()
        });
        let error_m: Vec<Vec<f64>> = errors.collect();
        let before = time_s.partition_point(|time_s| *time_s < motion_s[0]);
        let after = time_s.partition_point(|time_s| *time_s <= motion_s[1]).min(own.len - 1);
        let rest = |error_m: &Vec<f64>| {
            let from = (own.len - (own.len - after) / 4).min(own.len - 2);
            let places: Vec<f64> = (from..own.len).map(|k| k as f64).collect();
            let (mean, slope) = line(&places, &error_m[from..]);
            [mean + 0.5 * slope * (own.len - 1 - from) as f64, slope]
        };
        let rest_m = error_m.iter().map(rest).collect();
        Self { grid: own, error_m, offset_m, rest_m, moves_after: 0.0, after, before }
    }

    /// Root mean square and largest size of the error in m.
    pub fn rms_and_peak_m(&self) -> [f64; 2] {
        self.rms_and_peak_less_m(|_, _| 0.0)
    }

    /// Root mean square and largest size in m of the error less a change of the tip along an axis at a time in s.
    pub fn rms_and_peak_less_m(&self, change_m: impl Fn(usize, f64) -> f64) -> [f64; 2] {
        let square = |k: usize| {
            let axes = self.error_m.iter().enumerate();
            let left = axes.map(|(axis, e)| e[k] - change_m(axis, self.grid.time_s(k)));
            left.map(|left| left * left).sum::<f64>()
        };
        let (sum, most) = (0..self.grid.len)
            .map(square)
            .fold((0.0_f64, 0.0_f64), |(sum, most), square| (sum + square, most.max(square)));
        [(sum / self.grid.len as f64).sqrt(), most.sqrt()]
    }

    /// The error along an axis with smooth ends, and its last value in m: it rises from 0 and goes to its line at rest,
    /// which has no vibration.
    pub(super) fn tapered(&self, axis: usize) -> (Vec<f64>, f64) {
        let (len, [last_m, slope_m]) = (self.grid.len, self.rest_m[axis]);
        let rising = (self.before / 2).max(1) as f64;
        let falling = ((len - self.after) / 8).max(1) as f64;
        let of = |(k, error_m): (usize, &f64)| {
            let begin = smooth(k as f64 / rising);
            let end = smooth((len - 1 - k) as f64 / falling);
            let line_m = last_m - slope_m * (len - 1 - k) as f64;
            begin * (line_m + end * (error_m - line_m))
        };
        (self.error_m[axis].iter().enumerate().map(of).collect(), last_m)
    }
}

impl Rows {
    fn of(
        solution: &Solution,
        recording: &ChannelRecording,
        shift_s: f64,
    ) -> Result<Self, LearnError> {
        let channels = match solution.arm.alone() {
            Some(_) => &[SimulatedChannel::Tip][..],
            None => &[SimulatedChannel::TipX, SimulatedChannel::TipY],
        };
        let column = |channel: &SimulatedChannel| {
            let found = recording.channels.iter().find(|(own, _)| own == channel);
            let missing = || LearnError::NoTip { channel: channel.name() };
            found.map(|(_, at_m)| at_m.clone()).ok_or_else(missing)
        };
        let at_m = channels.iter().map(column).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { time_s: recording.time_s.iter().map(|time_s| time_s - shift_s).collect(), at_m })
    }

    /// Measured less wanted place along each axis in the first rows, which must rest.
    fn offset_m(
        &self,
        wanted: &Wanted,
        rows: usize,
        travel_m: f64,
    ) -> Result<Vec<f64>, LearnError> {
        let offset = |(axis, at_m): (usize, &Vec<f64>)| {
            let [low, high] = extremes(&at_m[..rows]);
            let share = (high - low) / travel_m;
            if share > RESTS_BEFORE {
                return Err(LearnError::NoRest { is_before: true, share });
            }
            let own = (0..rows).map(|k| at_m[k] - wanted.at_m(axis, self.time_s[k]));
            Ok(own.sum::<f64>() / rows as f64)
        };
        self.at_m.iter().enumerate().map(offset).collect()
    }

    /// Way of the mean tip after the motion over the travel; a large one is refused.
    fn way_after(&self, travel_m: f64, (end_s, lasts_s): (f64, f64)) -> Result<f64, LearnError> {
        let first = self.time_s.partition_point(|time_s| *time_s <= end_s);
        let from = first + (self.time_s.len() - first) / 2;
        // A line through a short rest says nothing about the time after it.
        let least_s = lasts_s.min(self.time_s[self.time_s.len() - 1] - self.time_s[from]);
        let way = |at_m: &Vec<f64>| {
            let (_, slope) = line(&self.time_s[from..], &at_m[from..]);
            (slope * least_s / travel_m).abs()
        };
        let share = self.at_m.iter().map(way).fold(0.0, f64::max);
        if share > RESTS_AFTER {
            Err(LearnError::NoRest { is_before: false, share })
        } else {
            Ok(share)
        }
    }
}

/// Smooth step from 0 at 0 to 1 at 1.
pub(super) fn smooth(share: f64) -> f64 {
    0.5 - 0.5 * libm::cos(PI * share.clamp(0.0, 1.0))
}

/// Mean and slope of the straight line of least squares.
fn line(x: &[f64], y: &[f64]) -> (f64, f64) {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_x, mean_y) = (mean(x), mean(y));
    let square: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let product: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    (mean_y, product / square)
}

/// Rows of a recording beside the wanted motion, both from the start.
struct Compared<'a> {
    wanted: &'a Wanted,
    /// Axis, time in s, and measured place from the start in m.
    rows: Vec<(usize, f64, f64)>,
    start_m: Vec<f64>,
    step_s: f64,
}

impl<'a> Compared<'a> {
    fn of(rows: &Rows, wanted: &'a Wanted, [from_s, until_s]: [f64; 2]) -> Self {
        let from = rows.time_s.partition_point(|time_s| *time_s < from_s);
        let until = rows.time_s.partition_point(|time_s| *time_s <= until_s);
        let start_m: Vec<f64> =
            (0..rows.at_m.len()).map(|axis| wanted.at_m(axis, f64::NEG_INFINITY)).collect();
        let every = ((until - from) / MOST_ROWS).max(1);
        let axes = rows.at_m.iter().zip(&start_m).enumerate();
        let pairs = axes.flat_map(|(axis, (at_m, start_m))| {
            let each = (from..until).step_by(every);
            each.map(move |k| (axis, rows.time_s[k], at_m[k] - start_m))
        });
        let last = rows.time_s.len() - 1;
        let step_s = (rows.time_s[last] - rows.time_s[0]) / last as f64;
        Self { wanted, rows: pairs.collect(), start_m, step_s }
    }

    /// Sums of wanted × wanted, wanted × measured and measured × measured, the wanted motion being late.
    fn sums(&self, late_s: f64) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (axis, time_s, measured) in &self.rows {
            let wanted = self.wanted.at_m(*axis, time_s - late_s) - self.start_m[*axis];
            for (sum, product) in
                sums.iter_mut().zip([wanted * wanted, wanted * measured, measured * measured])
            {
                *sum += product;
            }
        }
        sums
    }

    /// The delay in s with the least of a cost.
    fn best_s(&self, lasts_s: f64, cost: impl Fn([f64; 3]) -> f64) -> f64 {
        let step_s = LONGEST * lasts_s / f64::from(TRIALS);
        let at = |late_s: f64| cost(self.sums(late_s));
        let tried = (-TRIALS..=TRIALS).map(|k| step_s * f64::from(k));
        let least = tried.map(|late_s| (late_s, at(late_s))).min_by(|a, b| a.1.total_cmp(&b.1));
        let mut best_s = least.map_or(0.0, |(late_s, _)| late_s);
        let mut reach_s = 0.5 * step_s;
        while reach_s > 1e-3 * self.step_s {
            let around = [best_s - reach_s, best_s, best_s + reach_s];
            let least = around.into_iter().min_by(|a, b| at(*a).total_cmp(&at(*b)));
            best_s = least.unwrap_or(best_s);
            reach_s *= 0.5;
        }
        best_s
    }

    /// Refuses another motion, another travel and, beyond a lag in s, a shift.
    fn check(&self, lasts_s: f64, lag_s: Option<f64>) -> Result<(), LearnError> {
        let scaled = |[ww, wm, mm]: [f64; 3]| mm - wm * wm / ww;
        let sums = self.sums(self.best_s(lasts_s, scaled));
        let scale = sums[1] / sums[0];
        let left = (scaled(sums).max(0.0) / sums[2]).sqrt();
        if left > OTHER {
            return Err(LearnError::OtherMotion { left });
        }
        if !(LEAST_TRAVEL..=MOST_TRAVEL).contains(&scale) {
            return Err(LearnError::OtherTravel { scale });
        }
        let Some(lag_s) = lag_s else { return Ok(()) };
        let same = |[ww, wm, mm]: [f64; 3]| (mm - 2.0 * wm + ww).max(0.0);
        let shift_s = self.best_s(lasts_s, same);
        let left = (same(self.sums(shift_s)) / same(self.sums(0.0))).sqrt();
        if shift_s.abs() > self.step_s + lag_s && left < EXPLAINED {
            return Err(LearnError::Shift { shift_s, explained: 1.0 - left });
        }
        Ok(())
    }
}
