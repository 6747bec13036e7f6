//! The inversion of links on their chords: meshes, period, window and errors, up to the solution of an arm.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::answer::{ArmAnswer, curves_at_rest};
use super::problem::ArmProblem;
use super::window::straying;
use crate::beam::{Mesh, MeshPlan};
use crate::elastica::{ArmMotion, ElasticaError, SecondOrder};
use crate::inverse::accuracy::Curves;
use crate::inverse::diagnostics::{Edge, blocked_rad_s};
use crate::inverse::mesh_error::TORQUES_N_M;
use crate::inverse::period::{PeriodicTorque, Window, lengthened};
use crate::inverse::spectra::Probes;
use crate::inverse::{
    Analysis, Band, InversionError, PerQuantity, QuantityErrors, Resources, SecondOrderFindings,
    Solution,
};
use crate::link::Arm;
use crate::modal::torque_zeros;
use crate::model::{Model, check_size, model_of};
use crate::motion::{ArmPath, Cutoff, Motion};
use crate::numeric::{Size, TimeGrid};

/// Size of a quantity for a joint that hardly moves, over the largest size of any joint.
pub(super) const LEAST_SIZE: f64 = 1e-6;

/// Ratio of a longer period's remainder to the last one's above which the longer period did not help.
const STILL: f64 = 0.5;

type Models = Vec<Arc<dyn Model>>;
pub(super) type Sizes = Vec<PerQuantity<f64>>;

/// The inversion of several links.
pub(in super::super) fn invert_arm(
    arm: &Arm,
    plans: &[MeshPlan],
    path: &ArmPath,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<Solution, InversionError> {
    let links = arm.links().len();
    if links == 1 {
        return Err(InversionError::OtherMotion { links });
    }
    if plans.len() != links {
        return Err(InversionError::Plans { plans: plans.len(), links });
    }
    let mut models = Models::new();
    for (own, plan) in arm.links().iter().zip(plans) {
        let mesh = Mesh::new(&own.link, plan)?;
        check_size(&own.link, 2 * mesh.elements().len(), 2)?;
        models.push(model_of(&own.link, mesh, analysis.kept_modes())?);
    }
    let first_zero_per_s = models
        .iter()
        .filter_map(|model| torque_zeros(model.mesh(), 1).first().copied())
        .reduce(f64::min);
    let problem = ArmProblem::of(arm, path, (analysis, *resources), first_zero_per_s)?;
    let solver = Solver { problem, plans, falls_back: false };
    let refusal = match solver.solution(path, models.clone(), first_zero_per_s) {
        Err(error @ InversionError::Elastica(ElasticaError::Diverges { .. })) => error,
        found => return found,
    };
    // Second-order terms grow where no torque moves a link's tip.
    let refused = || diverged(refusal, &models, &solver.problem);
    if analysis.second_order().is_some() {
        return Err(refused());
    }
    // By default all terms count; first-order terms alone are the next best choice.
    let mut problem = solver.problem.with(SecondOrder::First, solver.problem.cutoffs.clone());
    problem.resources = *resources;
    let first = Solver { problem, plans, falls_back: true };
    match first.solution(path, models.clone(), first_zero_per_s) {
        Err(InversionError::Elastica(ElasticaError::Diverges { .. })) => {
            Err(InversionError::NorFirst(Box::new(refused())))
        }
        found => found,
    }
}

/// The refusal of terms that do not converge, with the frequency at which no torque moves an output.
pub(in super::super) fn diverged(
    refused: InversionError,
    models: &Models,
    problem: &ArmProblem<'_>,
) -> InversionError {
    match blocked(models, problem) {
        Some((link, frequency_hz)) => {
            let (refused, link) = (Box::new(refused), (models.len() > 1).then_some(link));
            InversionError::Blocked { refused, link, frequency_hz }
        }
        None => refused,
    }
}

/// The first link whose output no torque moves at some frequency within the motion's band, and this frequency in Hz.
fn blocked(models: &Models, problem: &ArmProblem<'_>) -> Option<(usize, f64)> {
    let nyquist_rad_s = PI / problem.wanted.grid().step_s;
    let end_rad_s = problem.cutoffs.iter().map(Cutoff::end_rad_s).reduce(f64::max)?;
    let end_rad_s = end_rad_s.min(nyquist_rad_s);
    models
        .iter()
        .enumerate()
        .find_map(|(link, model)| Some((link, blocked_rad_s(&**model, end_rad_s).first()? / TAU)))
}

pub(in super::super) struct Solver<'a> {
    pub(in super::super) problem: ArmProblem<'a>,
    pub(in super::super) plans: &'a [MeshPlan],
    /// True if the solution counts fewer terms than the caller chose.
    pub(in super::super) falls_back: bool,
}

