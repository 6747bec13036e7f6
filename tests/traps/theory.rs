//! The truth against what is published and against itself.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::answer::Exact;
use super::beam::{Beam, Frequency};
use super::link::{Body, Damping, Joint, Link, Payload, Segment};
use super::modes::natural_frequencies;
use super::motion::{Column, Motion, Profile};
use super::published::assert_published;
use super::truth::{Run, Truth};

/// A link with everything on it.
fn laden() -> Link {
    let mut link = Link::paper();
    link.radius_m = 0.05;
    link.bodies.push(Body { at_m: 0.7, mass_kg: 0.2, inertia_kg_m2: 0.003 });
    link.payload = Payload { mass_kg: 0.3, inertia_kg_m2: 0.02, offset_m: 0.1 };
    link
}

#[test]
fn the_uniform_link_has_the_published_transfer() {
    let exact = Exact::new(&Link::uniform(1.5, 5.0, 0.8, 0.1), &[]);
    assert_published(|hz| exact.at(TAU * hz).torque);
}

/// A link with everything on it, on a carriage, with a spring at its root and a station as output.
fn otherwise() -> Link {
    let joint = Joint::Carriage;
    let at = Link { joint, radius_m: 0.0, root_n_m_rad: 40.0, output_m: Some(1.1), ..laden() };
    Link { hub_kg_m2: 0.7, ..at }
}

/// Closed form of a uniform link on a carriage of 1 kg.
#[test]
fn a_uniform_link_on_a_carriage_has_the_transfer_of_the_closed_form() {
    let link = Link { joint: Joint::Carriage, ..Link::uniform(1.5, 5.0, 0.8, 1.0) };
    let exact = Exact::new(&link, &[]);
    for (hz, re, im) in [
        (0.5, 0.922_716_750_3, 0.037_845_385_13),
        (1.0, -0.631_178_851, 0.043_492_777_8),
        (2.0, -1.429_474_67, -0.004_409_163),
        (5.0, 0.517_749_270_7, -0.060_103_755_7),
        (10.0, 0.535_320_734_3, 0.080_418_613_4),
        (20.0, -0.503_883_504_8, -0.107_932_303_8),
    ] {
        let (found, expected) = (exact.at(TAU * hz).torque, Complex64::new(re, im));
        assert!((found - expected).norm() < 2e-9 * expected.norm(), "{hz} Hz: {found} {expected}");
    }
}

/// A carriage moves as a hub of a very long radius does, with stations and springs, too.
#[test]
fn a_long_hub_is_a_carriage() {
    let carriage = otherwise();
    let radius_m = 1e6;
    let mut hub = carriage.clone();
    hub.joint = Joint::Hub;
    hub.radius_m = radius_m;
    hub.hub_kg_m2 *= radius_m * radius_m;
    hub.output_m = hub.output_m.map(|at_m| at_m + radius_m);
    hub.bodies.iter_mut().for_each(|body| body.at_m += radius_m);
    let exact = [Exact::new(&carriage, &[0.4]), Exact::new(&hub, &[0.4 + radius_m])];
    for omega in [0.5, 7.0, 31.0, 90.0, 400.0] {
        let [own, long] = exact.each_ref().map(|exact| exact.at(omega));
        let near = |a: Complex64, b: Complex64, what: &str| {
            assert!((a - b).norm() < 1e-5 * a.norm(), "{what} at {omega} rad/s: {a} {b}");
        };
        near(own.torque, long.torque / radius_m, "force");
        near(own.moment[0], long.moment[0], "moment");
    }
}

#[test]
fn series_and_waves_are_one_solution_where_both_hold() {
    for (link, bound) in
        [(Link::paper(), 1e-9), (laden(), 1e-9), (Link::tube(), 1e-9), (otherwise(), 1e-9)]
    {
        let beam = Beam::new(&link, 1, &[0.07, 0.4, 0.7, link.length_m()]);
        for omega in [3.0, 10.0, 20.0, 60.0] {
            let at = Frequency::hysteretic(omega, 0.02);
            let (a, b) = (beam.by_series(at), beam.by_waves(at));
            let near = |a: Complex64, b: Complex64| {
                let off = (a - b).norm() / a.norm();
                assert!(off < bound, "{omega} rad/s, {}: {a} {b}", beam.waves(at));
            };
            near(a.tip_m, b.tip_m);
            near(a.inertia_kg_m2, b.inertia_kg_m2);
            near(a.tip_u, b.tip_u);
            for k in 0..4 {
                near(a.u[k], b.u[k]);
            }
            for k in 0..3 {
                near(a.moment[k], b.moment[k]);
            }
        }
    }
}

#[test]
fn natural_frequencies_are_the_published_ones() {
    let unit = |hub: f64, tip: f64| {
        let mut link = Link::uniform(1.0, 1.0, 1.0, hub);
        link.payload.mass_kg = tip;
        link
    };
    let published = [
        (0.0, 0.0, [3.926_602_312, 7.068_582_746, 10.210_176_12, 13.351_768_78]),
        (0.1, 1.0, [2.326_474_278, 4.184_594_707, 7.161_872_009, 10.265_909_9]),
        (0.0, 5.2, [3.171_011_466_89, 6.298_221_426_56, 9.434_866_134_38, 12.573_959_496_8]),
    ];
    for (hub, tip, expected) in published {
        let found = natural_frequencies(&Beam::new(&unit(hub, tip), 1, &[]), 4);
        for (omega, b) in found.iter().zip(expected) {
            assert!((omega.sqrt() / b - 1.0_f64).abs() < 1e-9, "{hub}, {tip}: {omega}, {b}");
        }
    }
}

