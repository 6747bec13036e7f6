//! Input of a simulation: a torque, and feedback around a reference, or a motion of the hub.

use std::f64::consts::{PI, TAU};
use std::slice::from_ref;

use super::driving::{CycleError, Driving, Interpolation};
use super::error::{SimulationError, SimulationWarning};
use super::history::{Feedback, HubReference, Torque};
use super::modes::{
    Equations, HubReaction, MOST_MODES, ModeSelection, NEGLIGIBLE, REACH, held, in_loop,
    kept_modes, torque_band_rad_s,
};
use super::pose::Start;
use super::state::{State, of_cycle};
use crate::beam::Mesh;
use crate::link::{Arm, Damping, Drive, Joint, Link};
use crate::modal::{DampingLaw, ModalBasis};
use crate::motion::is_repeated;
use crate::numeric::TimeGrid;

/// Largest part of a state that modes may omit, over the whole.
pub(super) const LEFT_OUT: f64 = 1e-7;

/// Most samples of a simulation.
const LONGEST: usize = 1 << 24;

/// Input that moves the joints.
#[derive(Debug, Clone, Copy)]
pub enum Input<'a> {
    /// The torque at the hub, or of each joint of an arm, the inner one first, at the same times; zero before the first
    /// and after the last sample. A holding torque supports links with weight before the first sample, and their last
    /// torque stays. The torque of a joint turns its link counterclockwise and the link before the other way.
    Torques(&'a [Torque]),
    /// The hub angle, or the angle of each joint, followed exactly. The joints are at rest before the first sample, unless a
    /// linear link [arrives](HubReference::arriving) there, and at rest after the last one.
    ///
    /// The angle between the samples is a quintic spline without rate and acceleration at the start. A joint that still moves at
    /// its last sample stops within the step after it, where the play goes on. Rates of the reference have no effect. With [`Interpolation::Zero`] the joint jumps from sample to sample, and with
    /// [`Interpolation::Linear`] it moves along straight lines. The torques of these motions contain no impulses.
    Angles(&'a [HubReference]),
}

impl Input<'_> {
    /// True for torques.
    pub fn is_torque(&self) -> bool {
        matches!(self, Self::Torques(_))
    }

    /// True for prescribed joints that move before their first samples.
    pub(super) fn is_arriving(&self) -> bool {
        let moves = |hub: &HubReference| hub.arrival()[1] != 0.0;
        matches!(self, Self::Angles(hubs) if hubs.iter().any(moves))
    }

    /// Number of moved joints.
    pub fn joints(&self) -> usize {
        match self {
            Self::Torques(torques) => torques.len(),
            Self::Angles(hubs) => hubs.len(),
        }
    }

    /// Times of the samples.
    pub fn grid(&self) -> TimeGrid {
        match self {
            Self::Torques(torques) => torques[0].grid(),
            Self::Angles(hubs) => hubs[0].grid(),
        }
    }
}

/// A grid continued to the requested end.
///
/// # Errors
/// [`SimulationError::EndsEarly`], [`SimulationError::TooLong`].
pub(super) fn continued(grid: TimeGrid, until_s: Option<f64>) -> Result<TimeGrid, SimulationError> {
    let Some(until_s) = until_s else { return Ok(grid) };
    let end_s = grid.end_s();
    let steps = (until_s - end_s) / grid.step_s;
    // Times within a millionth of a step from the last sample count as that sample.
    if steps.is_nan() || steps < -1e-6 {
        return Err(SimulationError::EndsEarly { until_s, end_s });
    }
    let more = (steps - 1e-6).ceil().max(0.0);
    let samples = grid.len as f64 + more;
    if samples > LONGEST as f64 {
        return Err(SimulationError::TooLong { until_s, samples, limit: LONGEST });
    }
    Ok(TimeGrid { len: samples as usize, ..grid })
}

/// Refuses a simulation that exceeds the memory limit with these samples and modes.
///
/// # Errors
/// [`SimulationError::TooMuchMemory`].
pub(super) fn refuse_memory(
    (samples, modes): (usize, usize),
    bytes: usize,
    allowed: Option<usize>,
) -> Result<(), SimulationError> {
    match allowed.filter(|allowed| bytes > *allowed) {
        Some(allowed) => Err(SimulationError::TooMuchMemory { samples, modes, bytes, allowed }),
        None => Ok(()),
    }
}

