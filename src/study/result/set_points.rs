//! Set-points for a controller to play: the rows that matter, and the output of a converter or a drive between them.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::ops::Range;

use num_complex::Complex64;
use thiserror::Error;

use super::drive_unit::{DriveUnit, SetPoint, UnitChoice};
use super::metrics::Acting;
use crate::inverse::{JointMotion, MotorHistories, Solution, size};
use crate::link::Joint;
use crate::motion::{Ends, Motion};
use crate::numeric::{CubicSpline, FourierPair, SplineEnds, TimeCurve, TimeGrid};
use crate::response::Interpolation;
use crate::text::significant;

/// Side of a joint's gear and elastic transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// The joint, beyond them.
    #[default]
    Joint,
    /// The motor, before them.
    Motor,
}

/// Quantity that a drive makes its joint follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Held {
    /// The position, exactly.
    Position,
    /// The velocity, exactly.
    Velocity,
    /// The torque or the force.
    Effort,
}

/// One quantity of one joint over the whole grid, in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct SetPointColumn {
    /// The quantity.
    pub set_point: SetPoint,
    /// Number of the joint from 0.
    pub joint: usize,
    /// Whether the joint slides, on its own side of a gear.
    pub slides: bool,
    /// Numbers of the drive.
    pub unit: DriveUnit,
    values: Vec<f64>,
    /// Change of a position over a cycle of a motion that repeats.
    turn: f64,
}

impl SetPointColumn {
    /// True if the values rest where they are at the ends, not at 0.
    fn rests_anywhere(&self, has_weight: bool) -> bool {
        self.set_point == SetPoint::Position || self.set_point == SetPoint::Effort && has_weight
    }

    /// True for an angle and its derivatives.
    fn is_angle(&self) -> bool {
        self.set_point != SetPoint::Effort && !self.slides
    }

    /// Values in SI over the whole grid, at rest outside the rows.
    pub fn whole(&self) -> &[f64] {
        &self.values
    }

    /// Filters the values about the ramp of a joint that turns on with each cycle. The ramp is ahead by `from` steps, and by `to`
    /// steps afterwards.
    fn filter(&mut self, [from, to]: [f64; 2], filter: impl Fn(&[f64]) -> Vec<f64>) {
        let slope = self.turn / self.values.len() as f64;
        let ramp = |k: usize, ahead: f64| slope * (k as f64 + ahead);
        let level = self.values.iter().enumerate().map(|(k, own)| own - ramp(k, from));
        let level = filter(&level.collect::<Vec<f64>>()).into_iter().enumerate();
        self.values = level.map(|(k, own)| own + ramp(k, to)).collect();
    }
}

/// Set-points of all joints, or the torques alone, as a controller plays them.
#[derive(Debug, Clone, PartialEq)]
pub struct SetPoints {
    /// Times of the solution, or of the controller's cycles.
    grid: TimeGrid,
    /// One after the other for each quantity, one for each joint.
    columns: Vec<SetPointColumn>,
    /// Rows of the table; outside them all quantities are at rest.
    rows: Range<usize>,
    /// Time in s of the solution when the motion begins.
    moves_from_s: f64,
    interpolation: Interpolation,
    side: Side,
    /// Samples of the solution in a cycle, about; 1 without a cycle.
    per_cycle: usize,
    /// Whether the first row follows the last.
    repeats: bool,
    /// Time in s of the first row, if the user sets it.
    start_s: Option<f64>,
    /// Share of its size below which each column stays outside the rows of a cut table.
    window: Option<f64>,
    /// Whether the torques hold a weight at rest.
    has_weight: bool,
    /// The joint of one link, or the first joint.
    joint: Joint,
    /// Whether the last joint is an arm's carriage.
    has_carriage: bool,
}

