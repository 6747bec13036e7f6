//! The tip alone under an input, for the many plants of a study: without nodes, energies and warnings.

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use num_complex::Complex64;

use super::driving::Driving;
use super::error::SimulationError;
use super::history::Feedback;
use super::linear::play_modes;
use super::modes::Equations;
use super::play::{Input, Play, Started, continued};
use super::played::Played;
use super::pose::ArmPose;
use super::pose_modes::PoseMode;
use super::simulation::play_bent_once;
use super::stepper::Stepper;
use crate::beam::{Mesh, MeshPlan};
use crate::link::{Arm, Gravity, Link};
use crate::modal::{DampingLaw, PoseHub, Shape, pose_modes};
use crate::numeric::{TimeGrid, magnitude};

/// Share of the motion above the input's band, see [`Play::band_rad_s`].
pub(crate) const NEGLIGIBLE: f64 = 1e-7;

/// Modes that feedback couples, in the search of the loop's slowest vibration.
const MODES_OF_LOOP: usize = 12;

/// Imaginary part of a pole over its magnitude, or ω² over the largest, below which nothing rings.
const RINGS: f64 = 1e-9;

/// How long and how finely to play.
#[derive(Debug, Clone, Copy)]
pub struct TipCourse<'a> {
    /// End of the wanted motion in s.
    pub end_s: f64,
    /// Periods of the lowest mode that rings to play after this end.
    pub periods: f64,
    /// Least end of the play in s.
    pub least_s: f64,
    /// Refinements of bent links: two orders of the polynomials, half the step each.
    pub refinements: usize,
    /// Directions of the links' chords in rad at the end of the wanted motion.
    pub directions_rad: &'a [f64],
}

/// The tip of a link or an arm under an input.
#[derive(Debug, Clone, PartialEq)]
pub struct PlayedTip {
    /// Times of the samples.
    pub grid: TimeGrid,
    /// Displacement in m of a link's tip, or x and y of an arm's.
    pub at_m: Vec<Vec<f64>>,
    /// The lowest mode that rings with the joints as they are played: free under efforts, held where they move as
    /// prescribed, on the gains of feedback. `None` if nothing rings.
    pub rings: Option<Ringing>,
}

/// A mode that rings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ringing {
    /// Its damped period in s.
    pub period_s: f64,
    /// Its damping ratio; 0 where unknown: for bent links.
    pub ratio: f64,
}

impl Ringing {
    /// Undamped frequency in rad/s.
    pub fn omega_rad_s(&self) -> f64 {
        TAU / self.period_s / (1.0 - self.ratio * self.ratio).sqrt()
    }
}

impl PlayedTip {
    /// The tip of a whole play.
    pub fn of(played: Played, rings: Option<Ringing>) -> Self {
        let at_m = played.tip.into_iter().map(|axis| axis.displacement_m).collect();
        Self { grid: played.grid, at_m, rings }
    }
}

/// Plays an input like [`simulate`](super::simulate), and computes the tip alone. Bent links play at one refinement.
///
/// # Errors
/// [`SimulationError`].
pub fn simulate_tip(
    arm: &Arm,
    plans: &[MeshPlan],
    play: &Play<'_>,
    course: &TipCourse<'_>,
) -> Result<PlayedTip, SimulationError> {
    let mut meshes = meshes(arm, plans)?;
    if !play.is_bent(arm) {
        return linear(&arm.links()[0].link, &meshes.swap_remove(0), play, course);
    }
    let (played, rings) = bent(arm, meshes, play, course)?;
    Ok(PlayedTip::of(played, rings))
}

/// The play of [`simulate_tip`] with the joints, and its lowest mode that rings. It has no warnings, and no energies of bent
/// links.
///
/// # Errors
/// [`SimulationError`].
pub fn simulate_once(
    arm: &Arm,
    plans: &[MeshPlan],
    play: &Play<'_>,
    course: &TipCourse<'_>,
) -> Result<(Played, Option<Ringing>), SimulationError> {
    let mut meshes = meshes(arm, plans)?;
    if play.is_bent(arm) {
        return bent(arm, meshes, play, course);
    }
    let (link, mesh) = (&arm.links()[0].link, meshes.swap_remove(0));
    let (band_rad_s, started, _) = started(link, &mesh, play)?;
    let rings = rings(&started.equations, play);
    let until_s = Some(until_s(play, course, rings));
    let played = play_modes(link, mesh, &Play { until_s, ..*play }, band_rad_s)?;
    Ok((Played { warnings: Vec::new(), ..played }, rings))
}

