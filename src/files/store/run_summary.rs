//! The summaries of `solve` and `simulate`, from their results.

use std::f64::consts::TAU;

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::names::{RunOutputs, played_files};
use super::summary::{LinkRecord, RunInputs, Summary};
use crate::beam::Mesh;
use crate::inverse::{LinkMotion, PerQuantity, QuantityErrors, SecondOrderFindings, Solution};
use crate::link::{Arm, Joint, Link};
use crate::modal::{REPORTED_MODES, REPORTED_ZEROS, reports_weight};
use crate::motion::Ends;
use crate::response::{
    Feedback, Input, ModalPlay, Play, PlayError, Played, PlayedBy, PlayedLink, SimulationError,
};
use crate::result::{
    Comparison, Exceeded, FollowedTarget, JointMetrics, JointQuantity, Limits, Metrics, Notice,
    PlayedJoint, PlayedMetrics, Remark, TipError, by_name,
};
use crate::verify::Verification;

/// Limits, checks and remarks of a solution beside its numbers.
#[derive(Debug, Clone, Copy, Default)]
pub struct Findings<'a> {
    /// Limits of each joint.
    pub limits: &'a [Limits],
    /// Those that it exceeds.
    pub exceeded: &'a [Exceeded],
    /// Checks of the answer, if there are any.
    pub verification: Option<&'a Verification>,
    /// Remarks on link or arm and motion.
    pub remarks: &'a [Remark],
}

/// A simulation with its numbers, its errors and its comparisons.
#[derive(Debug, Clone)]
pub struct Simulated {
    /// The motion.
    pub played: Played,
    /// Its numbers.
    pub metrics: PlayedMetrics,
    /// Its errors; absent if elements of half the length do not allow the damping.
    pub error: Option<PlayError>,
    /// The tip beside its target.
    pub target: Option<FollowedTarget>,
    /// The simulation beside a recording.
    pub comparison: Option<Comparison>,
}

impl Simulated {
    /// Measures the errors and the numbers of a simulation; without a recording.
    ///
    /// # Errors
    /// As [`PlayError::of`].
    pub fn of(
        played: Played,
        arm: &Arm,
        play: &Play<'_>,
        target: Option<FollowedTarget>,
    ) -> Result<Self, SimulationError> {
        let error = PlayError::of(&played, arm, play)?;
        let metrics = PlayedMetrics::of(&played, arm);
        Ok(Self { played, metrics, error, target, comparison: None })
    }
}

/// A simulation with its input and its limits.
#[derive(Debug, Clone, Copy)]
pub struct PlayedRun<'a> {
    /// The link or the arm.
    pub arm: &'a Arm,
    /// What was played.
    pub play: &'a Play<'a>,
    /// Limits of each joint.
    pub limits: &'a [Limits],
    /// The simulation.
    pub result: &'a Simulated,
}

impl PlayedRun<'_> {
    /// All warnings for the user; `of_limit` makes the notice of an exceeded limit.
    pub fn notices(&self, of_limit: impl Fn(&Exceeded) -> Notice) -> Vec<Notice> {
        let Simulated { played, metrics, error, target, .. } = self.result;
        let inexact = error.as_ref().and_then(|error| error.warning(played));
        let played = played.warnings.iter().copied().chain(inexact).map(Notice::from);
        let late = target.as_ref().and_then(|target| target.tip_error.late).map(Notice::from);
        let exceeded = metrics.exceeded(self.limits);
        let all = played.chain(late).chain(exceeded.iter().map(of_limit));
        all.map(|own| own.worded(self.arm)).collect()
    }
}

