//! Drives with losses under voltages: against a body on a massless link and a rigid pendulum, integrated separately, against
//! the law of the losses, and against the inversion.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::FRAC_PI_2;
use std::slice::from_ref;

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::fit::{
    Channel, FitOutcome, Free, Gain, Measurements, Motor, Record, RecordInput, Specimen, fit,
};
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{
    Arm, ArmLink, ArmParts, Carriage, Damping, Drive, Gravity, Hub, Link, LinkParts, Payload,
    Segment,
};
use flexlink::model::Sensor;
use flexlink::response::{
    Input, Interpolation, Play, Played, SimulationError, SimulationWarning, Start, Torque, simulate,
};
use flexlink::spec::{FreeValue, LinkDocument, Override};

use crate::common::{Smooth, peak};
use crate::recordings::Random;

/// Step of the voltages, number of samples, and steps of the separate integration for each of them.
const STEP_S: f64 = 0.002;
const SAMPLES: usize = 1000;
const FINER: usize = 40;

const BETA_S: f64 = 2e-3;

/// A joint of inertia I that carries a mass m on a massless beam of 1 m, and its drive.
struct Rig {
    slides: bool,
    inertia: f64,
    friction: f64,
    mass_kg: f64,
    stiffness_n_m2: f64,
    drive: Drive,
}

const DRIVE: Drive = Drive {
    rotor_inertia_kg_m2: 2e-3,
    gear_ratio: 10.0,
    efficiency: 0.75,
    coulomb_friction_n_m: 0.6,
    friction_rate_rad_s: Some(0.05),
    torque_constant_n_m_a: Some(0.05),
    resistance_ohm: Some(1.0),
    ..Drive::DIRECT
};

const RIG: Rig = Rig {
    slides: false,
    inertia: 0.3,
    friction: 0.1,
    mass_kg: 0.4,
    stiffness_n_m2: 30.0,
    drive: DRIVE,
};

impl Rig {
    fn link(&self) -> Link {
        self.under(None)
    }

