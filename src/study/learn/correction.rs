//! The correction of a step: the motion whose inverse is added to the effort, and the table of the next effort.

use super::band::Band;
use super::error::LearnError;
use super::recorded::{Recorded, Wanted, smooth};
use crate::inverse::Solution;
use crate::motion::{ArmPath, Motion, MotionColumns, PathColumns, Recording, TipMotion};
use crate::numeric::{
    FourierPair, SplineEnds, TimeCurve, TimeGrid, extremes, fast_length, largest, magnitude,
};
use crate::response::{HubReference, Torque};
use crate::robust::{Histories, Hold};

/// Rests before and after the recording in periods of the band's end, in which the filtered error comes to rest.
const RESTS: f64 = 2.0;

/// Size of an added row, over the largest of its column, below which it is left out.
const NOTHING: f64 = 1e-5;

/// Equal samples in a row that count as a plateau, and samples at a limit.
const PLATEAU: usize = 5;
const AT_LIMIT: usize = 3;

/// Jump at the ends of a plateau, over the last decimal, of a saturated effort: a rounded peak has less.
const EDGE: f64 = 4.0;

/// The wanted motion with the error of the band added, and what it promises.
#[derive(Debug, Clone)]
pub struct Correction {
    /// The motion.
    pub motion: Motion,
    /// Contraction in the band, weighted by the error's spectrum.
    pub contraction: f64,
    /// Largest root mean square in m of the next error of a link within the intervals, without noise, for small motions.
    pub predicted_rms_m: f64,
    /// Root mean squares in m of the error in the band, and of the largest that the answer of `solve` makes there on a link
    /// within the intervals.
    pub in_band_rms_m: [f64; 2],
}

impl Correction {
    /// The correction of a recorded error in a band.
    ///
    /// # Errors
    /// [`LearnError`] of a corrected motion that is refused.
    pub fn of(solution: &Solution, recorded: &Recorded, band: &Band) -> Result<Self, LearnError> {
        let (own, wanted) = (recorded.grid, Wanted::of(solution));
        #[expect(clippy::cast_possible_truncation, reason = "a few periods")]
        #[expect(clippy::cast_sign_loss, reason = "above 0")]
        let rest = (RESTS / (band.end_hz * own.step_s)).ceil() as usize;
        let len = own.len + 2 * rest;
        #[expect(clippy::cast_possible_wrap, reason = "a few periods")]
        let grid = TimeGrid { first: own.first - rest as i64, len, ..own };
        let pair = FourierPair::fast(fast_length(2 * len));
        let hertz = |k: usize| k as f64 / (pair.len() as f64 * own.step_s);
        let half = pair.len() / 2;
        // The samples and then all of them backwards: the period has no jump.
        let amplitudes = |mut samples: Vec<f64>| {
            samples.extend(samples.clone().into_iter().rev());
            pair.amplitudes(&samples)
        };
        let (mut sums, mut moved) = ([0.0; 5], Vec::new());
        let [mut energy, mut left_out] = [0.0; 2];
        for axis in 0..recorded.error_m.len() {
            let (error_m, last_m) = recorded.tapered(axis);
            let pairs = recorded.error_m[axis].iter().zip(&error_m);
            left_out += pairs.map(|(whole, own)| (whole - own).powi(2)).sum::<f64>();
            // Rests around the error.
            let mut samples = vec![0.0; rest];
            samples.extend(error_m);
            samples.resize(half, last_m);
            energy += samples.iter().map(|own| own * own).sum::<f64>();
            let mut amplitudes_m = amplitudes(samples);
            let start_m = wanted.at_m(axis, f64::NEG_INFINITY);
            let way = (0..half).map(|k| wanted.at_m(axis, grid.time_s(k)) - start_m);
            let of_way = amplitudes(way.collect());
            for (k, amplitude) in amplitudes_m.iter_mut().enumerate() {
                let (square, weight) = (magnitude(*amplitude).powi(2), band.weight(hertz(k)));
                let contraction = band.contraction(hertz(k)).min(1.0);
                let left = 1.0 - weight + weight * contraction;
                sums[0] += square;
                sums[1] += left * left * square;
                if hertz(k) <= band.end_hz {
                    sums[2] += square;
                    sums[3] += contraction * contraction * square;
                    sums[4] += (contraction * magnitude(of_way[k])).powi(2);
                }
                *amplitude *= weight;
            }
            let filtered = pair.samples(&amplitudes_m);
            let taper = (0.5 * rest as f64).max(1.0);
            let at = |k: usize| {
                let [begin, end] = [k, len - 1 - k].map(|own| smooth(own as f64 / taper));
                let added_m = begin * (last_m + end * (filtered[k] - last_m));
                wanted.at_m(axis, grid.time_s(k)) + added_m
            };
            moved.push((0..len).map(at).collect::<Vec<f64>>());
        }
        let time_s: Vec<f64> = (0..len).map(|k| grid.time_s(k)).collect();
        let beside = (moved.len()..wanted.len()).map(|own| {
            let at = |time_s: &f64| wanted.at_m(own, *time_s);
            time_s.iter().map(at).collect::<Vec<f64>>()
        });
        moved.extend(beside);
        let motion = motion_of(solution, time_s, moved)?;
        let ratio = |part: f64, whole: f64| if whole > 0.0 { (part / whole).sqrt() } else { 0.0 };
        let rms_m = |energy: f64| (energy / own.len as f64).sqrt();
        Ok(Self {
            motion,
            contraction: ratio(sums[3], sums[2]),
            predicted_rms_m: ratio(sums[1], sums[0]) * rms_m(energy) + rms_m(left_out),
            in_band_rms_m: [sums[2], sums[4]].map(|part| ratio(part, sums[0]) * rms_m(energy)),
        })
    }
}