/// The answer on fine enough meshes.
pub(super) struct Solved {
    pub(super) answer: ArmAnswer,
    pub(super) probes: Vec<Probes>,
    /// Places of the probes.
    pub(super) nodes: Vec<Vec<usize>>,
    pub(super) sizes: Sizes,
    mesh: Sizes,
}

/// The answer, its samples to write, and its errors.
pub(in super::super) struct Measured {
    pub(super) solved: Solved,
    pub(in super::super) window: Window,
    /// Errors of each joint.
    pub(in super::super) errors: Vec<PerQuantity<QuantityErrors>>,
    /// Remainders of the first joint's torque.
    pub(in super::super) edge: Edge,
}

impl Measured {
    /// Answer, size of each quantity and model of one link.
    pub(in super::super) fn of_link(self) -> (ArmAnswer, PerQuantity<f64>, Arc<dyn Model>) {
        let Solved { answer, sizes, .. } = self.solved;
        let model = Arc::clone(&answer.models[0]);
        (answer, sizes[0], model)
    }
}

impl Solver<'_> {
    /// The answer with all its errors.
    ///
    /// # Errors
    /// [`InversionError`].
    pub(in super::super) fn measured(
        &self,
        models: Models,
        first_zero_per_s: Option<f64>,
    ) -> Result<Measured, InversionError> {
        let problem = &self.problem;
        let (solved, rests, left) = self.decayed(self.on_mesh(models)?)?;
        let (window, cut) = self.window(&solved, rests.as_ref());
        let step = self.step_errors(&solved, first_zero_per_s)?;
        let input = self.input_errors(&solved)?;
        let is_iterated = problem.second_order != SecondOrder::None;
        let iteration = is_iterated.then(|| self.iteration_errors(&solved)).transpose()?;
        let errors = solved.mesh.iter().enumerate().map(|(joint, mesh)| {
            let at = |all: &Option<Sizes>| all.as_ref().map(|all| all[joint]);
            let errors = mesh.zip(&left[joint].at_least(&cut[joint]), |mesh, window| {
                QuantityErrors { mesh, window, ..QuantityErrors::default() }
            });
            errors
                .with(at(&step), |errors, step| QuantityErrors { step: Some(step), ..errors })
                .with(at(&iteration), |errors, iteration| QuantityErrors {
                    iteration: Some(iteration),
                    ..errors
                })
                .with(at(&input), |errors, input| QuantityErrors { input: Some(input), ..errors })
        });
        let errors = errors.collect();
        let edge = Edge { cut: cut[0].torque, seam: left[0].torque };
        Ok(Measured { solved, window, errors, edge })
    }

    /// The second-order terms of an answer, with the change by omitted ones.
    pub(in super::super) fn findings(&self, answer: &ArmAnswer) -> SecondOrderFindings {
        let (order, iteration) = (self.problem.second_order, answer.motion.iteration);
        let leaves_out = order != SecondOrder::Full && !self.falls_back;
        let left_out = leaves_out.then(|| self.left_out(answer));
        SecondOrderFindings { order, iteration, left_out, fallback: None }
    }

    fn solution(
        &self,
        path: &ArmPath,
        models: Models,
        first_zero_per_s: Option<f64>,
    ) -> Result<Solution, InversionError> {
        let problem = &self.problem;
        let arm = problem.arm;
        let Measured { solved, window, errors, .. } = self.measured(models, first_zero_per_s)?;
        let answer = &solved.answer;
        let motion_grid = path.grid();
        let grid = TimeGrid { first: window.start, len: window.len(), ..motion_grid };
        let findings = || self.findings(answer);
        // The error of the input already measures the digits' uncertainty.
        let is_settled = problem.cutoffs.iter().any(Cutoff::is_set_by_input);
        let shown = || {
            let unsettled = (!is_settled).then(|| self.unsettled(&solved)).transpose();
            (answer.links(&grid), answer.joints(arm, &grid, &errors), unsettled)
        };
        let (mut found, ((links, tip), joints, unsettled)) =
            match problem.refuse_memory(&[&answer.models[..]; 3], &answer.path) {
                Ok(()) => rayon::join(findings, shown),
                Err(_) => (findings(), shown()),
            };
        let cutoffs = problem.cutoffs.iter().map(|own| own.omega_rad_s).filter(|o| o.is_finite());
        let cutoff_hz = cutoffs.reduce(f64::max).map(|omega| omega / TAU);
        let spectrum = &answer.path.tip.spectrum;
        let band = Band::of(spectrum, spectrum.band_len());
        // The roll-off and the turning links bring frequencies above the path's; they are small above twice its cut-off.
        let highest_hz = cutoff_hz.map_or(f64::INFINITY, |cutoff_hz| 2.0 * cutoff_hz);
        let highest_hz = highest_hz.min(band.nyquist_hz);
        let (first, last) = path.moving_samples();
        let on_grid = |k: usize| (k as i64 - window.start).max(0) as usize;
        let mut solution = Solution {
            arm: arm.clone(),
            motion: Motion::Path(path.clone()),
            analysis: *problem.analysis,
            grid,
            joints,
            links,
            tip,
            tip_error: 0.0,
            tip_model_error: None,
            moving: (on_grid(first), on_grid(last)),
            first_zero_per_s,
            band: Band { highest_hz, cutoff_hz, ..band },
            second_order: None,
            warnings: Vec::new(),
            spectra: None,
        };
        solution.tip_error = answer.tip_error_m(path) / solution.tip_travel_m();
        if solution.joints.iter().any(|joint| joint.torque_n_m.iter().any(|t| !t.is_finite())) {
            return Err(InversionError::OutOfRange { peak_n_m: f64::NAN });
        }
        found.fallback = self.falls_back.then(|| straying(&solution, path));
        solution.second_order = Some(found);
        solution.warnings =
            self.warnings(&solved, (&solution, &found), &unsettled?.unwrap_or_default());
        Ok(solution.with_losses())
    }

    /// The answer over the shortest period on meshes fine enough for the plans.
    fn on_mesh(&self, coarsest: Models) -> Result<Solved, InversionError> {
        let problem = &self.problem;
        let is_automatic = self.plans.iter().any(MeshPlan::is_automatic);
        let tolerance = MeshPlan::smallest_tolerance(self.plans);
        let probes = coarsest.iter().zip(self.plans);
        let probes = probes.map(|(model, plan)| Probes::of(model.mesh(), plan, problem.analysis));
        let probes: Vec<Probes> = probes.collect();
        let mut nodes: Vec<Vec<usize>> = probes.iter().map(|own| own.nodes.clone()).collect();
        let mut models = coarsest;
        let path = problem.period(problem.shortest_len()?)?;
        let mut known: Option<ArmAnswer> = None;
        loop {
            let (finer, finer_nodes) = refined(&models, &nodes)?;
            // The finer mesh of a fixed plan only measures the error: its probes suffice.
            let shown = (!is_automatic).then_some(&finer_nodes[..]);
            let of_both = [&models[..], &finer];
            problem.begin(if known.is_none() { &of_both } else { &of_both[1..] }, &path);
            let own = || problem.answer_in_stage(&models, &path, None);
            let mut own = || known.take().map_or_else(own, Ok);
            let on_finer = || problem.answer_in_stage(&finer, &path, shown);
            let (answer, finer_answer) = match problem.refuse_memory(&of_both, &path) {
                Ok(()) => rayon::join(own, on_finer),
                Err(_) => (own(), on_finer()),
            };
            let (answer, finer_answer) = (answer?, finer_answer?);
            let on_finer = finer_answer.curves(&finer_nodes);
            let sizes = self.sizes(&on_finer, &finer_answer, &probes);
            if let Some(size) = sizes.iter().find(|own| !TORQUES_N_M.contains(&own.torque)) {
                return Err(InversionError::OutOfRange { peak_n_m: size.torque });
            }
            let mesh = changes(&models, &answer.curves(&nodes), &on_finer, &sizes);
            let error = worst(&mesh);
            let small = problem.small(&finer_answer);
            if !is_automatic || error <= tolerance.max(small) {
                return Ok(Solved { answer, probes, nodes, sizes, mesh });
            }
            let elements: usize = models.iter().map(|model| model.mesh().elements().len()).sum();
            let most: usize = finer.iter().map(|model| model.most_elements()).min().unwrap_or(0);
            if finer.iter().any(|model| 2 * model.mesh().elements().len() > most) {
                return Err(InversionError::NotConverged { error, elements, tolerance });
            }
            // A link with a fixed number of elements keeps it.
            for (link, plan) in self.plans.iter().enumerate() {
                if plan.is_automatic() {
                    models[link] = Arc::clone(&finer[link]);
                    nodes[link].clone_from(&finer_nodes[link]);
                }
            }
            known = self.plans.iter().all(MeshPlan::is_automatic).then_some(finer_answer);
        }
    }

    /// Size of each quantity, the reference of its errors; for a joint that hardly moves, a share of the largest size
    /// of any joint. One link has the sizes of its measured quantities.
    fn sizes(&self, curves: &[Curves], answer: &ArmAnswer, probes: &[Probes]) -> Sizes {
        let has_weight = self.problem.arm.has_weight();
        if self.problem.is_link() {
            let travel_m = answer.path.tip.histories.largest_travel_m();
            return vec![probes[0].measured(curves[0].sizes(has_weight, travel_m))];
        }
        let way_m = answer.way_of_chords_m(self.problem.wanted.grid().len);
        let sizes: Sizes = curves.iter().map(|own| own.sizes(has_weight, way_m)).collect();
        let of_links = &sizes[..probes.len()];
        let largest = of_links.iter().fold(sizes[0], |most, own| most.zip(own, f64::max));
        let floored = |own: &PerQuantity<f64>| PerQuantity {
            motor_torque: own.motor_torque,
            motor_rate: own.motor_rate,
            ..own.zip(&largest, |own, most| own.max(LEAST_SIZE * most))
        };
        sizes.iter().map(floored).collect()
    }

    /// Lengthens the period until every quantity is at rest where the chords begin and end their return; returns the
    /// remainders there. A periodic motion has no rest.
    fn decayed(
        &self,
        mut solved: Solved,
    ) -> Result<(Solved, Option<[ArmMotion; 2]>, Sizes), InversionError> {
        let problem = &self.problem;
        if problem.padding.cycles.is_some() {
            let none = solved.sizes.iter().map(|size| size.zip(size, |_, _| 0.0)).collect();
            return Ok((solved, None, none));
        }
        let initial = solved.answer.path.len();
        let linear = problem.with(SecondOrder::None, problem.cutoffs.clone());
        let is_linear = problem.second_order == SecondOrder::None;
        let tolerance = problem.analysis.tolerance();
        let mut last = f64::INFINITY;
        loop {
            let (rests, left) = left_at_rest(problem, &solved, &solved.answer)?;
            let len = solved.answer.path.len();
            // The iteration's error stays in a period of any length.
            let (open, now) = (solved.answer.motion.iteration.error, worst(&left));
            let is_still = now <= open && now > STILL * last;
            last = now;
            let small = problem.small(&solved.answer);
            let models = &solved.answer.models;
            let next = if now <= tolerance.max(small) || is_still {
                None
            } else {
                lengthened(len, initial, |len| {
                    Ok::<_, InversionError>(
                        is_linear || {
                            let nodes = Some(&solved.nodes[..]);
                            let shorter = linear.answer(models, &linear.period(len)?, nodes)?;
                            worst(&left_at_rest(&linear, &solved, &shorter)?.1) <= tolerance
                        },
                    )
                })?
            };
            if let Some(len) = next {
                solved.answer = problem.answer(models, &problem.period(len)?, None)?;
                continue;
            }
            if len > initial {
                let (finer, nodes) = refined(models, &solved.nodes)?;
                let on_finer = problem.answer(&finer, &solved.answer.path, Some(&nodes))?;
                let (own, on_finer) =
                    (solved.answer.curves(&solved.nodes), on_finer.curves(&nodes));
                solved.mesh = changes(models, &own, &on_finer, &solved.sizes);
            }
            return Ok((solved, Some(rests), left));
        }
    }

    /// The samples to write: until all torques, and that of one link's motor, stay within the tolerance of their values
    /// at rest; and the distance of each torque from rest outside, over its size. A periodic motion has the window of
    /// its cycle.
    fn window(
        &self,
        Solved { answer, sizes, .. }: &Solved,
        rests: Option<&[ArmMotion; 2]>,
    ) -> (Window, Sizes) {
        let (problem, spectrum) = (&self.problem, &answer.path.tip.spectrum);
        let motion_grid = problem.wanted.grid();
        let whole = Window { start: 0, stop: motion_grid.len as i64 - 1 };
        let Some(rests) = rests else {
            return (whole, vec![PerQuantity::default(); sizes.len()]);
        };
        let at_rest = |joint: usize| {
            rests.each_ref().map(|rest| match rest.links.get(joint) {
                Some(link) => link.bent.torque_n_m[0],
                None => answer.path.held_n(rest).unwrap_or(0.0),
            })
        };
        let beyond = |samples: &[f64], rests| answer.path.rest.beyond(samples, rests);
        let joints = sizes
            .iter()
            .enumerate()
            .map(|(joint, size)| (beyond(&answer.effort(joint), at_rest(joint)), size.torque));
        let joints: Vec<(Vec<f64>, f64)> = joints.collect();
        let drive = answer.models[0].link().drive().filter(|_| problem.is_link());
        let motor = drive.and_then(|drive| {
            let [samples, _] = answer.motor(0, answer.joint(0).rotor?)?;
            let at_rest = at_rest(0).map(|torque| torque / drive.gear_ratio);
            Some((beyond(&samples, at_rest), sizes[0].motor_torque?))
        });
        let (before, reach) = (spectrum.seam, spectrum.seam_reach());
        let each = joints.iter().chain(&motor).map(|(samples, size)| {
            PeriodicTorque { samples, before, reach }.window(
                motion_grid.len,
                motion_grid.step_s,
                problem.analysis,
                *size,
            )
        });
        let window = each.fold(whole, |all, own| Window {
            start: all.start.min(own.start),
            stop: all.stop.max(own.stop),
        });
        let outside = |(samples, size): &(Vec<f64>, f64)| {
            PeriodicTorque { samples, before, reach }.outside(&window) / size
        };
        let cut = joints.iter().map(|torque| PerQuantity {
            torque: outside(torque),
            motor_torque: motor.as_ref().map(outside),
            ..PerQuantity::default()
        });
        (window, cut.collect())
    }
}

