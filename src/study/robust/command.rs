//! Commands of the drives: efforts or positions from a solution, on fewer samples; the tip of a plant under them.

use std::num::NonZeroUsize;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::strays::Strays;
use crate::beam::MeshPlan;
use crate::inverse::{JointMotion, Solution};
use crate::link::{Arm, ParameterError};
use crate::motion::{Ends, Shaper};
use crate::numeric::{CubicSpline, SplineEnds, TimeCurve, TimeGrid, extremes, largest};
use crate::response::{
    Feedback, HistoryError, HubReference, Input, Play, PlayedTip, Ringing, SimulationError, Start,
    TipCourse, Torque, simulate, simulate_once, simulate_tip,
};
use crate::result::{LimitedValue, Limits, PlayedMetrics};

/// Periods of the lowest mode that rings to play after the motion.
pub const PERIODS: f64 = 10.0;

/// Largest error of a left out sample of a place, over the range of its history, and of an effort, which moves the tip
/// only twice integrated.
const THINNED: f64 = 1e-5;
const THINNED_EFFORT: f64 = 1e-4;

/// Most samples of which one is kept.
const MOST_LEFT_OUT: usize = 64;

/// Samples of a checked play after its first period.
const BEYOND: f64 = 32.0;

/// Tolerance of the nominal play of bent links, which finds the refinement for all plants.
const TOLERANCE: f64 = 1e-5;

/// Share of a command's range within which it counts as at rest, for its duration.
const AT_REST: f64 = 0.02;

/// Quantity that the drives hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Hold {
    /// The positions of the joints, exactly.
    Position,
    /// Torques and forces.
    Effort,
    /// Torques and forces, and feedback around the positions.
    Feedback,
}

impl Hold {
    /// Its name as an option's value.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Effort => "effort",
            Self::Feedback => "feedback",
        }
    }
}

/// Why a solution gives no command.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A motion without rest at its end.
    #[error("the motion does not end at rest, but must: the measures begin at its end")]
    Moves,
    /// Histories that cannot be played.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// Gains outside their range.
    #[error(transparent)]
    Gains(#[from] ParameterError),
}

/// Histories of a command at all samples.
#[derive(Debug, Clone)]
pub struct Histories {
    /// Their times.
    pub grid: TimeGrid,
    /// Torque in N m, or force in N, of each joint.
    pub efforts: Vec<Vec<f64>>,
    /// Angle in rad, or place in m, of each joint, and its rate.
    pub positions: Vec<[Vec<f64>; 2]>,
    /// Each coordinate of the wanted tip in m.
    pub wanted_m: Vec<Vec<f64>>,
}

/// How many samples a command keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Thinned {
    /// All.
    No,
    /// As few as splines through them restore the others from.
    Yes,
}

/// A command that the drives play on every plant, and the motion that the tip should make.
#[derive(Debug, Clone)]
pub struct Command {
    hold: Hold,
    efforts: Vec<Torque>,
    positions: Vec<HubReference>,
    feedback: Vec<Feedback>,
    wanted_m: Vec<Vec<f64>>,
    grid: TimeGrid,
    /// End of the wanted motion in s.
    pub end_s: f64,
    /// Largest travel of the wanted tip in m.
    pub travel_m: f64,
    /// Directions of the chords in rad at the start and at the end.
    directions_rad: [Vec<f64>; 2],
    start_angle_rad: Option<f64>,
    is_large: bool,
    refinements: usize,
    /// Error in m along each axis that every play has: see [`Command::less`].
    common_m: Vec<Vec<f64>>,
}

/// The tip of one plant against the wanted motion.
#[derive(Debug, Clone)]
pub struct PlantTip {
    /// Its measures.
    pub strays: Strays,
    /// Its error in m along each axis, at the samples of the command and after them.
    pub error_m: Vec<Vec<f64>>,
    /// The values with a limit.
    pub limited: Vec<LimitedValue>,
    /// The lowest mode that rings.
    pub rings: Option<Ringing>,
}