    /// The link under gravity.
    fn under(&self, gravity: Option<Gravity>) -> Link {
        let hub = Hub {
            inertia_kg_m2: self.inertia,
            viscous_friction_n_m_s_rad: self.friction,
            ..Hub::default()
        };
        let carriage = Carriage { mass_kg: self.inertia, viscous_friction_n_s_m: self.friction };
        Link::new(LinkParts {
            segments: vec![Segment::uniform(1.0, self.stiffness_n_m2, 1e-9)],
            hub: if self.slides { Hub::default() } else { hub },
            carriage: self.slides.then_some(carriage),
            payload: Payload { mass_kg: self.mass_kg, ..Payload::default() },
            damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: BETA_S },
            drive: Some(self.drive),
            gravity,
            ..LinkParts::default()
        })
        .unwrap()
    }

    /// Effort at the joint in front of rotor and losses, less the back voltage's part.
    fn effort(&self, volts: f64, rate: f64) -> f64 {
        let Drive { gear_ratio: n, torque_constant_n_m_a, resistance_ohm, .. } = self.drive;
        let (k, r) = (torque_constant_n_m_a.unwrap(), resistance_ohm.unwrap());
        n * k / r * (volts - n * k * rate)
    }

    /// Acceleration of the joint from its rate v and all forces on the joint but the motor's: a bisection of
    /// `f(I a − forces, x) = E − B v − R a`, whose left side rises with a.
    fn acceleration(&self, effort: f64, rate: f64, forces: f64) -> f64 {
        let Drive { efficiency, coulomb_friction_n_m, gear_ratio, .. } = self.drive;
        let along = (rate / self.drive.friction_rate_rad_s.unwrap()).tanh();
        let rotor = gear_ratio * gear_ratio * self.drive.rotor_inertia_kg_m2;
        let [sum, difference] =
            [1.0, -1.0].map(|sign| 0.5 * (1.0 / efficiency + sign * efficiency));
        let missing = |a: f64| {
            let loaded = self.inertia * a - forces + coulomb_friction_n_m * along;
            sum * loaded + difference * loaded.abs() * along + rotor * a - effort
        };
        let (mut low, mut high) = (-1e6, 1e6);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if missing(middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Positions of the joint and of the tip at all samples under a voltage, by Runge and Kutta's method of order 4.
    fn played(&self, voltage: impl Fn(f64) -> f64) -> [Vec<f64>; 2] {
        let spring = 3.0 * self.stiffness_n_m2;
        // Of a body at the end of 1 m the arc is the angle.
        let slope = |time_s: f64, [_, rate, w, w_rate]: [f64; 4]| {
            let bent = spring * (w + BETA_S * w_rate);
            let effort = self.effort(voltage(time_s), rate);
            let turning = self.acceleration(effort, rate, bent - self.friction * rate);
            [rate, turning, w_rate, -bent / self.mass_kg - turning]
        };
        let states = integrated([0.0; 4], slope);
        let joint = states.iter().map(|own| own[0]).collect();
        [joint, states.iter().map(|own| own[0] + own[2]).collect()]
    }

    /// Position of the joint at all samples, where a rigid beam carries the mass, by the same method. It hangs along -y at
    /// first.
    fn swung(&self, voltage: impl Fn(f64) -> f64) -> Vec<f64> {
        let rigid = Self { inertia: self.inertia + self.mass_kg, ..*self };
        let slope = |time_s: f64, [angle, rate]: [f64; 2]| {
            let forces = -self.mass_kg * G * angle.cos() - self.friction * rate;
            [rate, rigid.acceleration(self.effort(voltage(time_s), rate), rate, forces)]
        };
        integrated([-FRAC_PI_2, 0.0], slope).iter().map(|own| own[0]).collect()
    }
}

/// States at all samples, by Runge and Kutta's method of order 4.
fn integrated<const N: usize>(
    mut state: [f64; N],
    slope: impl Fn(f64, [f64; N]) -> [f64; N],
) -> Vec<[f64; N]> {
    let step_s = STEP_S / FINER as f64;
    let moved =
        |own: [f64; N], by: [f64; N], step_s: f64| std::array::from_fn(|i| own[i] + step_s * by[i]);
    let mut states = vec![state];
    for step in 0..(SAMPLES - 1) * FINER {
        let time_s = step as f64 * step_s;
        let a = slope(time_s, state);
        let b = slope(time_s + 0.5 * step_s, moved(state, a, 0.5 * step_s));
        let c = slope(time_s + 0.5 * step_s, moved(state, b, 0.5 * step_s));
        let d = slope(time_s + step_s, moved(state, c, step_s));
        let all = std::array::from_fn(|i| (a[i] + 2.0 * (b[i] + c[i]) + d[i]) / 6.0);
        state = moved(state, all, step_s);
        if (step + 1) % FINER == 0 {
            states.push(state);
        }
    }
    states
}

const G: f64 = 9.81;

/// Gravity along -y on a link that hangs.
const HANGING: Gravity =
    Gravity { acceleration_m_s2: [0.0, -G], start_angle_rad: Some(-FRAC_PI_2) };

fn times_s() -> Vec<f64> {
    (0..SAMPLES).map(|k| STEP_S * k as f64).collect()
}

/// A voltage that drives forth and back, brakes, and ends at 0.
fn voltage(time_s: f64) -> f64 {
    let share = time_s / (STEP_S * (SAMPLES - 1) as f64);
    24.0 * (1.5 * std::f64::consts::TAU * share).sin() * (std::f64::consts::PI * share).sin()
}

fn torque(drive: &Drive, volts: &[f64], times_s: &[f64]) -> Torque {
    let per_volt = drive.effort_per_volt().unwrap();
    Torque::new(times_s, volts.iter().map(|u| per_volt * u).collect()).unwrap()
}

fn plan(link: &Link, elements: usize) -> MeshPlan {
    MeshPlan::new(link, &[None], Some(ElementCount::Total(elements)), 1e-6).unwrap()
}

fn under_voltage(link: &Link, plan: &MeshPlan, torque: &Torque) -> Result<Played, SimulationError> {
    with_losses(link, plan, &Play::of(torque))
}

fn with_losses(link: &Link, plan: &MeshPlan, play: &Play<'_>) -> Result<Played, SimulationError> {
    let arm = Arm::from(link.clone()).under_voltages().unwrap();
    simulate(&arm, from_ref(plan), &Play { is_under_voltage: true, ..*play }, &|_| {})
}

/// Largest work less energies and losses, over the largest work.
fn missing(played: &Played) -> f64 {
    let energy = played.energy(8);
    let missing = energy
        .balances
        .iter()
        .map(|own| own.work_j - own.dissipated_j - (own.kinetic_j + own.strain_j - energy.start_j));
    let missing: Vec<f64> = missing.collect();
    let works: Vec<f64> = energy.balances.iter().map(|own| own.work_j).collect();
    peak(&missing) / peak(&works)
}

fn apart(found: &[f64], exact: &[f64]) -> f64 {
    assert_eq!(found.len(), exact.len());
    found.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / peak(exact)
}

#[test]
fn a_voltage_moves_the_link_as_the_separate_integration_does() {
    let volts: Vec<f64> = times_s().iter().map(|t| voltage(*t)).collect();
    let ideal = Drive { efficiency: 1.0, coulomb_friction_n_m: 0.0, ..DRIVE };
    let friction = Drive { efficiency: 1.0, ..DRIVE };
    let mut lossless = Vec::new();
    for (slides, drive) in [(false, ideal), (false, friction), (false, DRIVE), (true, DRIVE)] {
        let rig = Rig { slides, drive, ..RIG };
        let link = rig.link();
        let played =
            under_voltage(&link, &plan(&link, 2), &torque(&drive, &volts, &times_s())).unwrap();
        let [joint, tip] = rig.played(voltage);
        let found = [&played.hub().angle_rad, &played.tip[0].displacement_m];
        for (found, exact) in found.into_iter().zip([&joint, &tip]) {
            let off = apart(found, exact);
            assert!(off < 2e-5, "{slides} {drive:?}: {off}");
        }
        // The losses matter: the test would see them left out.
        if lossless.is_empty() {
            lossless = joint;
        } else {
            assert!(apart(&lossless, &joint) > 0.05, "{drive:?}");
        }
        assert!(missing(&played) < 1e-3, "{}", missing(&played));
    }
}

#[test]
fn a_stiff_link_with_weight_swings_as_the_rigid_pendulum_does() {
    let volts: Vec<f64> = times_s().iter().map(|t| voltage(*t)).collect();
    let friction = Drive { efficiency: 1.0, ..DRIVE };
    let lossless = Rig { drive: Drive { coulomb_friction_n_m: 0.0, ..friction }, ..RIG };
    let lossless = lossless.swung(voltage);
    for drive in [friction, DRIVE, Drive { efficiency: 0.8, ..DRIVE }] {
        let rig = Rig { drive, stiffness_n_m2: 1e7, ..RIG };
        let link = rig.under(Some(HANGING));
        let played =
            under_voltage(&link, &plan(&link, 2), &torque(&drive, &volts, &times_s())).unwrap();
        let swung = rig.swung(voltage);
        let off = apart(&played.hub().angle_rad, &swung);
        assert!(off < 2e-6, "{drive:?}: {off:e}");
        assert!(apart(&lossless, &swung) > 0.05, "{drive:?}");
        assert!(missing(&played) < 1e-3, "{}", missing(&played));
        // Nothing sees the vibration of so stiff a link.
        assert!(played.warnings.iter().all(|own| own.kind() == "coarse_step"));
    }
}

/// The peak rate sets the friction's rate in both.
#[test]
fn losses_at_large_angles_are_those_of_the_linear_link_where_it_bends_little() {
    let volts: Vec<f64> = times_s().iter().map(|t| 0.05 * voltage(*t)).collect();
    let drive = Drive { coulomb_friction_n_m: 0.03, friction_rate_rad_s: None, ..DRIVE };
    let link = Rig { drive, ..RIG }.link();
    let torque = torque(&drive, &volts, &times_s());
    let [linear, large] = [false, true].map(|is_large| {
        let play = Play { is_large, ..Play::of(&torque) };
        with_losses(&link, &plan(&link, 2), &play).unwrap()
    });
    let motor = |of: &Played| of.hub().torque_n_m.clone();
    for (found, exact, most) in [
        (&large.hub().angle_rad, &linear.hub().angle_rad, 1e-4),
        (&large.tip[0].displacement_m, &linear.tip[0].displacement_m, 1e-4),
        (&motor(&large), &motor(&linear), 1e-3),
    ] {
        let off = apart(found, exact);
        assert!(off < most, "{off:e}");
    }
    assert!(missing(&large) < 1e-3, "{}", missing(&large));
}

/// Efforts of the motors of an arm, and its motion under them.
fn swinging_arm(volts: &dyn Fn(f64) -> f64) -> ([Drive; 2], [Torque; 2], Played) {
    let first = Drive { friction_rate_rad_s: None, ..DRIVE };
    let second = Drive {
        rotor_inertia_kg_m2: 0.0,
        coulomb_friction_n_m: 0.2,
        friction_rate_rad_s: Some(0.2),
        ..DRIVE
    };
    let drives = [first, second];
    let links = drives.map(|drive| {
        let parts = LinkParts::from(Rig { drive, ..RIG }.link());
        let segments = vec![Segment::uniform(1.0, 60.0, 0.3)];
        ArmLink { name: None, link: Link::new(LinkParts { segments, ..parts }).unwrap() }
    });
    let gravity_m_s2 = HANGING.acceleration_m_s2;
    let arm = Arm::new(ArmParts { links: links.into(), gravity_m_s2, ..ArmParts::default() });
    let arm = arm.unwrap().under_voltages().unwrap();
    let samples: Vec<f64> = times_s().iter().map(|t| volts(*t)).collect();
    let torques = drives.map(|drive| torque(&drive, &samples, &times_s()));
    let play = Play {
        start: Some(Start::Joints(&[-FRAC_PI_2, 0.0])),
        is_under_voltage: true,
        ..Play::with(Input::Torques(&torques))
    };
    let plans: Vec<MeshPlan> = arm.links().iter().map(|own| plan(&own.link, 2)).collect();
    let played = simulate(&arm, &plans, &play, &|_| {}).unwrap();
    (drives, torques, played)
}

/// The losses have their law at every sample. The efforts of the motors less their losses account for all energy.
#[test]
fn the_drives_of_an_arm_keep_the_law_of_their_losses() {
    let (drives, torques, played) = swinging_arm(&voltage);
    for ((joint, drive), torque) in played.joints.iter().zip(drives).zip(&torques) {
        let at = peak(&joint.rate_rad_s);
        // The peak rate of one refinement sets the friction's rate of the next.
        let friction_rate = drive.friction_rate_rad_s.unwrap_or(0.01 * at);
        let back = drive.back_friction().unwrap();
        let [mut off, mut lost] = [0.0_f64; 2];
        for k in 0..SAMPLES {
            let (rate, acceleration) = (joint.rate_rad_s[k], joint.acceleration_rad_s2[k]);
            let along = (rate / friction_rate).tanh();
            let effort =
                torque.torque_n_m()[k] - back * rate - drive.rotor_at_joint() * acceleration;
            let loaded = joint.torque_n_m[k] + drive.coulomb_friction_n_m * along;
            let [mean, half] =
                [1.0, -1.0].map(|sign| 0.5 * (1.0 / drive.efficiency + sign * drive.efficiency));
            let needed = mean * loaded + half * loaded.abs() * along;
            off = off.max((needed - effort).abs());
            lost = lost.max((effort - joint.torque_n_m[k]).abs());
        }
        let size = peak(torque.torque_n_m());
        assert!(off < 1e-6 * size && lost > 0.05 * size, "{off:e} and {lost} of {size} N m");
    }
    assert!(played.imbalance() < 1e-6, "{:e}", played.imbalance());
    assert!(played.warnings.is_empty(), "{:?}", played.warnings);
}

/// A cycle of a voltage is that to which cycle after cycle leads.
#[test]
fn a_cycle_with_losses_is_that_of_many() {
    const CYCLES: usize = 12;
    const CYCLE: usize = 100;
    let volts = |cycles: usize| -> Vec<f64> {
        let share = |k: usize| std::f64::consts::TAU * k as f64 / CYCLE as f64;
        (0..cycles * CYCLE).map(|k| 9.0 * share(k).sin() + 3.0 * (2.0 * share(k)).cos()).collect()
    };
    let drive = Drive { friction_rate_rad_s: Some(0.2), ..DRIVE };
    for (gravity, is_large) in [(None, false), (None, true), (Some(HANGING), true)] {
        // Friction ends what is left of the start.
        let parts = LinkParts::from(Rig { friction: 2.0, drive, ..RIG }.under(gravity));
        let segments = vec![Segment::uniform(1.0, 30.0, 0.1)];
        let link = Link::new(LinkParts { segments, ..parts }).unwrap();
        let played = |cycles: usize, cycle_turn_rad| {
            let times_s: Vec<f64> = (0..cycles * CYCLE).map(|k| 0.01 * k as f64).collect();
            let torque = torque(&drive, &volts(cycles), &times_s);
            let tolerance = Some(1e-5);
            let play = Play { is_large, cycle_turn_rad, tolerance, ..Play::of(&torque) };
            with_losses(&link, &plan(&link, 2), &play).unwrap()
        };
        let (one, all) = (played(1, Some(0.0)), played(CYCLES, None));
        let first = (CYCLES - 3) * CYCLE;
        for (found, all) in [
            (&one.hub().rate_rad_s, &all.hub().rate_rad_s),
            (&one.hub().torque_n_m, &all.hub().torque_n_m),
        ] {
            let off = apart(found, &all[first..first + CYCLE]);
            assert!(off < 2e-4, "{gravity:?} {is_large}: {off:e}");
        }
    }
}

/// The torque at the joint behind rotor and losses is the one that moves the link without a drive.
#[test]
fn the_torque_at_the_joint_alone_moves_the_link_alike() {
    let volts: Vec<f64> = times_s().iter().map(|t| voltage(*t)).collect();
    let smooth = Drive { friction_rate_rad_s: Some(1.0), ..DRIVE };
    let link = Rig { drive: smooth, ..RIG }.link();
    let played =
        under_voltage(&link, &plan(&link, 2), &torque(&smooth, &volts, &times_s())).unwrap();
    let at_joint = Torque::new(&times_s(), played.hub().torque_n_m.clone()).unwrap();
    let again = simulate(&link.clone().into(), &[plan(&link, 2)], &Play::of(&at_joint), &|_| {});
    let off = apart(&again.unwrap().hub().angle_rad, &played.hub().angle_rad);
    assert!(off < 1e-4, "{off}");
}

fn times_of(solution: &Solution) -> Vec<f64> {
    (0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect()
}

/// Distance of the tip under the voltage of the inversion from the wanted motion, over its travel, and the play's warnings.
fn round_trip(parts: LinkParts) -> (f64, Vec<SimulationWarning>) {
    let link = Link::new(parts).unwrap();
    let plan = plan(&link, 10);
    let motion = Smooth { duration_s: 1.0, ..Smooth::SHORT }.motion();
    let solution = invert(&link, &plan, &motion, &Analysis::default()).unwrap();
    let motor = solution.hub().motor.as_ref().unwrap();
    let drive = *link.drive().unwrap();
    let volts = torque(&drive, motor.voltage_v.as_ref().unwrap(), &times_of(&solution));
    let played = under_voltage(&link, &plan, &volts).unwrap();
    (apart(&played.tip[0].displacement_m, &solution.tip[0].displacement_m), played.warnings)
}

#[test]
fn the_voltage_of_the_inversion_brings_the_tip_along_the_motion() {
    let parts = |drive: Drive, slides: bool| LinkParts {
        segments: vec![Segment::uniform(1.5, 5.0, 0.8)],
        hub: Hub { inertia_kg_m2: if slides { 0.0 } else { 0.1 }, ..Hub::default() },
        carriage: slides.then_some(Carriage { mass_kg: 1.0, viscous_friction_n_s_m: 0.2 }),
        damping: Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 },
        drive: Some(drive),
        ..LinkParts::default()
    };
    let smooth = Drive { friction_rate_rad_s: Some(0.05), coulomb_friction_n_m: 0.2, ..DRIVE };
    let ideal = Drive { efficiency: 1.0, coulomb_friction_n_m: 0.0, ..DRIVE };
    for slides in [false, true] {
        let (without, _) = round_trip(parts(ideal, slides));
        assert!(without < 1e-5, "{slides}: {without}");
        let (with, _) = round_trip(parts(smooth, slides));
        assert!(with < 2e-3, "{slides}: {with}");
    }
    // At first the gear takes a part of the torque that holds the weight.
    let segments = vec![Segment::uniform(1.5, 40.0, 0.8)];
    let gravity = Some(Gravity { start_angle_rad: Some(-1.0), ..HANGING });
    let weighted = LinkParts { segments, gravity, ..parts(smooth, false) };
    let (off, warnings) = round_trip(weighted);
    assert!(off < 2e-5, "{off:e}");
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn a_drive_without_the_motor_of_a_voltage_is_refused() {
    let elastic = Drive { joint_stiffness_n_m_rad: 1e3, ..DRIVE };
    for (drive, key) in [
        (elastic, "drive.joint_stiffness"),
        (Drive { resistance_ohm: None, ..DRIVE }, "drive.resistance"),
        (Drive::DIRECT, "drive.torque_constant"),
    ] {
        let refused = Arm::from(Rig { drive, ..RIG }.link()).under_voltages().unwrap_err();
        assert_eq!(refused.parameter, key);
    }
}

/// 24 V give at most 12 N m at the joint, against a friction of 20 N m.
#[test]
fn a_joint_stands_still_whose_friction_exceeds_its_motor() {
    let volts: Vec<f64> = times_s().iter().map(|t| voltage(*t)).collect();
    let drive = Drive { friction_rate_rad_s: Some(1e-7), coulomb_friction_n_m: 20.0, ..DRIVE };
    let link = Rig { drive, ..RIG }.link();
    let torque = torque(&drive, &volts, &times_s());
    for is_large in [false, true] {
        let play = Play { is_large, ..Play::of(&torque) };
        let crept_rad = peak(&with_losses(&link, &plan(&link, 2), &play).unwrap().hub().angle_rad);
        assert!(crept_rad > 0.0 && crept_rad < 1e-6, "{crept_rad}");
    }
}

/// A record of the hub angle with noise of 0.1 %, by the separate integration.
fn record(input: RecordInput, exact: &[f64], seed: u64) -> Measurements {
    let mut random = Random(seed);
    // Twelve numbers from 0 to 1 have the variance 1.
    let mut normal = || (0..12).map(|_| random.next()).sum::<f64>() - 6.0;
    let size = peak(exact);
    let channel = Channel {
        sensor: Sensor::HubAngle,
        gain: Gain::Known,
        has_offset: false,
        uncertainty: Some(1e-3 * size),
        unit: 1.0,
        samples: exact.iter().map(|own| own + 1e-3 * size * normal()).collect(),
    };
    let record = Record::new("r.csv".into(), STEP_S, input, vec![channel], false).unwrap();
    Measurements::new(vec![], vec![], vec![record]).unwrap()
}

fn fitted(text: &str, measured: &Measurements, free: &[&str]) -> FitOutcome {
    let document = LinkDocument::read("link.toml", text).unwrap();
    let values: Vec<FreeValue> = free.iter().map(|free| free.parse().unwrap()).collect();
    let bounds: Vec<Free> = values.iter().map(|value| document.free(value, &[]).unwrap()).collect();
    let specimen_at = |factors: &[f64]| {
        let changes = values.iter().zip(factors).map(|(value, factor)| value.times(*factor));
        let changes: Vec<Override> = changes.collect::<Result<_, _>>()?;
        let own = document.specification("link.toml", &changes)?;
        Ok::<_, flexlink::spec::SpecError>(Specimen::of(own.arm, &own.meshes))
    };
    fit(measured, &bounds, specimen_at).unwrap()
}

#[test]
fn coulomb_friction_and_stiffness_are_found_from_a_record() {
    let text = |more: &str| {
        format!(
            "mesh.elements = 2\nsegments = [{{ length = 1, EI = 36, mass_per_length = 1e-9 }}]\n\
             hub = {{ inertia = 0.3, viscous_friction = 0.1 }}\npayload.mass = 0.4\n\
             damping = {{ model = 'rayleigh', beta = 2e-3 }}\n\
             [drive]\ncoulomb_friction = 0.3\nfriction_rate = 0.05\n{more}"
        )
    };
    let check = |found: &FitOutcome| {
        assert_eq!((&found.misfit, found.undetermined.len()), (&None, 0), "{found:?}");
        for (value, exact) in found.values.iter().zip([2.0, 30.0 / 36.0]) {
            let [low, high] = value.relative_interval_95.unwrap().map(|own| own * value.factor);
            assert!(low <= exact && exact <= high, "{value:?}, not {exact}");
            assert!(high / low < 1.05, "{value:?}");
        }
    };
    let free = ["drive.coulomb_friction", "segments.*.EI"];
    let volts: Vec<f64> = times_s().iter().map(|t| voltage(*t)).collect();
    // A voltage at the motor of the link file, with rotor and gear.
    let own = "efficiency = 0.75\ngear_ratio = 10\nrotor_inertia = 2e-3\ntorque_constant = 0.05\n\
               resistance = 1\n";
    let motor = Motor::of(&DRIVE).unwrap();
    let input = RecordInput::Voltage(volts.clone(), Interpolation::Cubic, motor);
    let [joint, _] = RIG.played(voltage);
    check(&fitted(&text(own), &record(input, &joint, 7), &free));
    // A torque: a motor of so high a resistance has no back voltage.
    let current = Drive {
        rotor_inertia_kg_m2: 0.0,
        gear_ratio: 1.0,
        efficiency: 1.0,
        torque_constant_n_m_a: Some(1e-9),
        resistance_ohm: Some(1e-9),
        ..DRIVE
    };
    let rig = Rig { drive: current, ..RIG };
    let torque = |time_s: f64| 0.4 * voltage(time_s);
    let [joint, _] = rig.played(torque);
    let samples = times_s().iter().map(|t| torque(*t)).collect();
    let input = RecordInput::Torque(samples, Interpolation::Cubic);
    check(&fitted(&text(""), &record(input, &joint, 8), &free));
}
