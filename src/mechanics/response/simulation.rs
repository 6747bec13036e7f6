//! The front of direct dynamics: a linear link by its modes, a bent link and an arm as elasticas.

use super::bent::BentMotion;
use super::chain::play_bytes;
use super::checks::of_bent;
use super::driver::{Drive, DrivenLinks, InitialMotion, MORE_ORDERS, refine};
use super::driving::{CycleError, Driving, Interpolation};
use super::error::{SimulationError, SimulationWarning};
use super::linear::play_modes;
use super::linkage::Linkage;
use super::losses::Losses;
use super::modes::NEGLIGIBLE;
use super::play::{Input, Play, PlayProgress, refuse_memory};
use super::played::{Played, PlayedBy, PlayedLink};
use super::pose::{Start, at_rest, without_noise};
use super::shape::{direction, viscous};
use super::state::{Cycle, State};
use crate::beam::{Mesh, MeshPlan};
use crate::elastica::underived;
use crate::link::{Arm, Damping, Drive as LinkDrive, Joint, Link};
use crate::modal::{DampingLaw, REPORTED_MODES, hub_moves_mass, reported_frequencies};
use crate::numeric::{TimeGrid, largest};

/// Most refinements under torques, and with prescribed joints.
const MOST_REFINEMENTS: usize = 6;
const MOST_OF_MOVED: usize = 4;

/// Highest frequency of waves that the initial orders of one link follow, over the first natural frequency.
const WAVES: f64 = 3.0;

/// Stored numbers of a sample beside those of each angle, for an arm and for one link: of two motions, the finer beside the
/// coarser.
const NUMBERS_OF_ARM: usize = 128;
const NUMBERS_OF_LINK: usize = 32;

/// Computes the motion of a link or an arm under torques or with prescribed joints (direct dynamics). `watch` receives
/// the progress of bent links.
///
/// A link without weight has modal coordinates, each mode integrated exactly for the interpolated input (Bayo 1987, eqs
/// 11 and 12). With weight, with [`Play::is_large`], and in an arm, links are inextensible elasticas with angles as
/// coordinates. Radau's method integrates them with more angles and shorter steps until tip and joints settle within
/// the plan's tolerance. They start from their shape at rest.
///
/// Modes within the band of the input count; the others act as one residual mode with their static response. Hysteretic
/// damping has no equation in time. Its ratio becomes the viscous ratio of every mode: of the held modes for a
/// prescribed hub and in an arm, of the modes of the loop under feedback. An automatic mesh becomes finer until it
/// follows the input's band to the plan's tolerance.
///
/// # Errors
/// [`SimulationError`].
///
/// # Panics
/// If a joint lacks an input, if only some joints have feedback, or if prescribed joints of links that bend far arrive
/// moving.
pub fn simulate(
    arm: &Arm,
    plans: &[MeshPlan],
    play: &Play<'_>,
    watch: &dyn Fn(PlayProgress),
) -> Result<Played, SimulationError> {
    let (links, joints) = (arm.links(), arm.joints().count());
    assert!(play.input.joints() == joints, "one input for each joint");
    assert!([0, joints].contains(&play.feedback.len()), "feedback for all joints or none");
    assert!(!(play.is_bent(arm) && play.input.is_arriving()), "links that bend far begin at rest");
    let meshes = links.iter().zip(plans).map(|(own, plan)| Mesh::new(&own.link, plan));
    let meshes: Vec<Mesh> = meshes.collect::<Result<_, _>>()?;
    let tolerance = play.tolerance.unwrap_or_else(|| MeshPlan::smallest_tolerance(plans));
    if let Some(state) = play.state {
        if !play.input.is_torque() {
            let words = ["comes with a motion of the hub", "come with a torque"];
            let [found, must] = words.map(str::to_owned);
            return Err(SimulationError::State { found, must });
        }
        state.check(arm, play.is_bent(arm))?;
    }
    let mut played = play_links(arm, meshes, play, (plans, tolerance, watch))?;
    if play.is_under_voltage {
        let drives = links.iter().filter_map(|own| own.link.drive());
        let joints = std::mem::take(&mut played.joints).into_iter().zip(drives);
        played.joints = joints.map(|(joint, drive)| joint.behind(drive)).collect();
    }
    Ok(played)
}

