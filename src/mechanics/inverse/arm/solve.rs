//! The inversion of an arm: mesh, period, window and errors, up to the solution.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::answer::{ArmAnswer, curves_at_rest};
use super::moved::straying;
use super::problem::ArmProblem;
use crate::beam::{Mesh, MeshPlan};
use crate::elastica::{ArmMotion, ElasticaError, SecondOrder};
use crate::inverse::amplitudes::Probes;
use crate::inverse::curves::Curves;
use crate::inverse::inversion::invert_link;
use crate::inverse::period::{PeriodicTorque, Window};
use crate::inverse::rest::lengthened;
use crate::inverse::{
    Analysis, Band, InversionError, PerQuantity, QuantityErrors, Resources, SecondOrderFindings,
    Solution,
};
use crate::link::Arm;
use crate::modal::{real_frequency_zeros, torque_zeros};
use crate::model::{Model, check_size, model_of};
use crate::motion::{ArmPath, Cutoff, Motion};
use crate::numeric::{Size, TimeGrid};

/// Size of a quantity for a joint that hardly moves, over the largest size of any joint.
pub(super) const LEAST_SIZE: f64 = 1e-6;

/// Ratio of a longer period's remainder to the last one's above which the longer period did not help.
const STILL: f64 = 0.5;

type Models = Vec<Arc<dyn Model>>;
pub(super) type Sizes = Vec<PerQuantity<f64>>;

/// Finds the torques of all joints for the motion of an arm, or of one link; `plans` has one for each link.
///
/// # Errors
/// [`InversionError`]: impossible damping, an arm that cannot follow its path, a torque that is not finite, an automatic
/// mesh that does not converge, second-order terms that do not converge, a window too long to transform, or more memory
/// than `resources` allow.
pub fn invert_motion(
    arm: &Arm,
    plans: &[MeshPlan],
    motion: &Motion,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<Solution, InversionError> {
    match (motion, arm.links(), plans) {
        (Motion::Tip(motion), [own], [plan]) => {
            invert_link(&own.link, plan, motion, analysis, resources)
        }
        (Motion::Tip(_), [_], _) => Err(InversionError::Plans { plans: plans.len(), links: 1 }),
        (Motion::Tip(_), links, _) => Err(InversionError::OtherMotion { links: links.len() }),
        (Motion::Path(path), ..) => invert_arm(arm, plans, path, analysis, resources),
    }
}

/// [`invert_motion`] for several links.
fn invert_arm(
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
    let refusal = match solver.solution(models.clone(), first_zero_per_s) {
        Err(error @ InversionError::Elastica(ElasticaError::Diverges { .. })) => error,
        found => return found,
    };
    // Second-order terms grow where no torque moves a link's tip.
    let refused = || blocked(&models, &solver.problem.cutoffs).unwrap_or(refusal);
    if analysis.second_order().is_some() {
        return Err(refused());
    }
    // By default all terms count; first-order terms alone are the next best choice.
    let problem = solver.problem.with(SecondOrder::First, solver.problem.cutoffs.clone());
    let first = Solver { problem, plans, falls_back: true };
    match first.solution(models.clone(), first_zero_per_s) {
        Err(InversionError::Elastica(ElasticaError::Diverges { .. })) => {
            Err(InversionError::NorFirst(Box::new(refused())))
        }
        found => found,
    }
}

/// Finds the first link whose tip no torque moves at some frequency within the path's band.
fn blocked(models: &Models, cutoffs: &[Cutoff]) -> Option<InversionError> {
    let ends = cutoffs.iter().filter(|own| !own.keeps_all()).map(Cutoff::end_rad_s);
    let end_rad_s = ends.reduce(f64::max)?;
    models.iter().enumerate().find_map(|(link, model)| {
        let zero = real_frequency_zeros(model.mesh(), end_rad_s).first().copied()?;
        Some(InversionError::Blocked { link, frequency_hz: zero / TAU })
    })
}

pub(super) struct Solver<'a> {
    pub(super) problem: ArmProblem<'a>,
    plans: &'a [MeshPlan],
    /// True if the solution counts fewer terms than the caller chose.
    falls_back: bool,
}

/// The answer on fine enough meshes, and its measured errors.
pub(super) struct Solved {
    pub(super) models: Models,
    pub(super) probes: Vec<Vec<usize>>,
    pub(super) answer: ArmAnswer,
    pub(super) sizes: Sizes,
    mesh: Sizes,
}

