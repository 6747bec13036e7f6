//! Bad samples of tables: none is seen in good ones, and those that are there are named, or what they do is told.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "numbers of samples and of choices, not negative and small"
)]

use std::f64::consts::TAU;

use flexlink::csv::MotionTable;
use flexlink::inverse::SolutionWarning;
use flexlink::link::{Damping, Hub, Link, LinkParts, Segment};
use flexlink::motion::MotionColumns;
use flexlink::numeric::largest;
use flexlink::recording::{Change, outliers};

use crate::recordings::{Random, apart, min_jerk, septic, sine, solved};

/// A displacement from 0 to 1 over a time from 0 to 1, and its derivatives.
type Shape = fn(f64) -> [f64; 3];

fn versine(s: f64) -> [f64; 3] {
    let (angle, rate) = (0.5 * TAU * s, 0.5 * TAU);
    [0.5 - 0.5 * angle.cos(), 0.5 * rate * angle.sin(), 0.5 * rate * rate * angle.cos()]
}

/// Full acceleration, then full deceleration.
fn bang_bang(s: f64) -> [f64; 3] {
    if s < 0.5 {
        [2.0 * s * s, 4.0 * s, 4.0]
    } else {
        [1.0 - 2.0 * (1.0 - s).powi(2), 4.0 * (1.0 - s), -4.0]
    }
}

/// A quarter of the time up to speed, a quarter down.
fn trapezoid(s: f64) -> [f64; 3] {
    let rate = 1.0 / (0.25 * 0.75);
    let speed = 0.25 * rate;
    match s {
        _ if s < 0.25 => [0.5 * rate * s * s, rate * s, rate],
        _ if s <= 0.75 => [speed * (s - 0.125), speed, 0.0],
        _ => [1.0 - 0.5 * rate * (1.0 - s).powi(2), rate * (1.0 - s), -rate],
    }
}

/// The mean of a trapezoid over a tenth of its time: jerk in pulses.
fn s_curve(s: f64) -> [f64; 3] {
    // The integral of the trapezoid's displacement.
    let sum = |s: f64| {
        let rate = 1.0 / (0.25 * 0.75);
        let rise = |s: f64| rate * s.powi(3) / 6.0;
        let even = |s: f64| rise(0.25) + 0.25 * rate * (0.5 * s * s - 0.125 * s);
        match s {
            _ if s <= 0.0 => 0.0,
            _ if s < 0.25 => rise(s),
            _ if s < 0.75 => even(s),
            _ if s < 1.0 => even(0.75) + (s - 0.75) + rise(1.0 - s) - rise(0.25),
            _ => even(0.75) + 0.25 - rise(0.25) + (s - 1.0),
        }
    };
    let (now, before) = (1.1 * s, 1.1 * s - 0.1);
    let at = |s: f64, order: usize| match s {
        _ if s <= 0.0 => 0.0,
        _ if s >= 1.0 => f64::from(order == 0),
        _ => trapezoid(s)[order],
    };
    let mean = |order: usize| (at(now, order) - at(before, order)) / 0.1;
    [(sum(now) - sum(before)) / 0.1, 1.1 * mean(0), 1.1 * 1.1 * mean(1)]
}

const SHAPES: [Shape; 7] = [min_jerk, septic, sine, versine, bang_bang, trapezoid, s_curve];

/// A random motion: samples of place, velocity and acceleration without errors, and a record of the place.
struct Case {
    time_s: Vec<f64>,
    exact: [Vec<f64>; 3],
    recorded: Vec<f64>,
    /// Standard deviation of the record's noise and of its rounding.
    deviations: [f64; 2],
    /// Samples of a leg of the motion.
    leg: usize,
    rest: usize,
    is_uniform: bool,
}

fn one_of<T: Copy, const N: usize>(all: [T; N], random: &mut Random) -> T {
    all[(random.next() * N as f64) as usize]
}