/// Reason why a table of set-points is impossible.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SetPointError {
    /// A joint without a motor, for set-points on its side.
    #[error("{joint} has no motor, but must have a [drive] for set-points on the motor's side")]
    NoMotor {
        /// Name of the joint.
        joint: String,
    },
    /// A cycle that leaves too few rows, or too many.
    #[error(
        "a cycle of {} s leaves {rows:.0} rows, but must leave from {MIN_ROWS} to {MAX_ROWS}",
        significant(*cycle_s, 4)
    )]
    Rows {
        /// The cycle in s.
        cycle_s: f64,
        /// Rows of the table.
        rows: f64,
    },
    /// A cycle that does not fit a motion that repeats.
    #[error(
        "a cycle of {} s does not fit the repeating motion of {} s, but must be a whole number of its steps of {} s \
         and divide it",
        significant(*cycle_s, 6),
        significant(*period_s, 6),
        significant(*step_s, 6)
    )]
    NoFit {
        /// The cycle in s.
        cycle_s: f64,
        /// Period of the motion in s.
        period_s: f64,
        /// Step of the motion in s.
        step_s: f64,
    },
    /// A choice of a unit that fits no column.
    #[error("{text} fits no column of the table")]
    NoColumn {
        /// The text of the choice.
        text: String,
    },
    /// Counts over a range of an angle without a unit.
    #[error("{text} names no unit of its range, but must for an angle")]
    NoUnit {
        /// The text of the choice.
        text: String,
    },
    /// A count beyond 32 bits.
    #[error("the {word} of joint {joint} reaches {} counts, but must stay within 32 bits", significant(*count, 6))]
    TooManyCounts {
        /// The quantity.
        word: &'static str,
        /// Number of the joint from 1.
        joint: usize,
        /// The count.
        count: f64,
    },
}

/// Fewest and most rows of a table that can be played.
const MIN_ROWS: usize = 4;
const MAX_ROWS: usize = 1 << 24;

/// Share of its way that a velocity may drift in a cycle by round-off.
const DRIFT: f64 = 1e-9;

/// Share of a step that is round-off.
const ON_SAMPLE: f64 = 1e-6;

impl SetPoints {
    /// The torques of all joints.
    pub fn efforts(solution: &Solution) -> Self {
        let joints = solution.joints.iter().enumerate();
        let columns = joints.map(|(number, joint)| {
            let slides = slides(solution, number);
            SetPointColumn {
                set_point: SetPoint::Effort,
                joint: number,
                slides,
                unit: DriveUnit::si(SetPoint::Effort, slides),
                values: joint.torque_n_m.clone(),
                turn: 0.0,
            }
        });
        Self {
            grid: solution.grid,
            columns: columns.collect(),
            rows: 0..solution.grid.len,
            moves_from_s: solution.grid.time_s(solution.moving.0),
            interpolation: Interpolation::default(),
            side: Side::Joint,
            per_cycle: 1,
            repeats: solution.motion.ends() == Ends::Periodic,
            start_s: None,
            window: None,
            has_weight: solution.arm.has_weight(),
            joint: solution.arm.joint(),
            has_carriage: solution.arm.carriage().is_some(),
        }
    }

    /// These quantities of all joints, on a side of their gears.
    ///
    /// # Errors
    /// [`SetPointError::NoMotor`].
    pub fn of(
        solution: &Solution,
        set_points: &[SetPoint],
        side: Side,
    ) -> Result<Self, SetPointError> {
        let mut columns = Vec::new();
        for set_point in set_points {
            for (number, joint) in solution.joints.iter().enumerate() {
                let slides = side == Side::Joint && slides(solution, number);
                let values = match side {
                    Side::Joint => of_joint(solution, number, joint, *set_point),
                    Side::Motor => {
                        let joint_name = || solution.arm.name_of_joint(number);
                        let motor = joint.motor.as_ref();
                        let motor =
                            motor.ok_or_else(|| SetPointError::NoMotor { joint: joint_name() })?;
                        of_motor(motor, solution.grid.step_s, *set_point)
                    }
                };
                let turn =
                    if *set_point == SetPoint::Position { turn(solution, side) } else { 0.0 };
                columns.push(SetPointColumn {
                    set_point: *set_point,
                    joint: number,
                    slides,
                    unit: DriveUnit::si(*set_point, slides),
                    values,
                    turn,
                });
            }
        }
        Ok(Self { columns, side, ..Self::efforts(solution) })
    }

    /// True if the last joint is an arm's carriage.
    pub fn has_carriage(&self) -> bool {
        self.has_carriage
    }

    /// The joint of one link, or the first joint.
    pub fn joint(&self) -> Joint {
        self.joint
    }

    /// Side of the gears.
    pub fn side(&self) -> Side {
        self.side
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.columns.last().map_or(0, |own| own.joint + 1)
    }

    /// The columns.
    pub fn columns(&self) -> &[SetPointColumn] {
        &self.columns
    }

