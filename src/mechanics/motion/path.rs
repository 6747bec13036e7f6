//! The wanted motion of an arm: a path of its tip, or the directions of its chords.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rayon::prelude::*;

use super::error::{MotionError, PathError};
use super::period::TipPeriod;
use super::recording::{Recording, UNCERTAIN, Uncertainty};
use super::samples::{Ends, MotionColumns};
use super::scale::{MotionScale, TipTarget};
use super::spectrum::{Cutoff, InputBand};
use super::tip_motion::TipMotion;
use crate::numeric::{TimeGrid, extremes};

/// Number of possible errors in which all coordinates share one phase, as they share one profile.
const COMMON: u64 = 2;

/// Range of a column over the largest range of all columns below which it is round-off and its coordinate constant.
const HELD: f64 = 1e-12;

/// One column of a path: its name in the file, its samples, and their quality.
#[derive(Debug, Clone, PartialEq)]
pub struct PathColumn {
    /// Name, for messages: `x`, `angle1`.
    pub name: String,
    /// Samples in m or rad.
    pub values: Vec<f64>,
    /// Quality of the samples, in m or rad.
    pub recording: Recording,
}

/// Sampled columns of a path, of equal length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PathColumns {
    /// Time in s.
    pub time_s: Vec<f64>,
    /// x and y of the tip in m.
    pub tip: Option<[PathColumn; 2]>,
    /// Directions of the chords in rad, counterclockwise from x; the inner link first, `None` for a link without a
    /// column.
    pub angles: Vec<Option<PathColumn>>,
    /// Displacement of the carriage along its rail in m.
    pub carriage: Option<PathColumn>,
}

impl PathColumns {
    /// Columns of a tip at these places in m, one a step from 0 s on, with the directions in rad of each link from the
    /// third on, and the places of a carriage in m.
    pub fn of_tip(
        step_s: f64,
        places_m: &[[f64; 2]],
        outer_rad: impl IntoIterator<Item = Vec<f64>>,
        carriage_m: Option<Vec<f64>>,
    ) -> Self {
        let column =
            |name: String, values| PathColumn { name, values, recording: Recording::default() };
        let axis = |axis: usize| places_m.iter().map(|place| place[axis]).collect();
        let outer = outer_rad.into_iter().zip(3..);
        let outer = outer.map(|(angle_rad, link)| Some(column(format!("angle{link}"), angle_rad)));
        Self {
            time_s: (0..places_m.len()).map(|k| k as f64 * step_s).collect(),
            tip: Some([column("x".to_owned(), axis(0)), column("y".to_owned(), axis(1))]),
            angles: [None, None].into_iter().chain(outer).collect(),
            carriage: carriage_m.map(|own| column("carriage".to_owned(), own)),
        }
    }

    /// The columns beside the time, in their order.
    pub fn each(&self) -> impl Iterator<Item = &PathColumn> {
        self.tip.iter().flatten().chain(self.angles.iter().flatten()).chain(&self.carriage)
    }

    /// [`PathColumns::each`], to be changed, each with the length in m that makes a displacement of it.
    pub(crate) fn each_mut(
        &mut self,
        lengths_m: &[f64],
    ) -> impl Iterator<Item = (&mut PathColumn, f64)> {
        let lengths_m = lengths_m.iter().copied().chain(std::iter::repeat(1.0));
        let angles = self.angles.iter_mut().zip(lengths_m);
        let angles = angles.filter_map(|(column, length_m)| Some((column.as_mut()?, length_m)));
        let places = self.tip.iter_mut().flatten().chain(&mut self.carriage);
        places.map(|column| (column, 1.0)).chain(angles)
    }
}

/// Refuses an angle that jumps by half a turn or more.
pub(crate) fn refuse_jump(column: &PathColumn) -> Result<(), PathError> {
    let jumps = |pair: &[f64]| (pair[1] - pair[0]).abs() >= PI;
    match column.values.windows(2).position(jumps) {
        None => Ok(()),
        Some(at) => Err(PathError::Jump {
            column: column.name.clone(),
            sample: at + 1,
            found: column.values[at + 1],
            before: column.values[at],
        }),
    }
}