impl Command {
    /// The command of these histories, which end at `end_s`, on the link or the arm of a solution. `gains` has stiffness
    /// and damping of each joint's feedback.
    ///
    /// # Errors
    /// [`CommandError`].
    pub fn of(
        solution: &Solution,
        (histories, end_s): (&Histories, f64),
        (hold, gains): (Hold, &[(f64, f64)]),
        (thinned, is_large): (Thinned, bool),
    ) -> Result<Self, CommandError> {
        if solution.motion.ends() != Ends::AtRest {
            return Err(CommandError::Moves);
        }
        let every =
            if thinned == Thinned::Yes { every(histories, hold) } else { NonZeroUsize::MIN };
        let some =
            |values: &[f64]| values.iter().step_by(every.get()).copied().collect::<Vec<f64>>();
        let grid = histories.grid;
        let times: Vec<f64> = (0..grid.len).map(|k| grid.time_s(k)).collect();
        let times_s = some(&times);
        let efforts = histories.efforts.iter().map(|own| Torque::new(&times_s, some(own)));
        let positions = histories.positions.iter().map(|[angle, rate]| {
            HubReference::new(&times_s, some(angle), (!rate.is_empty()).then(|| some(rate)))
        });
        let positions = positions.collect::<Result<Vec<_>, _>>()?;
        let feedback = gains.iter().zip(&positions);
        let feedback = feedback.map(|((kp, kd), own)| Feedback::new(*kp, *kd, own.clone()));
        let feedback = feedback.collect::<Result<Vec<_>, _>>()?;
        let efforts = efforts.collect::<Result<Vec<_>, _>>()?;
        let wanted_m: Vec<Vec<f64>> = histories.wanted_m.iter().map(|own| some(own)).collect();
        Ok(Self {
            hold,
            grid: efforts[0].grid(),
            efforts,
            positions,
            feedback: if hold == Hold::Feedback { feedback } else { Vec::new() },
            travel_m: solution.tip_travel_m(),
            wanted_m,
            end_s,
            directions_rad: [0, solution.grid.len - 1].map(|k| directions_rad(solution, k)),
            start_angle_rad: start_angle_rad(solution),
            is_large,
            refinements: 0,
            common_m: Vec::new(),
        })
    }

    /// Quantity that the drives hold.
    pub fn hold(&self) -> Hold {
        self.hold
    }

    /// Time in s from the first to the last instant at which the played quantity differs from rest by more than 2 % of
    /// its range; the longest of all joints.
    pub fn duration_s(&self) -> f64 {
        let lasts = |own: &[f64]| {
            let [low, high] = extremes(own);
            let band = AT_REST * (high - low);
            let last = own.len() - 1;
            let from = own.iter().position(|x| (x - own[0]).abs() > band);
            let until = own.iter().rposition(|x| (x - own[last]).abs() > band);
            from.zip(until).map_or(0.0, |(from, until)| self.grid.step_s * (until - from) as f64)
        };
        let longest = match self.hold {
            Hold::Position => {
                self.positions.iter().map(|own| lasts(own.angle_rad())).reduce(f64::max)
            }
            _ => self.efforts.iter().map(|own| lasts(own.torque_n_m())).reduce(f64::max),
        };
        longest.unwrap_or(0.0)
    }

    /// The play on a link or an arm that stands where the wanted motion begins.
    fn play<'a>(&'a self, arm: &Arm, place: &'a [f64]) -> Play<'a> {
        let input = match self.hold {
            Hold::Position => Input::Angles(&self.positions),
            Hold::Effort | Hold::Feedback => Input::Torques(&self.efforts),
        };
        let start = match (self.hold, arm.alone()) {
            (Hold::Position, _) | (_, Some(_)) => None,
            (Hold::Effort, None) => Some(Start::Chords(&self.directions_rad[0])),
            (Hold::Feedback, None) => Some(Start::Joints(place)),
        };
        Play {
            feedback: &self.feedback,
            initial_tip_m: self.wanted_m[0][0],
            start,
            carriage_m: arm.carriage().map_or(0.0, |_| place.last().copied().unwrap_or_default()),
            is_large: self.is_large,
            start_angle_rad: self.start_angle_rad,
            tolerance: Some(TOLERANCE),
            ..Play::with(input)
        }
    }

    /// Where the joints begin.
    fn places(&self) -> Vec<f64> {
        self.positions.iter().map(|own| own.angle_rad()[0]).collect()
    }