    /// The quantities, each once.
    pub fn set_points(&self) -> Vec<SetPoint> {
        let first = self.columns.iter().filter(|own| own.joint == 0);
        first.map(|own| own.set_point).collect()
    }

    /// Columns of one quantity, one for each joint.
    pub fn columns_of(&self, set_point: SetPoint) -> impl Iterator<Item = &SetPointColumn> {
        self.columns.iter().filter(move |own| own.set_point == set_point)
    }

    /// Quantities that a drive may hold: the position, else the velocity; and the effort.
    pub fn held_by_drive(&self) -> Vec<Held> {
        let set_points = self.set_points();
        let has = |set_point| set_points.contains(&set_point);
        let moved = match (has(SetPoint::Position), has(SetPoint::Velocity)) {
            (true, _) => Some(Held::Position),
            (false, true) => Some(Held::Velocity),
            (false, false) => None,
        };
        moved.into_iter().chain(has(SetPoint::Effort).then_some(Held::Effort)).collect()
    }

    /// The table with a row for each cycle of a controller in s.
    ///
    /// # Errors
    /// [`SetPointError::Rows`], [`SetPointError::NoFit`].
    pub fn on_cycle(mut self, cycle_s: f64, ends: Ends) -> Result<Self, SetPointError> {
        let from = self.grid;
        let [first, last] = [from.time_s(0), from.end_s()].map(|t| (t - from.origin_s) / cycle_s);
        let (first, last) = ((first - ON_SAMPLE).ceil(), (last + ON_SAMPLE).floor());
        let count = last - first + 1.0;
        if !(MIN_ROWS as f64..=MAX_ROWS as f64).contains(&count) || from.len < MIN_ROWS {
            return Err(SetPointError::Rows { cycle_s, rows: count });
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "checked")]
        let (start, mut rows) = (first as i64, count as usize);
        if ends == Ends::Periodic {
            let (period_s, step_s) = (from.len as f64 * from.step_s, from.step_s);
            let [steps, cycles] = [cycle_s / step_s, period_s / cycle_s];
            if [steps, cycles].iter().any(|own| (own - own.round()).abs() > ON_SAMPLE * own) {
                return Err(SetPointError::NoFit { cycle_s, period_s, step_s });
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "below len"
            )]
            let cycles = cycles.round() as usize;
            rows = rows.min(cycles);
        }
        let grid = TimeGrid { step_s: cycle_s, first: start, len: rows, ..from };
        for column in &mut self.columns {
            column.values = TimeCurve::resampled(&column.values, from, &grid).into_owned();
        }
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 1")]
        let per_cycle = (cycle_s / from.step_s).round().max(1.0) as usize;
        Ok(Self { grid, rows: 0..rows, per_cycle, ..self })
    }

    /// Replaces the values by those for a drive that holds each for a step, or draws straight lines between them, so
    /// that its output up to the Nyquist frequency is that of the table. Its images above this frequency remain.
    ///
    /// Holding for a step h multiplies an amplitude at ω by `sinc(ωh/2) e^{−iωh/2}`, lines multiply it by
    /// `sinc²(ωh/2)`; the correction divides by this factor.
    #[must_use]
    pub fn held(mut self, interpolation: Interpolation, ends: Ends) -> Self {
        let filter = |level: &[f64]| for_hold(level, interpolation, ends);
        self.columns.iter_mut().for_each(|own| own.filter([0.0, late(interpolation)], filter));
        Self { interpolation, ..self }
    }

    /// The table of smooth curves that a drive follows up to the Nyquist frequency while it holds the values of this one.
    pub(crate) fn smoothed(mut self, ends: Ends) -> Self {
        let interpolation = self.interpolation;
        let filter = |level: &[f64]| of_hold(level, interpolation, ends);
        self.columns.iter_mut().for_each(|own| own.filter([late(interpolation), 0.0], filter));
        Self { interpolation: Interpolation::Cubic, ..self }
    }

    /// Cuts the rows before and after which every column stays below a share of its peak. Of positions, and of torques
    /// with weight, the share counts of the range, from the value at rest. One row at rest remains on either side.
    #[must_use]
    pub fn cut(mut self, share: f64) -> Self {
        let (last, has_weight) = (self.grid.len - 1, self.has_weight);
        let acting = self.columns.iter().filter_map(|own| {
            let size = size(&own.values, own.rests_anywhere(has_weight));
            (size > 0.0).then(|| Acting::beyond_rest(&own.values, share * size))
        });
        let (first, end) = acting
            .map(|acting| (acting.first, acting.last))
            .reduce(|(first, end), (own_first, own_end)| (first.min(own_first), end.max(own_end)))
            .unwrap_or((0, last));
        for own in &mut self.columns {
            let rests = own.rests_anywhere(has_weight);
            let values = &mut own.values;
            let rest = if rests { [values[0], values[last]] } else { [0.0; 2] };
            values[..first].fill(rest[0]);
            values[end + 1..].fill(rest[1]);
        }
        self.rows = first.saturating_sub(1)..(end + 1).min(last) + 1;
        Self { window: Some(share), ..self }
    }

    /// The table in the units of a drive, rounded to its counts.
    ///
    /// # Errors
    /// [`SetPointError::NoColumn`], [`SetPointError::NoUnit`], [`SetPointError::TooManyCounts`].
    pub fn in_units(
        mut self,
        units: &[UnitChoice],
        counts: &[UnitChoice],
    ) -> Result<Self, SetPointError> {
        for choices in [units, counts] {
            let before: Vec<DriveUnit> = self.columns.iter().map(|own| own.unit.clone()).collect();
            for choice in choices {
                let pairs = self.columns.iter_mut().zip(&before);
                let fits =
                    |own: &SetPointColumn| choice.is_for(own.set_point, own.joint, own.slides);
                let chosen: Vec<_> = pairs.filter(|(own, _)| fits(own)).collect();
                if chosen.is_empty() {
                    return Err(SetPointError::NoColumn { text: choice.text.clone() });
                }
                for (own, before) in chosen {
                    let is_si = *before == DriveUnit::si(own.set_point, own.slides);
                    if choice.has_bare_range() && is_si && own.is_angle() {
                        return Err(SetPointError::NoUnit { text: choice.text.clone() });
                    }
                    own.unit = choice.unit(before);
                }
            }
        }
        for own in &mut self.columns {
            let unit = own.unit.clone();
            let outside = |value: &&f64| {
                let count = unit.number(**value);
                unit.is_count && !(f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&count)
            };
            if let Some(value) = own.values.iter().find(outside) {
                let (word, joint) = (own.set_point.word(), own.joint + 1);
                return Err(SetPointError::TooManyCounts {
                    word,
                    joint,
                    count: unit.number(*value),
                });
            }
            own.values.iter_mut().for_each(|value| *value = unit.as_held(*value));
        }
        Ok(self)
    }

    /// The table with its first row at this time in s.
    #[must_use]
    pub fn starting_at(self, start_s: f64) -> Self {
        Self { start_s: Some(start_s), ..self }
    }

    /// Times of the rows.
    #[expect(clippy::cast_possible_wrap, reason = "samples stay far below 2^63")]
    pub fn grid(&self) -> TimeGrid {
        let Self { grid, rows, .. } = self;
        match self.start_s {
            Some(origin_s) => TimeGrid { origin_s, first: 0, len: rows.len(), ..*grid },
            None => TimeGrid { first: grid.first + rows.start as i64, len: rows.len(), ..*grid },
        }
    }

    /// Time in s of the table when the motion begins.
    pub fn moves_from_s(&self) -> f64 {
        self.time_s(self.moves_from_s)
    }

    /// Time in s at which the motion begins in its file.
    pub fn moves_from_in_file_s(&self) -> f64 {
        self.moves_from_s
    }

    /// True if the times of the table are not those of the motion.
    pub fn is_shifted(&self) -> bool {
        self.start_s.is_some()
    }

    /// Time in s of the table at a time of the solution.
    pub fn time_s(&self, solution_s: f64) -> f64 {
        self.grid().time_s(0) + (solution_s - self.grid.time_s(self.rows.start))
    }

    /// Values of a column in the rows, in SI.
    pub fn rows_of<'a>(&self, column: &'a SetPointColumn) -> &'a [f64] {
        &column.values[self.rows.clone()]
    }

    /// Numbers of a column in the rows, as the drive takes them.
    pub fn numbers_of<'a>(&self, column: &'a SetPointColumn) -> Cow<'a, [f64]> {
        let (si, unit) = (self.rows_of(column), &column.unit);
        if *unit == DriveUnit::si(column.set_point, column.slides) {
            return si.into();
        }
        si.iter().map(|value| unit.number(*value)).collect()
    }

    /// Share of its size below which each column stays outside the rows of a cut table.
    pub fn window(&self) -> Option<f64> {
        self.window
    }

    /// Whether the torques hold a weight at rest.
    pub fn has_weight(&self) -> bool {
        self.has_weight
    }

    /// Time in s of the table when the solution ends.
    pub fn solved_until_s(&self) -> f64 {
        self.time_s(self.grid.end_s())
    }

    /// Course of the output between the rows.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// Times of a play over the whole solution. Where the drive holds or draws lines, a cycle has about the samples of the
    /// solution.
    pub(crate) fn played_grid(&self) -> TimeGrid {
        let (parts, grid) = (self.parts(), self.grid);
        #[expect(clippy::cast_possible_wrap, reason = "samples stay far below 2^63")]
        let first = grid.first * parts as i64;
        let len = if self.repeats { grid.len * parts } else { (grid.len - 1) * parts + 1 };
        TimeGrid { step_s: grid.step_s / parts as f64, first, len, ..grid }
    }

    fn parts(&self) -> usize {
        match self.interpolation {
            Interpolation::Cubic => 1,
            // The line from the last row to the first one depends on the turn of a cycle.
            Interpolation::Linear if self.repeats => 1,
            _ => self.per_cycle,
        }
    }

    /// How far held velocities move a joint in each cycle beyond the motion, of the joint where this is most. Rounded numbers
    /// do not add up to the motion's own turn. `None` for a motion that does not repeat, and for round-off.
    pub(crate) fn drift(&self, solution: &Solution) -> Option<f64> {
        let turn = turn(solution, self.side);
        let columns = self.columns_of(SetPoint::Velocity).filter(|_| self.repeats);
        let drifts = columns.filter_map(|own| {
            let step_s = self.grid.step_s;
            let drift = own.values.iter().sum::<f64>() * step_s - turn;
            let size = own.values.iter().map(|value| value.abs()).sum::<f64>() * step_s;
            (drift.abs() > DRIFT * size).then_some(drift)
        });
        drifts.max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    /// Values that the drive of each joint follows, in SI on the table's side at the times of [`SetPoints::played_grid`], and its
    /// course between them. Velocities are integrated.
    pub(crate) fn played(&self, held: Held) -> (Vec<Vec<f64>>, Interpolation) {
        let (parts, step_s) = (self.parts(), self.grid.step_s);
        let between = |values: &[f64], interpolation| -> Vec<f64> {
            let pairs = values.windows(2).flat_map(|pair| {
                let [from, to] = [pair[0], pair[1]];
                (0..parts).map(move |part| match interpolation {
                    Interpolation::Zero => from,
                    _ => from + (to - from) * part as f64 / parts as f64,
                })
            });
            let lasts = if self.repeats { parts } else { 1 };
            pairs.chain(values.last().into_iter().flat_map(|last| vec![*last; lasts])).collect()
        };
        let set_point = match held {
            Held::Position => SetPoint::Position,
            Held::Velocity => SetPoint::Velocity,
            Held::Effort => SetPoint::Effort,
        };
        let columns = self.columns_of(set_point);
        if held != Held::Velocity {
            let all = columns.map(|own| between(&own.values, self.interpolation));
            return (all.collect(), self.interpolation);
        }
        let played_s = step_s / parts as f64;
        let positions = columns.map(|own| -> Vec<f64> {
            let fine = between(&own.values, self.interpolation);
            let turned = match self.interpolation {
                Interpolation::Cubic => {
                    CubicSpline::uniform(&fine, SplineEnds::NotAKnot).integral()
                }
                course => {
                    let mean = |pair: &[f64]| match course {
                        Interpolation::Zero => pair[0],
                        _ => 0.5 * (pair[0] + pair[1]),
                    };
                    let sums = fine.windows(2).map(mean).scan(0.0, |sum, step| {
                        *sum += step;
                        Some(*sum)
                    });
                    std::iter::once(0.0).chain(sums).collect()
                }
            };
            turned.iter().map(|steps| steps * played_s).collect()
        });
        // A held velocity draws straight lines of position.
        let course = match self.interpolation {
            Interpolation::Zero => Interpolation::Linear,
            _ => Interpolation::Cubic,
        };
        (positions.collect(), course)
    }
}

