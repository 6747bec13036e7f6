//! The inversion of an arm: mesh, period, window, errors, and the solution made of them.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::answer::{ArmAnswer, curves_at_rest};
use super::error::ArmError;
use super::problem::ArmProblem;
use super::solution::{ArmFindings, ArmSolution, larger};
use super::warning::ArmWarning;
use crate::beam::{Mesh, MeshPlan};
use crate::elastica::{ArmMotion, SecondOrder};
use crate::inverse::amplitudes::Probes;
use crate::inverse::curves::Curves;
use crate::inverse::diagnostics::blocked_tip;
use crate::inverse::period::{Padding, PeriodicTorque, Window};
use crate::inverse::{
    Analysis, InversionError, PerQuantity, Quantity, QuantityErrors, Resources, ShareOf, Unwatched,
    Warning,
};
use crate::link::Arm;
use crate::modal::{NOTICEABLE, REPORTED_MODES, Thickness, natural_frequencies, torque_zeros};
use crate::model::{Model, check_size, model_of};
use crate::motion::{ArmPath, Cutoff};
use crate::numeric::{TimeGrid, largest, largest_difference};

/// A period is lengthened to at most this many samples, or to four times what it began with.
const LENGTHENED: usize = 1 << 15;

/// What a quantity of a joint that hardly moves is measured by, over the largest one of any joint.
const LEAST_SIZE: f64 = 1e-6;

/// Error of mesh or step from which on the user is warned.
const COARSE: f64 = 1e-2;

/// Change by an iteration, over that by the one before, from which on the user is warned.
const SLOW: f64 = 0.7;

/// Change of a torque by twice the tip's tolerance from which on the user is warned.
const UNSETTLED: f64 = 0.03;

/// Change of a torque by terms that were left out from which on the user is warned.
const LEFT_OUT: f64 = 1e-4;

/// Sine of the elbow's angle below which the user is warned.
const NEARLY_STRETCHED: f64 = 0.15;

type Models = Vec<Arc<dyn Model>>;
type Sizes = Vec<PerQuantity<f64>>;

/// Finds the torques of all joints that make the tip of an arm follow its path, or its links their directions; `plans`
/// has one for each link.
///
/// # Errors
/// [`ArmError`]: a path that the arm cannot follow, or an inversion that is refused as that of one link is.
pub fn invert_arm(
    arm: &Arm,
    plans: &[MeshPlan],
    path: &ArmPath,
    analysis: &Analysis,
    resources: &Resources<'_>,
) -> Result<ArmSolution, ArmError> {
    let links = arm.links().len();
    if plans.len() != links {
        return Err(ArmError::Plans { plans: plans.len(), links });
    }
    let mut models = Models::new();
    for (own, plan) in arm.links().iter().zip(plans) {
        let mesh = Mesh::new(&own.link, plan).map_err(InversionError::from)?;
        check_size(&own.link, 2 * mesh.elements().len(), 2).map_err(InversionError::from)?;
        let model = model_of(&own.link, mesh, analysis.kept_modes());
        models.push(model.map_err(InversionError::from)?);
    }
    let first_zero_per_s = models
        .iter()
        .filter_map(|model| torque_zeros(model.mesh(), 1).first().copied())
        .reduce(f64::min);
    let problem = ArmProblem::of(arm, path, (analysis, *resources), first_zero_per_s)?;
    let solver = Solver { problem, plans };
    solver.solution(models, first_zero_per_s)
}

struct Solver<'a> {
    problem: ArmProblem<'a>,
    plans: &'a [MeshPlan],
}

/// The answer on meshes that are fine enough, and what was measured of it.
struct Solved {
    models: Models,
    probes: Vec<Vec<usize>>,
    answer: ArmAnswer,
    sizes: Sizes,
    mesh: Sizes,
}