/// Quantities that a path prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prescribed {
    /// Place of the tip, and directions of all chords from the third on.
    Tip,
    /// Direction of every chord.
    Angles,
}

/// One decimal, with a margin for round-off.
const LAST_DECIMAL: f64 = 1.0 + 1e-9;

/// One coordinate over time.
#[derive(Debug, Clone, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "an arm has few coordinates")]
enum Course {
    Held(f64),
    Moving(TipMotion),
}

/// The wanted motion of an arm on a uniform grid, from rest to rest unless its [`Ends`] differ. A clone shares the samples.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmPath {
    grid: TimeGrid,
    prescribed: Prescribed,
    /// x and y of the tip in m, if prescribed; then arcs L θ in m of the prescribed chords; then the carriage.
    courses: Vec<Course>,
    has_carriage: bool,
    /// Lengths that multiply the angles; 1 for x, y and the carriage.
    lengths_m: Vec<f64>,
    /// Directions in rad that the file contains besides the tip's place.
    beside: Vec<(usize, Vec<f64>)>,
    /// Quality of all samples: the largest of each column's numbers, in m.
    recording: Recording,
}

/// One coordinate over a period: value, rate and acceleration.
pub(crate) type CourseHistories = [Vec<f64>; 3];

impl ArmPath {
    /// The path of an arm with these lengths of links.
    ///
    /// If both x and y are present, they count together with the angles from the third link on; other angles must
    /// agree.
    ///
    /// # Errors
    /// [`PathError`].
    pub fn new(columns: PathColumns, lengths_m: &[f64]) -> Result<Self, PathError> {
        Self::with_ends(columns, lengths_m, Ends::AtRest)
    }

    /// [`ArmPath::new`] with other ends. A cycle leads back to its start.
    ///
    /// # Errors
    /// [`PathError`]; also a cycle that ends with its first sample.
    pub fn with_ends(
        columns: PathColumns,
        lengths_m: &[f64],
        ends: Ends,
    ) -> Result<Self, PathError> {
        let dropped = columns.each().map(|column| column.recording.dropped).sum();
        let PathColumns { time_s, tip, angles, carriage } = columns;
        let links = lengths_m.len();
        let grid = TimeGrid::through(&time_s).map_err(MotionError::from)?;
        for column in angles.iter().flatten() {
            refuse_jump(column)?;
        }
        if let Some(column) = angles.iter().skip(links).flatten().next() {
            return Err(PathError::TooMany { column: column.name.clone(), links });
        }
        let prescribed = if tip.is_some() { Prescribed::Tip } else { Prescribed::Angles };
        let mut angles = angles.into_iter().chain(std::iter::repeat(None)).take(links).enumerate();
        let mut beside = Vec::new();
        if prescribed == Prescribed::Tip {
            for (link, column) in angles.by_ref().take(2) {
                beside.extend(column.map(|column| (link, column.values)));
            }
        }
        let mut all: Vec<(PathColumn, f64)> =
            tip.into_iter().flatten().map(|column| (column, 1.0)).collect();
        for (link, column) in angles {
            let missing = || PathError::Missing { missing: format!("angle{}", link + 1), links };
            all.push((column.ok_or_else(missing)?, lengths_m[link]));
        }
        let has_carriage = carriage.is_some();
        all.extend(carriage.map(|column| (column, 1.0)));
        let range_m = |(column, per_value): &(PathColumn, f64)| {
            let [low, high] = extremes(&column.values);
            per_value * (high - low)
        };
        let widest_m = all.iter().map(range_m).fold(0.0, f64::max);
        if widest_m == 0.0 {
            return Err(PathError::NoMotion);
        }
        let lengths_m = all.iter().map(|(_, per_value)| *per_value).collect();
        let courses = all.into_iter().map(|own| {
            let (range_m, constant_m) = (range_m(&own), own.1 * own.0.constant());
            let is_held = range_m < widest_m && range_m <= constant_m.max(HELD * widest_m);
            Course::of(&time_s, own, (is_held, ends))
        });
        let courses: Vec<Course> = courses.collect::<Result<_, _>>()?;
        let of_moving = courses.iter().filter_map(Course::moving).map(TipMotion::recording);
        let Some(coarsest) = of_moving.copied().reduce(Recording::coarser) else {
            return Err(PathError::NoMotion);
        };
        let recording = Recording { dropped, ..coarsest };
        Ok(Self { grid, prescribed, courses, has_carriage, lengths_m, beside, recording })
    }