/// Input and options of a simulation of a link or an arm.
#[derive(Debug, Clone, Copy)]
pub struct Play<'a> {
    /// Input of the joints.
    pub input: Input<'a>,
    /// Shape of a torque or of an angle between its samples.
    pub interpolation: Interpolation,
    /// End time in s; `None`: the last sample of the input.
    pub until_s: Option<f64>,
    /// Feedback at the hub, or at each joint around its encoder's angle, added to torques; empty without feedback.
    pub feedback: &'a [Feedback],
    /// Displacement of one link's tip at the start in m, under a torque; a prescribed hub points to it.
    pub initial_tip_m: f64,
    /// Start of an arm at rest, under torques; prescribed joints determine it.
    pub start: Option<Start<'a>>,
    /// Place in m of an arm's carriage at this start, unless the start has it.
    pub carriage_m: f64,
    /// Tolerance of the tip and the joints of bent links, over their motion; `None`: the tolerance of the meshes.
    pub tolerance: Option<f64>,
    /// Memory limit in bytes; `None`: no limit.
    pub memory_bytes: Option<usize>,
    /// Whether all terms of large angles count. With weight they always do.
    pub is_large: bool,
    /// Direction of the chord in rad at zero displacement of the tip; `None`: the link's start angle, or 0 without
    /// weight.
    pub start_angle_rad: Option<f64>,
    /// Initial state of the links under torques. `None`: at rest.
    pub state: Option<&'a State>,
    /// Periodic steady state under one repeating cycle of the input. Holds the rotation per cycle in rad of a
    /// prescribed hub, or of a linear link's hub without friction and feedback. The prescribed joints of an arm make the
    /// whole turns of their angles.
    pub cycle_turn_rad: Option<f64>,
    /// Whether the torques are those of motors under voltages, on an [arm](Arm::under_voltages) with their rotors and
    /// back voltages. The losses of its drives then act.
    pub is_under_voltage: bool,
}

impl<'a> Play<'a> {
    /// A torque to its end, by cubics, without feedback, with the tip at 0 at the start.
    pub fn of(torque: &'a Torque) -> Self {
        Self::with(Input::Torques(from_ref(torque)))
    }

    /// A prescribed motion of the hub to its end.
    pub fn turning(hub: &'a HubReference) -> Self {
        Self::with(Input::Angles(from_ref(hub)))
    }

    /// An input to its end, without feedback.
    pub fn with(input: Input<'a>) -> Self {
        Self {
            input,
            interpolation: Interpolation::default(),
            until_s: None,
            feedback: &[],
            initial_tip_m: 0.0,
            start: None,
            carriage_m: 0.0,
            tolerance: None,
            memory_bytes: None,
            is_large: false,
            start_angle_rad: None,
            state: None,
            cycle_turn_rad: None,
            is_under_voltage: false,
        }
    }

    /// Rotation in rad of a prescribed joint over a cycle, where the input repeats.
    pub(super) fn turn_of_cycle_rad(&self, joint: usize) -> Option<f64> {
        match self.input {
            Input::Angles(joints) if joints.len() > 1 => {
                let turn_rad = joints[joint].turn_rad(None);
                self.cycle_turn_rad.map(|_| TAU * (turn_rad / TAU).round())
            }
            _ => self.cycle_turn_rad,
        }
    }

    /// The input's grid, continued to the requested end.
    pub(super) fn grid(&self) -> Result<TimeGrid, SimulationError> {
        continued(self.input.grid(), self.until_s)
    }

    /// True for prescribed joints that stop after their last sample, because the play goes on.
    fn stops(&self, grid: &TimeGrid) -> bool {
        let goes_on = grid.len > self.input.grid().len;
        goes_on && !self.input.is_torque() && self.cycle_turn_rad.is_none()
    }

    /// Warnings of the torque of a link without weight or of prescribed joints that do not repeat, at the first and the last
    /// sample, and of the torque that moves the hub of a link.
    pub(super) fn warnings_of_input(
        &self,
        (grid, torque_n_m): (&TimeGrid, &[f64]),
    ) -> Vec<SimulationWarning> {
        if self.cycle_turn_rad.is_some() {
            return Vec::new();
        }
        let of = |[begins, ends]: [Option<SimulationWarning>; 2]| {
            begins.filter(|_| self.state.is_none()).into_iter().chain(ends)
        };
        match self.input {
            Input::Torques(torques) => {
                of(SimulationWarning::jumps(torques[0].torque_n_m())).collect()
            }
            Input::Angles(hubs) => {
                let is_arm = hubs.len() > 1;
                let joints = (1..).zip(hubs).flat_map(|(number, hub)| {
                    let joint = is_arm.then_some(number);
                    let [begins, ends] =
                        SimulationWarning::hub_moves(joint, &hub.slopes_rad_s(false));
                    of([begins, ends.filter(|_| self.stops(grid))])
                });
                let rough = SimulationWarning::rough(&torque_n_m[..hubs[0].grid().len]);
                joints.chain(rough.filter(|_| !is_arm)).collect()
            }
        }
    }