impl Solver<'_> {
    fn solution(
        &self,
        models: Models,
        first_zero_per_s: Option<f64>,
    ) -> Result<ArmSolution, ArmError> {
        let problem = &self.problem;
        let (arm, path) = (problem.arm, problem.path);
        let solved = self.on_mesh(models)?;
        let (solved, rests, left) = self.decayed(solved)?;
        let window = self.window(&solved, &rests);
        let step = self.step_errors(&solved, first_zero_per_s)?;
        let Solved { models, answer, sizes, mesh, .. } = &solved;
        let iteration = answer.motion.iteration;
        let is_iterated = problem.second_order != SecondOrder::None;
        let error_of_iteration = is_iterated.then_some(iteration.error);
        let errors: Vec<PerQuantity<QuantityErrors>> = (0..arm.links().len())
            .map(|joint| {
                let errors = mesh[joint].zip(&left[joint], |mesh, window| QuantityErrors {
                    mesh,
                    window,
                    iteration: error_of_iteration,
                    ..QuantityErrors::default()
                });
                let step = step.as_ref().map(|step| step[joint]);
                errors.with(step, |errors, step| QuantityErrors { step: Some(step), ..errors })
            })
            .collect();
        let given = path.grid();
        let grid = TimeGrid { first: window.start, len: window.len(), ..given };
        let (links, tip) = answer.links(models, &grid);
        let way_m = way_m(&tip);
        let tip_error = tip_error_m(answer, path) / way_m;
        let findings = ArmFindings {
            order: problem.second_order,
            iteration,
            left_out: self.left_out(&solved),
        };
        let cutoff = problem.cutoffs.iter().map(|own| own.omega_rad_s).filter(|o| o.is_finite());
        let mut solution = ArmSolution {
            arm: arm.clone(),
            path: path.clone(),
            analysis: *problem.analysis,
            grid,
            joints: answer.joints(arm, &grid),
            links,
            tip,
            way_m,
            tip_error,
            errors,
            first_zero_per_s,
            period_s: answer.period.spectrum.period_s(),
            cutoff_hz: cutoff.reduce(f64::max).map(|omega| omega / TAU),
            findings,
            warnings: Vec::new(),
            models: models.clone(),
        };
        if solution.joints.iter().any(|joint| joint.torque_n_m.iter().any(|t| !t.is_finite())) {
            return Err(InversionError::OutOfRange { peak_n_m: f64::NAN }.into());
        }
        solution.warnings = self.warnings(&solved, &solution, sizes)?;
        Ok(solution)
    }

    /// The answer over the shortest period on meshes that are fine enough for the plans.
    fn on_mesh(&self, coarsest: Models) -> Result<Solved, ArmError> {
        let problem = &self.problem;
        let (arm, len) = (problem.arm, problem.shortest_len()?);
        let is_automatic = self.plans.iter().any(MeshPlan::is_automatic);
        let tolerance = self.plans.iter().map(MeshPlan::tolerance).fold(1.0, f64::min);
        let mut probes: Vec<Vec<usize>> = coarsest
            .iter()
            .zip(self.plans)
            .map(|(model, plan)| Probes::of(model.mesh(), plan, problem.analysis).nodes)
            .collect();
        let mut models = coarsest;
        let mut answer = problem.answer(&models, len)?;
        loop {
            let (finer, finer_probes) = refined(&models, &probes)?;
            let finer_answer = problem.answer(&finer, len)?;
            let on_finer = finer_answer.curves(arm, &finer_probes);
            let sizes = self.sizes(&on_finer, &finer_answer);
            let own = answer.curves(arm, &probes);
            let mesh = changes(&models, &own, &on_finer, &sizes);
            let error = worst(&mesh);
            if !is_automatic || error <= tolerance {
                return Ok(Solved { models, probes, answer, sizes, mesh });
            }
            let elements: usize = models.iter().map(|model| model.mesh().elements().len()).sum();
            let most: usize = finer.iter().map(|model| model.most_elements()).min().unwrap_or(0);
            if finer.iter().any(|model| 2 * model.mesh().elements().len() > most) {
                return Err(InversionError::NotConverged { error, elements, tolerance }.into());
            }
            // A link whose number of elements is given keeps it.
            for (link, plan) in self.plans.iter().enumerate() {
                if plan.is_automatic() {
                    models[link] = Arc::clone(&finer[link]);
                    probes[link].clone_from(&finer_probes[link]);
                }
            }
            answer = if self.plans.iter().all(MeshPlan::is_automatic) {
                finer_answer
            } else {
                problem.answer(&models, len)?
            };
        }
    }

    /// What errors of each quantity are a share of; of a joint that hardly moves, of the largest one of any.
    fn sizes(&self, curves: &[Curves], answer: &ArmAnswer) -> Sizes {
        let has_weight = self.problem.arm.has_weight();
        let way_m = way_of_chords_m(answer, self.problem.path.grid().len);
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

    /// Lengthens the period until every quantity has come to rest where the chords begin and end their return; returns
    /// what is left there.
    fn decayed(&self, mut solved: Solved) -> Result<(Solved, [ArmMotion; 2], Sizes), ArmError> {
        let problem = &self.problem;
        let initial = solved.answer.period.spectrum.pair.len();
        let longer = |len: usize| {
            let longer = Padding::lengthened(len, initial);
            longer.filter(|len| *len <= LENGTHENED.max(4 * initial))
        };
        let linear = problem.with(SecondOrder::None, problem.cutoffs.clone());
        let tolerance = problem.analysis.tolerance();
        loop {
            let (rests, left) = self.left(problem, &solved, &solved.answer)?;
            let len = solved.answer.period.spectrum.pair.len();
            let next = longer(len).filter(|_| worst(&left) > tolerance);
            let Some(mut next) = next else {
                if len > initial {
                    let (finer, probes) = refined(&solved.models, &solved.probes)?;
                    let on_finer = problem.answer(&finer, len)?.curves(problem.arm, &probes);
                    let own = solved.answer.curves(problem.arm, &solved.probes);
                    solved.mesh = changes(&solved.models, &own, &on_finer, &solved.sizes);
                }
                return Ok((solved, rests, left));
            };
            // Where the linear torques have not decayed, those with second-order terms have not either, most times.
            while let Some(longer) =
                longer(next).filter(|_| problem.second_order != SecondOrder::None)
            {
                let shorter = linear.answer(&solved.models, next)?;
                if worst(&self.left(&linear, &solved, &shorter)?.1) <= tolerance {
                    break;
                }
                next = longer;
            }
            solved.answer = problem.answer(&solved.models, next)?;
        }
    }

    /// What is left of each quantity where the chords begin and end their return, beyond the arm at rest.
    fn left(
        &self,
        problem: &ArmProblem<'_>,
        Solved { models, probes, sizes, .. }: &Solved,
        answer: &ArmAnswer,
    ) -> Result<([ArmMotion; 2], Sizes), ArmError> {
        let arm = problem.arm;
        let rests = problem.at_rest(models, answer)?;
        let [first, last] = rests.each_ref().map(|rest| curves_at_rest(arm, rest, probes));
        let reaches = answer.rest.reaches(problem.path.grid().len);
        let curves = answer.curves(arm, probes);
        let ends = first.into_iter().zip(last).zip(&curves).zip(sizes);
        let left = ends.map(|(((first, last), own), size)| {
            own.left_of(&[first, last], reaches).zip(size, |left, size| left / size)
        });
        Ok((rests, left.collect()))
    }

    /// The samples to write: until all torques stay within the tolerance of what they are at rest.
    fn window(&self, Solved { answer, sizes, .. }: &Solved, rests: &[ArmMotion; 2]) -> Window {
        let (problem, spectrum) = (&self.problem, &answer.period.spectrum);
        let given = problem.path.grid();
        let mut all: Option<Window> = None;
        for (joint, size) in sizes.iter().enumerate() {
            let at_rest = rests.each_ref().map(|rest| rest.links[joint].bent.torque_n_m[0]);
            let torque_n_m = &answer.motion.links[joint].bent.torque_n_m;
            let samples = answer.rest.beyond(torque_n_m, at_rest);
            let (before, reach) = (spectrum.seam, spectrum.seam_reach());
            let torque = PeriodicTorque { samples: &samples, before, reach };
            let own = torque.window(given.len, given.step_s, problem.analysis, size.torque);
            all = Some(all.map_or(own, |all| Window {
                start: all.start.min(own.start),
                stop: all.stop.max(own.stop),
            }));
        }
        all.unwrap_or(Window { start: 0, stop: given.len as i64 - 1 })
    }

    /// What half the step changes of each quantity, where every frequency of the samples is solved or second-order terms
    /// reach beyond what they resolve; none where the path cannot be sampled twice as often.
    fn step_errors(
        &self,
        Solved { models, probes, answer, sizes, .. }: &Solved,
        first_zero_per_s: Option<f64>,
    ) -> Result<Option<Sizes>, ArmError> {
        let problem = &self.problem;
        let keeps_all = problem.analysis.tip_tolerance() == 0.0;
        if !answer.motion.iteration.exceeds_step && !keeps_all {
            return Ok(None);
        }
        let Ok(path) = problem.path.twice_as_often() else { return Ok(None) };
        let resources = Resources { watch: &Unwatched, ..problem.resources() };
        let (arm, given) = (problem.arm, problem.path.grid().len);
        let finer = ArmProblem::of(arm, &path, (problem.analysis, resources), first_zero_per_s)?;
        let found = finer.answer(models, 2 * answer.period.spectrum.pair.len())?;
        let own = answer.curves_of_motion(arm, probes, given);
        let finer = found.curves_of_motion(arm, probes, 2 * given - 1);
        let pairs = own.iter().zip(&finer).zip(sizes);
        let errors = pairs.map(|((own, finer), size)| {
            own.apart_from_finer(finer).zip(size, |off, size| off / size)
        });
        Ok(Some(errors.collect()))
    }

    /// What all terms change of a torque at most, over its size, where fewer were asked for; none where they are refused.
    fn left_out(&self, Solved { models, answer, sizes, .. }: &Solved) -> Option<Option<f64>> {
        let problem = &self.problem;
        if problem.second_order == SecondOrder::Full {
            return None;
        }
        let all = problem.with(SecondOrder::Full, problem.cutoffs.clone());
        let full = all.answer(models, answer.period.spectrum.pair.len()).ok();
        Some(full.map(|full| largest_change(answer, &full, sizes)))
    }

    fn warnings(
        &self,
        solved: &Solved,
        solution: &ArmSolution,
        sizes: &Sizes,
    ) -> Result<Vec<ArmWarning>, ArmError> {
        let problem = &self.problem;
        let tolerance = problem.analysis.tolerance();
        let of = if problem.arm.has_weight() { ShareOf::Range } else { ShareOf::Peak };
        let mut warnings = Vec::new();
        let shortfall = problem.cutoffs.iter().find_map(|own| own.shortfall);
        if let Some(shortfall) = shortfall {
            let (share, tolerance) = (solution.tip_error, problem.analysis.tip_tolerance());
            warnings.push(ArmWarning::Arm(Warning::TipMissed { share, tolerance, shortfall }));
        }
        if let Some((sample, sine)) = problem.least_sine().filter(|own| own.1 < NEARLY_STRETCHED) {
            let time_s = problem.path.grid().time_s(sample);
            warnings.push(ArmWarning::NearlyStretched { sine, time_s });
        }
        let slow = solution.findings.iteration.contraction.filter(|factor| *factor > SLOW);
        let slow = slow.map(|contraction| Warning::SlowIteration { contraction });
        let left_out = solution.findings.left_out;
        let left_out = left_out.filter(|share| share.is_none_or(|share| share > LEFT_OUT));
        let left_out = left_out.map(|share| Warning::SecondOrderLeftOut { share });
        warnings.extend(slow.into_iter().chain(left_out).map(ArmWarning::Arm));
        let unsettled = self.unsettled(solved, sizes)?;
        for (joint, errors) in solution.errors.iter().enumerate() {
            let worst = |kind: &dyn Fn(QuantityErrors) -> f64| {
                let all = errors.zip(errors, |own, _| kind(own));
                all.worst()
            };
            let (quantity, share) = worst(&|own| own.window);
            let mut found = Vec::new();
            found.extend((share > tolerance).then_some(Warning::InexactWindow {
                of,
                quantity,
                share,
                tolerance,
            }));
            let (quantity, error) = worst(&|own| own.mesh);
            let coarse = Warning::CoarseMesh { of, quantity, error };
            found.extend((error > COARSE).then_some(coarse));
            let (quantity, share) = worst(&|own| own.step.unwrap_or(0.0));
            let coarse = Warning::CoarseStep { of, quantity, share };
            found.extend((share > COARSE).then_some(coarse));
            let (quantity, share) = worst(&|own| own.iteration.unwrap_or(0.0));
            let inexact = Warning::InexactIteration { quantity, share, tolerance };
            found.extend((share > tolerance).then_some(inexact));
            let mesh = solved.models[joint].mesh();
            found.extend(blocked_tip(mesh, &solved.answer.period.spectrum, tolerance));
            found.extend(unsettled[joint]);
            found.extend(self.thick_link(solved, joint));
            warnings.extend(found.into_iter().map(|warning| ArmWarning::Joint { joint, warning }));
        }
        Ok(warnings)
    }

    /// For each joint a torque whose peak changes where the tip's tolerance is twice as large.
    fn unsettled(
        &self,
        Solved { models, answer, .. }: &Solved,
        sizes: &Sizes,
    ) -> Result<Vec<Option<Warning>>, ArmError> {
        let problem = &self.problem;
        let looser: Vec<Cutoff> = problem
            .cutoffs
            .iter()
            .map(|own| Cutoff { omega_rad_s: own.looser_rad_s, ..*own })
            .collect();
        let len = answer.period.spectrum.pair.len();
        let linear = |cutoffs| problem.with(SecondOrder::None, cutoffs).answer(models, len);
        let (own, looser) = (linear(problem.cutoffs.clone())?, linear(looser)?);
        let peaks = sizes.iter().enumerate().map(|(joint, size)| {
            let [own, looser] =
                [&own, &looser].map(|answer| largest(&answer.motion.links[joint].bent.torque_n_m));
            let is_unsettled = (own - looser).abs() > UNSETTLED * size.torque;
            is_unsettled.then_some(Warning::UnsettledTorque {
                quantity: Quantity::Torque,
                peak_n_m: own,
                looser_n_m: looser,
            })
        });
        Ok(peaks.collect())
    }

    /// The share by which shear and rotary inertia, which the theory leaves out, change a link's torque, where that is
    /// noticeable.
    fn thick_link(&self, Solved { models, answer, .. }: &Solved, joint: usize) -> Option<Warning> {
        let model = &models[joint];
        let (thickness, mesh) = (Thickness::known(model.link()), model.mesh());
        if thickness.is_slender(mesh, REPORTED_MODES) {
            return None;
        }
        let mut torque = answer.torque_amplitudes_n_m(joint);
        torque[0] = 0.0.into();
        let omegas = &answer.period.spectrum.omegas_rad_s;
        let band = answer.period.spectrum.band_len().min(torque.len());
        let modes = natural_frequencies(mesh, REPORTED_MODES);
        let torque = (&omegas[..band], &torque[..band]);
        let share = thickness.torque_change(mesh, model.law(), &modes, torque);
        (share > NOTICEABLE).then_some(Warning::ThickLink { share })
    }
}