/// Legs of `fewest` samples or more: one move, several, there and back, or a cycle of two harmonics; sometimes at uneven
/// times, with noise, or in steps.
fn case(random: &mut Random, fewest: usize) -> Case {
    let shape = one_of(SHAPES, random);
    let kind = one_of([0, 0, 1, 2, 3], random);
    let legs = [1, 1 + (random.next() * 3.0) as usize, 2, 2][kind];
    let leg = one_of([9, 12, 20, 40, 80, 160, 320], random).max(fewest);
    let rest = one_of([0, 3, 6, 20, 60], random);
    let shift = one_of([0.0, random.next()], random);
    let (moved, total) = (leg * legs, leg * legs + 2 * rest);
    let travel = one_of([1.0, 0.5, 0.05, 300.0], random);
    let ends: Vec<f64> =
        (0..=legs).map(|leg| if leg == 0 { 0.0 } else { random.between(-1.0, 1.0) }).collect();
    let at = |k: f64| -> [f64; 3] {
        let all = moved as f64;
        let place = (k - rest as f64 + shift) / all;
        let s = place.clamp(0.0, 1.0);
        let rests = place <= 0.0 || place >= 1.0;
        let scaled = |[x, v, a]: [f64; 3], size: f64, rate: f64| {
            [size * x, size * rate * v, size * rate * rate * a]
        };
        let [x, v, a] = match kind {
            0 => scaled(shape(s), 1.0, 1.0 / all),
            1 => {
                let leg = ((s * legs as f64) as usize).min(legs - 1);
                let size = ends[leg + 1] - ends[leg];
                let [x, v, a] = shape(s * legs as f64 - leg as f64);
                let [x, v, a] = scaled([x, v, a], size, legs as f64 / all);
                [ends[leg] + x, v, a]
            }
            2 if s < 0.5 => scaled(shape(2.0 * s), 1.0, 2.0 / all),
            2 => scaled(shape(2.0 - 2.0 * s), 1.0, -2.0 / all),
            _ => {
                let wave = |times: f64, size: f64| {
                    let rate = TAU * times / total as f64;
                    let (sin, cos) = (rate * k + times * shift).sin_cos();
                    [size * sin, size * rate * cos, -size * rate * rate * sin]
                };
                let (one, two) = (wave(1.0, 1.0), wave(2.0, 0.3));
                [one[0] + two[0], one[1] + two[1], one[2] + two[2]]
            }
        };
        if rests && kind != 3 { [travel * x, 0.0, 0.0] } else { [x, v, a].map(|own| travel * own) }
    };
    let is_uniform = random.next() > 0.25;
    let mut time_s: Vec<f64> = (0..=total).map(|k| k as f64).collect();
    if !is_uniform {
        for time in &mut time_s {
            *time += random.between(-0.04, 0.04);
        }
    }
    let exact = [0, 1, 2].map(|order| time_s.iter().map(|k| at(*k)[order]).collect());
    let noise = one_of([0.0, 0.0, 10_f64.powf(random.between(-7.0, -2.0))], random);
    let quantum = travel * one_of([0.0, 0.0, 1e-2, 1e-3, 1e-5, 0.0037], random);
    let deviation = travel * noise;
    let read = |x: &f64| {
        let value = x + deviation * random.normal();
        if quantum > 0.0 { (value / quantum).round() * quantum } else { value }
    };
    let exact: [Vec<f64>; 3] = exact;
    let recorded = exact[0].iter().map(read).collect();
    let deviations = [deviation, quantum / 12_f64.sqrt()];
    Case { time_s, exact, recorded, deviations, leg, rest, is_uniform }
}

/// Numbers of the samples that do not follow their neighbours.
fn bad_in(time_s: &[f64], values: &[f64], change: Change) -> Vec<usize> {
    outliers(time_s, values, change).iter().map(|own| own.sample).collect()
}

#[test]
fn good_motions_have_no_bad_samples() {
    let mut random = Random(49);
    let (mut tables, mut columns) = (0, 0);
    for number in 0..4000 {
        let case = case(&mut random, 12);
        let judge = |values: &[f64], change| {
            let bad = bad_in(&case.time_s, values, change);
            assert!(bad.is_empty(), "case {number}, {change:?}, legs of {}: {bad:?}", case.leg);
        };
        judge(&case.recorded, Change::Continuous);
        judge(&case.exact[0], Change::Continuous);
        tables += 2;
        for values in &case.exact[1..] {
            judge(values, Change::Jumping);
            columns += 1;
        }
    }
    println!("no bad sample in {tables} tables of places and {columns} of rates");
}

/// Steps from the first of some bad samples to the others.
const PATTERNS: [&[usize]; 9] =
    [&[0], &[0], &[0, 1], &[0, 2], &[0, 3], &[0, 1, 2], &[0, 1, 3], &[0, 8], &[0, 5, 6]];

/// What becomes of a table with bad samples.
#[derive(Debug, Default)]
struct Tally {
    all: usize,
    some: usize,
    with_others: usize,
    others: usize,
    unseen: usize,
}