/// Plays the input on the links.
fn play_links(
    arm: &Arm,
    mut meshes: Vec<Mesh>,
    play: &Play<'_>,
    (plans, tolerance, watch): (&[MeshPlan], f64, &dyn Fn(PlayProgress)),
) -> Result<Played, SimulationError> {
    if play.is_bent(arm) {
        return play_bent(arm, meshes, play, (tolerance, watch));
    }
    let (link, band_rad_s) = (&arm.links()[0].link, driven_rad_s(play)?);
    let mesh = meshes.swap_remove(0);
    let is_open = plans[0].is_automatic();
    let mesh = if is_open { mesh.resolving(band_rad_s, tolerance) } else { mesh };
    play_modes(link, mesh, play, band_rad_s)
}

/// Computes the motion of one link like [`simulate`], on this mesh.
///
/// # Errors
/// [`SimulationError`].
pub(crate) fn simulate_on(
    link: &Link,
    mesh: Mesh,
    play: &Play<'_>,
) -> Result<Played, SimulationError> {
    if play.is_large || link.has_weight() {
        let tolerance = play.tolerance.unwrap_or(MeshPlan::DEFAULT_TOLERANCE);
        return play_bent(&Arm::from(link.clone()), vec![mesh], play, (tolerance, &|_| {}));
    }
    play_modes(link, mesh, play, driven_rad_s(play)?)
}

/// Highest frequency in rad/s of a link's input; 0 for a state.
fn driven_rad_s(play: &Play<'_>) -> Result<f64, SimulationError> {
    play.band_rad_s(NEGLIGIBLE).or(play.state.map(|_| 0.0)).ok_or(play.nothing())
}

impl PlayedLink {
    /// A link with its natural frequencies.
    pub(super) fn of(link: &Link, mesh: Mesh, law: DampingLaw) -> Self {
        let outward_m_s2 = link.outward_m_s2();
        let natural_frequencies_rad_s = reported_frequencies(&mesh, outward_m_s2, REPORTED_MODES);
        Self { mesh, law, outward_m_s2, natural_frequencies_rad_s }
    }
}

/// Computes the motion of a link with weight or at large angles, or of an arm; the meshes have the nodes of the tables.
fn play_bent(
    arm: &Arm,
    meshes: Vec<Mesh>,
    play: &Play<'_>,
    (tolerance, watch): (f64, &dyn Fn(PlayProgress)),
) -> Result<Played, SimulationError> {
    let (played, grid) = (bent_links(arm, meshes, play)?, play.grid()?);
    let bending = Bending { arm, links: &played, play, drives: drives(arm, play)?, grid: &grid };
    let refined = (grid.len, tolerance, MOST_REFINEMENTS);
    let mut motion = refine(|more, before| bending.driven_links(more, before), refined, watch)?;
    if arm.links().len() > 1 {
        let weight_n_m = arm.weight_moment_n_m();
        for (number, joint) in motion.joints.iter_mut().enumerate() {
            let size = weight_n_m / motion.play.linkage.size_of(number);
            joint.holding_n_m = joint.holding_n_m.map(|own| without_noise(own, size));
        }
    }
    let warnings = of_bent(arm, (play, &grid), &motion, &played[0]);
    Ok(of_motion(motion, (grid, play.input.grid().len), played, warnings))
}

/// The motion of bent links at one refinement, without energies and warnings.
pub(super) fn play_bent_once(
    arm: &Arm,
    meshes: Vec<Mesh>,
    play: &Play<'_>,
    refinements: usize,
) -> Result<Played, SimulationError> {
    let (played, grid) = (bent_links(arm, meshes, play)?, play.grid()?);
    let bending = Bending { arm, links: &played, play, drives: drives(arm, play)?, grid: &grid };
    let links = bending.driven_links(refinements * MORE_ORDERS, None)?;
    let links = DrivenLinks { has_energies: false, ..links };
    let motion = links.play(1 << refinements, |_| {})?;
    Ok(of_motion(motion, (grid, play.input.grid().len), played, Vec::new()))
}

