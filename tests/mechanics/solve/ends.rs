//! Motions that repeat, or whose tip moves at their ends, against longer ones from rest to rest.

use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;

use flexlink::beam::MeshPlan;
use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, InversionError, RefusedEnds, Solution, invert};
use flexlink::link::{Damping, Drive, Gravity, Hub, Link, LinkParts, Payload, Segment};
use flexlink::model::{Dense, KeptModes, Model, model_of};
use flexlink::motion::{Ends, MotionColumns, MotionError, TipMotion};
use num_complex::Complex64;

use crate::common::{displaced, mesh_of, plan_of};
use crate::recordings::ninth;

const CYCLE_S: f64 = 1.3;

fn parts(damping: &Damping) -> LinkParts {
    let hub = Hub { inertia_kg_m2: 0.02, viscous_friction_n_m_s_rad: 0.05, ..Hub::default() };
    let payload = Payload { mass_kg: 0.1, ..Payload::default() };
    LinkParts {
        segments: vec![Segment::uniform(1.1, 12.0, 0.4)],
        hub,
        payload,
        damping: damping.clone(),
        ..LinkParts::default()
    }
}

fn solved(parts: &LinkParts, motion: &TipMotion) -> Result<Solution, InversionError> {
    let link = Link::new(parts.clone()).expect("a link");
    let plan = plan_of(&link, 10);
    let analysis = Analysis::new(1e-8, None, None).expect("a tolerance");
    let analysis = analysis.with_tip_tolerance(1e-9).expect("a tolerance");
    invert(&link, &plan, motion, &analysis)
}

/// Displacement, velocity and acceleration at a share of a cycle that starts at 0 and travels by so much.
fn cycle(share: f64, travel_m: f64) -> [f64; 3] {
    let harmonics = [(1.0, 0.05, 0.4), (2.0, 0.02, 1.1), (3.0, 0.01, 2.0)];
    let at = |share: f64| {
        let mut all = [travel_m * share, travel_m / CYCLE_S, 0.0];
        for (order, size, phase) in harmonics {
            let (omega, angle) = (TAU * order / CYCLE_S, TAU * order * share + phase);
            all[0] += size * angle.cos();
            all[1] -= size * omega * angle.sin();
            all[2] -= size * omega * omega * angle.cos();
        }
        all
    };
    let [displacement, velocity, acceleration] = at(share);
    [displacement - at(0.0)[0], velocity, acceleration]
}

#[derive(Clone, Copy, PartialEq)]
enum Given {
    Displacement,
    Acceleration,
}

fn columns(step_s: f64, samples: &[[f64; 3]], given: Given, with_velocity: bool) -> MotionColumns {
    let column = |k: usize| Some(samples.iter().map(|all| all[k]).collect());
    MotionColumns {
        time_s: (0..samples.len()).map(|k| k as f64 * step_s).collect(),
        displacement_m: column(0).filter(|_| given == Given::Displacement),
        velocity_m_s: column(1).filter(|_| with_velocity),
        acceleration_m_s2: column(2).filter(|_| given == Given::Acceleration),
    }
}

/// Integral of a velocity from the first time to each, by Simpson's rule.
fn integral(times_s: &[f64], velocity: impl Fn(f64) -> f64) -> Vec<f64> {
    const PARTS: u32 = 24;
    let mut sum = 0.0;
    let piece = |ends: &[f64]| {
        let h = (ends[1] - ends[0]) / f64::from(PARTS);
        for k in 0..PARTS {
            let from = ends[0] + f64::from(k) * h;
            sum += h / 6.0 * (velocity(from) + 4.0 * velocity(from + 0.5 * h) + velocity(from + h));
        }
        sum
    };
    std::iter::once(0.0).chain(times_s.windows(2).map(piece)).collect()
}

/// So many cycles, begun and ended smoothly over four of them each, from rest to rest.
fn repeated(samples: u32, cycles: u32, travel_m: f64) -> TipMotion {
    let step_s = CYCLE_S / f64::from(samples);
    let times_s: Vec<f64> = (0..=samples * cycles).map(|k| step_s * f64::from(k)).collect();
    let faded = |t: f64| {
        let (fade_s, end_s) = (4.0 * CYCLE_S, f64::from(cycles) * CYCLE_S);
        ninth(t / fade_s)[0] * ninth((end_s - t) / fade_s)[0]
    };
    let travelled = integral(&times_s, |t| travel_m / CYCLE_S * faded(t));
    let displacement = times_s
        .iter()
        .zip(travelled)
        .map(|(t, travelled)| faded(*t) * cycle((t / CYCLE_S).fract(), 0.0)[0] + travelled);
    let displacement_m = displacement.collect();
    displaced(times_s, displacement_m)
}