    /// Quality of the samples, in m: that of the coarsest coordinate that moves, with the number of replaced samples of
    /// all columns.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Estimate of the largest error of a coordinate in m from the samples; `None` for exact samples.
    pub(super) fn known_to_m(&self) -> Option<f64> {
        self.moving().filter_map(TipMotion::known_to_m).reduce(f64::max)
    }

    /// This path over another distance and duration: each coordinate changes by `distance` times as much from its first
    /// sample. Of directions besides the tip's place only the first still belongs to a path of another distance.
    ///
    /// # Errors
    /// Those of [`TipMotion::scaled`].
    pub fn scaled(&self, scale: MotionScale) -> Result<Self, MotionError> {
        let scaled = |course: &Course| match course {
            Course::Held(value) => Ok(Course::Held(*value)),
            Course::Moving(motion) => {
                let start_m = motion.initial_displacement_m();
                motion.scaled_about(scale, start_m).map(Course::Moving)
            }
        };
        let courses = self.courses.iter().map(scaled).collect::<Result<Vec<_>, _>>()?;
        let grid = courses.iter().find_map(Course::moving).map_or(self.grid, TipMotion::grid);
        let recording = self.recording.scaled(scale.distance, scale.duration);
        let is_as_long = scale.distance.total_cmp(&1.0).is_eq();
        // Of another path only the start is the same.
        let belonging = if is_as_long { self.grid.len } else { 1 };
        let beside = self.beside.iter();
        let beside = beside.map(|(link, angles)| (*link, angles[..belonging].to_vec())).collect();
        Ok(Self { grid, courses, beside, recording, ..self.clone() })
    }

    /// Grid of the input samples.
    pub fn grid(&self) -> TimeGrid {
        self.grid
    }

    /// Quantities that the path prescribes.
    pub fn prescribed(&self) -> Prescribed {
        self.prescribed
    }

    /// True if the path prescribes the motion of a carriage, its last coordinate.
    pub fn has_carriage(&self) -> bool {
        self.has_carriage
    }

    /// Directions in rad of links, by their number from 0, that the input contains besides the tip's place.
    pub fn beside(&self) -> &[(usize, Vec<f64>)] {
        &self.beside
    }

    /// Motion before the first sample and after the last.
    pub fn ends(&self) -> Ends {
        self.moving().next().map_or(Ends::AtRest, TipMotion::ends)
    }

    /// Smallest even number of samples that contains whole cycles of a periodic path.
    pub(crate) fn cycles(&self) -> Option<usize> {
        self.moving().next().and_then(TipMotion::cycles)
    }

    /// Numbers of the last sample at rest before the motion and of the first one after it.
    pub fn moving_samples(&self) -> (usize, usize) {
        let ends = self.moving().map(TipMotion::moving_samples);
        ends.fold((self.grid.len - 1, 0), |(first, last), own| (first.min(own.0), last.max(own.1)))
    }

    fn moving(&self) -> impl Iterator<Item = &TipMotion> {
        self.courses.iter().filter_map(Course::moving)
    }

    /// The coordinates in m and rad, with the rests around the path, in whole steps, between two times in s.
    pub fn between(&self, from_s: f64, until_s: f64) -> (TimeGrid, Vec<Vec<f64>>) {
        let targets = self.courses.iter().map(|own| Some(own.moving()?.target(from_s, until_s)));
        let targets: Vec<_> = targets.collect();
        let grid = targets.iter().flatten().next().map_or(self.grid, TipTarget::grid);
        let each = targets.iter().zip(&self.courses).zip(&self.lengths_m);
        let histories = each.map(|((target, course), length_m)| match (target, course) {
            (Some(target), _) => target.displacement_m().iter().map(|m| m / length_m).collect(),
            (None, Course::Held(value)) => vec![value / length_m; grid.len],
            (None, Course::Moving(_)) => Vec::new(),
        });
        (grid, histories.collect())
    }