/// The links with their damping laws; refuses what bent links cannot play.
fn bent_links(
    arm: &Arm,
    meshes: Vec<Mesh>,
    play: &Play<'_>,
) -> Result<Vec<PlayedLink>, SimulationError> {
    let links = arm.links();
    if links[0].link.joint().slides() && arm.has_weight() && links[0].link.direction_rad().is_none()
    {
        return Err(SimulationError::NoStartAngle);
    }
    if let [mesh] = &meshes[..] {
        if !hub_moves_mass(mesh) {
            return Err(SimulationError::MasslessHub);
        }
        // Under a torque of zero a link falls, or goes on.
        let falls = (arm.has_weight() || play.state.is_some()) && play.input.is_torque();
        if play.band_rad_s(NEGLIGIBLE).is_none() && !falls {
            return Err(play.nothing());
        }
    }
    let laws = links.iter().zip(&meshes).map(|(own, mesh)| DampingLaw::of(&own.link, mesh));
    let laws: Vec<DampingLaw> = laws.collect::<Result<_, _>>()?;
    let played = links.iter().zip(meshes).zip(laws);
    let played = played.map(|((own, mesh), law)| PlayedLink::of(&own.link, mesh, law));
    let played: Vec<PlayedLink> = played.collect();
    for (own, link) in links.iter().zip(&played) {
        if let Some([what, known]) = underived(&own.link, &link.law, true) {
            return Err(SimulationError::NotDerived { what, known });
        }
    }
    Ok(played)
}

/// The results from a motion of bent links.
fn of_motion(
    BentMotion { play, joints, tip }: BentMotion,
    (grid, driven): (TimeGrid, usize),
    links: Vec<PlayedLink>,
    warnings: Vec<SimulationWarning>,
) -> Played {
    Played { grid, driven, joints, tip, links, by: PlayedBy::Elastica(play), warnings }
}

/// The input of each joint.
fn drives(arm: &Arm, play: &Play<'_>) -> Result<Vec<Drive>, SimulationError> {
    let (is_link, link) = (arm.links().len() == 1, &arm.links()[0].link);
    let drive = |(number, joint): (usize, Joint)| {
        let zero_rad = if is_link { play.zero_of_state_rad(link) } else { Some(0.0) };
        let driving = play.driving((number, link), zero_rad, arm.has_weight())?;
        // In an arm the damping of a link does not act on its joint, and turns with no reference.
        let turning = driving.turning.filter(|_| is_link);
        let driving = Driving { turning, ..driving };
        Ok(match play.input {
            Input::Torques(_) => Drive::Torque(driving, play.reaction(number, &joint)),
            Input::Angles(_) => Drive::Acceleration(driving),
        })
    };
    arm.joints().enumerate().map(drive).collect()
}

/// Links that bend under an input.
struct Bending<'a> {
    arm: &'a Arm,
    links: &'a [PlayedLink],
    play: &'a Play<'a>,
    drives: Vec<Drive>,
    grid: &'a TimeGrid,
}

