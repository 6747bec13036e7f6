//! The input of a simulation, its feedback and its start, from files or arrays.

use crate::link::{Arm, Drive, Link};
use crate::response::{Feedback, HubReference, Input, Interpolation, Play, Start, State, Torque};
use crate::result::TipPlaces;

use super::common::directions;
use crate::cli::terminal::{Exit, Failure, memory};

/// Histories that move the joints.
pub enum Moving {
    Torques(Vec<Torque>),
    Angles(Vec<HubReference>),
}

/// The link or the arm that moves under voltages: with the rotors of its motors.
pub fn under_voltages(arm: &Arm) -> Result<Arm, Failure> {
    arm.under_voltages().map_err(|error| {
        let hint = "[drive] has torque_constant in N m/A and resistance in ohm";
        Failure::new(Exit::InputRefused, &arm.worded(&error.to_string()), Some(hint))
    })
}

/// The history of a voltage in V at these times, which [`of_motor`] makes a torque.
pub fn voltage(times_s: &[f64], volts: Vec<f64>) -> Result<Torque, Failure> {
    Torque::new(times_s, volts).map_err(|error| {
        let message = error.to_string().replace("torque", "voltage");
        Failure::new(Exit::InputRefused, &message, error.hint())
    })
}

/// The torque of a link's motor at the held joint under a voltage.
pub fn of_motor(link: &Link, volts: &Torque) -> Torque {
    volts.scaled(link.drive().and_then(Drive::effort_per_volt).unwrap_or_default())
}

/// A play of a link or an arm from a call, and the wanted tip.
pub struct Moves {
    pub moving: Moving,
    pub interpolation: Interpolation,
    pub until_s: Option<f64>,
    /// The feedback of each joint; empty without.
    pub feedback: Vec<Feedback>,
    pub start: AtRest,
    /// Place in m of an arm's carriage at this start, unless the start has it.
    pub carriage_m: f64,
    pub state: Option<State>,
    pub target: Option<TipPlaces>,
    /// Direction of one link in rad where the target's displacement is 0.
    pub start_angle_rad: Option<f64>,
    pub is_large: bool,
    pub is_periodic: bool,
    /// Whether the torques are those of motors under voltages.
    pub is_under_voltage: bool,
}

/// The start at rest: the displacement of one link's tip, or a pose of an arm.
pub enum AtRest {
    Displaced(f64),
    Joints(Vec<f64>),
    Chords(Vec<f64>),
    Tip([f64; 2]),
    /// Where the joints' motion begins.
    Moved,
}

/// The start that a call names.
pub struct Begins<'a> {
    /// Whether it is a state.
    pub state: bool,
    /// Whether the motion of the joints is the input.
    pub moved: bool,
    /// Directions of an arm's chords in rad.
    pub at: Option<&'a [f64]>,
    /// Displacement of one link's tip in m.
    pub tip_m: Option<f64>,
}

impl AtRest {
    /// The start of the call, or of the feedback's reference, or of the target.
    pub fn of(
        arm: &Arm,
        begins: &Begins<'_>,
        (feedback, target): (&[Feedback], Option<&TipPlaces>),
    ) -> Result<Self, Failure> {
        let first_rad = || feedback.iter().map(|own| own.reference().angle_rad()[0]);
        let first_m = |axis: usize| target.and_then(|own| own.at_m[axis].first().copied());
        match (arm.links(), begins.at) {
            ([own], _) => {
                // Without weight a link at rest is straight: the hub points to its tip.
                let from_rad = own.link.origin_rad();
                let turn_rad = first_rad().next().filter(|_| !arm.has_weight());
                let turn_rad = turn_rad.map(|first| first - from_rad.unwrap_or(0.0));
                let of_target = target.map(|_| first_m(0).unwrap_or(0.0));
                let tip_m = begins.tip_m.or(of_target);
                let of_hub = turn_rad.map(|turn_rad| turn_rad * own.link.rigid_tip());
                Ok(Self::Displaced(tip_m.or(of_hub).unwrap_or(0.0)))
            }
            _ if begins.state => Ok(Self::Joints(Vec::new())),
            _ if begins.moved => Ok(Self::Moved),
            (links, Some(at)) => Ok(Self::Chords(directions(Some(at), links.len())?)),
            _ if !feedback.is_empty() => Ok(Self::Joints(first_rad().collect())),
            ([_, _], None) if target.is_some() && arm.elbow().is_some() => {
                Ok(Self::Tip([0, 1].map(|axis| first_m(axis).unwrap_or_default())))
            }
            _ => {
                let message = "--at is missing: nothing states where the arm starts";
                let hint = "use --at '30 deg,75 deg', the directions of its chords, as in the first row of chord_angles.csv, or --feedback with --reference";
                Err(Failure::new(Exit::Usage, &message, Some(hint)))
            }
        }
    }
}

impl Moving {
    /// The input of a play.
    pub fn input(&self) -> Input<'_> {
        match self {
            Self::Torques(torques) => Input::Torques(torques),
            Self::Angles(hubs) => Input::Angles(hubs),
        }
    }
}

impl Moves {
    /// The play up to the time of the call, or else to the later end of input and target.
    pub fn play(&self) -> Play<'_> {
        let input = self.moving.input();
        let end_s = input.grid().end_s();
        let both_s = self.target.as_ref().map(|target| target.grid.end_s().max(end_s));
        let (initial_tip_m, start) = match &self.start {
            AtRest::Displaced(tip_m) => (*tip_m, None),
            AtRest::Joints(joints_rad) => (0.0, Some(Start::Joints(joints_rad))),
            AtRest::Chords(chords_rad) => (0.0, Some(Start::Chords(chords_rad))),
            AtRest::Tip(at_m) => (0.0, Some(Start::Tip { at_m: *at_m, outer_rad: &[] })),
            AtRest::Moved => (0.0, None),
        };
        Play {
            interpolation: self.interpolation,
            until_s: self.until_s.or(both_s),
            feedback: &self.feedback,
            initial_tip_m,
            start,
            carriage_m: self.carriage_m,
            memory_bytes: memory::available(),
            is_large: self.is_large,
            start_angle_rad: self.start_angle_rad,
            state: self.state.as_ref(),
            cycle_turn_rad: self.is_periodic.then_some(0.0),
            is_under_voltage: self.is_under_voltage,
            ..Play::with(input)
        }
    }
}
