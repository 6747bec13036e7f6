//! A second integrator, which knows no modes: assembled matrices and Newmark's average acceleration.

use std::f64::consts::PI;
use std::num::NonZeroUsize;

use faer::Mat;
use faer::linalg::solvers::Solve;
use flexlink::beam::MeshPlan;
use flexlink::link::{Damping, Hub, Link, LumpedMass, Payload};
use flexlink::response::{Feedback, HubReference, Interpolation, Play, Played, Torque};

use super::assembly::Assembly;
use super::{damping, difference, link, plan_of, played, times, torque};

/// `M ẍ + C ẋ + K x = e_θ u` on `(θ, v_1, φ_1, …)`.
struct System {
    mass: Mat<f64>,
    damping: Mat<f64>,
    stiffness: Mat<f64>,
}

/// Histories of hub angle, of the displacement of a node near the middle, and of the tip.
type Motion = [Vec<f64>; 3];

impl System {
    fn of(link: &Link, simulation: &Played, feedback: Option<&Feedback>) -> Self {
        let nodes_m = simulation.mesh().nodes_m();
        let [mass, mut stiffness] = Assembly::of_link(link, nodes_m).mass_and_stiffness();
        let mut damping = match link.damping() {
            Damping::Rayleigh { alpha_per_s, beta_s } => {
                faer::Scale(*alpha_per_s) * &mass + faer::Scale(*beta_s) * &stiffness
            }
            Damping::Modal { ratios } => {
                damping::modal(&mass, &stiffness, |k, _| ratios[(k - 1).min(ratios.len() - 1)])
            }
            other => panic!("{other:?}"),
        };
        damping[(0, 0)] += link.hub().viscous_friction_n_m_s_rad;
        if let Some(feedback) = feedback {
            stiffness[(0, 0)] += feedback.stiffness_n_m_rad();
            damping[(0, 0)] += feedback.damping_n_m_s_rad();
        }
        Self { mass, damping, stiffness }
    }

    /// From rest, in `parts` steps between neighbouring samples of a torque that is straight
    /// between them.
    fn newmark(&self, torque: &[f64], step_s: f64, parts: u32, node: usize) -> Motion {
        let size = self.mass.nrows();
        let h = step_s / f64::from(parts);
        let effective = faer::Scale(4.0 / (h * h)) * &self.mass
            + faer::Scale(2.0 / h) * &self.damping
            + &self.stiffness;
        let inverse = effective.partial_piv_lu().solve(Mat::<f64>::identity(size, size));
        let load = |u: f64| Mat::from_fn(size, 1, |row, _| if row == 0 { u } else { 0.0 });
        let (mut x, mut v) = (Mat::<f64>::zeros(size, 1), Mat::<f64>::zeros(size, 1));
        let mut a = self.mass.partial_piv_lu().solve(load(torque[0]));
        let mut motion: Motion = Default::default();
        let mut keep = |x: &Mat<f64>| {
            for (history, row) in motion.iter_mut().zip([0, 2 * node - 1, size - 2]) {
                history.push(x[(row, 0)]);
            }
        };
        keep(&x);
        for ends in torque.windows(2) {
            for part in 1..=parts {
                let u = ends[0] + (ends[1] - ends[0]) * f64::from(part) / f64::from(parts);
                let known_a = faer::Scale(4.0 / (h * h)) * &x + faer::Scale(4.0 / h) * &v + &a;
                let known_v = faer::Scale(2.0 / h) * &x + &v;
                let right = load(u) + &self.mass * &known_a + &self.damping * &known_v;
                let next = &inverse * right;
                a = faer::Scale(4.0 / (h * h)) * &next - known_a;
                v = faer::Scale(2.0 / h) * &next - known_v;
                x = next;
            }
            keep(&x);
        }
        motion
    }
}

/// A link with all that a link can have.
fn loaded(damping: Damping) -> Link {
    link(|parts| {
        parts.hub = Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.08 };
        parts.masses = vec![
            LumpedMass { at_m: 0.6, mass_kg: 0.2, inertia_kg_m2: 2e-3 },
            LumpedMass { at_m: 1.55, mass_kg: 0.05, inertia_kg_m2: 1e-4 },
        ];
        parts.payload = Payload { mass_kg: 0.2, inertia_kg_m2: 1e-3, offset_m: 0.04 };
        parts.damping = damping;
    })
}

const LAST_S: f64 = 0.9;
const UNTIL_S: f64 = 1.2;

/// Two unequal pulses against each other, smooth in an odd power above 1.
fn pulses(step_s: f64, steps: u32, power: i32) -> Torque {
    torque(step_s, steps, |t| {
        let size = if t < 0.5 * LAST_S { 1.0 } else { 0.8 };
        size * (2.0 * PI * t / LAST_S).sin().powi(power)
    })
}

/// Largest difference of hub, node and tip over the peak of each.
fn distances(found: &Motion, expected: &Motion) -> Vec<f64> {
    found.iter().zip(expected).map(|(a, b)| difference(a, b)).collect()
}

/// What remains of the h² error of the coarser of two steps in the finer one, taken out.
fn extrapolated(coarse: &Motion, fine: &Motion) -> Motion {
    [0, 1, 2].map(|k| coarse[k].iter().zip(&fine[k]).map(|(a, b)| (4.0 * b - a) / 3.0).collect())
}

/// The simulation, and Newmark's with its step halved five times.
struct Comparison {
    simulation: Played,
    /// Distances of each step.
    errors: Vec<Vec<f64>>,
    /// Distances with the h² error taken out, of each pair of steps.
    limits: Vec<Vec<f64>>,
}