/// A motion of the same link or arm with these histories of what it prescribes, in the order of [`Wanted`].
fn motion_of(
    solution: &Solution,
    time_s: Vec<f64>,
    mut wanted: Vec<Vec<f64>>,
) -> Result<Motion, LearnError> {
    let start_angle_rad = solution.motion.recording().start_angle_rad;
    if solution.arm.alone().is_some() {
        let displacement_m = Some(wanted.remove(0));
        let columns = MotionColumns { time_s, displacement_m, ..MotionColumns::default() };
        let motion = TipMotion::new(columns)?;
        return Ok(Motion::Tip(
            motion.recorded(Recording { start_angle_rad, ..Recording::default() }),
        ));
    }
    let step_s = time_s[1] - time_s[0];
    let places: Vec<[f64; 2]> = wanted[0].iter().zip(&wanted[1]).map(|(x, y)| [*x, *y]).collect();
    let carriage_m = solution.arm.carriage().and_then(|_| wanted.pop());
    let columns = PathColumns::of_tip(step_s, &places, wanted.split_off(2), carriage_m);
    let columns = PathColumns { time_s, ..columns };
    Ok(Motion::Path(ArmPath::new(columns, &solution.arm.lengths_m())?))
}

/// Columns over time of what the joints play: the effort of each joint, or its position and, where it is known, its rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Times of the rows.
    pub grid: TimeGrid,
    /// Columns of each joint.
    pub joints: Vec<Vec<Vec<f64>>>,
}

impl Table {
    /// The columns that the joints of a solution play.
    pub fn of(solution: &Solution, hold: Hold) -> Self {
        let joints = solution.joints.iter().map(|joint| match hold {
            Hold::Position => vec![joint.angle_rad.clone(), joint.rate_rad_s.clone()],
            Hold::Effort | Hold::Feedback => vec![joint.torque_n_m.clone()],
        });
        Self { grid: solution.grid, joints: joints.collect() }
    }

    /// The table as histories that a plant plays, beside the wanted tip of a solution. Joints whose positions are not played
    /// have those of its start.
    pub fn histories(&self, solution: &Solution, hold: Hold) -> Histories {
        let (grid, wanted) = (self.grid, Wanted::of(solution));
        let axis = |axis| (0..grid.len).map(|k| wanted.at_m(axis, grid.time_s(k))).collect();
        let pairs = self.joints.iter().zip(&solution.joints);
        let (efforts, positions) = pairs
            .map(|(columns, joint)| match hold {
                Hold::Position => {
                    let rate = columns.get(1).cloned().unwrap_or_default();
                    (vec![0.0; grid.len], [columns[0].clone(), rate])
                }
                Hold::Effort | Hold::Feedback => {
                    (columns[0].clone(), [vec![joint.angle_rad[0]; grid.len], Vec::new()])
                }
            })
            .unzip();
        let wanted_m = (0..solution.tip.len()).map(axis).collect();
        Histories { grid, efforts, positions, wanted_m }
    }

    /// Efforts of the joints.
    pub fn of_efforts(efforts: &[Torque]) -> Self {
        let columns = efforts.iter().map(|own| vec![own.torque_n_m().to_vec()]);
        Self { grid: efforts[0].grid(), joints: columns.collect() }
    }

    /// Positions of the joints, with their rates where these are known.
    pub fn of_positions(positions: &[HubReference]) -> Self {
        let columns = |own: &HubReference| {
            let rate = own.rate_rad_s().map(<[f64]>::to_vec);
            [own.angle_rad().to_vec()].into_iter().chain(rate).collect()
        };
        Self { grid: positions[0].grid(), joints: positions.iter().map(columns).collect() }
    }

