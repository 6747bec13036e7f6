//! `simulate`: torques of the joints, or a motion of the hub, in arrays, and the other keywords of the call.

use flexlink::cli::options::moves::{
    AtRest, Begins, Moves, Moving, of_motor, under_voltages, voltage,
};
use flexlink::cli::options::play::feedback;
use flexlink::csv::{InputFile, Joints};
use flexlink::elastica::SecondOrder;
use flexlink::link::{Arm, ArmLink};
use flexlink::motion::TipTarget;
use flexlink::numeric::TimeGrid;
use flexlink::response::{HistoryError, HubReference, Interpolation, State, Torque};
use flexlink::result::TipPlaces;
use flexlink::store::read_state;

use crate::arrays::{column, columns, gains};
use crate::keywords::{take, unknown};
use crate::link::Link;
use crate::motion::Motion;
use crate::prelude::*;
use crate::properties::Links;
use crate::samples::path_of;
use crate::simulation::Simulation;
use crate::table::SetPoints;
use crate::threads::until_pressed;

/// The keywords of one link and of arms, with blanks between.
const KEYWORDS: [(Links, &str); 6] = [
    (Links::Turning, "torque hub_angle hub_rate"),
    (Links::Carriage, "force carriage carriage_velocity"),
    (Links::Any, "voltage hold until periodic feedback reference reference_rate target state"),
    (Links::One, "initial_tip"),
    (Links::Several, "at"),
    (Links::CarriedArm, "carriage_at"),
];

/// The refusal of incomplete feedback.
const HALF_A_FEEDBACK: &str =
    "one of feedback and reference, but must be both or none, and reference_rate with them alone";

/// Plays torques, or a motion of the joints, on a link or an arm at rest, as ``flexlink simulate``: independent of
/// ``solve``.
///
/// ``time`` may be a table of a solution, ``solution.table(…)``: its efforts are played at the times of the motion's file, in
/// which the target is, too, with the ``hold`` of the table. Else it has the times of arrays in s, evenly spaced: ``torque``
/// in N m; or ``hub_angle`` in rad, and ``hub_rate`` if it is known; or ``voltage`` in V of the motor of ``[drive]``, which
/// turns its rotor and the link.
/// Other keywords: ``hold``, the torque between its samples, ``"cubic"``, ``"linear"`` or ``"zero"``; ``until`` in s;
/// ``periodic``. ``feedback`` is a pair of gains in N m/rad and N m s/rad, around ``reference`` in rad with
/// ``reference_rate``. A link on a carriage takes ``force`` in N, or ``carriage`` in m and ``carriage_velocity``, and gains
/// in N/m and N s/m. ``target`` is the wanted :class:`Motion` with which the tip is compared. The link starts where the
/// target or the reference does, or with its tip at ``initial_tip`` in m, or from ``state``: an earlier simulation, or the
/// file that its ``save_state`` wrote.
///
/// For an arm ``torque``, ``voltage``, ``hub_angle``, ``hub_rate``, ``reference`` and ``reference_rate`` have a column for each joint, as
/// those of its solution.
/// ``feedback`` is a pair for all joints or a list of pairs; ``target`` has x and y of the tip in m at each time. The arm
/// starts at rest where the reference does, or with its chords in the directions ``at`` in rad, or where the target does,
/// or from a ``state``. An arm on a carriage takes ``force`` beside ``torque``, or ``carriage`` beside ``hub_angle``;
/// ``reference`` and ``reference_rate`` have a last column for the carriage. It starts with its carriage there, or at
/// ``carriage_at`` in m, 0 by default. Ctrl-C ends it.
///
/// >>> import flexlink
/// >>> link = flexlink.Link(
/// ...     segments=[{"length": 1.5, "EI": 5.0, "mass_per_length": 0.8}],
/// ...     hub={"inertia": 0.1}, damping={"model": "rayleigh", "alpha": 0.1, "beta": 0.002},
/// ... )
/// >>> motion = flexlink.trajectory("sine", distance=0.5, duration=0.88, step=0.002)
/// >>> solution = flexlink.solve(link, **motion)
/// >>> wanted = flexlink.Motion(**motion)
/// >>> played = flexlink.simulate(link, solution.time, torque=solution.torque, target=wanted)
/// >>> played.tip_error["share"] < 1e-3  # of the largest distance from the start
/// True
#[pyfunction]
#[pyo3(signature = (link, time, **keywords))]
pub(crate) fn simulate(
    py: Python<'_>,
    link: &Link,
    time: &Any<'_>,
    keywords: Option<Keywords<'_>>,
) -> PyResult<Simulation> {
    let keywords = keywords.unwrap_or_else(|| PyDict::new(py));
    let specification = link.specification.clone();
    let time_s = match time.cast::<SetPoints>() {
        Ok(table) => {
            let is_input = |name: &&str| keywords.contains(name).unwrap_or_default();
            let inputs = ["torque", "force", "hub_angle", "carriage", "voltage"];
            if !inputs.iter().any(is_input) {
                for name in ["torque", "force"] {
                    if let Ok(effort) = table.getattr(name)
                        && !effort.is_none()
                    {
                        keywords.set_item(name, effort)?;
                    }
                }
                if let (Some(hold), false) = (table.get().hold(), keywords.contains("hold")?) {
                    keywords.set_item("hold", hold)?;
                }
            }
            table.get().times_of_motion()
        }
        Err(_) => column("time", time)?,
    };
    let moves = moves(link, &time_s, &keywords)?;
    let simulation = until_pressed(py, || Simulation::of(specification, moves))?;
    warn(py, &simulation.warnings)?;
    Ok(simulation)
}