fn meshes(arm: &Arm, plans: &[MeshPlan]) -> Result<Vec<Mesh>, SimulationError> {
    let meshes = arm.links().iter().zip(plans).map(|(own, plan)| Mesh::new(&own.link, plan));
    Ok(meshes.collect::<Result<_, _>>()?)
}

/// Bent links at one refinement.
fn bent(
    arm: &Arm,
    meshes: Vec<Mesh>,
    play: &Play<'_>,
    course: &TipCourse<'_>,
) -> Result<(Played, Option<Ringing>), SimulationError> {
    let rings = rings_bent(arm, &meshes, play, course.directions_rad);
    let until_s = Some(until_s(play, course, rings));
    let play = Play { until_s, ..*play };
    Ok((play_bent_once(arm, meshes, &play, course.refinements)?, rings))
}

/// End of the play in s: not before the input's.
fn until_s(play: &Play<'_>, course: &TipCourse<'_>, rings: Option<Ringing>) -> f64 {
    let after_s = course.periods * rings.map_or(0.0, |own| own.period_s);
    (course.end_s + after_s).max(course.least_s).max(play.input.grid().end_s())
}

/// A linear link before its play, with the band of the input in rad/s and the input.
fn started(
    link: &Link,
    mesh: &Mesh,
    play: &Play<'_>,
) -> Result<(f64, Started, Driving), SimulationError> {
    let band_rad_s = play.band_rad_s(NEGLIGIBLE).ok_or(play.nothing())?;
    let driving = play.driving((0, link), play.zero_of_state_rad(link), false)?;
    let law = DampingLaw::of(link, mesh)?;
    let started = Started::of(link, (mesh, &law), (play, &driving), band_rad_s)?;
    Ok((band_rad_s, started, driving))
}

/// The tip of a linear link by its modes.
fn linear(
    link: &Link,
    mesh: &Mesh,
    play: &Play<'_>,
    course: &TipCourse<'_>,
) -> Result<PlayedTip, SimulationError> {
    let (_, started, driving) = started(link, mesh, play)?;
    let Started { equations, start: [coordinates, rates], .. } = started;
    let rings = rings(&equations, play);
    let grid = continued(play.input.grid(), Some(until_s(play, course, rings)))?;
    let stepper = Stepper::new(&equations, grid.step_s).starting_at(&coordinates, &rates);
    let tips: Vec<f64> = equations.coordinates.iter().map(|own| own.tip).collect();
    let factors = stepper.factors(&tips, &vec![0.0; tips.len()]);
    let (start_m, mut at_m) = (play.start_m(link), Vec::with_capacity(grid.len));
    stepper.jumped(driving.first_jump()).run(driving.steps(grid.len), |stepper| {
        at_m.push(start_m + stepper.weighted(&factors));
    });
    match at_m.iter().position(|at_m| !at_m.is_finite()) {
        Some(sample) => Err(SimulationError::NotFinite { time_s: grid.time_s(sample) }),
        None => Ok(PlayedTip { grid, at_m: vec![at_m], rings }),
    }
}

/// A free mode of the plant: ω² in 1/s², its decay 2ζω in 1/s, and the displacement of each joint.
struct FreeMode {
    square_per_s2: f64,
    rate_per_s: f64,
    joints: Vec<f64>,
}