impl Bending<'_> {
    /// First natural frequency of one link in rad/s, 0 for a rigid link.
    fn first_rad_s(&self) -> f64 {
        self.links[0].first_rad_s().unwrap_or(0.0)
    }

    /// The links with `more` orders of polynomials, after a motion `before`. Its peak rates, or those of a motion without
    /// losses, set the rates of the joints by which losses change their sign.
    fn driven_links(
        &self,
        more: usize,
        before: Option<&BentMotion>,
    ) -> Result<DrivenLinks<'_>, SimulationError> {
        let lossy = || self.play.lossy(self.arm);
        let needs_peak = lossy().any(|(.., drive)| drive.friction_rate_rad_s.is_none());
        let free = |refinement: usize| {
            let links = self.lossless_links(more, None)?;
            DrivenLinks { has_energies: false, ..links }.play(1 << refinement, |_| {})
        };
        let free = (before.is_none() && needs_peak).then(|| {
            let is_lost =
                |own: &Result<_, _>| matches!(own, Err(SimulationError::NotConverged { .. }));
            // Shorter steps may converge where long ones do not.
            let shorter = (0..MOST_REFINEMENTS).map(free).find(|own| !is_lost(own));
            shorter.unwrap_or_else(|| free(MOST_REFINEMENTS))
        });
        let free = free.transpose()?;
        let before = before.or(free.as_ref());
        let losses = |(number, link, drive): (usize, &Link, &LinkDrive)| {
            let peak = before.map_or(0.0, |own| largest(&own.joints[number].rate_rad_s));
            let peak = (peak, self.grid.duration_s());
            Some((number, Losses::of(link, drive.back_friction(), peak)?))
        };
        let lossy = lossy().filter_map(losses).collect();
        Ok(DrivenLinks { lossy, ..self.lossless_links(more, before)? })
    }

    /// The links without losses. A repeating motion begins approximately like the motion `before`.
    fn lossless_links(
        &self,
        more: usize,
        before: Option<&BentMotion>,
    ) -> Result<DrivenLinks<'_>, SimulationError> {
        let Self { arm, play, grid, drives, .. } = self;
        let one = match arm.links() {
            [one] => Some(&one.link),
            _ => None,
        };
        let highest_rad_s =
            if one.is_some() { WAVES * self.first_rad_s() } else { play.band_of_arm_rad_s() };
        let count = Linkage::coordinates(arm, highest_rad_s, more, play.state);
        let numbers = 4 * count + one.map_or(NUMBERS_OF_ARM, |_| NUMBERS_OF_LINK);
        let bytes = play_bytes(count, grid.len, numbers);
        refuse_memory((grid.len, count), bytes, play.memory_bytes)?;
        let linkage = Linkage::of(arm, highest_rad_s, more, play.state);
        let free_hub = one.filter(|_| play.input.is_torque());
        let free_hub = free_hub.map(|link| (play.reaction(0, &link.joint()), self.first_rad_s()));
        let damping = linkage.links.iter().zip(self.links);
        let damping = damping.map(|(chain, link)| viscous(chain, &link.law, free_hub));
        let lost = SimulationError::NotFinite { time_s: grid.time_s(0) };
        let damping: Vec<Vec<f64>> = damping.collect::<Option<_>>().ok_or(lost)?;
        let linkage = linkage.damped(&damping);
        let begun = before.filter(|_| play.cycle_turn_rad.is_some());
        let begun = begun.map(|before| before.play.state(grid, 0));
        let state = begun.as_ref().or(play.state);
        let mut start = match one {
            Some(link) => self.start_of_link(link, &linkage, state)?,
            None => self.start_of_arm(&linkage, state)?,
        };
        if let Input::Angles(hubs) = play.input {
            for (number, (joint, hub)) in linkage.joints.iter().zip(hubs).enumerate() {
                let turn_rad = play.turn_of_cycle_rad(number);
                start.rates[*joint] = hub.first_rate_rad_s(play.interpolation, turn_rad);
            }
        }
        let aim_rad = one.map_or(0.0, |link| {
            let reference = play.feedback.first().filter(|_| link.has_weight());
            let reference_rad = reference.map(|feedback| feedback.reference().angle_rad()[0]);
            play.zero_of_state_rad(link).or(reference_rad).unwrap_or(start.q[0])
        });
        let aims_rad = vec![aim_rad; linkage.joints.len()];
        let cycle = play.cycle_turn_rad.map(|_| self.cycle(&linkage.joints)).transpose()?;
        let has_energies = one.is_none();
        let lossy = Vec::new();
        Ok(DrivenLinks { linkage, drives, lossy, aims_rad, grid, start, cycle, has_energies })
    }

    /// One cycle of the input. Prescribed joints may turn on, and the first joint under a torque, or the carriage of an arm,
    /// where neither weight nor stiffness of its feedback holds it. Weight holds no carriage at a place.
    fn cycle(&self, joints: &[usize]) -> Result<Cycle, SimulationError> {
        let grid = self.play.input.grid();
        let free = self.arm.carriage().map_or(0, |_| joints.len() - 1);
        let turning = match &self.drives[free] {
            Drive::Acceleration(_) => return Ok(Cycle::prescribed(grid, joints)),
            Drive::Torque(_, reaction) => {
                let slides = self.arm.joints().nth(free).is_some_and(|joint| joint.slides());
                let is_held = self.arm.has_weight() && !slides;
                let is_unheld = !is_held && reaction.stiffness_n_m_rad == 0.0;
                if is_unheld && reaction.damping_n_m_s_rad == 0.0 {
                    return Err(CycleError::Free.into());
                }
                joints[free..free + usize::from(is_unheld)].to_vec()
            }
        };
        Ok(Cycle { grid, turning, is_prescribed: false })
    }

    /// One link before the input, at rest or in a state.
    fn start_of_link(
        &self,
        link: &Link,
        linkage: &Linkage,
        state: Option<&State>,
    ) -> Result<InitialMotion, SimulationError> {
        let given_rad = self.play.origin_rad(link);
        let rates = vec![0.0; linkage.count];
        let chain = &linkage.links[0];
        if let Some(state) = state {
            let (q, own) = linkage.of_state(state)?;
            let first_rad = direction(chain.output(&q, &rates).at_m, q[0]);
            let level_rad = if link.has_weight() { first_rad } else { 0.0 };
            return Ok(InitialMotion { q, rates: own, from_rad: given_rad.unwrap_or(level_rad) });
        }
        let start_rad = self.play.start_m(link) / link.rigid_tip() + given_rad.unwrap_or(0.0);
        if !link.has_weight() {
            let mut straight = vec![0.0; linkage.count];
            straight[0] = start_rad;
            return Ok(InitialMotion { q: straight, rates, from_rad: given_rad.unwrap_or(0.0) });
        }
        let start = match self.play.input {
            Input::Torques(_) if given_rad.is_none() => return Err(SimulationError::NoStartAngle),
            Input::Torques(_) if !chain.slides() => Start::Chords(&[start_rad]),
            Input::Torques(_) | Input::Angles(_) => Start::Joints(&[start_rad]),
        };
        let mut q = at_rest(self.arm, linkage, start, 0.0).ok_or(SimulationError::NoRest)?;
        let output_m = chain.output(&q, &rates).at_m;
        if chain.slides() && self.play.input.is_torque() {
            // The bent link has the same shape wherever its carriage stands.
            q[0] += start_rad - chain.across(output_m);
        }
        // With a prescribed hub the weight determines the chord.
        let first_rad = direction(output_m, start_rad);
        Ok(InitialMotion { q, rates, from_rad: given_rad.unwrap_or(first_rad) })
    }

    /// An arm before the input, at rest or in a state.
    fn start_of_arm(
        &self,
        linkage: &Linkage,
        state: Option<&State>,
    ) -> Result<InitialMotion, SimulationError> {
        if let Some(state) = state {
            let (q, rates) = linkage.of_state(state)?;
            return Ok(InitialMotion { q, rates, from_rad: 0.0 });
        }
        let first_rad: Vec<f64> = match self.play.input {
            Input::Angles(joints) => joints.iter().map(|own| own.angle_rad()[0]).collect(),
            Input::Torques(_) => Vec::new(),
        };
        let start = match (self.play.input, self.play.start) {
            (Input::Angles(_), _) => Start::Joints(&first_rad),
            (Input::Torques(_), Some(start)) => start,
            (Input::Torques(_), None) => return Err(SimulationError::NoStartAngle),
        };
        let q = at_rest(self.arm, linkage, start, self.play.carriage_m);
        let q = q.ok_or(SimulationError::NoRest)?;
        Ok(InitialMotion { q, rates: vec![0.0; linkage.count], from_rad: 0.0 })
    }
}