    /// Frequency in rad/s above which the input moves a rigid link by less than a `share`. `None` for an input of zero.
    pub(super) fn band_rad_s(&self, share: f64) -> Option<f64> {
        let grid = self.input.grid();
        let torque = match self.input {
            Input::Torques(torques) => torque_band_rad_s(&grid, torques[0].torque_n_m(), share),
            Input::Angles(hubs) => {
                let (samples, ..) = hubs[0].accelerations(self.cycle_turn_rad, false);
                let band_rad_s = torque_band_rad_s(&grid, &samples, share);
                return band_rad_s.map(|band_rad_s| self.jumping_rad_s(&grid).max(band_rad_s));
            }
        };
        // The reference's rate, unlike its angle, is zero at both ends.
        let drives = |of: &&Feedback| of.stiffness_n_m_rad() > 0.0 || of.damping_n_m_s_rad() > 0.0;
        let repeats = self.cycle_turn_rad.is_some();
        let wanted = self.feedback.first().filter(drives).map(|of| of.rate_rad_s(repeats));
        let wanted = wanted.and_then(|rate| torque_band_rad_s(&grid, &rate, share));
        torque.into_iter().chain(wanted).reduce(f64::max)
    }

    /// Nyquist frequency in rad/s of prescribed joints that jump at their samples, else 0.
    fn jumping_rad_s(&self, grid: &TimeGrid) -> f64 {
        let jumps = !self.input.is_torque() && self.interpolation != Interpolation::Cubic;
        if jumps { PI / grid.step_s } else { 0.0 }
    }

    /// Highest frequency in rad/s of an arm's inputs and references. The samples count from the first one, and there
    /// and back, so that holding torques at the ends do not matter.
    pub(super) fn band_of_arm_rad_s(&self) -> f64 {
        let grid = self.input.grid();
        let twice = TimeGrid { len: 2 * grid.len, ..grid };
        let moving = |samples: &[f64]| {
            let there_and_back = samples.iter().chain(samples.iter().rev());
            let moving: Vec<f64> = there_and_back.map(|own| own - samples[0]).collect();
            torque_band_rad_s(&twice, &moving, NEGLIGIBLE)
        };
        let inputs: Vec<Option<f64>> = match self.input {
            Input::Torques(torques) => {
                torques.iter().map(|torque| moving(torque.torque_n_m())).collect()
            }
            Input::Angles(hubs) => {
                let turned = |joint| self.turn_of_cycle_rad(joint);
                let moved = hubs.iter().enumerate();
                moved
                    .map(|(joint, hub)| moving(&hub.accelerations(turned(joint), false).0))
                    .collect()
            }
        };
        let repeats = self.cycle_turn_rad.is_some();
        let wanted = self.feedback.iter().filter_map(|own| moving(&own.rate_rad_s(repeats)));
        let jumping = self.jumping_rad_s(&grid);
        inputs.into_iter().flatten().chain(wanted).fold(jumping, f64::max)
    }

    /// The error of an input that moves nothing.
    pub(super) fn nothing(&self) -> SimulationError {
        match self.input {
            Input::Torques(_) => SimulationError::NoTorque,
            Input::Angles(_) => SimulationError::NoTurn,
        }
    }

    /// Position of the joint of an unbent link at zero displacement of its tip, from the play or from the link.
    pub(super) fn origin_rad(&self, link: &Link) -> Option<f64> {
        self.start_angle_rad.or(link.origin_rad())
    }

    /// Whether all terms of large angles count: always in an arm.
    pub(super) fn is_bent(&self, arm: &Arm) -> bool {
        self.is_large || arm.has_weight() || arm.links().len() > 1
    }