impl Summary {
    /// The summary of a solution whose `outputs` the run writes.
    pub fn of_solution(
        inputs: RunInputs,
        solution: &Solution,
        metrics: &Metrics,
        findings: &Findings,
        outputs: &RunOutputs,
    ) -> Self {
        let arm = &solution.arm;
        let mut values = solution_values(solution, metrics);
        if let Some(found) = &solution.second_order {
            values["second_order"] = second_order_record(solution, found);
        }
        store_limits(&mut values, findings.limits, arm);
        store_gravity(&mut values, arm, solution.links.iter().any(LinkMotion::reports_weight));
        let exceeded = findings.exceeded.iter().map(Notice::from);
        let warnings = solution.warnings.iter().map(Notice::from).chain(exceeded);
        let remarks = findings.remarks.iter().map(Notice::from);
        let files = outputs.files(arm).into_iter();
        Self {
            values,
            drive: arm
                .alone()
                .map(|link| link.drive().map(|own| renamed(&link.joint(), json!(own)))),
            verification: Some(findings.verification.map(|own| own.checks.clone())),
            warnings: warnings.map(|own| own.worded(arm)).collect(),
            remarks: Some(remarks.map(|own| own.worded(arm)).collect()),
            files: files.map(str::to_owned).collect(),
            ..Self::of("solve", inputs, arm, solution.links[0].law())
        }
    }

    /// The summary of a simulation.
    pub fn of_played(inputs: RunInputs, run: &PlayedRun<'_>) -> Self {
        let PlayedRun { arm, play, limits, result } = *run;
        let Simulated { played, metrics, target, comparison, .. } = result;
        let tip_error = target.as_ref().map(|target| tip_numbers(&target.tip_error));
        let joint = arm.joint();
        let input = match play.input {
            Input::Torques(_) if play.is_under_voltage => "voltage",
            Input::Torques(_) if joint.slides() => "force",
            Input::Torques(_) => "torque",
            Input::Angles(_) if joint.slides() => "carriage",
            Input::Angles(_) => arm.pick("hub_angle", "joint_angles"),
        };
        let input = (input, input_values(play, played));
        let PlayedLink { mesh, law, natural_frequencies_rad_s, outward_m_s2 } = &played.links[0];
        let mut values = if arm.alone().is_some() {
            let periods_s: Vec<f64> =
                natural_frequencies_rad_s.iter().map(|omega| TAU / omega).collect();
            json!({
                "mesh": mesh_values(mesh),
                input.0: input.1,
                "feedback": play.feedback.first().map(|own| renamed(&joint, gains(own))),
                "periods_s": periods_s,
                "viscous_damping_ratios": law.modal_ratios(natural_frequencies_rad_s),
                "results": played_results(metrics, arm),
                "errors": renamed(&joint, link_errors(result)),
                "tip_error": tip_error,
            })
        } else {
            let elements = played.links.iter().map(|link| link.mesh.elements().len());
            let [tip_m, joint_rad] = played.change();
            let feedback = play.feedback.iter().zip(arm.joints());
            let feedback = feedback.map(|(own, joint)| renamed(&joint, gains(own)));
            json!({
                "arm": arm_record(arm, elements),
                input.0: input.1,
                "feedback": feedback.collect::<Vec<_>>(),
                "results": played_results(metrics, arm),
                "errors": {
                    "refinement": { "tip_m": tip_m, "joints_rad": joint_rad },
                    "energy": played.imbalance(),
                },
                "tip_error": tip_error,
            })
        };
        store_limits(&mut values, limits, arm);
        match &played.by {
            PlayedBy::Modes(ModalPlay { selection, residual, .. }) => {
                let modes = json!({
                    "kept": selection.modes,
                    "of_mesh": selection.of,
                    "torque_band_hz": selection.torque_band_hz,
                    "highest_hz": selection.highest_hz,
                });
                values["modes"] = renamed(&joint, modes);
                if let Some(residual) = residual {
                    values["residual"] = json!(residual);
                }
            }
            PlayedBy::Elastica(bent) => {
                let mut elastica = json!({ "angles": bent.angles, "steps_per_sample": bent.steps });
                if arm.alone().is_some() {
                    elastica[joint.named("holding_torque_n_m")] = json!(played.hub().holding_n_m);
                }
                values["elastica"] = elastica;
            }
        }
        store_gravity(&mut values, arm, reports_weight(mesh, *outward_m_s2));
        let files = played_files(arm, target.is_some());
        Self {
            values,
            measured: comparison.clone(),
            warnings: run.notices(|limit| Notice::from(limit)),
            files: files.into_iter().map(str::to_owned).collect(),
            ..Self::of("simulate", inputs, arm, law)
        }
    }
}