    /// Largest travel of a coordinate from its first sample, in m.
    pub(super) fn farthest_m(&self) -> f64 {
        self.moving().map(TipMotion::farthest_m).fold(0.0, f64::max)
    }

    /// This path sampled twice as often.
    ///
    /// # Errors
    /// Those of [`TipMotion::twice_as_often`].
    pub fn twice_as_often(&self) -> Result<Self, MotionError> {
        let finer = |course: &Course| match course {
            Course::Held(value) => Ok(Course::Held(*value)),
            Course::Moving(motion) => motion.twice_as_often().map(Course::Moving),
        };
        let courses = self.courses.iter().map(finer).collect::<Result<Vec<_>, _>>()?;
        let grid = courses.iter().find_map(Course::moving).map_or(self.grid, TipMotion::grid);
        Ok(Self { grid, courses, beside: Vec::new(), ..self.clone() })
    }

    /// Cut-offs of all coordinates that keep the tip within `tolerance` of the largest travel of a coordinate; constant
    /// coordinates keep all frequencies.
    pub(crate) fn cutoffs(&self, tolerance: f64) -> Vec<Cutoff> {
        let each_m = self.farthest_m() / self.moving().count() as f64;
        let of = |course: &Course| match course {
            Course::Held(_) => Cutoff::ALL,
            Course::Moving(motion) => {
                let found = motion.cutoff(tolerance * each_m / motion.farthest_m());
                let wanted_m =
                    if tolerance > 0.0 { tolerance.max(UNCERTAIN) * each_m } else { 0.0 };
                let input = found.input.map(|input| InputBand { wanted_m, ..input });
                Cutoff { input, ..found }
            }
        };
        self.courses.par_iter().map(of).collect()
    }

    /// Coordinates over a period of `len` samples in m and rad, and the largest error of each in m. Samples from `seam`
    /// on precede the motion.
    ///
    /// With `stray` it adds possible errors of the samples, different ones for each number.
    pub(crate) fn over_period(
        &self,
        (len, seam): (usize, usize),
        cutoffs: &[Cutoff],
        stray: Option<u64>,
    ) -> PathPeriod {
        let mut found =
            PathPeriod { courses: Vec::new(), errors_m: Vec::new(), period: None, seam_reach: 0 };
        let all = self.courses.par_iter().zip(cutoffs).map(|(course, cutoff)| match course {
            Course::Moving(motion) => Ok(Arc::new(motion.over_period(len, seam, *cutoff))),
            Course::Held(value) => Err(value),
        });
        let all: Vec<_> = all.collect();
        let mut stray = stray.map(|nth| Stray::new(nth, self.moving_samples()));
        for ((period, cutoff), length_m) in all.into_iter().zip(cutoffs).zip(&self.lengths_m) {
            let (histories, error_m) = match period {
                Ok(period) => {
                    let own = &period.histories;
                    let mut histories =
                        [&own.displacement_m, &own.velocity_m_s, &own.acceleration_m_s2]
                            .map(Vec::clone);
                    if let Some((stray, input)) = stray.as_mut().zip(cutoff.input) {
                        let errors = stray.of(&period, &input);
                        for (value, error) in histories.iter_mut().zip(&errors) {
                            value.iter_mut().zip(error).for_each(|(value, error)| *value += error);
                        }
                    }
                    histories.iter_mut().flatten().for_each(|value| *value /= length_m);
                    let error_m = period.tip_error_m();
                    found.seam_reach = found.seam_reach.max(period.spectrum.seam_reach());
                    let is_higher = |other: &Arc<TipPeriod>| {
                        cutoff.omega_rad_s > other.spectrum.cutoff.omega_rad_s
                    };
                    if found.period.as_ref().is_none_or(is_higher) {
                        found.period = Some(period);
                    }
                    (histories, error_m)
                }
                Err(value) => ([vec![value / length_m; len], vec![0.0; len], vec![0.0; len]], 0.0),
            };
            found.courses.push(histories);
            found.errors_m.push(error_m);
        }
        found
    }