/// Two modes with ratios that Rayleigh's β gives every mode are Rayleigh's own link.
#[test]
fn modal_damping_in_proportion_to_frequency_is_that_of_rayleigh() {
    let mut link = laden();
    link.damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 1e-3 };
    let stations = [0.4, 1.0];
    let local = Exact::new(&link, &stations);
    let omegas = natural_frequencies(&Beam::new(&link, 1, &[]), 30);
    link.damping = Damping::Modal(omegas.iter().map(|omega| 0.5e-3 * omega).collect());
    let modal = Exact::new(&link, &stations);
    for omega in [0.01, 1.0, 7.0, 31.0, 90.0] {
        let (a, b) = (local.at(omega), modal.at(omega));
        // The modes that are left out carry no damping.
        let near = |a: Complex64, b: Complex64, what: &str| {
            assert!((a - b).norm() < 1e-4 * a.norm(), "{what} at {omega} rad/s: {a} {b}");
        };
        near(a.torque, b.torque, "torque");
        near(a.excess_angle, b.excess_angle, "angle");
        near(a.excess[0], b.excess[0], "displacement");
        near(a.excess[1], b.excess[1], "displacement");
    }
}

/// A taper in twice the pieces is the limit of both to the fourth power.
#[test]
fn a_taper_is_known_to_six_digits() {
    let mut link = Link::uniform(1.0, 5.0, 0.8, 0.1);
    link.segments[0].stiffness_n_m2 = [9.0, 3.0];
    link.segments[0].mass_kg_m = [1.1, 0.5];
    let exact = Exact::new(&link, &[0.5]);
    let mut halves = link.clone();
    let half =
        |ei: [f64; 2], m: [f64; 2]| Segment { length_m: 0.5, stiffness_n_m2: ei, mass_kg_m: m };
    halves.segments = vec![half([9.0, 6.0], [1.1, 0.8]), half([6.0, 3.0], [0.8, 0.5])];
    let finer = Exact::new(&halves, &[0.5]);
    for omega in [1.0, 30.0, 80.0, 150.0] {
        let (a, b) = (exact.at(omega), finer.at(omega));
        let off = (a.torque - b.torque).norm() / b.torque.norm();
        assert!(off < 1e-6, "{omega} rad/s: {off:e}");
    }
}

fn paper_run(step_s: f64, period: usize) -> Run {
    let rows = (-1.5 / step_s).round() as i64..(2.5 / step_s).round() as i64;
    Run { band_hz: None, rows, nodes_m: vec![0.75, 1.5], period, every: 1 }
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, x| m.max(x.abs()))
}

/// The paper's example, sine of 0.88 s that gives the rigid link a peak of 2.7 N m.
#[test]
fn the_papers_example_peaks_at_1_358_n_m() {
    let mut motion = Motion::new(Profile::Sine, 0.5, 0.88, 0.002);
    let travel = motion.samples().way_m();
    motion.distance_m *= 0.5 / travel;
    let run = Run { band_hz: Some(20.0), ..paper_run(0.002, 1 << 16) };
    let found = Truth::of(&Link::paper(), &motion.samples(), &run);
    let longer = Run { period: 1 << 18, ..run };
    let again = Truth::of(&Link::paper(), &motion.samples(), &longer);
    println!("peak {} N m", peak(&found.torque_n_m));
    let differ = |a: &[f64], b: &[f64]| {
        let worst = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        worst / peak(a)
    };
    assert!(differ(&found.torque_n_m, &again.torque_n_m) < 1e-10);
    assert!(differ(&found.hub_angle_rad, &again.hub_angle_rad) < 1e-9);
    assert!(differ(&found.displacement_m[0], &again.displacement_m[0]) < 1e-9);
    assert!(differ(&found.tip_m, &found.displacement_m[1]) < 1e-12, "the tip is its own node");
    assert!(differ(&found.wanted_m, &again.wanted_m) < 1e-10);
}

#[test]
fn displacement_and_acceleration_files_say_the_same_of_a_smooth_motion() {
    let motion = Motion::new(Profile::Gaussian, 0.5, 1.0, 0.002);
    let run = Run { band_hz: Some(20.0), ..paper_run(0.002, 1 << 15) };
    let from_acceleration = Truth::of(&Link::paper(), &motion.samples(), &run);
    let file = Motion { column: Column::Displacement, ..motion }.samples();
    let rest = (file.values.len() - motion.samples().values.len()) as i64 / 2;
    let shifted = Run { rows: run.rows.start + rest..run.rows.end + rest, ..run };
    let from_displacement = Truth::of(&Link::paper(), &file, &shifted);
    let pairs = [
        (&from_acceleration.torque_n_m, &from_displacement.torque_n_m),
        (&from_acceleration.hub_angle_rad, &from_displacement.hub_angle_rad),
        (&from_acceleration.wanted_m, &from_displacement.wanted_m),
    ];
    for (a, b) in pairs {
        let worst = a.iter().zip(b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(worst < 1e-7 * peak(a), "off by {worst:e}");
    }
}

#[test]
fn profiles_are_the_integrals_of_their_accelerations() {
    for profile in Profile::ALL {
        let (steps, mut velocity, mut way) = (240_000, 0.0, 0.0);
        let h = 1.0 / f64::from(steps);
        for k in 0..steps {
            let u = (f64::from(k) + 0.5) * h;
            way += h * (velocity + 0.5 * h * profile.acceleration(u));
            velocity += h * profile.acceleration(u);
            if k == steps / 5 {
                let at = (f64::from(k) + 1.0) * h;
                assert!((way - profile.displacement(at)).abs() < 1e-6, "{profile:?}");
            }
        }
        assert!((way - 1.0).abs() < 1e-6, "{profile:?}: {way}");
    }
}