/// Numbers of a solution. Those of modes and zeros belong to a link without joints beyond its hub.
fn solution_values(solution: &Solution, metrics: &Metrics) -> Value {
    let Solution { arm, links, joints, tip_model_error, .. } = solution;
    let mut values = json!({});
    if let [link] = &links[..] {
        values["mesh"] = mesh_values(link.mesh());
    } else {
        values["arm"] = arm_record(arm, links.iter().map(|link| link.mesh().elements().len()));
    }
    values["motion"] = motion_values(solution, metrics);
    if let [link] = &links[..] {
        let frequencies = link.natural_frequencies_rad_s(REPORTED_MODES);
        let hertz: Vec<f64> = frequencies.iter().map(|omega| omega / TAU).collect();
        values["periods_s"] = hertz.iter().map(|hertz| hertz.recip()).collect();
        values["natural_frequencies_hz"] = json!(hertz);
        values["modal_damping_ratios"] = json!(link.law().modal_ratios(&frequencies));
        values["zeros_per_s"] = json!(link.zeros_per_s(REPORTED_ZEROS));
    }
    values["analysis"] = analysis_values(solution);
    values["results"] = match &metrics.joints[..] {
        [hub] => joint_record(&arm.joint(), hub).into(),
        joints => {
            let mut records: Vec<_> =
                joints.iter().zip(arm.joints()).map(|(own, of)| joint_record(&of, own)).collect();
            let carriage = records.split_off(links.len()).pop();
            let mut results = json!({ "farthest_m": solution.tip_travel_m(), "joints": records });
            if let Some(own) = carriage {
                results["carriage"] = own.into();
            }
            results
        }
    };
    let tip = solution.expected_tip_error();
    values["errors"] = match &joints[..] {
        [hub] => {
            let errors = ErrorsRecord { tip, tip_model: *tip_model_error, hub: &hub.errors };
            renamed(&arm.joint(), json!(errors))
        }
        joints => {
            let (joints, carriage) = joints.split_at(links.len());
            let joints: Vec<_> = joints.iter().map(|joint| &joint.errors).collect();
            let mut errors = json!({ "tip": tip, "joints": joints });
            if let ([own], Some(of)) = (carriage, arm.joints().last()) {
                let errors_of =
                    PerQuantity { displacement: None, bending_moment: None, ..own.errors };
                errors["carriage"] = renamed(&of, json!(errors_of));
            }
            errors
        }
    };
    values
}

/// An object with the keys of a joint.
fn renamed(joint: &Joint, object: Value) -> Value {
    let Value::Object(entries) = object else { return object };
    entries.into_iter().map(|(key, value)| (joint.named(&key), value)).collect()
}

/// Errors of one link: those of its tip, then those of its hub.
#[derive(Serialize)]
struct ErrorsRecord<'a> {
    tip: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    tip_model: Option<f64>,
    #[serde(flatten)]
    hub: &'a PerQuantity<QuantityErrors>,
}

/// The second-order terms of a solution, with the largest slope of the link or of each link of an arm.
fn second_order_record(solution: &Solution, found: &SecondOrderFindings) -> Value {
    let SecondOrderFindings { order, iteration, left_out, fallback } = found;
    let mut record = json!({
        "order": order,
        "iterations": iteration.iterations,
        "contraction": iteration.contraction,
    });
    let slopes: Vec<_> = solution.links.iter().filter_map(|link| link.largest_slope).collect();
    let of_link = ("largest_slope", json!(slopes.first()));
    let (key, slopes) = solution.arm.pick(of_link, ("largest_slopes", json!(slopes)));
    record[key] = slopes;
    record["torque_change"] = json!(iteration.second_order_change);
    record["left_out"] = json!(left_out.flatten());
    if solution.arm.alone().is_none() {
        record["fallback"] = json!(fallback);
    }
    record
}

