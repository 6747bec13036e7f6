use std::f64::consts::PI;

use super::any_link::any_link;
use super::any_motion::TwoMotions;
use super::solution_laws::{bending, check_finite, check_linear, check_rigid};
use super::wording::check_words;
use arbitrary::{Result, Unstructured};
use flexlink::beam::{ElementCount, Mesh, MeshPlan};
use flexlink::inverse::{Analysis, Resources, Solution, invert_motion};
use flexlink::link::{Link, LinkParts, ParameterError};
use flexlink::modal::{natural_frequencies, torque_zeros};
use flexlink::model::{KeptModes, model_of};
use flexlink::motion::{Motion, MotionColumns, TipMotion};

/// Memory that bounds the period, and so the time of one execution: 190 bytes a sample.
const MEMORY_BYTES: usize = 190 * 1024;

/// What is solved, but for the motion.
struct Problem {
    link: Link,
    plan: MeshPlan,
    analysis: Analysis,
}

/// Laws: a link that the bytes make has modes and zeros in order, and its solutions are finite,
/// linear in the motion, and rigid where the link is.
///
/// # Panics
/// If one is broken.
pub fn solve(bytes: &[u8]) {
    // Bytes that end too early make no link.
    let _ = run(&mut Unstructured::new(bytes));
}

fn run(u: &mut Unstructured) -> Result<()> {
    let parts = any_link(u)?;
    let Some((link, plan)) = meshed(parts.clone(), u.int_in_range(1..=8)?) else { return Ok(()) };
    let mesh = Mesh::new(&link, &plan).expect("a plan of the link");
    let (omegas, zeros) = (natural_frequencies(&mesh, 8), torque_zeros(&mesh, 4));
    // Law: natural frequencies and zeros are numbers above 0, in order.
    for found in [&omegas, &zeros] {
        let positive = found.iter().all(|x| x.is_finite() && *x > 0.0);
        assert!(positive && found.is_sorted(), "{found:?} of {link:?}");
    }
    let scale_s = omegas.first().map_or(1.0, |omega| 1.0 / omega);
    let motions = TwoMotions::any(u, scale_s)?;
    let problem = Problem { link, plan, analysis: any_analysis(u)? };
    let both = motions.sum([1.0, 1.0]);
    match u.int_in_range(0..=3)? {
        0 => check_scaled(&problem, &motions, u.int_in_range(-20..=20)?),
        1 => check_sum(problem, &motions, zeros.first().copied()),
        2 => check_stiff(&problem, parts, &both),
        _ => drop(solved(&problem, both)),
    }
    Ok(())
}

fn meshed(parts: LinkParts, elements: usize) -> Option<(Link, MeshPlan)> {
    let own = vec![None; parts.segments.len()];
    let meshed = || -> std::result::Result<_, ParameterError> {
        let link = Link::new(parts)?;
        let count = Some(ElementCount::Total(elements));
        let plan = MeshPlan::new(&link, &own, count, MeshPlan::DEFAULT_TOLERANCE)?;
        Ok((link, plan))
    };
    meshed().map_err(|error| check_words("", &error, None)).ok()
}

fn any_analysis(u: &mut Unstructured) -> Result<Analysis> {
    let tolerance = *u.choose(&[1e-6, 1e-4, 1e-2, 1e-10])?;
    let analysis = Analysis::new(tolerance, None, None).expect("a tolerance");
    let modes = u.int_in_range(0..=12)?;
    let analysis = analysis.keeping_modes(modes).unwrap_or(analysis);
    Ok(analysis)
}

// Law: what is solved is finite, and what is not is refused with words.
fn solved(problem: &Problem, columns: MotionColumns) -> Option<Solution> {
    let motion = TipMotion::new(columns);
    let motion = motion.map_err(|error| check_words("", &error, error.hint())).ok()?;
    let Problem { link, plan, analysis } = problem;
    let resources = Resources { memory_bytes: Some(MEMORY_BYTES), ..Resources::default() };
    let found = invert_motion(
        &link.clone().into(),
        std::slice::from_ref(plan),
        &Motion::Tip(motion),
        analysis,
        &resources,
    );
    let solution = found.map_err(|error| check_words("", &error, error.hint())).ok()?;
    check_finite(&solution);
    Some(solution)
}

// Law: a power of two, of either sign, on the motion is one on all that is solved for, to the last bit.
fn check_scaled(problem: &Problem, motions: &TwoMotions, exponent: i32) {
    let factor = -(2.0_f64.powi(exponent));
    let Some(one) = solved(problem, motions.sum([1.0, 1.0])) else { return };
    let Some(other) = solved(problem, motions.sum([factor, factor])) else { return };
    let histories = |of: &Solution| {
        [
            &of.hub().torque_n_m,
            &of.hub().angle_rad,
            &of.hub().rate_rad_s,
            &of.links[0].root_moment_n_m,
        ]
        .map(Vec::clone)
    };
    for (one, other) in histories(&one).iter().zip(&histories(&other)) {
        let other_than = |(a, b): (&f64, &f64)| (a * factor - b).abs() > 0.0;
        let different = one.iter().zip(other).position(other_than);
        assert!(different.is_none() && one.len() == other.len(), "times {factor:e}: {different:?}");
    }
}

// Law: the torque of a sum is the sum of the torques, but for round-off, on the same period.
fn check_sum(problem: Problem, motions: &TwoMotions, first_zero: Option<f64>) {
    let [first, second, both] = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|f| motions.sum(f));
    // All that decay asks for, and a step more, so that no motion asks for more than another.
    let step_s = both.time_s[1] - both.time_s[0];
    let tolerance = problem.analysis.tolerance();
    let decay_s = first_zero.map_or(0.0, |zero| (10.0 / tolerance).ln() / zero) + step_s;
    let Ok(analysis) = Analysis::new(tolerance, Some(decay_s), Some(decay_s)) else { return };
    let problem = Problem { analysis, ..problem };
    let [first, second, both] = [first, second, both].map(|motion| solved(&problem, motion));
    if let (Some(first), Some(second), Some(both)) = (first, second, both) {
        check_linear(&first, &second, &both);
    }
}

// Law: a link so stiff that bending changes its torque by 2⁻⁶⁰ at most needs the rigid torque.
fn check_stiff(problem: &Problem, mut parts: LinkParts, columns: &MotionColumns) {
    let mesh = Mesh::new(&problem.link, &problem.plan).expect("a plan of the link");
    let Ok(model) = model_of(&problem.link, mesh, KeptModes::All) else { return };
    let Some(bending) = bending(&*model) else { return };
    let nyquist_rad_s = PI / (columns.time_s[1] - columns.time_s[0]);
    let factor = (bending * nyquist_rad_s.powi(2)).max(1.0) * 2.0_f64.powi(60);
    for segment in &mut parts.segments {
        segment.bending_stiffness_n_m2 = segment.bending_stiffness_n_m2.scaled(factor);
    }
    let Ok(link) = Link::new(parts) else { return };
    let problem = Problem { link, plan: problem.plan.clone(), analysis: problem.analysis };
    if let Some(solution) = solved(&problem, columns.clone()) {
        check_rigid(&problem.link, &solution, nyquist_rad_s);
    }
}