fn max((a, b): (f64, f64)) -> f64 {
    a.max(b)
}

/// The models with elements half as long, and the same places on them.
fn refined(
    models: &Models,
    probes: &[Vec<usize>],
) -> Result<(Models, Vec<Vec<usize>>), InversionError> {
    let models = models.iter().map(|model| model.refined()).collect::<Result<_, _>>()?;
    let twice = |nodes: &Vec<usize>| nodes.iter().map(|node| 2 * node).collect();
    Ok((models, probes.iter().map(twice).collect()))
}

/// What halved elements change of each quantity, over its size.
fn changes(models: &Models, own: &[Curves], finer: &[Curves], sizes: &Sizes) -> Sizes {
    // The errors of one link reach all joints: where one has shear, all fall as slowly.
    let per_change = models.iter().map(|model| model.mesh().error_per_change()).fold(1.0, f64::max);
    let pairs = own.iter().zip(finer).zip(sizes);
    pairs
        .map(|((own, finer), size)| own.apart(finer).zip(size, |off, size| per_change * off / size))
        .collect()
}

/// The largest of all errors; NaN is the largest.
fn worst(errors: &Sizes) -> f64 {
    errors.iter().map(|own| own.worst().1).fold(0.0, larger)
}

/// Largest difference of two answers' torques, over their sizes.
fn largest_change(own: &ArmAnswer, other: &ArmAnswer, sizes: &Sizes) -> f64 {
    let torques = sizes.iter().enumerate().map(|(joint, size)| {
        let [own, other] = [own, other]
            .map(|answer| own.rest.outside_return(&answer.motion.links[joint].bent.torque_n_m));
        largest_difference(&own, &other) / size.torque
    });
    torques.fold(0.0, larger)
}