    /// The input samples: one history for each coordinate, in m and rad.
    pub fn given(&self) -> Vec<Vec<f64>> {
        let courses = self.courses.iter().zip(&self.lengths_m);
        let samples = courses.map(|(course, length_m)| match course {
            Course::Held(value) => vec![value / length_m; self.grid.len],
            Course::Moving(motion) => {
                motion.samples().displacements_m().iter().map(|m| m / length_m).collect()
            }
        });
        samples.collect()
    }
}

/// The coordinates of a path over a period.
pub(crate) struct PathPeriod {
    /// Value, rate and acceleration of each coordinate in m or rad.
    pub(crate) courses: Vec<CourseHistories>,
    /// Largest error of each coordinate in m.
    pub(crate) errors_m: Vec<f64>,
    /// The period of the course with the highest cut-off.
    pub(crate) period: Option<Arc<TipPeriod>>,
    /// Samples on either side of the seam in which a decay is measured, for the slowest course.
    pub(crate) seam_reach: usize,
}

/// Possible errors of the samples of a path.
struct Stray {
    state: u64,
    /// The sample at which the error parts beyond the band pass.
    at: usize,
    /// Common phase of these parts if coordinates share one profile; otherwise each coordinate has a random phase.
    common: Option<f64>,
}

impl Stray {
    /// The errors number `nth` of a path that moves between two samples.
    fn new(nth: u64, (first, last): (usize, usize)) -> Self {
        let at = [first, last, first.midpoint(last)][(nth % 3) as usize];
        let mut stray = Self { state: nth, at, common: None };
        let phase = TAU * stray.draw();
        stray.common = (nth < COMMON).then_some(phase);
        stray
    }

    /// A random number from 0 to 1.
    fn draw(&mut self) -> f64 {
        // Knuth's linear congruence; its upper bits are random enough here.
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.state >> 33) as f64 / f64::from(1_u32 << 31)
    }

    /// Error of the next coordinate in m, its rate and its acceleration.
    fn of(&mut self, period: &TipPeriod, input: &InputBand) -> CourseHistories {
        let turned = if period.spectrum.travel_m() < 0.0 { PI } else { 0.0 };
        let phase = self.common.map_or_else(|| TAU * self.draw(), |phase| phase + turned);
        period.possible_error(input, (self.at, phase), &mut || self.draw())
    }
}

impl PathColumn {
    /// Range of the values below which the column counts as constant: a change by the last decimal, or noise.
    fn constant(&self) -> f64 {
        match self.recording.uncertainty {
            Some(Uncertainty::Rounded { step_m, .. }) => step_m * LAST_DECIMAL,
            Some(noise @ Uncertainty::Noisy { .. }) => 2.0 * noise.tolerance_m(self.values.len()),
            _ => 0.0,
        }
    }
}

impl Course {
    fn moving(&self) -> Option<&TipMotion> {
        match self {
            Self::Moving(motion) => Some(motion),
            Self::Held(_) => None,
        }
    }

