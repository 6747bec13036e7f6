//! The stated input errors of arms: paths of few digits, and coarse ones that are resampled, against the exact ones.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of samples and of decimals, not negative and small"
)]

use std::fmt::Write as _;

use flexlink::beam::ElementCount;
use flexlink::csv::{MotionTable, TableFormat, read_motion_table_as};
use flexlink::inverse::{Analysis, JointMotion, PerQuantity, QuantityErrors, Solution};
use flexlink::link::{Arm, Damping, Hub, LinkParts, Payload, Segment};
use flexlink::motion::{ArmPath, Motion};
use flexlink::result::{JointMetrics, Metrics, Remark};

use super::inversion::{arm, largest, solved};
use super::two_links;
use crate::common::apart as farthest;
use crate::elastica;
use crate::recordings::{Random, Shape, min_jerk, septic, sine};

/// A way from rest to rest: places of the tip or directions of the chords, each from one value to another by one profile.
pub(super) struct Way {
    pub(super) names: Vec<String>,
    pub(super) ends: Vec<[f64; 2]>,
    pub(super) shape: Shape,
    pub(super) duration_s: f64,
    pub(super) steps: u32,
}

impl Way {
    /// A file of it with every `stride`-th sample and so many decimals.
    pub(super) fn file(&self, stride: usize, decimals: usize) -> String {
        let mut text = format!("time,{}\n", self.names.join(","));
        for k in (0..=self.steps).step_by(stride) {
            let share = f64::from(k) / f64::from(self.steps);
            write!(text, "{:.12}", share * self.duration_s).unwrap();
            for [from, to] in &self.ends {
                let value = from + (to - from) * (self.shape)(share)[0];
                write!(text, ",{value:.decimals$}").unwrap();
            }
            text.push('\n');
        }
        text
    }

    fn path(&self, arm: &Arm, decimals: usize) -> ArmPath {
        let text = self.file(1, decimals);
        path_of(&read(&text, arm))
    }
}

pub(super) fn read(text: &str, arm: &Arm) -> MotionTable {
    let (lengths_m, format) = (arm.lengths_m(), TableFormat::default());
    read_motion_table_as("path.csv", text.as_bytes(), &lengths_m, &format).unwrap()
}

pub(super) fn path_of(table: &MotionTable) -> ArmPath {
    let Motion::Path(path) = table.clone().into_motion().unwrap() else { panic!("a path") };
    path
}

pub(super) fn random_arm(random: &mut Random, links: usize) -> Arm {
    let gravity_m_s2 = [0.0, if random.next() < 0.5 { -9.81 } else { 0.0 }];
    let (mut length_m, mut stiffness, mut mass) = (random.between(0.3, 0.7), 1.0, 0.5);
    stiffness *= random.between(60.0, 300.0) * length_m * length_m;
    let mut parts = Vec::new();
    for _ in 0..links {
        parts.push(LinkParts {
            segments: vec![Segment::uniform(length_m, stiffness, mass)],
            hub: Hub { inertia_kg_m2: 10.0_f64.powf(random.between(-3.5, -1.5)), ..Hub::default() },
            payload: Payload { mass_kg: random.between(0.0, 0.4), ..Payload::default() },
            damping: Damping::Rayleigh {
                alpha_per_s: 0.0,
                beta_s: 10.0_f64.powf(random.between(-4.5, -3.0)),
            },
            ..elastica::arm()
        });
        length_m *= random.between(0.6, 1.0);
        stiffness *= random.between(0.3, 0.8);
        mass *= random.between(0.5, 1.0);
    }
    arm(&parts, gravity_m_s2)
}

pub(super) fn random_way(random: &mut Random, arm: &Arm, case: usize) -> Way {
    let lengths_m = arm.lengths_m();
    let shapes: [Shape; 3] = [septic, min_jerk, sine];
    let shape = shapes[case % 3];
    let (mut names, mut ends) = (Vec::new(), Vec::new());
    if case.is_multiple_of(2) {
        // Two places within the reach of two links, from which the elbow is neither stretched nor folded.
        let mut place = || {
            let distance_m = random.between(0.55, 0.9) * (lengths_m[0] + lengths_m[1]);
            let direction_rad = random.between(-1.2, 1.2);
            [distance_m * direction_rad.cos(), distance_m * direction_rad.sin()]
        };
        let [from, to] = [place(), place()];
        names = vec!["x".to_owned(), "y".to_owned()];
        ends = vec![[from[0], to[0]], [from[1], to[1]]];
    } else {
        let mut from = random.between(-1.5, 1.5);
        for link in 0..lengths_m.len() {
            names.push(format!("angle{}", link + 1));
            ends.push([from, from + random.between(-1.2, 1.2)]);
            from += random.between(0.4, 1.8);
        }
    }
    let duration_s = random.between(0.8, 2.5);
    Way { names, ends, shape, duration_s, steps: 40 * random.between(5.0, 25.0) as u32 }
}