/// Takes the input of a play out of the keywords of a call.
fn moves(link: &Link, time_s: &[f64], keywords: &Keywords<'_>) -> Raises<Moves> {
    let links = link.links();
    refuse_others(keywords, link.kind())?;
    let of = |name: &str, joints| {
        let read = |values| match joints {
            1 => Ok(vec![column(name, &values)?]),
            _ => columns(name, &values, (time_s.len(), joints)),
        };
        take(keywords, name)?.map(read).transpose()
    };
    let joints = link.specification.arm.joints().count();
    let of_joints = |name, of_carriage| match of(name, links)? {
        own if joints == links => Ok(own),
        own => both([name, of_carriage], own, of(of_carriage, 1)?),
    };
    let number = |name: &str| take(keywords, name)?.map(|value| value.extract()).transpose();
    let names = if link.kind().slides && links == 1 {
        ["force", "carriage", "carriage_velocity"]
    } else {
        ["torque", "hub_angle", "hub_rate"]
    };
    let input = [
        of_joints(names[0], "force")?,
        of_joints(names[1], "carriage")?,
        of_joints(names[2], "carriage_velocity")?,
        of("voltage", links)?,
    ];
    let is_under_voltage = input[3].is_some();
    let moving = moving((&link.specification.arm, names), time_s, input)?;
    let hold = take(keywords, "hold")?.map(|value| interpolation(&value)).transpose()?;
    let gains = take(keywords, "feedback")?.map(|value| gains(&value)).transpose()?;
    let references = match (&gains, of("reference", joints)?, of("reference_rate", joints)?) {
        (None, None, None) => Vec::new(),
        (Some(_), Some(angles), rates) => hubs(time_s, angles, rates)?,
        _ => return Err(usage(&HALF_A_FEEDBACK, None).into()),
    };
    let feedback = feedback(gains.as_deref(), references, &link.specification.arm)?;
    let effort = if is_under_voltage { "voltage" } else { names[0] };
    let others = (hold.is_some(), !feedback.is_empty());
    let grid = grid_of(&moving, [effort, names[1]], others)?;
    let is_periodic = take(keywords, "periodic")?.map(|value| value.is_truthy()).transpose()?;
    let is_periodic = is_periodic.unwrap_or_default();
    let (tip_m, until_s) = (number("initial_tip")?, number("until")?);
    let carriage_m = number("carriage_at")?;
    let at = take(keywords, "at")?.map(|value| column("at", &value)).transpose()?;
    let state = take(keywords, "state")?.map(|value| state(&value, links)).transpose()?;
    let starts =
        [("periodic", is_periodic), ("initial_tip", tip_m.is_some()), ("at", at.is_some())];
    if carriage_m.is_some()
        && (state.is_some() || !feedback.is_empty() || matches!(moving, Moving::Angles(_)))
    {
        let message = "carriage_at must stand beside neither state, feedback nor hub_angle";
        return Err(usage(&message, None).into());
    }
    if let Some((name, _)) = starts.iter().find(|(_, is_there)| *is_there && state.is_some()) {
        return Err(usage(&format!("{name} must not stand beside state"), None).into());
    }
    let mut start_angle_rad = None;
    let target = match take(keywords, "target")? {
        Some(motion) if links == 1 => {
            let motion = motion.cast::<Motion>().map_err(PyErr::from)?.get();
            motion.refuse_other(link.first())?;
            let target = motion.target(grid.time_s(0), until_s.unwrap_or(grid.end_s()));
            start_angle_rad = TipTarget::start_angle_rad(&target);
            Some(TipPlaces::from(&target))
        }
        places => places.map(|places| tip_places(&places, grid)).transpose()?,
    };
    let (arm, analysis) = (&link.specification.arm, &link.specification.analysis);
    let order = link.one().map(|one| analysis.second_order_of(one));
    let is_large = order.is_some_and(|order| order != SecondOrder::None);
    let moved = matches!(moving, Moving::Angles(_));
    let begins = Begins { state: state.is_some(), moved, at: at.as_deref(), tip_m };
    let start = AtRest::of(arm, &begins, (&feedback, target.as_ref()))?;
    Ok(Moves {
        moving,
        interpolation: hold.unwrap_or(Interpolation::Cubic),
        until_s,
        feedback,
        start,
        carriage_m: carriage_m.unwrap_or_default(),
        state,
        target,
        start_angle_rad,
        is_large,
        is_periodic,
        is_under_voltage,
    })
}