    /// Numbers, links and drives whose losses act: under voltages.
    pub(super) fn lossy<'b>(
        &self,
        arm: &'b Arm,
    ) -> impl Iterator<Item = (usize, &'b Link, &'b Drive)> + use<'b> {
        let acts = self.is_under_voltage && self.input.is_torque();
        arm.links().iter().enumerate().filter_map(move |(number, own)| {
            let drive = own.link.drive().filter(|drive| acts && drive.has_losses())?;
            Some((number, &own.link, drive))
        })
    }

    /// True if the play starts from a state or in a repeating cycle, instead of at rest.
    fn is_started(&self) -> bool {
        self.state.is_some() || self.cycle_turn_rad.is_some()
    }

    /// Hub angle in rad at the zero of a state's angles. `None` without a state.
    pub(super) fn zero_of_state_rad(&self, link: &Link) -> Option<f64> {
        self.is_started().then(|| self.origin_rad(link).unwrap_or(0.0))
    }

    /// Displacement of the tip at the start in m; a prescribed hub points to it.
    pub(super) fn start_m(&self, link: &Link) -> f64 {
        match self.input {
            // The coordinates of a state contain the displacement.
            Input::Torques(_) if self.is_started() => 0.0,
            Input::Torques(_) => self.initial_tip_m,
            Input::Angles(hubs) => {
                (hubs[0].arrival()[0] - self.origin_rad(link).unwrap_or(0.0)) * link.rigid_tip()
            }
        }
    }

    /// Turn in rad from the start to the final angle of a hub held by feedback.
    pub(super) fn goal_rad(&self, link: &Link) -> Option<f64> {
        match self.input {
            Input::Torques(_) => {
                let holds = |feedback: &&Feedback| feedback.stiffness_n_m_rad() > 0.0;
                let feedback = self.feedback.first().filter(holds);
                feedback.map(|own| own.reference().turn_rad(self.zero_of_state_rad(link)))
            }
            Input::Angles(_) => None,
        }
    }

    /// The link's equations of motion under this input.
    ///
    /// # Errors
    /// [`SimulationError::NotFinite`].
    pub(super) fn equations(
        &self,
        link: &Link,
        (mesh, law): (&Mesh, &DampingLaw),
        basis: ModalBasis,
    ) -> Result<Equations, SimulationError> {
        let free = Equations::new(mesh, law, basis, self.reaction(0, &link.joint()));
        match self.input {
            Input::Torques(_) => Ok(in_loop(free, law)),
            Input::Angles(_) => {
                let time_s = self.input.grid().time_s(0);
                held(&free, law).ok_or(SimulationError::NotFinite { time_s })
            }
        }
    }

    /// Friction and feedback at the joint with this number.
    pub(super) fn reaction(&self, joint: usize, own: &Joint) -> HubReaction {
        let friction_n_m_s_rad = own.friction();
        let gain = |of: fn(&Feedback) -> f64| self.feedback.get(joint).map_or(0.0, of);
        HubReaction {
            stiffness_n_m_rad: gain(Feedback::stiffness_n_m_rad),
            damping_n_m_s_rad: friction_n_m_s_rad + gain(Feedback::damping_n_m_s_rad),
            friction_n_m_s_rad,
        }
    }

    /// The input of a joint at all samples and between them, with a reference's angles from `zero_rad`. After the last
    /// sample the motor of links with weight keeps its torque.
    ///
    /// # Errors
    /// [`SimulationError::OtherTimes`] of a reference.
    pub(super) fn driving(
        &self,
        (joint, link): (usize, &Link),
        zero_rad: Option<f64>,
        has_weight: bool,
    ) -> Result<Driving, SimulationError> {
        let torque = match self.input {
            Input::Torques(torques) => &torques[joint],
            Input::Angles(hubs) => {
                let hub = &hubs[joint];
                let turn_rad = self.turn_of_cycle_rad(joint);
                if let Some(jump_rad) = turn_rad.and_then(|turn_rad| hub.jump_rad(turn_rad)) {
                    return Err(CycleError::Reference { jump_rad }.into());
                }
                if self.interpolation != Interpolation::Cubic {
                    let is_stairs = self.interpolation == Interpolation::Zero;
                    let jumps = hub.jumps(is_stairs, turn_rad);
                    return Ok(Driving::jumping(jumps, turn_rad.is_some()));
                }
                let stops = self.stops(&self.grid()?);
                let (samples, pieces, _) = hub.accelerations(turn_rad, stops);
                return Ok(Driving {
                    repeats: turn_rad.is_some(),
                    jumps: vec![[hub.first_jump_rad(), 0.0]],
                    ..Driving::new(samples, pieces)
                });
            }
        };
        let torque_n_m = torque.torque_n_m();
        if self.cycle_turn_rad.is_some() && is_repeated(torque_n_m, 0.0) {
            return Err(CycleError::Repeats.into());
        }
        let kept_n_m = if has_weight { torque_n_m[torque_n_m.len() - 1] } else { 0.0 };
        let repeats = self.cycle_turn_rad.is_some();
        let feedback = self.feedback.get(joint);
        let (samples, hold) = match feedback {
            None => (torque_n_m.to_vec(), kept_n_m),
            Some(feedback) => {
                let wanted = feedback.wanted_torque_n_m(torque, zero_rad, repeats)?;
                let samples = torque_n_m.iter().zip(wanted).map(|(t, wanted)| t + wanted).collect();
                let turn_rad = feedback.reference().turn_rad(zero_rad);
                (samples, kept_n_m + feedback.stiffness_n_m_rad() * turn_rad)
            }
        };
        let between = |samples: Vec<f64>, interpolation, hold, turning| {
            let driving = Driving::sampled(samples, interpolation, repeats);
            // A cycle has no last sample that could stay.
            Driving { hold: if repeats { 0.0 } else { hold }, turning, ..driving }
        };
        let is_hysteretic = matches!(link.damping(), Damping::Hysteretic { .. });
        let reference = feedback.filter(|of| is_hysteretic && of.stiffness_n_m_rad() > 0.0);
        let turning = reference.map(|of| {
            let rate_rad_s = of.rate_rad_s(repeats);
            Box::new(between(rate_rad_s, Interpolation::Cubic, 0.0, None))
        });
        Ok(between(samples, self.interpolation, hold, turning))
    }

    /// Coordinates and rates of a linear link at the start, and the part of a state that its modes omit, over the
    /// whole.
    pub(super) fn start(
        &self,
        link: &Link,
        (equations, mesh): (&Equations, &Mesh),
        driving: &Driving,
    ) -> Result<([Vec<f64>; 2], f64), SimulationError> {
        if let Some(turn_rad) = self.cycle_turn_rad {
            let travel_m = turn_rad * link.rigid_tip();
            let (grid, ends_m) = (self.input.grid(), [travel_m, self.initial_tip_m]);
            return Ok((of_cycle(equations, driving, grid, ends_m)?, 0.0));
        }
        let Some(state) = self.state else {
            let mut rates = vec![0.0; equations.coordinates.len()];
            let coordinates = rates.clone();
            if let Input::Angles(hubs) = self.input {
                // The coordinate of the undeformed link.
                rates[0] = hubs[0].arrival()[1];
            }
            return Ok(([coordinates, rates], 0.0));
        };
        let origin_rad = self.origin_rad(link).unwrap_or(0.0);
        Ok(state.links[0].coordinates(equations, mesh, origin_rad))
    }
}