/// True if the joint with this number slides.
fn slides(solution: &Solution, number: usize) -> bool {
    solution.arm.joints().nth(number).is_some_and(|joint| joint.slides())
}

/// Change of the position of a link's joint over a cycle, on a side of its gear. The joints of an arm return.
fn turn(solution: &Solution, side: Side) -> f64 {
    let Motion::Tip(motion) = &solution.motion else { return 0.0 };
    let link = solution.links[0].link();
    let ratio = link.drive().filter(|_| side == Side::Motor).map_or(1.0, |own| own.gear_ratio);
    motion.turn_of_cycle_rad(link.rigid_tip()).map_or(0.0, |turn_rad| ratio * turn_rad)
}

/// A quantity of a joint.
fn of_joint(
    solution: &Solution,
    number: usize,
    joint: &JointMotion,
    set_point: SetPoint,
) -> Vec<f64> {
    match set_point {
        SetPoint::Position => joint.angle_rad.clone(),
        SetPoint::Velocity => joint.rate_rad_s.clone(),
        SetPoint::Acceleration => solution.acceleration_rad_s2(number).into_owned(),
        SetPoint::Effort => joint.torque_n_m.clone(),
    }
}

/// A quantity of a motor, the acceleration by a spline through its rates.
fn of_motor(motor: &MotorHistories, step_s: f64, set_point: SetPoint) -> Vec<f64> {
    match set_point {
        SetPoint::Position => motor.angle_rad.clone(),
        SetPoint::Velocity => motor.rate_rad_s.clone(),
        SetPoint::Acceleration => {
            let spline = CubicSpline::uniform(&motor.rate_rad_s, SplineEnds::NotAKnot);
            spline.slopes().iter().map(|slope| slope / step_s).collect()
        }
        SetPoint::Effort => motor.torque_n_m.clone(),
    }
}