    /// The same command with the refinement that bent links need within a tolerance of their motion, one refinement
    /// below the one that shows it.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn refined(self, arm: &Arm, plans: &[MeshPlan]) -> Result<Self, SimulationError> {
        let places = self.places();
        let play = self.play(arm, &places);
        let is_bent = self.is_large || arm.has_weight() || arm.alone().is_none();
        if !is_bent {
            return Ok(self);
        }
        let played = simulate(arm, plans, &play, &|_| {})?;
        let steps = played.bent().map_or(1, |bent| bent.steps);
        let refinements = (steps.ilog2() as usize).saturating_sub(1);
        Ok(Self { refinements, ..self })
    }

    /// Plays the command on a plant whose drives lag by a delay in s, up to 10 periods after the motion and to `least_s`.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn plant(
        &self,
        (arm, plans): (&Arm, &[MeshPlan]),
        (delay_s, band_m, least_s): (f64, f64, f64),
        limits: &[Limits],
    ) -> Result<PlantTip, SimulationError> {
        let places = self.places();
        let play = self.play(arm, &places);
        let course = TipCourse {
            end_s: self.end_s,
            periods: PERIODS,
            least_s,
            refinements: self.refinements,
            directions_rad: &self.directions_rad[1],
        };
        let (tip, limited) = if limits.iter().all(|own| *own == Limits::default()) {
            (simulate_tip(arm, plans, &play, &course)?, Vec::new())
        } else {
            let (played, rings) = simulate_once(arm, plans, &play, &course)?;
            let limited = PlayedMetrics::of(&played, arm).limited(limits);
            (PlayedTip::of(played, rings), limited)
        };
        let error_m = self.error_m(&tip.grid, &tip.at_m, delay_s);
        let period_s = tip.rings.map(|own| own.period_s);
        let strays = Strays::of(&error_m, &tip.grid, (self.end_s, period_s), band_m);
        Ok(PlantTip { strays, error_m, limited, rings: tip.rings })
    }

    /// The same plant by the whole simulation of `simulate`, with all its modes, meshes and refinements, up to a period
    /// after the motion. It measures the error of [`Command::plant`].
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn checked(
        &self,
        (arm, plans): (&Arm, &[MeshPlan]),
        (delay_s, band_m): (f64, f64),
        period_s: Option<f64>,
    ) -> Result<PlantTip, SimulationError> {
        let places = self.places();
        let until_s = self.end_s + period_s.unwrap_or(0.0) + BEYOND * self.grid.step_s;
        let until_s = Some(until_s.max(self.grid.end_s()));
        let play = Play { until_s, tolerance: None, ..self.play(arm, &places) };
        let played = simulate(arm, plans, &play, &|_| {})?;
        let at_m: Vec<Vec<f64>> = played.tip.into_iter().map(|axis| axis.displacement_m).collect();
        let error_m = self.error_m(&played.grid, &at_m, delay_s);
        let strays = Strays::of(&error_m, &played.grid, (self.end_s, period_s), band_m);
        Ok(PlantTip { strays, error_m, limited: Vec::new(), rings: None })
    }

    /// The tip along each axis less the wanted one, delayed by a time in s.
    fn error_m(&self, grid: &TimeGrid, at_m: &[Vec<f64>], delay_s: f64) -> Vec<Vec<f64>> {
        let late = delay_s / grid.step_s;
        let axes = at_m.iter().zip(&self.wanted_m).map(|(at_m, wanted_m)| {
            let spline = (late > 0.0).then(|| CubicSpline::uniform(at_m, SplineEnds::NotAKnot));
            let at = |k: usize| {
                let spline = spline.as_ref();
                spline.map_or(at_m[k], |own| own.value((k as f64 - late).max(0.0)))
            };
            let error = |k: usize| at(k) - wanted_m[k.min(wanted_m.len() - 1)];
            (0..at_m.len()).map(error).collect::<Vec<f64>>()
        });
        let mut error_m: Vec<Vec<f64>> = axes.collect();
        for (own, common) in error_m.iter_mut().zip(&self.common_m) {
            let last = common.len() - 1;
            own.iter_mut().enumerate().for_each(|(k, e)| *e -= common[k.min(last)]);
        }
        error_m
    }

    /// The same command with an error along each axis that is taken off from every play: that of the nominal plant under
    /// the exact inverse, which would be 0. It is the difference between the laws of damping in frequency and in time.
    #[must_use]
    pub fn less(self, common_m: Vec<Vec<f64>>) -> Self {
        Self { common_m, ..self }
    }

    /// An error of a play along each axis at any time in s: that of the first sample before it, that of the last after it.
    pub fn over_time(&self, error_m: &[Vec<f64>]) -> impl Fn(usize, f64) -> f64 + use<> {
        let grid = TimeGrid { len: error_m[0].len(), ..self.grid };
        let curve = |own: &Vec<f64>| TimeCurve::new(grid, own, SplineEnds::NotAKnot);
        let curves: Vec<TimeCurve> = error_m.iter().map(curve).collect();
        move |axis, time_s| curves[axis].value(time_s)
    }

    /// Time in s of a sample, also after the last one of the command.
    pub fn time_s(&self, sample: usize) -> f64 {
        self.grid.time_s(sample)
    }
}