impl Comparison {
    fn of(link: &Link, plan: &MeshPlan, torque: &Torque, feedback: Option<&Feedback>) -> Self {
        let interpolation = Interpolation::Linear;
        let until_s = Some(UNTIL_S);
        let play = Play {
            interpolation,
            until_s,
            feedback: feedback.map_or(&[], std::slice::from_ref),
            ..Play::of(torque)
        };
        let simulation = played(link, plan, &play);
        let node = simulation.mesh().nodes_m().len() / 2;
        let middle =
            simulation.displacements_m(&[node], NonZeroUsize::MIN).unwrap().samples.concat();
        let expected =
            [simulation.hub().angle_rad.clone(), middle, simulation.tip[0].displacement_m.clone()];
        let system = System::of(link, &simulation, feedback);
        let input = input(torque, feedback, simulation.grid.len);
        let step_s = torque.grid().step_s;
        let motions: Vec<Motion> =
            [1, 2, 4, 8, 16].map(|parts| system.newmark(&input, step_s, parts, node)).into();
        let pairs = motions.windows(2).map(|pair| extrapolated(&pair[0], &pair[1]));
        Self {
            errors: motions.iter().map(|motion| distances(motion, &expected)).collect(),
            limits: pairs.map(|limit| distances(&limit, &expected)).collect(),
            simulation,
        }
    }

    /// Fails unless the orders observed over the first three halvings are 2, and the limit of
    /// vanishing steps, taken from one of the pairs, is the simulation.
    #[track_caller]
    fn assert_converges(&self, what: &str, pair: usize, tolerance: f64) {
        for (coarse, fine) in self.errors.iter().zip(&self.errors[1..4]) {
            for (coarse, fine) in coarse.iter().zip(fine) {
                let order = (coarse / fine).log2();
                assert!((1.97..2.03).contains(&order), "{what}: order {order} at {fine:e}");
            }
        }
        for limit in &self.limits[pair] {
            assert!(*limit < tolerance, "{what}: {limit:e} in the limit");
        }
    }
}

/// Torque and what feedback wants, held after the last sample.
fn input(torque: &Torque, feedback: Option<&Feedback>, len: usize) -> Vec<f64> {
    let mut input = torque.torque_n_m().to_vec();
    let mut hold = 0.0;
    if let Some(feedback) = feedback {
        let [kp, kd] = [feedback.stiffness_n_m_rad(), feedback.damping_n_m_s_rad()];
        for (k, input) in input.iter_mut().enumerate() {
            let [angle, rate] = reference(torque.grid().time_s(k));
            *input += kp * (angle - reference(0.0)[0]) + kd * rate;
        }
        hold = kp * (reference(LAST_S)[0] - reference(0.0)[0]);
    }
    input.resize(len, hold);
    input
}

/// A hub angle and its rate that the hub is held to, from 0.2 rad up to 0.5 rad.
fn reference(t: f64) -> [f64; 2] {
    let phase = PI * t / LAST_S;
    let angle = 0.2 + 0.3 * (phase - 0.5 * (2.0 * phase).sin()) / PI;
    [angle, 0.3 / LAST_S * (1.0 - (2.0 * phase).cos())]
}

fn laws() -> [Damping; 2] {
    let rayleigh = Damping::Rayleigh { alpha_per_s: 0.3, beta_s: 1e-3 };
    [rayleigh, Damping::Modal { ratios: vec![0.01, 0.05, 0.02] }]
}

/// Orders observed: 1.991 to 2.001; the limit within 1e-9, where Newmark's own round-off begins.
#[test]
fn with_all_modes_of_the_mesh_newmarks_limit_is_the_simulation() {
    for law in laws() {
        let link = loaded(law.clone());
        let found = Comparison::of(&link, &plan_of(&link, 7), &pulses(2e-3, 450, 1), None);
        assert_eq!(
            (
                found.simulation.modes().unwrap().selection.modes,
                found.simulation.modes().unwrap().selection.of
            ),
            (14, 14)
        );
        found.assert_converges(law.name(), 2, 5e-9);
    }
}

/// A torque smooth enough for 12 of 40 modes; the limit within 1.6e-8, a sixteenth of what half as
/// many steps leave: it is Newmark's, not that of modes left out.
#[test]
fn with_few_modes_of_a_finer_mesh_newmarks_limit_is_the_simulation() {
    for law in laws() {
        let link = loaded(law.clone());
        let found = Comparison::of(&link, &plan_of(&link, 20), &pulses(1e-2, 90, 5), None);
        let selection = found.simulation.modes().unwrap().selection;
        assert!(selection.modes < 20 && selection.of == 40, "{selection:?}");
        found.assert_converges(law.name(), 3, 1e-7);
    }
}

/// Orders observed: 1.991 to 2.001; the limit within 5e-10.
#[test]
fn with_feedback_newmarks_limit_is_the_simulation() {
    let torque = pulses(2e-3, 450, 5);
    let time_s = times(2e-3, 450);
    let column = |of: usize| -> Vec<f64> { time_s.iter().map(|t| reference(*t)[of]).collect() };
    let reference = HubReference::new(&time_s, column(0), Some(column(1))).unwrap();
    let feedback = Feedback::new(15.0, 2.0, reference).unwrap();
    for law in laws() {
        let link = loaded(law.clone());
        let found = Comparison::of(&link, &plan_of(&link, 7), &torque, Some(&feedback));
        found.assert_converges(law.name(), 2, 5e-9);
    }
}