/// Largest difference of all histories of a solution from those of a longer one, over the range of each, its first
/// time being this one of the longer. What is counted from a place counts from the first sample.
fn apart(found: &Solution, longer: &Solution, from_s: f64) -> Vec<(&'static str, f64)> {
    let first = ((from_s - longer.grid.time_s(0)) / longer.grid.step_s).round();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a sample")]
    let first = first as usize;
    let nodes: Vec<usize> = (1..found.links[0].mesh().nodes_m().len()).collect();
    let deflections =
        |of: &Solution| of.deflections(&nodes, NonZeroUsize::MIN).unwrap().histories().samples;
    let mut pairs = vec![
        ("torque", found.hub().torque_n_m.clone(), longer.hub().torque_n_m.clone(), false),
        (
            "rigid torque",
            found.hub().rigid_torque_n_m.clone(),
            longer.hub().rigid_torque_n_m.clone(),
            false,
        ),
        ("hub angle", found.hub().angle_rad.clone(), longer.hub().angle_rad.clone(), true),
        ("hub rate", found.hub().rate_rad_s.clone(), longer.hub().rate_rad_s.clone(), false),
        (
            "hub acceleration",
            found.acceleration_rad_s2(0).into_owned(),
            longer.acceleration_rad_s2(0).into_owned(),
            false,
        ),
        (
            "root moment",
            found.links[0].root_moment_n_m.clone(),
            longer.links[0].root_moment_n_m.clone(),
            false,
        ),
        ("tip", found.tip[0].displacement_m.clone(), longer.tip[0].displacement_m.clone(), true),
        ("velocity", found.tip[0].velocity_m_s.clone(), longer.tip[0].velocity_m_s.clone(), false),
    ];
    for (own, other) in deflections(found).into_iter().zip(deflections(longer)) {
        pairs.push(("deflection", own, other, false));
    }
    if let (Some(own), Some(other)) = (&found.hub().motor, &longer.hub().motor) {
        pairs.push(("motor torque", own.torque_n_m.clone(), other.torque_n_m.clone(), false));
        pairs.push(("motor angle", own.angle_rad.clone(), other.angle_rad.clone(), true));
        pairs.push(("motor rate", own.rate_rad_s.clone(), other.rate_rad_s.clone(), false));
    }
    let of = |(name, own, other, counts): (&'static str, Vec<f64>, Vec<f64>, bool)| {
        let other = &other[first..first + own.len()];
        let shift = if counts { other[0] - own[0] } else { 0.0 };
        let off = own.iter().zip(other).map(|(a, b)| (a + shift - b).abs()).fold(0.0, f64::max);
        let high = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (name, off / (high - own.iter().copied().fold(f64::INFINITY, f64::min)))
    };
    pairs.into_iter().map(of).collect()
}

const HYSTERETIC: Damping = Damping::Hysteretic { ratio: 0.02 };
const RAYLEIGH: Damping = Damping::Rayleigh { alpha_per_s: 0.3, beta_s: 1e-3 };
const BETA: Damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 };