impl Histories {
    /// The histories of a solution: its own, or those of rigid links.
    pub fn of(solution: &Solution, is_rigid: bool) -> Self {
        let joints = &solution.joints;
        let effort = |own: &JointMotion| {
            if is_rigid { own.rigid_torque_n_m.clone() } else { own.torque_n_m.clone() }
        };
        let position = |own: &JointMotion| {
            if is_rigid {
                [own.rigid_angle_rad.clone(), Vec::new()]
            } else {
                [own.angle_rad.clone(), own.rate_rad_s.clone()]
            }
        };
        Self {
            grid: solution.grid,
            efforts: joints.iter().map(effort).collect(),
            positions: joints.iter().map(position).collect(),
            wanted_m: solution.tip.iter().map(|axis| axis.displacement_m.clone()).collect(),
        }
    }

    /// All histories, shaped, with the rest until the shaper ends. The wanted tip is shaped, too.
    #[must_use]
    pub fn shaped(&self, shaper: &Shaper) -> Self {
        let step_s = self.grid.step_s;
        let of = |own: &Vec<f64>| shaper.shaped_samples(own, step_s);
        let position = |[angle, rate]: &[Vec<f64>; 2]| {
            [of(angle), if rate.is_empty() { Vec::new() } else { of(rate) }]
        };
        let wanted_m: Vec<Vec<f64>> = self.wanted_m.iter().map(of).collect();
        Self {
            grid: TimeGrid { len: wanted_m[0].len(), ..self.grid },
            efforts: self.efforts.iter().map(of).collect(),
            positions: self.positions.iter().map(position).collect(),
            wanted_m,
        }
    }
}

/// The largest number of which one sample is enough.
fn every(histories: &Histories, hold: Hold) -> NonZeroUsize {
    let positions = histories.positions.iter().map(|[angle, _]| angle);
    let efforts = histories.efforts.iter().filter(|_| hold != Hold::Position);
    let places = positions.filter(|_| hold != Hold::Effort).chain(&histories.wanted_m);
    let needed = places.map(|own| (own, THINNED)).chain(efforts.map(|own| (own, THINNED_EFFORT)));
    let needed: Vec<(&Vec<f64>, f64)> = needed.collect();
    let restores = |every: usize| {
        needed.iter().all(|(own, share)| {
            let some: Vec<f64> = own.iter().step_by(every).copied().collect();
            if some.len() < 8 {
                return false;
            }
            let [low, high] = extremes(own);
            let spline = CubicSpline::uniform(&some, SplineEnds::NotAKnot);
            let last = (some.len() - 1) * every;
            let off = |k: usize| own[k] - spline.value(k as f64 / every as f64);
            let off: Vec<f64> = (0..=last).map(off).collect();
            largest(&off) <= share * (high - low)
        })
    };
    let mut found = 1;
    while found < MOST_LEFT_OUT && restores(2 * found) {
        found *= 2;
    }
    NonZeroUsize::new(found).unwrap_or(NonZeroUsize::MIN)
}

/// Directions of the chords in rad at a sample of a solution.
pub fn directions_rad(solution: &Solution, sample: usize) -> Vec<f64> {
    match solution.arm.alone() {
        None => solution.shapes().map(|shape| shape.chord[0][sample]).collect(),
        Some(link) => {
            let from_rad = start_angle_rad(solution).or(link.direction_rad()).or(link.origin_rad());
            let turn = if link.joint().slides() {
                0.0
            } else {
                solution.tip[0].displacement_m[sample] / link.rigid_tip()
            };
            vec![from_rad.unwrap_or(0.0) + turn]
        }
    }
}

/// Direction of a link at zero displacement of its tip, where the motion has it.
fn start_angle_rad(solution: &Solution) -> Option<f64> {
    let tip = solution.motion.tip()?;
    tip.target(solution.grid.time_s(0), solution.grid.end_s()).start_angle_rad()
}