    fn of(
        time_s: &[f64],
        (column, length_m): (PathColumn, f64),
        (is_held, ends): (bool, Ends),
    ) -> Result<Self, PathError> {
        if is_held {
            let [low, high] = extremes(&column.values);
            let is_noisy = matches!(column.recording.uncertainty, Some(Uncertainty::Noisy { .. }));
            let mean = || column.values.iter().sum::<f64>() / column.values.len() as f64;
            let value = if is_noisy { mean() } else { low + 0.5 * (high - low) };
            return Ok(Self::Held(length_m * value));
        }
        let displacement_m = column.values.iter().map(|value| length_m * value).collect();
        let columns = MotionColumns {
            time_s: time_s.to_vec(),
            displacement_m: Some(displacement_m),
            ..MotionColumns::default()
        };
        let recording = column.recording.scaled(length_m, 1.0);
        let name = column.name.clone();
        let refused = |error| match error {
            MotionError::MovingAtEnd { sample, velocity_m_s, share }
                if name.starts_with("angle") =>
            {
                let rate_rad_s = velocity_m_s / length_m;
                PathError::TurnsAtEnd { column: name, sample, rate_rad_s, share }
            }
            error => PathError::Column { column: name, error },
        };
        let motion = TipMotion::with_ends(columns, ends).map_err(refused)?;
        Ok(Self::Moving(motion.recorded(recording)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::Recording;

    fn smooth(t: f64) -> f64 {
        t.powi(3) * (10.0 - 15.0 * t + 6.0 * t * t)
    }

    fn column(name: &str, at: impl Fn(f64) -> f64) -> PathColumn {
        let values = (0..=100).map(|k| at(f64::from(k) / 100.0)).collect();
        PathColumn { name: name.to_owned(), values, recording: Recording::default() }
    }

    fn columns(
        tip: Option<[PathColumn; 2]>,
        angles: Vec<Option<PathColumn>>,
    ) -> Result<ArmPath, PathError> {
        let time_s = (0..=100).map(|k| 0.01 * f64::from(k)).collect();
        ArmPath::new(PathColumns { time_s, tip, angles, carriage: None }, &[0.7, 0.6])
    }

    #[test]
    fn a_coordinate_that_does_not_change_is_held() {
        let tip = [column("x", smooth), column("y", |_| 0.3)];
        let path = columns(Some(tip), vec![]).unwrap();
        let found = path.over_period((256, 180), &path.cutoffs(1e-6), None);
        assert_eq!(found.courses[1][0], vec![0.3; 256]);
        assert!((found.courses[0][0][100] - 1.0).abs() < 1e-6 && found.errors_m[1] == 0.0);
        assert_eq!(path.moving_samples(), (0, 100));
    }

    #[test]
    fn angles_are_followed_in_rad_to_a_share_of_the_way() {
        let angle = |name, by: f64| Some(column(name, move |t| 0.2 + by * smooth(t)));
        let path = columns(None, vec![angle("angle1", 1.0), angle("angle2", -0.1)]).unwrap();
        let cutoffs = path.cutoffs(1e-6);
        let found = path.over_period((256, 180), &cutoffs, None);
        assert!((found.courses[0][0][100] - 1.2).abs() < 2e-6);
        assert!((found.courses[1][0][100] - 0.1).abs() < 2e-6);
        // The outer link moves a tenth as far: its frequencies end sooner.
        let omega = |k: usize| cutoffs[k].omega_rad_s;
        assert!(omega(1) < omega(0), "{} {}", omega(1), omega(0));
    }

    #[test]
    fn what_is_no_path_is_refused_by_its_column() {
        let refused = |tip, angles| columns(tip, angles).unwrap_err();
        let angle = |name| Some(column(name, smooth));
        let lacking = refused(None, vec![angle("angle1"), None]).to_string();
        let must = "an arm of 2 links needs x and y, or angle1 and angle2";
        assert_eq!(lacking, format!("angle2 is missing: {must}"));
        let third = refused(None, vec![angle("angle1"), angle("angle2"), angle("angle3")]);
        assert_eq!(third.to_string(), "angle3 belongs to no link: the arm has 2 links");
        let jump = |t: f64| if t > 0.5 { smooth(t) - 6.0 } else { smooth(t) };
        let jumps = refused(None, vec![Some(column("angle1", jump)), angle("angle2")]);
        assert_eq!(jumps.sample(), Some(51));
        let ends = refused(Some([column("x", |t| t), column("y", smooth)]), vec![]);
        assert!(ends.to_string().starts_with("x: the motion starts with a velocity"), "{ends}");
        let still = [column("x", |_| 0.1), column("y", |_| 0.3)];
        assert_eq!(refused(Some(still), vec![]), PathError::NoMotion);
    }
}