#[test]
fn bad_samples_are_named_wherever_they_are() {
    let mut random = Random(7);
    let mut tallies: [[Tally; 2]; 3] = Default::default();
    for _ in 0..3000 {
        let case = case(&mut random, 80);
        let noise = case.deviations[0].hypot(case.deviations[1]);
        let noise = noise.max(1e-5 * largest(&case.exact[0]));
        let size = 10_f64.powf(random.between(0.5, 3.0));
        let pattern = one_of(PATTERNS, &mut random);
        let span = pattern[pattern.len() - 1];
        let len = case.recorded.len();
        let place = one_of([0, 1, 2, 2, 2, 2], &mut random);
        let first = match place {
            0 => (3.0 * random.next()) as usize,
            1 => len - 1 - span - (3.0 * random.next()) as usize,
            _ => 3 + (random.next() * (len - span - 6) as f64) as usize,
        };
        let bad: Vec<usize> = pattern.iter().map(|step| first + step).collect();
        let mut values = case.recorded.clone();
        for sample in &bad {
            let sign = one_of([1.0, -1.0], &mut random);
            values[*sample] += sign * noise * size * random.between(0.7, 1.4);
        }
        let found = bad_in(&case.time_s, &values, Change::Continuous);
        let is_right = |sample: &usize| bad.contains(sample);
        let class = if size < 9.0 {
            0
        } else if size < 50.0 {
            1
        } else {
            2
        };
        let tally = &mut tallies[class][usize::from(place < 2)];
        let count = match found.iter().filter(|sample| is_right(sample)).count() {
            right if found == bad => {
                assert_eq!(right, bad.len());
                &mut tally.all
            }
            0 if found.is_empty() => &mut tally.unseen,
            0 => &mut tally.others,
            right if right == found.len() => &mut tally.some,
            _ => &mut tally.with_others,
        };
        *count += 1;
    }
    for (size, [inside, ends]) in ["3 to 9", "9 to 50", "50 to 1000"].iter().zip(&tallies) {
        println!("{size} times the noise: inside {inside:?}, at the ends {ends:?}");
    }
    // Those that are not seen are covered by the next test. At the ends fewer are: what leads there from one side is less
    // sure.
    for (class, most_unseen) in [(1, 0.5), (2, 0.15)] {
        for Tally { all, some, with_others, others, unseen } in &tallies[class] {
            let seen = all + some + with_others;
            let tables = (seen + others + unseen) as f64;
            assert!(*unseen as f64 <= most_unseen * tables, "{class}: {unseen} of {tables}");
            // A good sample is named first in few, and in none that are far off.
            assert!(*others * [0, 25, 200][class] <= seen, "{class}: {others} beside {seen}");
        }
    }
}

/// A link of a metre and a half.
fn link() -> Link {
    Link::new(LinkParts {
        segments: vec![Segment::uniform(1.5, 5.0, 0.8)],
        hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
        damping: Damping::Hysteretic { ratio: 0.02 },
        ..LinkParts::default()
    })
    .unwrap()
}

#[test]
fn a_bad_sample_that_is_not_refused_is_told_by_the_error_of_the_input_or_a_warning() {
    const STEP_S: f64 = 0.005;
    let link = link();
    let mut random = Random(11);
    let (mut counts, mut untold) = ([0; 4], 0);
    let mut solves = 0;
    while solves < 100 {
        let case = case(&mut random, 80);
        if !case.is_uniform || case.rest < 20 || case.leg > 160 {
            continue;
        }
        let time_s: Vec<f64> = case.time_s.iter().map(|k| k * STEP_S).collect();
        // Half a metre at the most.
        let scale = 0.5 / largest(&case.exact[0]);
        let metres = |values: &[f64]| values.iter().map(|x| scale * x).collect::<Vec<f64>>();
        let exact_m = metres(&case.exact[0]);
        let mut recorded_m = metres(&case.recorded);
        let [noise_m, rounding_m] = case.deviations.map(|own| scale * own);
        let len = recorded_m.len();
        let pattern = one_of(PATTERNS, &mut random);
        let first = (random.next() * (len - 9) as f64) as usize;
        let error_m = noise_m.hypot(rounding_m).max(1e-6) * 10_f64.powf(random.between(0.5, 1.7));
        for step in pattern {
            recorded_m[first + step] += one_of([1.0, -1.0], &mut random) * error_m;
        }
        let motion = |displacement_m: &[f64], noise_m: f64| {
            let columns = MotionColumns {
                time_s: time_s.clone(),
                displacement_m: Some(displacement_m.to_vec()),
                ..Default::default()
            };
            let table = MotionTable::of_columns("motion", columns)?;
            let table = if noise_m > 0.0 { table.with_noise(noise_m)? } else { table };
            table.into_motion().map(|motion| motion.into_tip().unwrap())
        };
        // Motions that do not end at rest, or that are warned of as they are, tell nothing.
        let Ok(exact) = motion(&exact_m, 0.0) else { continue };
        let exact = solved(&link, &exact);
        if !exact.warnings.is_empty() {
            continue;
        }
        solves += 1;
        let Ok(read) = motion(&recorded_m, noise_m) else {
            counts[0] += 1;
            continue;
        };
        let found = solved(&link, &read);
        let apart = apart(&found, &exact);
        let claimed = found.hub().errors.torque.input.unwrap_or(0.0);
        let kinds: Vec<_> = found.warnings.iter().map(SolutionWarning::kind).collect();
        if apart < 1e-3 {
            counts[1] += 1;
        } else if 2.0 * claimed >= apart {
            counts[2] += 1;
        } else {
            println!("off by {apart:.2e}, claimed {claimed:.1e}, {kinds:?}");
            counts[3] += 1;
            // A sample that is off by less than the bends of a motion without noise: known to be untold.
            untold += usize::from(kinds.is_empty());
            assert!(!kinds.is_empty() || apart < 0.15, "off by {apart:.2e}, claimed {claimed:.1e}");
        }
    }
    let [refused, unharmed, covered, warned] = counts;
    println!(
        "refused {refused}, unharmed {unharmed}, claimed {covered}, warned of {warned}, untold {untold}"
    );
    assert!(refused >= 20 && untold <= 2);
}