/// Errors of one link's simulation: shares of the peak of each quantity, or of the tip's travel.
fn link_errors(run: &Simulated) -> Value {
    let modes = run.played.modes();
    let mut errors = run.error.as_ref().map_or(json!({}), |error| {
        let kind = if modes.is_some() { "mesh" } else { "refinement" };
        json!({ "tip": { kind: error.tip }, "hub_angle": { kind: error.hub_angle } })
    });
    if let Some(ModalPlay { model_error, .. }) = modes {
        errors["tip"]["model"] = json!(model_error.tip);
        errors["deflection"] = json!({ "model": model_error.deflection });
    }
    errors
}

/// Notes that gravity acts on a single link, if its frequencies are without it.
fn store_gravity(values: &mut Value, arm: &Arm, reports_weight: bool) {
    if arm.alone().is_some_and(Link::has_weight) && !reports_weight {
        values["frequencies_without_gravity"] = json!(true);
    }
}

/// Stores the limits of a single link, or of each joint, if there are any.
fn store_limits(values: &mut Value, limits: &[Limits], arm: &Arm) {
    let stored = limits.iter().zip(arm.joints());
    let stored = stored.map(|(limits, joint)| Some(renamed(&joint, limits.stored()?)));
    let stored: Vec<Option<Value>> = stored.collect();
    match &stored[..] {
        [Some(own)] => values["limits"] = own.clone(),
        several if several.iter().any(Option::is_some) => values["limits"] = json!(several),
        _ => {}
    }
}

fn gains(feedback: &Feedback) -> Value {
    json!({
        "stiffness_n_m_rad": feedback.stiffness_n_m_rad(),
        "damping_n_m_s_rad": feedback.damping_n_m_s_rad(),
    })
}

/// The arm and its links, in SI.
fn arm_record(arm: &Arm, elements: impl IntoIterator<Item = usize>) -> Value {
    let links = arm.links().iter().zip(elements).map(|(own, elements)| {
        json!({
            "name": own.name,
            "elements": elements,
            "link": LinkRecord::of_parts(&own.link),
            "drive": own.link.drive(),
        })
    });
    let mut record = json!({
        "length_m": arm.length_m(),
        "gravity_m_s2": arm.gravity_m_s2(),
        "elbow": arm.elbow(),
        "links": links.collect::<Vec<Value>>(),
    });
    if let Some(carriage) = arm.carriage() {
        record["carriage"] = json!(carriage);
    }
    record
}

/// The numbers of a hub, or of a joint with its angles at the ends; null for a motion without the number.
fn joint_record(of: &Joint, joint: &JointMetrics) -> Map<String, Value> {
    // A cycle has neither lead nor lag.
    let is_there = |quantity: &JointQuantity| {
        (quantity.of)(joint).is_some() || ["lead", "lag"].contains(&quantity.name)
    };
    let mut record =
        by_name(of, |quantity| is_there(quantity).then(|| (quantity.of)(joint).into()));
    if joint.joint.is_some() {
        let [start_rad, end_rad] = joint.end_angles_rad;
        let [start, end] = end_keys(of);
        record.insert(start.to_owned(), start_rad.into());
        record.insert(end.to_owned(), end_rad.into());
    }
    record
}

/// Keys of a joint's positions at the ends.
fn end_keys(of: &Joint) -> [&'static str; 2] {
    if of.slides() { ["start_m", "end_m"] } else { ["start_angle_rad", "end_angle_rad"] }
}

fn mesh_values(mesh: &Mesh) -> Value {
    let elements = mesh.elements().len();
    json!({
        "elements": elements,
        "degrees_of_freedom": 2 * elements + 1,
        "resolved_hz": mesh.resolved_frequency_rad_s() / TAU,
    })
}

fn motion_values(solution: &Solution, metrics: &Metrics) -> Value {
    let motion = &solution.motion;
    let (grid, (from, until)) = (motion.grid(), motion.moving_samples());
    let mut values = json!({
        "given": motion.given(),
        "samples": grid.len,
        "step_s": grid.step_s,
        "start_s": grid.time_s(0),
        "moves_from_s": grid.time_s(from),
        "moves_until_s": grid.time_s(until),
    });
    if let Some(tip) = motion.tip() {
        values["travel_m"] = json!(tip.travel_m());
    }
    values["peak_velocity_m_s"] = json!(metrics.peak_tip_velocity_m_s.value);
    values["peak_acceleration_m_s2"] = json!(metrics.peak_tip_acceleration_m_s2.value);
    if motion.ends() != Ends::AtRest {
        values["ends"] = json!(motion.ends());
        if let Some(tip) = motion.tip() {
            let [before_m_s, after_m_s] = tip.end_velocities_m_s();
            values["velocity_before_m_s"] = json!(before_m_s);
            values["velocity_after_m_s"] = json!(after_m_s);
        }
    }
    values
}