impl Solver<'_> {
    fn solution(
        &self,
        models: Models,
        first_zero_per_s: Option<f64>,
    ) -> Result<Solution, InversionError> {
        let problem = &self.problem;
        let (arm, path) = (problem.arm, problem.path);
        let solved = self.on_mesh(models)?;
        let (solved, rests, left) = self.decayed(solved)?;
        let (window, cut) = self.window(&solved, &rests);
        let step = self.step_errors(&solved, first_zero_per_s)?;
        let input = self.input_errors(&solved)?;
        let Solved { models, answer, mesh, .. } = &solved;
        let iteration = answer.motion.iteration;
        let is_iterated = problem.second_order != SecondOrder::None;
        let error_of_iteration = is_iterated.then_some(iteration.error);
        let errors = (0..arm.links().len()).map(|joint| {
            let window = PerQuantity { torque: left[joint].torque.max(cut[joint]), ..left[joint] };
            let errors = mesh[joint].zip(&window, |mesh, window| QuantityErrors {
                mesh,
                window,
                iteration: error_of_iteration,
                ..QuantityErrors::default()
            });
            let step = step.as_ref().map(|step| step[joint]);
            let input = input.as_ref().map(|input| input[joint]);
            errors
                .with(step, |errors, step| QuantityErrors { step: Some(step), ..errors })
                .with(input, |errors, input| QuantityErrors { input: Some(input), ..errors })
        });
        let errors = errors.collect::<Vec<_>>();
        let given = path.grid();
        let grid = TimeGrid { first: window.start, len: window.len(), ..given };
        let leaves_out = problem.second_order != SecondOrder::Full && !self.falls_back;
        let left_out = || leaves_out.then(|| solved.left_out());
        // The error of the input already measures the digits' uncertainty.
        let is_settled = problem.cutoffs.iter().any(Cutoff::is_set_by_input);
        let shown = || {
            let unsettled = (!is_settled).then(|| self.unsettled(&solved)).transpose();
            (answer.links(models, &grid), answer.joints(arm, &grid, &errors), unsettled)
        };
        let (left_out, ((links, tip), joints, unsettled)) =
            match problem.refuse_memory(&[&models[..]; 3], &solved.answer.path) {
                Ok(()) => rayon::join(left_out, shown),
                Err(_) => (left_out(), shown()),
            };
        let order = problem.second_order;
        let mut found = SecondOrderFindings { order, iteration, left_out, fallback: None };
        let cutoffs = problem.cutoffs.iter().map(|own| own.omega_rad_s).filter(|o| o.is_finite());
        let cutoff_hz = cutoffs.reduce(f64::max).map(|omega| omega / TAU);
        let spectrum = &answer.path.tip.spectrum;
        let band = Band::of(spectrum, spectrum.band_len());
        // The roll-off and the turning links bring frequencies above the path's; they are small above twice its cut-off.
        let highest_hz = cutoff_hz.map_or(band.nyquist_hz, |cutoff_hz| 2.0 * cutoff_hz);
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
        Ok(solution)
    }

    /// The answer over the shortest period on meshes fine enough for the plans.
    fn on_mesh(&self, coarsest: Models) -> Result<Solved, InversionError> {
        let problem = &self.problem;
        let (arm, len) = (problem.arm, problem.shortest_len()?);
        let is_automatic = self.plans.iter().any(MeshPlan::is_automatic);
        let tolerance = MeshPlan::smallest_tolerance(self.plans);
        let mut probes: Vec<Vec<usize>> = coarsest
            .iter()
            .zip(self.plans)
            .map(|(model, plan)| Probes::of(model.mesh(), plan, problem.analysis).nodes)
            .collect();
        let mut models = coarsest;
        let path = problem.period(len)?;
        let mut known = None;
        loop {
            let (finer, finer_probes) = refined(&models, &probes)?;
            // The finer mesh of a fixed plan only measures the error: its probes suffice.
            let nodes = (!is_automatic).then_some(&finer_probes[..]);
            let mut own = || known.take().map_or_else(|| problem.answer(&models, &path, None), Ok);
            let on_finer = || problem.answer(&finer, &path, nodes);
            let (answer, finer_answer) = match problem.refuse_memory(&[&models, &finer], &path) {
                Ok(()) => rayon::join(own, on_finer),
                Err(_) => (own(), on_finer()),
            };
            let (answer, finer_answer) = (answer?, finer_answer?);
            let on_finer = finer_answer.curves(arm, &finer_probes);
            let sizes = self.sizes(&on_finer, &finer_answer);
            let own = answer.curves(arm, &probes);
            let mesh = changes(&models, &own, &on_finer, &sizes);
            let error = worst(&mesh);
            let small = problem.small(&finer_answer);
            if !is_automatic || error <= tolerance.max(small) {
                return Ok(Solved { models, probes, answer, sizes, mesh });
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
                    probes[link].clone_from(&finer_probes[link]);
                }
            }
            known = self.plans.iter().all(MeshPlan::is_automatic).then_some(finer_answer);
        }
    }

    /// Size of each quantity, the reference of its errors; for a joint that hardly moves, a share of the largest size
    /// of any joint.
    fn sizes(&self, curves: &[Curves], answer: &ArmAnswer) -> Sizes {
        let has_weight = self.problem.arm.has_weight();
        let way_m = answer.way_of_chords_m(self.problem.arm, self.problem.path.grid().len);
        let sizes: Sizes = curves.iter().map(|own| own.sizes(has_weight, way_m)).collect();
        let largest = sizes.iter().fold(sizes[0], |most, own| PerQuantity {
            torque: most.torque.max(own.torque),
            hub_angle: most.hub_angle.max(own.hub_angle),
            hub_rate: most.hub_rate.max(own.hub_rate),
            hub_acceleration: most.hub_acceleration.zip(own.hub_acceleration).map(max),
            bending_moment: most.bending_moment.zip(own.bending_moment).map(max),
            ..most
        });
        let floored = |own: &PerQuantity<f64>| PerQuantity {
            motor_torque: own.motor_torque,
            motor_rate: own.motor_rate,
            ..own.zip(&largest, |own, most| own.max(LEAST_SIZE * most))
        };
        sizes.iter().map(floored).collect()
    }

    /// Lengthens the period until every quantity is at rest where the chords begin and end their return; returns the
    /// remainders there.
    fn decayed(
        &self,
        mut solved: Solved,
    ) -> Result<(Solved, [ArmMotion; 2], Sizes), InversionError> {
        let problem = &self.problem;
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
            let next = if now <= tolerance.max(small) || is_still {
                None
            } else {
                lengthened(len, initial, |len| {
                    Ok::<_, InversionError>(
                        is_linear || {
                            let nodes = Some(&solved.probes[..]);
                            let shorter =
                                linear.answer(&solved.models, &linear.period(len)?, nodes)?;
                            worst(&left_at_rest(&linear, &solved, &shorter)?.1) <= tolerance
                        },
                    )
                })?
            };
            if let Some(len) = next {
                let path = problem.period(len)?;
                solved.answer = problem.answer(&solved.models, &path, None)?;
                continue;
            }
            if len > initial {
                let (finer, probes) = refined(&solved.models, &solved.probes)?;
                let on_finer = problem.answer(&finer, &solved.answer.path, Some(&probes))?;
                let on_finer = on_finer.curves(problem.arm, &probes);
                let own = solved.answer.curves(problem.arm, &solved.probes);
                solved.mesh = changes(&solved.models, &own, &on_finer, &solved.sizes);
            }
            return Ok((solved, rests, left));
        }
    }

    /// The samples to write: until all torques stay within the tolerance of their values at rest; and the distance of
    /// each from rest outside, over its size.
    fn window(
        &self,
        Solved { answer, sizes, .. }: &Solved,
        rests: &[ArmMotion; 2],
    ) -> (Window, Vec<f64>) {
        let (problem, spectrum) = (&self.problem, &answer.path.tip.spectrum);
        let given = problem.path.grid();
        let (before, reach) = (spectrum.seam, spectrum.seam_reach());
        let beyond: Vec<Vec<f64>> = (0..sizes.len())
            .map(|joint| {
                let at_rest = rests.each_ref().map(|rest| rest.links[joint].bent.torque_n_m[0]);
                answer.path.rest.beyond(&answer.motion.links[joint].bent.torque_n_m, at_rest)
            })
            .collect();
        let torques = || beyond.iter().map(|samples| PeriodicTorque { samples, before, reach });
        let own = torques().zip(sizes).map(|(torque, size)| {
            torque.window(given.len, given.step_s, problem.analysis, size.torque)
        });
        let window = own.fold(Window { start: 0, stop: given.len as i64 - 1 }, |all, own| Window {
            start: all.start.min(own.start),
            stop: all.stop.max(own.stop),
        });
        let outside =
            torques().zip(sizes).map(|(torque, size)| torque.outside(&window) / size.torque);
        (window, outside.collect())
    }
}

fn max((a, b): (f64, f64)) -> f64 {
    a.max(b)
}

/// Models with elements half as long, and the same places on them.
fn refined(
    models: &Models,
    probes: &[Vec<usize>],
) -> Result<(Models, Vec<Vec<usize>>), InversionError> {
    let models = models.iter().map(|model| model.refined()).collect::<Result<_, _>>()?;
    let twice = |nodes: &Vec<usize>| nodes.iter().map(|node| 2 * node).collect();
    Ok((models, probes.iter().map(twice).collect()))
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
    Solved { models, probes, sizes, .. }: &Solved,
    answer: &ArmAnswer,
) -> Result<([ArmMotion; 2], Sizes), InversionError> {
    let arm = problem.arm;
    let rests = problem.at_rest(models, &answer.path)?;
    let [first, last] = rests.each_ref().map(|rest| curves_at_rest(arm, rest, probes));
    let reaches = answer.path.rest.reaches(problem.path.grid().len);
    let curves = answer.curves(arm, probes);
    let ends = first.into_iter().zip(last).zip(&curves).zip(sizes);
    let left = ends.map(|(((first, last), own), size)| {
        own.left_of(&[first, last], reaches).zip(size, |left, size| left / size)
    });
    Ok((rests, left.collect()))
}