/// Largest difference of a history over the samples of the path, over its range with weight and else its peak.
fn apart(found: &Solution, exact: &Solution, joint: usize, of: fn(&JointMotion) -> &[f64]) -> f64 {
    let [own, other] = [found, exact].map(|solution| {
        let (history, before) = (of(&solution.joints[joint]), -solution.grid.first);
        &history[before as usize..][..solution.motion.grid().len]
    });
    let all = of(&found.joints[joint]);
    let low = all.iter().copied().fold(f64::INFINITY, f64::min);
    let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let size = if found.arm.has_weight() { high - low } else { high.abs().max(low.abs()) };
    farthest(own, other) / size
}

/// True over stated errors of the torque, the angle and the rate of each joint: that of the input alone, and that with all
/// other kinds.
pub(super) fn ratios(found: &Solution, exact: &Solution) -> Vec<[f64; 2]> {
    let mut ratios = Vec::new();
    let mut add = |apart: f64, own: QuantityErrors| {
        let input = own.input.unwrap();
        let all = input + own.mesh + own.window + 2.0 * own.iteration.unwrap_or(0.0);
        ratios.push([apart / input, apart / all]);
    };
    for (joint, JointMotion { errors, .. }) in found.joints.iter().enumerate() {
        let PerQuantity { torque, hub_angle, hub_rate, .. } = *errors;
        add(apart(found, exact, joint, |own| &own.torque_n_m), torque);
        add(apart(found, exact, joint, |own| &own.rate_rad_s), hub_rate);
        // Without weight its error is a share of its largest turn.
        if found.arm.has_weight() {
            add(apart(found, exact, joint, |own| &own.angle_rad), hub_angle);
        }
    }
    ratios
}

fn told(ratios: &[[f64; 2]]) -> String {
    let mut ratios: Vec<f64> = ratios.iter().map(|[of_input, _]| *of_input).collect();
    ratios.sort_by(f64::total_cmp);
    let [least, median, most] = [0, ratios.len() / 2, ratios.len() - 1].map(|k| ratios[k]);
    format!("true over stated error: {least:.3}, {median:.3}, {most:.3} of {}", ratios.len())
}

#[test]
fn the_stated_input_error_holds_for_paths_of_few_digits() {
    let mut random = Random::of(3);
    let mut all = Vec::new();
    for case in 0..6 {
        let arm = random_arm(&mut random, if case % 4 == 1 { 3 } else { 2 });
        let way = random_way(&mut random, &arm, case);
        let of = |decimals| {
            solved(&arm, &way.path(&arm, decimals), ElementCount::Auto, &Analysis::default())
        };
        let exact = of(16);
        for decimals in [3 + case % 3, 6 + case % 2] {
            let found = ratios(&of(decimals), &exact);
            println!("case {case}, {decimals} decimals: {found:.3?}");
            let is_bound = |[of_input, of_all]: &[f64; 2]| *of_all <= 1.0 && 30.0 * of_input >= 1.0;
            assert!(found.iter().all(is_bound), "case {case}, {decimals} decimals: {found:.3?}");
            all.extend(found);
        }
    }
    println!("{}", told(&all));
}

#[test]
fn the_stated_input_error_holds_for_coarse_paths_that_are_resampled() {
    let mut random = Random::of(4);
    let mut all = Vec::new();
    for case in 0..6 {
        let arm = random_arm(&mut random, 2);
        let way = Way { steps: 400, ..random_way(&mut random, &arm, case) };
        let exact = solved(&arm, &way.path(&arm, 16), ElementCount::Auto, &Analysis::default());
        let text = way.file([40, 20, 16][case % 3], 16);
        let table = read(&text, &arm);
        let table = table.resampled(way.duration_s / 400.0).unwrap();
        let path = path_of(&table);
        let found = solved(&arm, &path, ElementCount::Auto, &Analysis::default());
        let found = ratios(&found, &exact);
        println!("case {case}: {found:.3?}");
        let is_bound = |[of_input, of_all]: &[f64; 2]| *of_all <= 1.0 && 30.0 * of_input >= 1.0;
        assert!(found.iter().all(is_bound), "case {case}: {found:.3?}");
        all.extend(found);
    }
    println!("{}", told(&all));
}