    /// A column at a time. Outside the table the first and the last value hold, or the column is 0.
    fn at(&self, column: &[f64], holds: bool) -> impl Fn(f64) -> f64 + use<> {
        let curve = TimeCurve::new(self.grid, column, SplineEnds::NotAKnot);
        move |time_s| if holds || curve.covers(time_s) { curve.value(time_s) } else { 0.0 }
    }

    /// This table with the change from one table to another added, on as many more rows as it needs. `holds`: what is played
    /// before and after a table is its first and last row, not 0.
    #[must_use]
    pub fn changed(&self, [from, to]: [&Self; 2], holds: bool) -> Self {
        let own = self.grid;
        let more = |time_s: f64| (time_s / own.step_s - 1e-6).ceil().max(0.0);
        let [before, after] =
            [more(own.time_s(0) - to.grid.time_s(0)), more(to.grid.end_s() - own.end_s())];
        #[expect(clippy::cast_possible_truncation, reason = "rows of a table")]
        #[expect(clippy::cast_sign_loss, reason = "not below 0")]
        let [left, right] = [before as usize, after as usize];
        #[expect(clippy::cast_possible_wrap, reason = "rows of a table")]
        let grid = TimeGrid { first: own.first - left as i64, len: own.len + left + right, ..own };
        let joints = self.joints.iter().enumerate().map(|(joint, columns)| {
            let column = |(number, column): (usize, &Vec<f64>)| {
                let [from_column, to_column] = [from, to].map(|own| &own.joints[joint][number]);
                let own = self.at(column, holds);
                let (old, new) = (from.at(from_column, holds), to.at(to_column, holds));
                let at = |time_s: f64| own(time_s) + new(time_s) - old(time_s);
                (0..grid.len).map(|k| at(grid.time_s(k))).collect::<Vec<f64>>()
            };
            columns.iter().enumerate().map(column).collect::<Vec<_>>()
        });
        Self { grid, joints: joints.collect() }.trimmed([left, right])
    }

    /// The table without added rows at its ends in which nothing changes.
    fn trimmed(mut self, [left, right]: [usize; 2]) -> Self {
        let len = self.grid.len;
        let is_still = |column: &Vec<f64>, k: usize, end: usize| {
            let [low, high] = extremes(column);
            (column[k] - column[end]).abs() <= NOTHING * (high - low).max(largest(column) * 1e-9)
        };
        let columns: Vec<&Vec<f64>> = self.joints.iter().flatten().collect();
        let still = |k: &usize, end: usize| columns.iter().all(|own| is_still(own, *k, end));
        let from = (0..left).take_while(|k| still(k, 0)).count();
        let until = len - (len - right..len).rev().take_while(|k| still(k, len - 1)).count();
        for column in self.joints.iter_mut().flatten() {
            column.truncate(until);
            column.drain(..from);
        }
        #[expect(clippy::cast_possible_wrap, reason = "rows of a table")]
        let first = self.grid.first + from as i64;
        Self { grid: TimeGrid { first, len: until - from, ..self.grid }, ..self }
    }
}

/// An effort that its drive cuts off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation {
    /// Number of its first sample.
    pub sample: usize,
    /// Number of its samples.
    pub samples: usize,
    /// The effort there.
    pub value: f64,
    /// True at a limit of the link file, false at an extremum of the table.
    pub is_limit: bool,
}

/// The first plateau of an effort at its largest or smallest value, or its first samples at a limit. The rests at the ends
/// of a table do not count.
pub fn saturation(effort: &[f64], limit: Option<f64>) -> Option<Saturation> {
    let limit = limit.unwrap_or(f64::INFINITY);
    let at_limit = |x: &&f64| x.abs() >= limit * (1.0 - 1e-9);
    if let Some(sample) = effort.iter().position(|x| at_limit(&x)) {
        let samples = effort.iter().filter(at_limit).count();
        if samples >= AT_LIMIT {
            return Some(Saturation { sample, samples, value: effort[sample], is_limit: true });
        }
    }
    let changes = effort.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let decimal = changes.filter(|change| *change > 0.0).fold(f64::INFINITY, f64::min);
    let [low, high] = extremes(effort);
    let mut sample = 0;
    for run in effort.chunk_by(|a, b| a.to_bits() == b.to_bits()) {
        let (first, value, samples) = (sample, run[0], run.len());
        sample += samples;
        let is_extreme = [low, high].iter().any(|end| end.to_bits() == value.to_bits());
        let is_inside = first > 0 && sample < effort.len();
        if samples >= PLATEAU && is_extreme && is_inside {
            let edges = [effort[first - 1], effort[sample]].map(|beside| (beside - value).abs());
            if edges.iter().all(|edge| *edge > EDGE * decimal) {
                return Some(Saturation { sample: first, samples, value, is_limit: false });
            }
        }
    }
    None
}