/// The lowest mode of a linear link that rings.
fn rings(equations: &Equations, play: &Play<'_>) -> Option<Ringing> {
    if play.feedback.is_empty() {
        let alone = equations.coordinates.iter().skip(1).map(|own| {
            let omega_rad_s = own.square.sqrt();
            let ratio = 0.5 * own.rate_per_s / omega_rad_s;
            let period_s = TAU / omega_rad_s / (1.0 - ratio * ratio).max(0.0).sqrt();
            Ringing { period_s, ratio }
        });
        return alone.into_iter().find(|own| own.period_s.is_finite());
    }
    let own = equations.coordinates.iter().take(MODES_OF_LOOP).map(|own| FreeMode {
        square_per_s2: own.square,
        rate_per_s: own.rate_per_s,
        joints: vec![own.hub_angle],
    });
    let reaction = equations.reaction;
    rings_in_loop(
        &own.collect::<Vec<_>>(),
        &[[reaction.stiffness_n_m_rad, reaction.damping_n_m_s_rad]],
    )
}

/// The slowest vibration of modes whose joints have feedback with these gains.
fn rings_in_loop(modes: &[FreeMode], gains: &[[f64; 2]]) -> Option<Ringing> {
    let count = modes.len();
    let matrix = DMatrix::from_fn(2 * count, 2 * count, |row, column| {
        if row < count {
            return f64::from(u8::from(column == row + count));
        }
        let (own, other) = (&modes[row - count], &modes[column % count]);
        let part = column / count;
        let pairs = own.joints.iter().zip(&other.joints).zip(gains);
        let fed: f64 = pairs.map(|((a, b), gains)| a * b * gains[part]).sum();
        let is_same = column % count == row - count;
        let alone = if is_same { [own.square_per_s2, own.rate_per_s][part] } else { 0.0 };
        -alone - fed
    });
    let poles = matrix.schur().complex_eigenvalues();
    let size = |pole: &Complex64| magnitude(*pole);
    let rings = poles.iter().filter(|pole| pole.im > RINGS * size(pole));
    let slowest = rings.min_by(|a, b| a.im.total_cmp(&b.im))?;
    Some(Ringing { period_s: TAU / slowest.im, ratio: -slowest.re / size(slowest) })
}

/// The lowest mode that rings about the pose at the end of the motion.
fn rings_bent(
    arm: &Arm,
    meshes: &[Mesh],
    play: &Play<'_>,
    directions_rad: &[f64],
) -> Option<Ringing> {
    let (is_held, has_gains) = (matches!(play.input, Input::Angles(_)), !play.feedback.is_empty());
    let joints = arm.joints().count();
    let count = if has_gains { MODES_OF_LOOP } else { joints + 2 };
    let modes: Vec<FreeMode> = if let Some(link) =
        arm.alone().filter(|own| own.joint().slides() || !has_gains)
    {
        let hub = if is_held { PoseHub::Spring(f64::INFINITY) } else { PoseHub::Free };
        let along = |own: &Gravity| own.along_m_s2(directions_rad[0]);
        let modes = pose_modes(&meshes[0], link.gravity().map_or(0.0, along), hub, count)?;
        let mode = |(square_per_s2, shape): (f64, Shape)| FreeMode {
            square_per_s2,
            rate_per_s: 0.0,
            joints: vec![shape.hub_angle],
        };
        modes.into_iter().map(mode).collect()
    } else {
        let pose = ArmPose::of_all_joints(arm, directions_rad, (0.0, 2)).ok()?;
        let held = vec![f64::INFINITY; joints];
        let modes = pose.modes(is_held.then_some(&held[..]), count).ok()?;
        let mode = |own: PoseMode| FreeMode {
            square_per_s2: own.square_per_s2,
            rate_per_s: 2.0 * own.damping_ratio.unwrap_or(0.0) * own.square_per_s2.max(0.0).sqrt(),
            joints: pose.joints.iter().map(|joint| own.shape[*joint]).collect(),
        };
        modes.into_iter().map(mode).collect()
    };
    if has_gains {
        let gains = |own: &Feedback| [own.stiffness_n_m_rad(), own.damping_n_m_s_rad()];
        return rings_in_loop(&modes, &play.feedback.iter().map(gains).collect::<Vec<_>>());
    }
    let squares = modes.iter().map(|own| own.square_per_s2);
    let most = squares.clone().fold(0.0, |most: f64, own| most.max(own.abs()));
    let rings = squares.filter(|square| *square > RINGS * most);
    let square = rings.reduce(f64::min)?;
    Some(Ringing { period_s: TAU / square.sqrt(), ratio: 0.0 })
}