#[test]
fn a_cycle_is_that_of_the_motion_repeated_thirty_times() {
    let drive = Drive {
        joint_stiffness_n_m_rad: 300.0,
        rotor_inertia_kg_m2: 1e-4,
        gear_ratio: 20.0,
        ..Drive::DIRECT
    };
    for (damping, drive, samples, given, travel_m) in [
        (HYSTERETIC, None, 120, Given::Displacement, 0.0),
        (HYSTERETIC, Some(drive), 121, Given::Acceleration, 0.0),
        (Damping::None, None, 121, Given::Displacement, 0.0),
        (RAYLEIGH, Some(drive), 120, Given::Displacement, 0.7),
        (BETA, None, 121, Given::Acceleration, -0.4),
    ] {
        let parts = LinkParts { drive, ..parts(&damping) };
        let step_s = CYCLE_S / f64::from(samples);
        let all: Vec<_> =
            (0..samples).map(|k| cycle(f64::from(k) / f64::from(samples), travel_m)).collect();
        let columns = columns(step_s, &all, given, travel_m != 0.0);
        let motion = TipMotion::with_ends(columns, Ends::Periodic).unwrap();
        assert!((motion.travel_m() - travel_m).abs() < 1e-12);
        let found = solved(&parts, &motion).unwrap();
        assert_eq!((found.grid.first, found.grid.len), (0, all.len()));
        let (_, window) = found.hub().errors.of_kind(|errors| errors.window).worst();
        assert_eq!(window.to_bits(), 0, "nothing is cut off");
        let longer = solved(&parts, &repeated(samples, 30, travel_m)).unwrap();
        for (name, off) in apart(&found, &longer, 15.0 * CYCLE_S) {
            assert!(off < 2e-6, "{damping:?}, {samples} samples, {travel_m} m: {name} {off:e}");
        }
    }
}

#[test]
fn a_cycle_under_gravity_or_at_large_angles_is_that_of_the_motion_repeated() {
    let gravity = |turns| Gravity { acceleration_m_s2: [0.0, -9.81], start_angle_rad: Some(turns) };
    for (damping, gravity, samples) in
        [(BETA, Some(gravity(-1.2)), 100), (BETA, Some(gravity(0.3)), 101), (HYSTERETIC, None, 100)]
    {
        let parts = LinkParts { gravity, ..parts(&damping) };
        let link = Link::new(parts.clone()).unwrap();
        let plan = plan_of(&link, 8);
        let analysis = Analysis::default().with_second_order(SecondOrder::Full);
        let step_s = CYCLE_S / f64::from(samples);
        let all: Vec<_> =
            (0..samples).map(|k| cycle(f64::from(k) / f64::from(samples), 0.0)).collect();
        let columns = columns(step_s, &all, Given::Displacement, false);
        let motion = TipMotion::with_ends(columns, Ends::Periodic).unwrap();
        let found = invert(&link, &plan, &motion, &analysis).unwrap();
        let longer = invert(&link, &plan, &repeated(samples, 14, 0.0), &analysis).unwrap();
        for (name, off) in apart(&found, &longer, 7.0 * CYCLE_S) {
            assert!(off < 1e-5, "{damping:?}, {samples} samples: {name} {off:e}");
        }
    }
}

/// One harmonic has the torque of the transfer at its frequency, by the dense matrices.
#[test]
fn a_harmonic_takes_the_torque_of_its_transfer() {
    for damping in [HYSTERETIC, RAYLEIGH] {
        let parts = parts(&damping);
        let link = Link::new(parts.clone()).unwrap();
        let model = model_of(&link, mesh_of(&link, 10), KeptModes::All).unwrap();
        let dense = Dense::assemble(model.on_mesh().clone()).unwrap();
        let omega = TAU * 2.0 / CYCLE_S;
        let at = |share: f64| 0.03 * (2.0 * TAU * share).cos();
        let displacement: Vec<f64> = (0..90).map(|k| at(f64::from(k) / 90.0)).collect();
        let columns = MotionColumns {
            time_s: (0..90).map(|k| CYCLE_S * f64::from(k) / 90.0).collect(),
            displacement_m: Some(displacement),
            ..Default::default()
        };
        let motion = TipMotion::with_ends(columns, Ends::Periodic).unwrap();
        let found = solved(&parts, &motion).unwrap();
        let tip = dense.tip_transfer(omega);
        let (alpha_per_s, stiffness) = match damping {
            Damping::Hysteretic { ratio } => (0.0, Complex64::new(1.0, 2.0 * ratio)),
            _ => (0.3, Complex64::new(1.0, 1e-3 * omega)),
        };
        // T = H (a + α v) + b θ̇, and the tip's displacement is a cosine.
        let derived = Complex64::new(0.0, omega);
        let damped = -omega * omega + derived * alpha_per_s;
        let excess = tip.deflection_s2 / stiffness / link.length_m() * damped;
        let rate = derived * (1.0 / link.length_m() + excess);
        let amplitude = 0.03 * (tip.inertia_kg_m * damped + 0.05 * rate);
        for (k, torque) in found.hub().torque_n_m.iter().enumerate() {
            let turned = Complex64::cis(2.0 * TAU * k as f64 / 90.0);
            let expected = (amplitude * turned).re;
            assert!((torque - expected).abs() < 1e-9 * amplitude.norm(), "{torque} {expected}");
        }
    }
}