/// Motion of a joint: initial angle in rad and rate in rad/s, and accelerations in rad/s² at each sample.
#[derive(Debug, Clone, Copy)]
pub struct MovedJoint<'a> {
    /// Angle against the tip of the link before, for the first joint against x.
    pub angle_rad: f64,
    /// Its rate.
    pub rate_rad_s: f64,
    /// Its accelerations.
    pub accelerations_rad_s2: &'a [f64],
}

/// Moves the joints of an arm over a grid, independent of the inversion. Refines the motion until tip and joints change
/// by less than `tolerance` of their motion, or to the finest level (see
/// [`BentPlay::change`](super::BentPlay::change)). `highest_rad_s` is the highest frequency of the motion. Prescribed
/// joints let no pose fall. A motion that `repeats` is one cycle over the grid, in its periodic steady state.
///
/// # Errors
/// [`SimulationError`], for example for damping without an equation in time.
pub fn move_arm(
    arm: &Arm,
    joints: &[MovedJoint<'_>],
    grid: &TimeGrid,
    (highest_rad_s, tolerance): (f64, f64),
    repeats: bool,
) -> Result<Played, SimulationError> {
    let drive = |joint: &MovedJoint<'_>| {
        let samples = joint.accelerations_rad_s2.to_vec();
        Drive::Acceleration(Driving::sampled(samples, Interpolation::Cubic, repeats))
    };
    let drives: Vec<Drive> = joints.iter().map(drive).collect();
    let angles_rad: Vec<f64> = joints.iter().map(|joint| joint.angle_rad).collect();
    let links = |more: usize, before: Option<&BentMotion>| {
        let linkage = rayleigh(arm, Linkage::of(arm, highest_rad_s, more, None))?;
        let (mut q, mut rates) = if let Some(before) = before.filter(|_| repeats) {
            linkage.of_state(&before.play.state(grid, 0))?
        } else {
            let q = at_rest(arm, &linkage, Start::Joints(&angles_rad), 0.0);
            (q.ok_or(SimulationError::NoRest)?, vec![0.0; linkage.count])
        };
        for (joint, moved) in linkage.joints.iter().zip(joints) {
            (q[*joint], rates[*joint]) = (moved.angle_rad, moved.rate_rad_s);
        }
        let cycle = repeats.then(|| Cycle::prescribed(*grid, &linkage.joints));
        let start = InitialMotion { q, rates, from_rad: 0.0 };
        let aims_rad = vec![0.0; joints.len()];
        let has_energies = arm.links().len() > 1;
        let (drives, lossy) = (&drives[..], Vec::new());
        Ok(DrivenLinks { linkage, drives, lossy, aims_rad, grid, start, cycle, has_energies })
    };
    let motion = refine(links, (grid.len, tolerance, MOST_OF_MOVED), &|_| {})?;
    Ok(of_motion(motion, (*grid, grid.len), Vec::new(), Vec::new()))
}

/// The links with their damping, which must be proportional to stiffness.
fn rayleigh(arm: &Arm, linkage: Linkage) -> Result<Linkage, SimulationError> {
    let refused = SimulationError::NotDerived {
        what: "the damping of a link is neither rayleigh with alpha = 0 nor none",
        known: "with these",
    };
    let betas_s = arm.links().iter().map(|own| match own.link.damping() {
        Damping::Rayleigh { alpha_per_s: 0.0, beta_s } => Ok(*beta_s),
        Damping::None | Damping::Hysteretic { ratio: 0.0 } => Ok(0.0),
        _ => Err(refused.clone()),
    });
    let betas_s: Vec<f64> = betas_s.collect::<Result<_, _>>()?;
    let damping = linkage.scaled_stiffness(&betas_s);
    Ok(Linkage { damping, ..linkage })
}