fn input_values(play: &Play<'_>, played: &Played) -> Value {
    let grid = play.input.grid();
    let mut values = json!({
        "samples": grid.len,
        "step_s": grid.step_s,
        "start_s": grid.time_s(0),
        "end_s": grid.end_s(),
        "simulated_until_s": played.grid.end_s(),
    });
    if play.input.is_torque() {
        values["interpolation"] = json!(play.interpolation);
    }
    values
}

/// Settings of the analysis. The band is null if the solver uses every frequency of the samples; the modes are null
/// if it keeps all.
fn analysis_values(solution: &Solution) -> Value {
    let Solution { arm, analysis, band, grid, first_zero_per_s, .. } = solution;
    let mut values = json!({
        "tolerance": analysis.tolerance(),
        "tip_tolerance": analysis.tip_tolerance(),
        "band_hz": band.cutoff_hz,
        "modes": analysis.modes(),
        "period_s": band.period_s,
        "fft_length": band.fft_length,
        "frequencies": band.frequencies,
        "highest_frequency_hz": band.highest_hz,
        "nyquist_hz": band.nyquist_hz,
        "window_start_s": grid.time_s(0),
        "window_end_s": grid.end_s(),
        "rows": grid.len,
    });
    if arm.alone().is_none() {
        values["first_zero_per_s"] = json!(first_zero_per_s);
    }
    values
}

/// The results of a simulation: its numbers with those of the hub, or of an arm with those of its joints.
fn played_results(metrics: &PlayedMetrics, arm: &Arm) -> Value {
    let whole = [
        ("farthest_m", metrics.farthest_m),
        ("travel_m", metrics.travel_m),
        ("final_tip_velocity_m_s", metrics.final_tip_velocity_m_s),
    ];
    let whole = whole.map(|(key, number)| (key.to_owned(), Value::from(number))).into_iter();
    let Some(final_tip_m) = metrics.final_tip_m else {
        // The hub's torque stands first.
        let mut hub = played_joint((metrics.hub(), arm.joint())).into_iter();
        return hub.next().into_iter().chain(whole).chain(hub).collect();
    };
    let mut joints: Vec<_> = metrics.joints.iter().zip(arm.joints()).map(played_joint).collect();
    let carriage = joints.split_off(arm.links().len()).pop();
    let carriage = carriage.map(|own| ("carriage", json!(own)));
    let arm = [("final_tip_m", json!(final_tip_m)), ("joints", json!(joints))];
    whole
        .chain(arm.into_iter().chain(carriage).map(|(key, value)| (key.to_owned(), value)))
        .collect()
}

/// The results of a simulation's joint.
fn played_joint((joint, of): (&PlayedJoint, Joint)) -> Map<String, Value> {
    let mut numbers = by_name(&of, |quantity| Some(quantity.played_by(joint)?.into()));
    if joint.joint.is_some() {
        let [start_rad, end_rad] = joint.end_angles_rad;
        let holding = joint.holding_torque_n_m.map(|torque| ("holding_torque_n_m", torque));
        let ends = end_keys(&of).into_iter().zip([start_rad, end_rad]);
        // The torques stand first.
        for (place, (key, number)) in (1..).zip(holding.into_iter().chain(ends)) {
            numbers.shift_insert(place, of.named(key), number.into());
        }
    }
    numbers
}

pub(super) fn tip_numbers(error: &TipError) -> Value {
    json!({
        "worst_m": error.worst_m,
        "share": error.share,
        "time_s": error.time_s,
        "rms_m": error.rms_m,
        "final_m": error.final_m,
    })
}