/// Models with elements half as long, and the same places on them.
fn refined(
    models: &Models,
    probes: &[Vec<usize>],
) -> Result<(Models, Vec<Vec<usize>>), InversionError> {
    let of_link = |(model, nodes): (&Arc<dyn Model>, &Vec<usize>)| -> Vec<usize> {
        nodes.iter().map(|node| model.mesh().refined_node(*node)).collect()
    };
    let probes = models.iter().zip(probes).map(of_link).collect();
    let models = models.iter().map(|model| model.refined()).collect::<Result<_, _>>()?;
    Ok((models, probes))
}

/// Change of each quantity by halved elements, over its size.
fn changes(models: &Models, own: &[Curves], finer: &[Curves], sizes: &Sizes) -> Sizes {
    // The errors of one link reach all joints: if one link has shear, all errors fall as slowly.
    let per_change = models.iter().map(|model| model.mesh().error_per_change()).fold(1.0, f64::max);
    let pairs = own.iter().zip(finer).zip(sizes);
    pairs
        .map(|((own, finer), size)| own.apart(finer).zip(size, |off, size| per_change * off / size))
        .collect()
}

/// The largest of all errors; NaN is the largest.
fn worst(errors: &Sizes) -> f64 {
    errors.iter().map(|own| own.worst().1).fold(0.0, Size::larger)
}

/// Remainder of each quantity beyond the arm at rest where the chords begin and end their return.
fn left_at_rest(
    problem: &ArmProblem<'_>,
    Solved { nodes, sizes, .. }: &Solved,
    answer: &ArmAnswer,
) -> Result<([ArmMotion; 2], Sizes), InversionError> {
    let models = &answer.models;
    let rests = problem.at_rest(models, &answer.path)?;
    let [first, last] =
        [0, 1].map(|end: usize| curves_at_rest(models, &answer.path, (&rests[end], end), nodes));
    let reaches = answer.path.rest.reaches(problem.wanted.grid().len);
    let curves = answer.curves(nodes);
    let ends = first.into_iter().zip(last).zip(&curves).zip(sizes);
    let left = ends.map(|(((first, last), own), size)| {
        own.left_of(&[first, last], reaches).zip(size, |left, size| left / size)
    });
    Ok((rests, left.collect()))
}