/// The times of an input, named as an effort or a position. Refuses a hold or a feedback that it cannot have.
fn grid_of(
    moving: &Moving,
    [effort, position]: [&str; 2],
    (has_hold, has_feedback): (bool, bool),
) -> Fails<TimeGrid> {
    let hubs = match moving {
        Moving::Torques(_) if effort == "voltage" && has_feedback => {
            let hint = "the feedback is a torque, which the voltage does not contain";
            return Err(usage(&"feedback stands beside voltage", Some(hint)));
        }
        Moving::Torques(torques) => return Ok(torques[0].grid()),
        Moving::Angles(hubs) => hubs,
    };
    let others = [("hold", has_hold), ("feedback", has_feedback)];
    let Some((name, _)) = others.iter().find(|(_, is_there)| *is_there) else {
        return Ok(hubs[0].grid());
    };
    let message = format!("{name} stands beside {position}, but must come with {effort}");
    Err(usage(&message, Some("a joint that moves as prescribed needs neither")))
}

/// The torques of the motors under voltages, a history for each joint.
fn under(arm: &Arm, time_s: &[f64], volts: &[Vec<f64>]) -> Fails<Moving> {
    under_voltages(arm)?;
    let joints = arm.links().iter().zip(volts);
    let torque = |(own, volts): (&ArmLink, &Vec<f64>)| {
        Ok(of_motor(&own.link, &voltage(time_s, volts.clone())?))
    };
    let torques = joints.map(torque);
    Ok(Moving::Torques(torques.collect::<Fails<_>>()?))
}

/// Histories of the joints of an arm's links, and of its carriage last; both or none.
fn both(
    [name, of_carriage]: [&str; 2],
    own: Option<Vec<Vec<f64>>>,
    last: Option<Vec<Vec<f64>>>,
) -> Raises<Option<Vec<Vec<f64>>>> {
    if own.is_some() != last.is_some() {
        let message =
            format!("one of {name} and {of_carriage}, but an arm on a carriage needs both");
        return Err(usage(&message, None).into());
    }
    Ok(own.zip(last).map(|(own, last)| [own, last].concat()))
}