/// A velocity from one constant value to another, with a bump between, and its derivative.
fn passing(time_s: f64, [before, after, bump]: [f64; 3]) -> [f64; 2] {
    const WIDTH_S: f64 = 0.12;
    let x = (time_s - 0.75) / WIDTH_S;
    let (bell, change) = (libm::exp(-x * x), 0.5 * (after - before));
    let rise = 2.0 / PI.sqrt() * change - 2.0 * x * bump;
    [before + change * (1.0 + libm::erf(x)) + bump * bell, rise * bell / WIDTH_S]
}

#[test]
fn a_tip_that_moves_at_its_ends_needs_what_it_needs_in_a_longer_motion() {
    const STEPS: u32 = 500;
    let drive = Drive {
        joint_stiffness_n_m_rad: 300.0,
        rotor_inertia_kg_m2: 1e-4,
        gear_ratio: 20.0,
        ..Drive::DIRECT
    };
    let step_s = 1.5 / f64::from(STEPS);
    for (damping, drive, given, with_velocity, shape) in [
        (BETA, None, Given::Displacement, true, [0.3, 0.3, -0.3]),
        (BETA, Some(drive), Given::Acceleration, true, [0.3, 0.0, 0.1]),
        (BETA, None, Given::Displacement, false, [0.0, -0.4, 0.0]),
        (Damping::None, Some(drive), Given::Displacement, true, [-0.2, 0.3, 0.2]),
        (HYSTERETIC, None, Given::Displacement, true, [0.2, 0.2, 0.3]),
    ] {
        let parts = LinkParts { drive, ..parts(&damping) };
        let times_s: Vec<f64> = (0..=STEPS).map(|k| step_s * f64::from(k)).collect();
        let travelled = integral(&times_s, |t| passing(t, shape)[0]);
        let all: Vec<[f64; 3]> = times_s
            .iter()
            .zip(travelled)
            .map(|(t, travelled)| {
                let [velocity, acceleration] = passing(*t, shape);
                [travelled, velocity, acceleration]
            })
            .collect();
        let columns = columns(step_s, &all, given, with_velocity);
        // A velocity column says it by itself.
        let ends = if with_velocity { Ends::AtRest } else { Ends::Moving };
        let motion = TipMotion::with_ends(columns, ends).unwrap();
        assert_eq!(motion.ends(), Ends::Moving);
        let [before, after] = motion.end_velocities_m_s();
        assert!((before - shape[0]).abs() < 1e-9 && (after - shape[1]).abs() < 1e-9);
        let found = solved(&parts, &motion).unwrap();
        // The same, set out some seconds before and brought to rest as long after.
        let compared = |seconds: u32| {
            let far_s = f64::from(seconds);
            let around = |t: f64| match t {
                t if t < 0.0 => shape[0] * ninth(0.5 * (t + far_s))[0],
                t if t > 1.5 => shape[1] * ninth((1.5 + far_s - t) / 2.0)[0],
                t => passing(t, shape)[0],
            };
            let steps = seconds * 1000 / 3;
            let at = |k: u32| step_s * (f64::from(k) - f64::from(steps));
            let times_s: Vec<f64> = (0..=2 * steps + STEPS).map(at).collect();
            let displacement_m = integral(&times_s, around);
            let longer = solved(&parts, &displaced(times_s, displacement_m)).unwrap();
            apart(&found, &longer, found.grid.time_s(0))
        };
        let near = compared(9);
        if damping == HYSTERETIC {
            // It remembers start and stop as 1/t.
            for ((name, near), (_, far)) in near.into_iter().zip(compared(18)) {
                assert!(near < 5e-4 && far < (0.65 * near).max(4e-5), "{name}: {near:e}, {far:e}");
            }
            continue;
        }
        for (name, off) in near {
            // The longer motion goes ten times as far, and is followed ten times less closely.
            let bound = if name == "hub acceleration" { 1e-4 } else { 2e-5 };
            assert!(off < bound, "{damping:?}, {shape:?}: {name} {off:e}");
        }
    }
}