/// Part of a step by which held values follow a ramp late.
fn late(interpolation: Interpolation) -> f64 {
    if interpolation == Interpolation::Zero { 0.5 } else { 0.0 }
}

/// Samples that, each held for a step or joined by straight lines, have the amplitudes of these samples up to the Nyquist
/// frequency.
///
/// Unless the samples repeat, the function corrects their differences and adds them up, because differences are zero
/// at both ends even if the torque holds a weight there. Where the samples move at their ends, the differences of a parabola
/// through these are corrected by its derivatives:
///
/// ```text
/// held Q(k + ½) − Q''/24, joined by lines Q(k) − Q''/12,   Q(k + 1) − Q(k) = first + bend k
/// ```
pub(crate) fn for_hold(samples: &[f64], interpolation: Interpolation, ends: Ends) -> Vec<f64> {
    held(samples, interpolation, ends, Complex64::inv)
}

/// The inverse of [`for_hold`], except where the samples move at their ends.
fn of_hold(samples: &[f64], interpolation: Interpolation, ends: Ends) -> Vec<f64> {
    held(samples, interpolation, ends, |transfer| *transfer)
}

/// Samples with each amplitude times a factor from the transfer of the hold.
fn held(
    samples: &[f64],
    interpolation: Interpolation,
    ends: Ends,
    factor: impl Fn(&Complex64) -> Complex64,
) -> Vec<f64> {
    let len = samples.len();
    let is_line = match interpolation {
        Interpolation::Cubic => return samples.to_vec(),
        Interpolation::Linear => true,
        Interpolation::Zero => false,
    };
    let filtered = |samples: &[f64], pair: &FourierPair| {
        let mut amplitudes = pair.amplitudes(samples);
        let half = PI / pair.len() as f64;
        for (k, amplitude) in amplitudes.iter_mut().enumerate().skip(1) {
            let (sine, cosine) = libm::sincos(half * k as f64);
            let sinc = sine / (half * k as f64);
            let turned = if is_line { sinc.into() } else { Complex64::new(cosine, -sine) };
            *amplitude *= factor(&(turned * sinc));
        }
        pair.samples(amplitudes)
    };
    if ends == Ends::Periodic {
        // Two cycles, because the number of samples must be even.
        let mut found = filtered(&[samples, samples].concat(), &FourierPair::new(2 * len));
        found.truncate(len);
        return found;
    }
    let mut differences: Vec<f64> = samples.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let last = differences.len() - 1;
    let (first, bend) = match ends {
        Ends::Moving => (differences[0], (differences[last] - differences[0]) / last as f64),
        _ => (0.0, 0.0),
    };
    let parabola = |k: f64| first + bend * k;
    (0..).zip(&mut differences).for_each(|(k, own)| *own -= parabola(f64::from(k)));
    let (late, begins) =
        if is_line { (0.0, -bend / 12.0) } else { (0.5, first / 2.0 - bend / 6.0) };
    let found = filtered(&differences, &FourierPair::fast(2 * len));
    // The second half of the period lies before the first sample.
    let (after, before) = found.split_at(len);
    let mut sum = samples[0] + begins + before.iter().sum::<f64>();
    let add = |(k, difference): (u32, &f64)| {
        let sample = sum;
        sum += difference + parabola(f64::from(k) + late);
        sample
    };
    (0..).zip(after).map(add).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Amplitude of e^{iωt} in a staircase over one period of all its samples, by the sum of its steps' integrals on
    /// a hundredfold grid.
    fn amplitude(stairs: &[f64], cycles: usize) -> Complex64 {
        const FINE: usize = 100;
        let len = stairs.len() * FINE;
        let turn = |j: usize| TAU * (cycles as f64) * (j as f64 + 0.5) / len as f64;
        let part = |j: usize| Complex64::from_polar(stairs[j / FINE], -turn(j));
        (0..len).map(part).sum::<Complex64>() / len as f64
    }

    #[test]
    fn a_staircase_has_the_amplitudes_of_the_wave_that_it_is_for() {
        for len in [64, 45] {
            for cycles in [1, 5, 20] {
                let wave = |k: usize| (TAU * (cycles * k) as f64 / len as f64 + 0.4).cos();
                let samples: Vec<f64> = (0..len).map(wave).collect();
                let exact = Complex64::from_polar(0.5, 0.4);
                let of_held =
                    amplitude(&for_hold(&samples, Interpolation::Zero, Ends::Periodic), cycles);
                let of_samples = amplitude(&samples, cycles);
                let bound = 1e-4 * cycles as f64 / 20.0;
                assert!((of_held - exact).norm() < bound, "{len}, {cycles}: {of_held}");
                assert!(
                    (of_samples - exact).norm() > 100.0 * bound,
                    "{len}, {cycles}: {of_samples}"
                );
            }
        }
    }

    /// Of a parabola, held and joined by lines, the mean over each step is that of the parabola.
    #[test]
    fn a_motion_that_moves_at_its_ends_is_corrected_up_to_them() {
        let at = |t: f64| 1.0 + 0.3 * t - 2e-4 * t * t;
        let samples: Vec<f64> = (0..200).map(|k| at(f64::from(k))).collect();
        let stairs = for_hold(&samples, Interpolation::Zero, Ends::Moving);
        let lines = for_hold(&samples, Interpolation::Linear, Ends::Moving);
        let mean = |t: f64| (at(t) + 4.0 * at(t + 0.5) + at(t + 1.0)) / 6.0;
        for k in 0..199_u32 {
            let (j, t) = (k as usize, f64::from(k));
            let apart = [stairs[j] - mean(t), 0.5 * (lines[j] + lines[j + 1]) - mean(t)];
            // Of second order, held values are off by a twelfth of the step's curvature.
            assert!(apart[0].abs() < 1e-4 && apart[1].abs() < 1e-10, "{k}: {apart:?}");
        }
    }

    #[test]
    fn a_step_between_two_rests_comes_half_a_step_earlier() {
        // Smooth, and resting at other values on either side.
        let rises = |t: f64| 2.0 + 3.0 * libm::erf((t - 100.0) / 12.0);
        let samples: Vec<f64> = (0..200).map(|k| rises(f64::from(k))).collect();
        // In the middle of its step a held value is T − h² T''/24 + ….
        let curved = |t: f64| (rises(t + 1.0) - 2.0 * rises(t) + rises(t - 1.0)) / 24.0;
        for (k, held) in (0..).zip(for_hold(&samples, Interpolation::Zero, Ends::AtRest)) {
            let t = f64::from(k) + 0.5;
            assert!((held - (rises(t) - curved(t))).abs() < 1e-4, "{k}: {held}");
        }
        let stairs = for_hold(&samples, Interpolation::Zero, Ends::AtRest);
        let smooth = of_hold(&stairs, Interpolation::Zero, Ends::AtRest);
        assert!(smooth.iter().zip(&samples).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
