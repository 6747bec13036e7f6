//! Recorded motions: few decimals, noise, times that are not quite uniform.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]
#![expect(
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "numbers of samples and of decimals, not negative and small"
)]

use std::f64::consts::TAU;
use std::fmt::Write as _;

use flexlink::beam::MeshPlan;
use flexlink::csv::{TableError, read_motion_table};
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{Damping, Hub, Link, LinkParts, Payload, Segment};
use flexlink::motion::{Ends, TipMotion};
use flexlink::numeric::largest;
use flexlink::result::{Metrics, Remark};
use flexlink::spec::read_specification;

use crate::common::displaced;

/// Numbers between 0 and 1 that are the same in every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Those of a seed, others where `FLEXLINK_TRAPS_SEED` is set.
    pub(crate) fn of(seed: u64) -> Self {
        let other = std::env::var("FLEXLINK_TRAPS_SEED");
        let other = other.map_or(0, |text| text.parse().expect("a seed is a number"));
        Self(seed.wrapping_add(other * 1_000_003))
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Between two numbers above 0, every factor as likely.
    pub(crate) fn over(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    /// Normal with deviation 1, by Box and Muller.
    pub(crate) fn box_muller(&mut self) -> f64 {
        let turn = std::f64::consts::TAU;
        (-2.0 * (1.0 - self.next()).ln()).sqrt() * (turn * self.next()).cos()
    }

    /// Normal with deviation 1, nearly: the sum of twelve.
    pub(crate) fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

/// Displacement from 0 to 1 over the time from 0 to 1, its first and its second derivative.
pub(crate) type Shape = fn(f64) -> [f64; 3];

/// A motion from rest to rest with half its duration of rest on either side.
#[derive(Clone, Copy)]
struct Move {
    shape: Shape,
    travel_m: f64,
    duration_s: f64,
    steps: u32,
}

impl Move {
    const PAPER: Self = Self { shape: septic, travel_m: 0.5, duration_s: 1.0, steps: 500 };

    fn step_s(&self) -> f64 {
        self.duration_s / f64::from(self.steps)
    }

    /// Displacement in m at a time in s from the first sample.
    fn at(&self, time_s: f64) -> f64 {
        self.derivatives(time_s)[0]
    }

    /// Displacement in m, velocity and acceleration there.
    fn derivatives(&self, time_s: f64) -> [f64; 3] {
        let [x, v, a] = (self.shape)((time_s / self.duration_s - 0.5).clamp(0.0, 1.0));
        let rate = self.duration_s.recip();
        [x, rate * v, rate * rate * a].map(|own| self.travel_m * own)
    }

    /// A file of its velocity or acceleration in so many decimals.
    fn file_of(&self, order: usize, decimals: usize) -> String {
        let mut text = format!("time,{}\n", ["displacement", "velocity", "acceleration"][order]);
        for k in 0..=2 * self.steps {
            let time_s = f64::from(k) * self.step_s();
            writeln!(text, "{time_s:.12},{:.decimals$}", self.derivatives(time_s)[order]).unwrap();
        }
        text
    }

    /// The exact motion with so many samples for each.
    fn exact(&self, finer: u32) -> TipMotion {
        let step_s = self.step_s() / f64::from(finer);
        let time_s: Vec<f64> =
            (0..=2 * finer * self.steps).map(|k| f64::from(k) * step_s).collect();
        let displacement_m = time_s.iter().map(|time| self.at(*time)).collect();
        displaced(time_s, displacement_m)
    }

    /// A file of it: displacements in so many decimals, times off by up to `jitter` steps, noise in m.
    fn file(&self, decimals: usize, jitter: f64, noise_m: f64, random: &mut Random) -> String {
        let mut text = "time,displacement\n".to_owned();
        for k in 0..=2 * self.steps {
            let off = jitter * random.between(-1.0, 1.0);
            let time_s = (f64::from(k) + off) * self.step_s();
            let displacement_m = self.at(time_s) + noise_m * random.normal();
            writeln!(text, "{time_s:.12},{displacement_m:.decimals$}").unwrap();
        }
        text
    }
}

pub(crate) fn septic(s: f64) -> [f64; 3] {
    [
        s.powi(4) * (35.0 - 84.0 * s + 70.0 * s * s - 20.0 * s.powi(3)),
        140.0 * (s * (1.0 - s)).powi(3),
        420.0 * (s * (1.0 - s)).powi(2) * (1.0 - 2.0 * s),
    ]
}

pub(crate) fn min_jerk(s: f64) -> [f64; 3] {
    [
        s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s),
        30.0 * (s * (1.0 - s)).powi(2),
        60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
    ]
}

/// A step; before it 0 and after it 1.
pub(crate) fn ninth(s: f64) -> [f64; 3] {
    let s = s.clamp(0.0, 1.0);
    let left = s * (1.0 - s);
    [
        s.powi(5) * (126.0 + s * (-420.0 + s * (540.0 + s * (-315.0 + 70.0 * s)))),
        630.0 * left.powi(4),
        2520.0 * left.powi(3) * (1.0 - 2.0 * s),
    ]
}

pub(crate) fn sine(s: f64) -> [f64; 3] {
    use std::f64::consts::TAU;
    let turned = TAU * s;
    [s - turned.sin() / TAU, 1.0 - turned.cos(), TAU * turned.sin()]
}

fn paper() -> Link {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/specs/bayo1987_example1.toml");
    let text = std::fs::read_to_string(path).unwrap();
    read_specification("link.toml", &text, &[]).unwrap().link().clone()
}

/// A link with a hub and perhaps a payload, and its first natural frequency with the hub free, about, in Hz.
fn random_link(random: &mut Random) -> (Link, f64) {
    let length_m = random.between(0.4, 2.5);
    let mass_kg_m = random.between(0.2, 2.0);
    let stiffness = 0.5 * length_m.powi(3) * 10.0_f64.powf(random.between(0.0, 2.0));
    let payload = [0.0, 0.1, 0.5][(3.0 * random.next()) as usize] * mass_kg_m * length_m;
    let inertia_kg_m2 = mass_kg_m * length_m.powi(3) * 10.0_f64.powf(random.between(-2.0, 0.0));
    let link = Link::new(LinkParts {
        segments: vec![Segment::uniform(length_m, stiffness, mass_kg_m)],
        hub: Hub { inertia_kg_m2, ..Hub::default() },
        payload: Payload { mass_kg: payload, ..Payload::default() },
        damping: Damping::Hysteretic { ratio: 0.02 },
        ..LinkParts::default()
    })
    .unwrap();
    // Clamped, without payload: 3.516/2π √(EI/mL⁴).
    let hertz = 0.56 * (stiffness / (mass_kg_m * length_m.powi(4))).sqrt();
    (link, hertz)
}

pub(crate) fn solved(link: &Link, motion: &TipMotion) -> Solution {
    invert(link, &MeshPlan::automatic(link), motion, &Analysis::default()).unwrap()
}

fn recorded(link: &Link, text: &str) -> Result<Solution, TableError> {
    let table = read_motion_table("move.csv", text.as_bytes(), link.length_m())?;
    Ok(solved(link, &table.into_motion()?.into_tip().unwrap()))
}

/// Largest difference of the torques at any time, over the peak of the first.
pub(crate) fn apart(found: &Solution, exact: &Solution) -> f64 {
    apart_in(found, exact, |solution| solution.hub().torque_n_m.clone())
}

/// The same of any history.
fn apart_in(found: &Solution, exact: &Solution, of: fn(&Solution) -> Vec<f64>) -> f64 {
    let [found_in, exact_in] = [found, exact].map(of);
    let at = |time_s: f64| {
        let place = (time_s - exact.grid.time_s(0)) / exact.grid.step_s;
        let before = place.floor();
        let sample = |k: f64| {
            let inside = k >= 0.0 && k < exact_in.len() as f64;
            if inside { exact_in[k as usize] } else { 0.0 }
        };
        let share = place - before;
        (1.0 - share) * sample(before) + share * sample(before + 1.0)
    };
    let off = found_in.iter().enumerate();
    let off: Vec<f64> = off.map(|(k, own)| own - at(found.grid.time_s(k))).collect();
    largest(&off) / largest(&found_in)
}

#[test]
fn the_papers_motion_keeps_its_torque_with_jitter_and_few_decimals() {
    let link = paper();
    let exact = solved(&link, &Move::PAPER.exact(1));
    let peak_n_m = largest(&exact.hub().torque_n_m);
    assert!((peak_n_m - 1.313).abs() < 1e-3, "{peak_n_m}");
    let mut random = Random(1);
    // A microsecond of two milliseconds.
    for (decimals, jitter, most) in
        [(12, 5e-4, 1e-3), (12, 0.04, 1e-3), (4, 0.0, 0.02), (4, 0.04, 0.02), (3, 0.0, 0.1)]
    {
        let found = recorded(&link, &Move::PAPER.file(decimals, jitter, 0.0, &mut random)).unwrap();
        let apart = apart(&found, &exact);
        let input = found.hub().errors.torque.input;
        println!("{decimals} decimals, jitter {jitter}: {apart:.2e}, stated {input:?}");
        assert!(apart < most, "{decimals} decimals, jitter {jitter}: {apart}");
        assert_eq!(input.is_some(), decimals < 12);
        assert_eq!(found.motion.tip().unwrap().recording().jitter.is_some(), jitter > 0.0);
    }
    let stray = Move::PAPER.file(12, 0.2, 0.0, &mut random);
    let Err(error) = recorded(&link, &stray) else { panic!("jitter of a fifth of a step") };
    assert!(error.hint().unwrap().contains("--resample"), "{error}");
}

#[test]
fn noise_on_the_papers_motion_is_followed_as_closely_as_it_deserves() {
    let link = paper();
    let exact = solved(&link, &Move::PAPER.exact(1));
    for (seed, deviation_m) in [(1, 1e-5), (2, 1e-4), (3, 1e-4), (4, 1e-3)] {
        let text = Move::PAPER.file(9, 0.0, deviation_m, &mut Random(seed));
        let table = read_motion_table("move.csv", text.as_bytes(), 1.5).unwrap();
        let motion =
            table.with_noise(deviation_m).unwrap().into_motion().unwrap().into_tip().unwrap();
        let found = solved(&link, &motion);
        let (apart, input) = (apart(&found, &exact), found.hub().errors.torque.input.unwrap());
        println!("noise {deviation_m}: {apart:.2e}, stated {input:.2e}");
        assert!(apart < input, "{deviation_m}: {apart} {input}");
        // The times of the torque are told with their error where that is more than 5 %.
        let [told, true_s] = [&found, &exact].map(|solution| *Metrics::of(solution).hub());
        let [lead_s, lag_s] = match Remark::on_timing(&found)[..] {
            [Remark::Timing { lead_s, lag_s, .. }] => [lead_s, lag_s],
            _ => [0.05 * told.lead_s.unwrap(), 0.05 * told.lag_s.unwrap()],
        };
        for (told, true_s, error_s) in
            [(told.lead_s, true_s.lead_s, lead_s), (told.lag_s, true_s.lag_s, lag_s)]
        {
            let off_s = (told.unwrap() - true_s.unwrap()).abs();
            println!("  {told:?} for {true_s:?} s, off by {off_s:.2e}, told {error_s:.2e}");
            assert!(off_s < error_s, "{deviation_m}: {off_s} {error_s}");
        }
    }
}

#[test]
fn the_stated_input_error_holds_for_random_links_and_motions() {
    let mut random = Random::of(7);
    let shapes: [(&str, Shape); 3] = [("septic", septic), ("min-jerk", min_jerk), ("sine", sine)];
    let (mut least, mut refused) = (f64::INFINITY, 0);
    println!("motion    steps decimals jitter  step/travel  true error  stated");
    for case in 0..30 {
        let (link, hertz) = random_link(&mut random);
        let (name, shape) = shapes[case % 3];
        let wanted = Move {
            shape,
            travel_m: link.length_m() * random.between(0.05, 0.3),
            duration_s: random.between(1.0, 5.0) / hertz,
            steps: random.between(100.0, 1000.0) as u32,
        };
        let exact = solved(&link, &wanted.exact(8));
        for decimals in 2..=6 {
            let jitter = if (case + decimals) % 2 == 0 { 0.04 } else { 0.0 };
            let text = wanted.file(decimals, jitter, 0.0, &mut random);
            let rounding = 0.1_f64.powi(decimals as i32) / wanted.travel_m;
            let Ok(found) = recorded(&link, &text) else {
                // The travel as it is read is rounded, too.
                assert!(rounding > 0.07, "{rounding}");
                refused += 1;
                continue;
            };
            let errors = found.hub().errors.torque;
            let others = errors.mesh + errors.window + exact.hub().errors.torque.mesh;
            let stated = errors.input.unwrap() + others;
            let apart = apart(&found, &exact);
            println!(
                "{name:9} {:5} {decimals:8} {jitter:6} {rounding:12.1e} {apart:11.2e} {stated:7.1e}",
                wanted.steps
            );
            assert!(apart <= stated, "case {case}: {apart} {stated}");
            least = least.min(stated / apart);
        }
    }
    println!("stated over true error at least {least:.2}; {refused} refused");
}

#[test]
fn the_stated_input_error_holds_for_velocities_and_accelerations_of_few_digits() {
    let mut random = Random::of(11);
    let shapes: [Shape; 3] = [septic, min_jerk, sine];
    let mut ratios = Vec::new();
    for case in 0..8 {
        let (link, hertz) = random_link(&mut random);
        let wanted = Move {
            shape: shapes[case % 3],
            travel_m: link.length_m() * random.between(0.05, 0.3),
            duration_s: random.between(1.0, 5.0) / hertz,
            steps: random.between(100.0, 1000.0) as u32,
        };
        let exact = solved(&link, &wanted.exact(8));
        for order in [1, 2] {
            let times = (0..=2 * wanted.steps).map(|k| f64::from(k) * wanted.step_s());
            let peak =
                times.map(|time_s| wanted.derivatives(time_s)[order].abs()).fold(0.0, f64::max);
            // From 10 to 100 of the last decimal, from 100 to 1000, …
            let decimals =
                (2.0 + f64::from(case as u32 / 3 % 3) - peak.log10().floor()) as usize - 1;
            let found = recorded(&link, &wanted.file_of(order, decimals)).unwrap();
            let errors = found.hub().errors;
            let of_torque = (apart(&found, &exact), errors.torque);
            let of_hub = (
                apart_in(&found, &exact, |own| own.acceleration_rad_s2(0).into_owned()),
                errors.hub_acceleration.unwrap(),
            );
            for (apart, own) in [of_torque, of_hub] {
                let stated = own.mesh + own.window + own.input.unwrap_or(0.0);
                println!(
                    "case {case} order {order} decimals {decimals}: {apart:.1e} of {stated:.1e}"
                );
                assert!(apart <= 2.0 * stated, "case {case}, order {order}: {apart} {stated}");
                assert!(stated <= 30.0 * apart, "case {case}, order {order}: {apart} {stated}");
                ratios.push(apart / stated);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    println!("true over stated error: median {:.2}", ratios[ratios.len() / 2]);
}

/// Samples do not tell where an acceleration has a kink between them.
#[test]
fn the_stated_input_error_holds_for_kinks_of_accelerations() {
    let mut random = Random::of(13);
    let shapes: [Shape; 3] = [septic, min_jerk, sine];
    let mut judged = 0;
    for case in 0..18 {
        let (link, hertz) = random_link(&mut random);
        let wanted = Move {
            shape: shapes[case % 3],
            travel_m: link.length_m() * random.between(0.05, 0.3),
            duration_s: random.between(1.0, 5.0) / hertz,
            steps: (40.0 * 25.0_f64.powf(random.next())) as u32,
        };
        let exact = solved(&link, &wanted.exact(8));
        let found = recorded(&link, &wanted.file_of(2, 16)).unwrap();
        let (apart, own) = (apart(&found, &exact), found.hub().errors.torque);
        let stated = own.mesh + own.window + own.input.unwrap_or(0.0);
        println!("case {case}, {} steps: {apart:.1e} of {stated:.1e}", wanted.steps);
        // Below that the two cut-offs, each for its own samples, and the mesh have a larger share.
        if apart > 1e-5 {
            assert!(apart <= 2.0 * stated, "case {case}: {apart} {stated}");
            assert!(stated <= 30.0 * apart, "case {case}: {apart} {stated}");
            judged += 1;
        }
    }
    assert!(judged >= 6, "{judged} cases only");
}

/// A cycle of any number of rows has no kinks beside them.
#[test]
fn a_cosine_states_no_error_of_its_samples() {
    let link = paper();
    for rows in [101, 107, 499, 500] {
        let mut text = "time,acceleration\n".to_owned();
        for k in 0..rows {
            let time_s = f64::from(k) / f64::from(rows);
            writeln!(text, "{time_s:.16},{:.17e}", libm::cos(TAU * time_s)).unwrap();
        }
        let table = read_motion_table("cycle.csv", text.as_bytes(), 1.5).unwrap();
        let motion = table.with_ends(Ends::Periodic).into_motion().unwrap().into_tip().unwrap();
        let input = solved(&link, &motion).hub().errors.torque.input;
        assert!(input.is_none_or(|input| input < 1e-6), "{rows}: {input:?}");
    }
}

/// A table of four or five rows does not tell what lies between them.
#[test]
fn a_table_of_five_rows_is_not_known_between_them() {
    let link = paper();
    for rows in [4, 5, 6] {
        let mut text = "time,displacement\n".to_owned();
        for k in 0..rows {
            let time_s = f64::from(k) / f64::from(rows - 1);
            writeln!(text, "{time_s:.16},{:.17e}", 0.5 * septic(time_s)[0]).unwrap();
        }
        let table = read_motion_table("move.csv", text.as_bytes(), 1.5).unwrap();
        let motion = table.resampled(0.001).unwrap().into_motion().unwrap().into_tip().unwrap();
        let input = solved(&link, &motion).hub().errors.torque.input;
        assert!(input.is_some_and(|input| input > 0.1), "{rows}: {input:?}");
    }
}

#[test]
fn the_stated_input_error_holds_for_coarse_tables_that_are_resampled() {
    let mut random = Random::of(5);
    let shapes: [Shape; 3] = [septic, min_jerk, sine];
    for case in 0..18 {
        let (link, hertz) = random_link(&mut random);
        let wanted = Move {
            shape: shapes[case % 3],
            travel_m: link.length_m() * random.between(0.05, 0.3),
            duration_s: random.between(2.0, 5.0) / hertz,
            steps: 400,
        };
        let exact = solved(&link, &wanted.exact(4));
        let rows = [10, 20, 30, 50][case % 4];
        let order = [0, 2][case / 9];
        let mut text = format!("time,{}\n", ["displacement", "", "acceleration"][order]);
        for k in 0..=2 * rows {
            let is_end = k == 0 || k == 2 * rows;
            let off = if is_end { 0.0 } else { random.between(-0.2, 0.2) };
            let time_s = (f64::from(k) + off) * wanted.duration_s / f64::from(rows);
            writeln!(text, "{time_s:.15e},{:.17e}", wanted.derivatives(time_s)[order]).unwrap();
        }
        let table = read_motion_table("move.csv", text.as_bytes(), link.length_m()).unwrap();
        // An acceleration of few rows may not integrate to 0.
        let Ok(motion) = table.resampled(wanted.step_s()).unwrap().into_motion() else {
            assert_eq!(order, 2, "case {case}, {rows} rows");
            continue;
        };
        let found = solved(&link, &motion.into_tip().unwrap());
        let (apart, own) = (apart(&found, &exact), found.hub().errors.torque);
        let stated = own.mesh + own.window + own.input.unwrap_or(0.0);
        println!("case {case}, order {order}, {rows} rows: {apart:.1e} of {stated:.1e}");
        let ratio = stated / apart;
        assert!((0.5..30.0).contains(&ratio), "case {case}, {rows} rows: {apart} {stated}");
    }
}