#[test]
fn ends_that_cannot_be_are_refused() {
    let all: Vec<_> = (0..100).map(|k| cycle(f64::from(k) / 100.0, 0.3)).collect();
    let step_s = CYCLE_S / 100.0;
    let turning = columns(step_s, &all, Given::Displacement, true);
    let motion = TipMotion::with_ends(turning.clone(), Ends::Periodic).unwrap();
    let gravity = Gravity { acceleration_m_s2: [0.0, -9.81], start_angle_rad: Some(0.0) };
    let weighted = LinkParts { gravity: Some(gravity), ..parts(&BETA) };
    let refused = |parts: &LinkParts, motion: &TipMotion| solved(parts, motion).err().unwrap();
    assert_eq!(refused(&weighted, &motion), InversionError::Ends(RefusedEnds::Turned));
    let accelerating = TipMotion::with_ends(turning.clone(), Ends::Moving);
    assert!(matches!(accelerating, Err(MotionError::AcceleratingEnd { sample: 0, .. })));
    let passed: Vec<[f64; 3]> = (0..=150)
        .map(|k| {
            let [velocity, acceleration] = passing(0.01 * f64::from(k), [0.3, 0.3, -0.2]);
            [0.0, velocity, acceleration]
        })
        .collect();
    let passed = columns(0.01, &passed, Given::Acceleration, true);
    let moving = TipMotion::with_ends(passed, Ends::Moving).unwrap();
    assert_eq!(refused(&weighted, &moving), InversionError::Ends(RefusedEnds::Bent));
    assert_eq!(refused(&parts(&RAYLEIGH), &moving), InversionError::Ends(RefusedEnds::Drag));
    let link = Link::new(parts(&BETA)).unwrap();
    let analysis = Analysis::new(1e-6, Some(0.1), None).unwrap();
    let edges = invert(&link, &MeshPlan::automatic(&link), &motion, &analysis).err().unwrap();
    assert_eq!(edges, InversionError::Ends(RefusedEnds::Edges));
    // Without a word of it the tip is taken to be at rest.
    let silent = MotionColumns { velocity_m_s: None, ..turning.clone() };
    assert!(matches!(TipMotion::new(silent), Err(MotionError::MovingAtEnd { .. })));
    let accelerated = columns(step_s, &all, Given::Acceleration, false);
    let unknown = TipMotion::with_ends(accelerated.clone(), Ends::Moving);
    assert_eq!(unknown, Err(MotionError::UnknownVelocity));
    let mut offset = accelerated;
    for a in offset.acceleration_m_s2.iter_mut().flatten() {
        *a += 0.1 * PI;
    }
    let added = TipMotion::with_ends(offset, Ends::Periodic);
    assert!(matches!(added, Err(MotionError::AddsVelocity { .. })));
    // Velocity and displacement that contradict each other, and a cycle that does not come back.
    let mut faster = turning.clone();
    for velocity in faster.velocity_m_s.iter_mut().flatten() {
        *velocity += 0.002;
    }
    let unclosed = TipMotion::with_ends(faster, Ends::Periodic);
    assert!(matches!(unclosed, Err(MotionError::Unclosed { .. })), "{unclosed:?}");
    let alone = MotionColumns { velocity_m_s: None, ..turning.clone() };
    let unclosed = TipMotion::with_ends(alone, Ends::Periodic);
    assert!(matches!(unclosed, Err(MotionError::Unclosed { sample: 99, .. })), "{unclosed:?}");
    let again: Vec<_> = (0..=100).map(|k| cycle(f64::from(k) / 100.0, 0.3)).collect();
    for given in [Given::Displacement, Given::Acceleration] {
        let again = TipMotion::with_ends(columns(step_s, &again, given, true), Ends::Periodic);
        assert_eq!(again, Err(MotionError::Repeats { sample: 100 }));
    }
    let still = MotionColumns {
        time_s: (0..9).map(f64::from).collect(),
        displacement_m: Some((0..9).map(|k| 0.1 * f64::from(k)).collect()),
        ..Default::default()
    };
    assert_eq!(TipMotion::with_ends(still, Ends::Moving), Err(MotionError::Steady));
}