/// Refuses a keyword outside the known ones, or one for other joints.
fn refuse_others(keywords: &Keywords<'_>, joints: Joints) -> Raises<()> {
    let known =
        || KEYWORDS.iter().flat_map(|(of, names)| names.split(' ').map(move |name| (of, name)));
    for key in keywords.keys() {
        let key: String = key.extract()?;
        match known().find(|(_, name)| *name == key) {
            Some((of, _)) if of.holds(joints) => {}
            Some((of, _)) => return Err(usage(&of.refusal(&key, joints), None).into()),
            None => {
                let known = known().filter(|(of, _)| of.holds(joints)).map(|(_, name)| name);
                return Err(unknown(&key, known).into());
            }
        }
    }
    Ok(())
}

/// The input: torques of the joints, or voltages of their motors, or angles of the hub with or without rates; of a carriage
/// force, position, velocity.
fn moving(
    (arm, [effort, position, rate_of]): (&Arm, [&str; 3]),
    time_s: &[f64],
    [torque, angle, rate, voltage]: [Option<Vec<Vec<f64>>>; 4],
) -> Fails<Moving> {
    match (torque, angle, rate, voltage) {
        (Some(torques), None, None, None) => {
            let torques = torques.into_iter().map(|torque| Torque::new(time_s, torque));
            Ok(Moving::Torques(torques.collect::<Result<_, _>>().map_err(|e| history(&e))?))
        }
        (None, Some(angles), rates, None) => Ok(Moving::Angles(hubs(time_s, angles, rates)?)),
        (None, None, None, Some(volts)) => under(arm, time_s, &volts),
        (None, .., None) if arm.alone().is_none() => {
            Err(usage(&"torque is missing: an arm needs a column for each joint", None))
        }
        _ => {
            let must = format!(
                "must be {effort} or voltage alone, or {position} with or without {rate_of}"
            );
            Err(usage(&format!("the input {must}"), None))
        }
    }
}

/// Angles of the joints at these times, and their rates if known.
fn hubs(
    time_s: &[f64],
    angles: Vec<Vec<f64>>,
    rates: Option<Vec<Vec<f64>>>,
) -> Fails<Vec<HubReference>> {
    let rates = rates.into_iter().flatten().map(Some).chain(std::iter::repeat(None));
    let joints = angles.into_iter().zip(rates);
    let joints = joints.map(|(angle, rate)| HubReference::new(time_s, angle, rate));
    joints.collect::<Result<_, _>>().map_err(|error| history(&error))
}

/// The refusal of samples.
fn history(error: &HistoryError) -> Failure {
    Failure::new(Exit::InputRefused, error, error.hint())
}

/// The torque between its samples.
fn interpolation(hold: &Any<'_>) -> Raises<Interpolation> {
    let hold: String = hold.extract()?;
    let known = [Interpolation::Zero, Interpolation::Linear, Interpolation::Cubic];
    let named = ["zero", "linear", "cubic"].into_iter().zip(known).find(|(name, _)| *name == hold);
    let must = "must be \"zero\", \"linear\" or \"cubic\"";
    let refused = || usage(&format!("hold = {hold:?}, but {must}"), None);
    Ok(named.ok_or_else(refused)?.1)
}

/// Wanted places of an arm's tip at the times of the torques.
fn tip_places(target: &Any<'_>, grid: TimeGrid) -> Raises<TipPlaces> {
    let at_m = columns("target", target, (grid.len, 2))?;
    if at_m.iter().flatten().all(|place| place.is_finite()) {
        return Ok(TipPlaces { grid, at_m });
    }
    Err(usage(&"target: not a number, but must be finite numbers", None).into())
}

/// The state at the end of an earlier simulation of this many links, from its object or from the file of
/// `save_state`.
fn state(state: &Any<'_>, links: usize) -> Raises<State> {
    if let Ok(simulation) = state.cast::<Simulation>()
        && simulation.get().played().links.len() == links
    {
        return Ok(simulation.get().played().state());
    }
    let Some(path) = path_of(state)? else {
        let must = "must be an earlier simulation of the same kind, or the path of its state";
        let message = format!("state = {}, but {must}", state.get_type());
        return Err(PyTypeError::new_err(message).into());
    };
    let file = InputFile::read(&path).map_err(Failure::from)?;
    Ok(read_state(&file.shown, &file.bytes, links).map_err(Failure::from)?)
}