/// Largest distance in m of the tip from where it starts.
fn way_m([x, y]: &[[Vec<f64>; 3]; 2]) -> f64 {
    let far = |(x_m, y_m): (&f64, &f64)| {
        let [dx, dy] = [x_m - x[0][0], y_m - y[0][0]];
        (dx * dx + dy * dy).sqrt()
    };
    x[0].iter().zip(&y[0]).map(far).fold(0.0, f64::max)
}

/// The same of the rigid arm over the samples of its path.
fn way_of_chords_m(answer: &ArmAnswer, given: usize) -> f64 {
    let mut tip = [[0, 1, 2].map(|_| vec![0.0; given]), [0, 1, 2].map(|_| vec![0.0; given])];
    for (chord, link) in answer.rigid.iter().zip(&answer.motion.links) {
        // Rigid, a chord is as long as it is at most.
        let length_m = largest(&link.chord_length_m);
        for k in 0..given {
            tip[0][0][k] += length_m * libm::cos(chord[0][k]);
            tip[1][0][k] += length_m * libm::sin(chord[0][k]);
        }
    }
    way_m(&tip)
}

/// How far the solved tip is at most from the wanted one, in m.
fn tip_error_m(answer: &ArmAnswer, path: &ArmPath) -> f64 {
    match (path.prescribed(), &answer.errors_m[..]) {
        (crate::motion::Prescribed::Tip, [x, y, ..]) => (x * x + y * y).sqrt(),
        // The tip is the sum of the chords: L δθ of each.
        (_, errors_m) => errors_m.iter().sum(),
    }
}