/// A linear link before its simulation.
pub(super) struct Started {
    pub(super) equations: Equations,
    pub(super) selection: ModeSelection,
    /// Coordinates and rates.
    pub(super) start: [Vec<f64>; 2],
    /// Part of the state that the modes omit, over the whole.
    pub(super) left_out: f64,
}

impl Started {
    /// A link with the modes that an input drives up to `band_rad_s`, or that a state contains.
    pub(super) fn of(
        link: &Link,
        (mesh, law): (&Mesh, &DampingLaw),
        (play, driving): (&Play, &Driving),
        mut band_rad_s: f64,
    ) -> Result<Self, SimulationError> {
        loop {
            let (basis, selection) = kept_modes(mesh, band_rad_s, MOST_MODES);
            let equations = play.equations(link, (mesh, law), basis)?;
            let (start, left_out) = play.start(link, (&equations, mesh), driving)?;
            let has_all = selection.modes >= selection.of.min(MOST_MODES);
            if left_out <= LEFT_OUT || has_all {
                return Ok(Self { equations, selection, start, left_out });
            }
            band_rad_s = 2.0 * band_rad_s.max(TAU * selection.highest_hz / REACH);
        }
    }
}

/// Progress of a simulation of bent links.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlayProgress {
    /// Number of refinements so far: more angles, half the step.
    pub refinement: usize,
    /// Finished samples at this refinement.
    pub done: usize,
    /// All samples.
    pub samples: usize,
}