/// A torque of few digits begins when it does by the exact path, within the error that a remark tells.
#[test]
fn the_start_and_the_end_of_an_arms_torques_have_their_errors() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let way = Way {
        names: vec!["x".to_owned(), "y".to_owned()],
        ends: vec![[0.9, 0.5], [-0.5, 0.8]],
        shape: septic,
        duration_s: 1.5,
        steps: 300,
    };
    let solved_with = |arm: &Arm, decimals| {
        solved(arm, &way.path(arm, decimals), ElementCount::Auto, &Analysis::default())
    };
    let of = |decimals| {
        let found = solved_with(&arm, decimals);
        let metrics = Metrics::of(&found);
        let remarks = Remark::on_timing(&found);
        // Rounded samples leave their rest later than exact ones.
        let Motion::Path(path) = &found.motion else { panic!("a path") };
        let (first, last) = path.moving_samples();
        let [from_s, until_s] = [first, last].map(|sample| found.motion.grid().time_s(sample));
        let times_s = metrics
            .joints
            .iter()
            .map(|own| [from_s - own.lead_s.unwrap(), until_s + own.lag_s.unwrap()]);
        (times_s.collect::<Vec<_>>(), remarks)
    };
    let (exact, none) = of(16);
    assert_eq!(none, [], "exact samples leave nothing open");
    let mut told = 0;
    for (found, remarks) in [of(4), of(5)] {
        for remark in &remarks {
            let Remark::Timing { joint: Some(joint), lead_s, lag_s, .. } = remark else {
                panic!("{remark}")
            };
            let [own, other] = [&found, &exact].map(|times_s| times_s[joint - 1]);
            let off_s = [0, 1].map(|end| f64::abs(own[end] - other[end]));
            assert!(off_s[0] <= *lead_s && off_s[1] <= *lag_s, "{remark}: {off_s:?}");
            assert!(remark.to_string().starts_with(&format!("joint {joint}: ")), "{remark}");
            assert!(remark.to_string().contains(" % of its range: "), "{remark}");
            told += 1;
        }
    }
    assert!(told > 0);
    // Without gravity errors are shares of peaks.
    let flat = solved_with(&self::arm(&two_links(), [0.0; 2]), 3);
    let remarks = Remark::on_timing(&flat);
    assert!(!remarks.is_empty());
    for remark in remarks {
        let Remark::Timing { joint: Some(joint), share, .. } = remark else { panic!("{remark}") };
        assert_eq!(Some(share), flat.joints[joint - 1].errors.torque.input);
        assert!(remark.to_string().contains(" % of its peak: "), "{remark}");
    }
}

/// Peaks lie between samples: those of a step four times as long are the same, though its largest samples differ.
#[test]
fn the_peaks_of_an_arm_do_not_change_with_the_step() {
    let arm = arm(&two_links(), [0.0, -9.81]);
    let of = |steps| {
        let way = Way {
            names: vec!["x".to_owned(), "y".to_owned()],
            ends: vec![[0.9, 0.5], [-0.5, 0.8]],
            shape: septic,
            duration_s: 1.5,
            steps,
        };
        solved(&arm, &way.path(&arm, 16), ElementCount::Auto, &Analysis::default())
    };
    let [coarse, fine] = [of(80), of(320)];
    let [own, other] = [&coarse, &fine].map(|solution| Metrics::of(solution).joints);
    let mut missed = 0.0_f64;
    for (joint, (own, other)) in own.iter().zip(&other).enumerate() {
        let numbers = |own: &JointMetrics| {
            let deflection_m = own.peak_deflection_m.expect("a link");
            [own.peak_torque_n_m, own.peak_hub_rate_rad_s, own.peak_power_w, deflection_m]
                .map(|peak| peak.value)
        };
        for (own, other) in numbers(own).into_iter().zip(numbers(other)) {
            assert!((own / other - 1.0).abs() < 1e-5, "joint {joint}: {own} {other}");
        }
        let sampled = largest(coarse.joints[joint].rate_rad_s.iter().copied());
        missed = missed.max(1.0 - sampled / other.peak_hub_rate_rad_s.value);
    }
    assert!(missed > 1e-4, "the largest samples are the peaks: {missed:e}");
}
