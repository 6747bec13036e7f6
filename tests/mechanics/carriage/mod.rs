//! A link on a carriage against closed forms, assembled matrices over long periods, and a hub with a very long radius.

#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::f64::consts::TAU;

use flexlink::beam::{ElementCount, Mesh, MeshPlan};
use flexlink::elastica::SecondOrder;
use flexlink::inverse::{Analysis, Solution, invert};
use flexlink::link::{
    Carriage, Damping, Drive, Hub, Link, LinkParts, LumpedMass, Payload, Segment,
};
use flexlink::modal::{
    PoseHub, buckling_share, held_frequencies, natural_frequencies, pose_modes, pose_zeros,
    real_frequency_zeros, torque_zeros,
};
use flexlink::model::{
    Dense, FrequencyResponse, KeptModes, LinkOnMesh, Model, Sensor, model_of, responses_with_weight,
};
use flexlink::motion::{Ends, MotionColumns, TipMotion};
use flexlink::response::{Feedback, HubReference, Input, Interpolation, Play, Torque, simulate};
use flexlink::result::Metrics;
use num_complex::Complex64;
use serde_json::Value;

use crate::common::{accelerated, apart, mesh_of, peak, plan_of, sine};

/// Bayo's link without its stiff root on a carriage of this mass.
fn uniform(mass_kg: f64) -> LinkParts {
    Link::builder()
        .segment(Segment::uniform(1.5, 5.0, 0.8))
        .carriage(Carriage { mass_kg, ..Carriage::default() })
}

/// √(EI/m̄)/L² of this link in 1/s.
fn unit_per_s() -> f64 {
    (5.0_f64 / 0.8).sqrt() / 1.5_f64.powi(2)
}

fn close(found: &[f64], exact: &[f64], tolerance: f64) {
    assert_eq!(found.len(), exact.len(), "{found:?}");
    for (found, exact) in found.iter().zip(exact) {
        assert!((found / exact - 1.0).abs() < tolerance, "{found} is not {exact}");
    }
}

/// The tip of a uniform link stands still where `cos b + cosh b = 0` for b = z^½ (1 + i)/√2, whatever the masses at both
/// ends: z = 2((k − ½)π)² in units of √(EI/m̄L⁴).
#[test]
fn zeros_are_those_of_the_closed_form_whatever_the_masses() {
    for (carriage_kg, tip_kg) in [(0.0, 0.0), (1.0, 0.3), (50.0, 2.0)] {
        let link = uniform(carriage_kg).payload_kg(tip_kg).build().unwrap();
        let exact: Vec<f64> = (1..=4)
            .map(|k| unit_per_s() * 2.0 * ((f64::from(k) - 0.5) * TAU / 2.0).powi(2))
            .collect();
        close(&torque_zeros(&mesh_of(&link, 600), 4), &exact, 1e-9);
    }
}

#[test]
fn frequencies_are_those_of_the_closed_forms() {
    // Clamped at a heavy carriage: cos b cosh b = −1. On a carriage without mass: tan b + tanh b = 0.
    let clamped = [1.875_104_068_711_961, 4.694_091_132_974_175, 7.854_757_438_237_613];
    let sliding = [2.365_020_372_431_352, 5.497_803_919_000_836, 8.639_379_828_699_742];
    let squares = |b: [f64; 3]| b.map(|b| b * b * unit_per_s());
    let light = mesh_of(&uniform(0.0).build().unwrap(), 300);
    close(&natural_frequencies(&light, 3), &squares(sliding), 1e-9);
    close(&held_frequencies(&light, f64::INFINITY, 3), &squares(clamped), 1e-9);
    let heavy = mesh_of(&uniform(1e12).build().unwrap(), 300);
    close(&natural_frequencies(&heavy, 3), &squares(clamped), 1e-9);
    let hertz = |mass_kg, tip_kg, count| -> Vec<f64> {
        let link = uniform(mass_kg).payload_kg(tip_kg).build().unwrap();
        natural_frequencies(&mesh_of(&link, 300), count).iter().map(|omega| omega / TAU).collect()
    };
    // Roots of the closed form, computed with fifty digits.
    close(&hertz(1.0, 0.0, 4), &[0.761_305_525, 4.237_231_31, 11.273_837_9, 21.760_275_9], 5e-9);
    close(&hertz(10.0, 0.0, 2), &[0.643_240_02, 3.939_339_47], 5e-9);
    close(&hertz(1.0, 0.3, 3), &[0.560_339_807, 3.471_630_6, 9.727_040_77], 5e-9);
}

/// Position of the carriage per tip displacement, then force and moment of the carriage on the root per tip acceleration, of
/// a uniform beam with the root's slope held at zero:
///
/// ```text
/// u/v_tip = (1 + cos b cosh b)/(cos b + cosh b),    b = L (m̄ω²/(EI κ))^¼
/// F/a_tip = M u/v_tip + m̄L (sin b cosh b + cos b sinh b)/(b (cos b + cosh b))
/// M₀/a_tip = m̄L² sin b sinh b/(b² (cos b + cosh b))
/// ```
fn closed_form(mass_kg: f64, ratio: f64, frequency_hz: f64) -> [Complex64; 3] {
    let omega = TAU * frequency_hz;
    let kappa = Complex64::new(1.0, 2.0 * ratio);
    let b = (0.8 * omega * omega / (5.0 * kappa)).sqrt().sqrt() * 1.5;
    let (c, s, ch, sh) = (b.cos(), b.sin(), b.cosh(), b.sinh());
    let position = (1.0 + c * ch) / (c + ch);
    let force = mass_kg * position + 0.8 * 1.5 * (s * ch + c * sh) / (b * (c + ch));
    [position, force, 0.8 * 1.5_f64.powi(2) * s * sh / (b * b * (c + ch))]
}

#[test]
fn force_and_position_over_frequency_are_those_of_the_closed_form() {
    let link = uniform(1.0).damping_ratio(0.02).build().unwrap();
    let model = model_of(&link, mesh_of(&link, 1200), KeptModes::All).unwrap();
    for frequency_hz in [0.01, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0] {
        let found = FrequencyResponse::at(&*model, frequency_hz);
        let [position, force, moment] = closed_form(1.0, 0.02, frequency_hz);
        let root_inertia = model.tip_transfer(TAU * frequency_hz).root_inertia_kg_m;
        let off = [
            (found.torque_per_tip_acceleration_kg_m / force - 1.0).norm(),
            (found.hub_angle_per_tip_displacement_rad_m / position - 1.0).norm(),
            (root_inertia / moment - 1.0).norm(),
        ];
        assert!(off.iter().all(|off| *off < 2e-9), "{off:?} at {frequency_hz} Hz");
    }
    // Published beside the closed form.
    let [_, force, _] = closed_form(1.0, 0.02, 2.0);
    assert!((force - Complex64::new(-1.429_474_67, -0.004_409_163)).norm() < 1e-8, "{force}");
}

/// A link with all features that move a node.
fn furnished(damping: Damping) -> LinkParts {
    Link::builder()
        .segment(Segment::uniform(0.5, 20.0, 0.9))
        .segment(Segment::uniform(1.0, 5.0, 0.7))
        .carriage(Carriage { mass_kg: 0.8, viscous_friction_n_s_m: 0.3 })
        .mass(LumpedMass { at_m: 0.0, mass_kg: 0.1, inertia_kg_m2: 2e-3 })
        .mass(LumpedMass { at_m: 0.8, mass_kg: 0.2, inertia_kg_m2: 1e-3 })
        .payload(Payload { mass_kg: 0.2, inertia_kg_m2: 2e-3, offset_m: 0.04 })
        .damping(damping)
}

#[test]
fn recursion_and_modes_answer_as_the_assembled_matrices_do() {
    let laws = [
        Damping::None,
        Damping::Hysteretic { ratio: 0.03 },
        Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 2e-3 },
        Damping::Modal { ratios: vec![0.05, 0.01] },
    ];
    let on_hub = |parts: LinkParts| LinkParts {
        carriage: None,
        hub: Hub { inertia_kg_m2: 0.1, radius_m: 0.05, ..Hub::default() },
        masses: vec![LumpedMass { at_m: 0.05, mass_kg: 0.1, inertia_kg_m2: 2e-3 }],
        ..parts
    };
    for damping in laws {
        let sprung = furnished(damping.clone()).root_stiffness_n_m_rad(30.0);
        let inboard = furnished(damping.clone()).output_m(1.1);
        let both = on_hub(sprung.clone()).output_m(0.9);
        for parts in [furnished(damping), sprung.clone(), on_hub(sprung), inboard, both] {
            let link = parts.build().unwrap();
            let on_mesh = LinkOnMesh::new(&link, mesh_of(&link, 8)).unwrap();
            let dense = Dense::assemble(on_mesh).unwrap();
            let model = model_of(&link, mesh_of(&link, 8), KeptModes::All).unwrap();
            for omega in [3.0, 17.0, 90.0] {
                let [found, exact] =
                    [&*model, &dense as &dyn Model].map(|model| model.nodal_transfer(omega));
                let numbers = |of: &flexlink::beam::NodalTransfer| {
                    let tip = of.tip;
                    let mut all = vec![tip.inertia_kg_m, tip.root_inertia_kg_m, tip.angle_rad_m];
                    all.extend(&of.moments_kg_m);
                    all.extend(
                        of.deflections_s2.iter().map(|deflection| deflection * omega * omega),
                    );
                    all
                };
                let size = numbers(&exact).iter().map(|x| x.norm()).fold(0.0, f64::max);
                let pairs = numbers(&found).into_iter().zip(numbers(&exact));
                let off = pairs.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size;
                assert!(off < 1e-9, "{:?} at {omega}: {off:e}", link.damping());
            }
        }
    }
}

/// A beam on a rotational spring k, its joint held: `1 + cos b cosh b = EI b/(kL) (sin b cosh b − cos b sinh b)`.
#[test]
fn a_held_link_on_a_spring_has_the_frequencies_of_the_closed_form() {
    for (stiffness, carriage_kg) in [(0.5, Some(1.0)), (20.0, None), (1e5, Some(0.0))] {
        let parts = uniform(1.0).root_stiffness_n_m_rad(stiffness);
        let carriage = carriage_kg.map(|mass_kg| Carriage { mass_kg, ..Carriage::default() });
        let link = LinkParts { carriage, ..parts }.build().unwrap();
        let mesh = mesh_of(&link, 300);
        let surplus = |b: f64| {
            let bent = 5.0 * b / (stiffness * 1.5) * (b.sin() * b.cosh() - b.cos() * b.sinh());
            (1.0 + b.cos() * b.cosh() - bent) / b.cosh()
        };
        for omega in held_frequencies(&mesh, f64::INFINITY, 3) {
            let b = (omega / unit_per_s()).sqrt();
            let (before, after) = (surplus(b * (1.0 - 1e-9)), surplus(b * (1.0 + 1e-9)));
            assert!(before * after < 0.0, "{stiffness} N m/rad, b = {b}: {before:e} {after:e}");
        }
        // Without the hub's own inertia it is the spring of a drive.
        let clamped = LinkParts { carriage: None, ..uniform(0.0) }.build().unwrap();
        let by_drive = held_frequencies(&mesh_of(&clamped, 300), stiffness, 3);
        close(&held_frequencies(&mesh, f64::INFINITY, 3), &by_drive, 1e-10);
    }
}

/// A uniform link under an effort at its root alone, with v = 0 there on a hub and v' = 0 on a carriage, and its free end at
/// ξ = 1, moves as `v = p cos bξ + q sin bξ + r cosh bξ + t sinh bξ`. A zero of effort → output is a root of v at the output:
/// b real for a zero at a real frequency, b along (1 + i)/√2 for a real zero.
#[test]
fn zeros_of_a_station_are_those_of_the_closed_form_on_both_axes() {
    let displacement = |slides: bool, share: f64, b: Complex64| {
        let (c, s, ch, sh) = (b.cos(), b.sin(), b.cosh(), b.sinh());
        let one = Complex64::ONE;
        let [p, q, r, t] = if slides {
            let per_det = -(c * sh + ch * s).inv();
            [(s * sh - c * ch - one) * per_det, one, -(one + c * ch + s * sh) * per_det, -one]
        } else {
            let per_det = (sh * c - s * ch).inv();
            [one, (one + c * ch + s * sh) * per_det, -one, (one + c * ch - s * sh) * per_det]
        };
        let x = b * share;
        p * x.cos() + q * x.sin() + r * x.cosh() + t * x.sinh()
    };
    for (slides, at_m) in [(true, 1.0), (true, 0.6), (false, 1.2), (false, 0.8)] {
        let carriage = slides.then(|| Carriage { mass_kg: 0.7, ..Carriage::default() });
        let link = LinkParts { carriage, ..uniform(0.0) }.output_m(at_m).build().unwrap();
        let mesh = mesh_of(&link, 600);
        let real = torque_zeros(&mesh, 2);
        let blocked = real_frequency_zeros(&mesh, 600.0);
        assert!(!real.is_empty() && !blocked.is_empty(), "{real:?} {blocked:?}");
        let turned = Complex64::new(0.5_f64.sqrt(), 0.5_f64.sqrt());
        let places =
            real.iter().map(|z| (*z, turned)).chain(blocked.iter().map(|w| (*w, Complex64::ONE)));
        for (place, direction) in places {
            let b = direction * (place / unit_per_s()).sqrt();
            // Newton's step from the zero that was found.
            let at = |b: Complex64| displacement(slides, at_m / 1.5, b);
            let h = 1e-6;
            let slope = (at(b * (1.0 + h)) - at(b * (1.0 - h))) / (2.0 * h);
            let off = (at(b) / slope).norm();
            // The error of the elements grows with the square of the frequency.
            let allowed = 1e-9 * (1.0 + (place / 100.0).powi(2));
            assert!(off < allowed, "slides: {slides}, at {at_m} m, {place}: {off:e}");
        }
    }
}

/// A stiff short segment at the root bends as a spring of 3EI/l does about its end, and turns as one of EI/l.
#[test]
fn a_spring_of_the_root_is_the_limit_of_a_short_soft_segment() {
    let hysteretic = Damping::Hysteretic { ratio: 0.02 };
    let rayleigh = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-3 };
    for (damping, gravity_m_s2, travel_m) in [(hysteretic, None, 0.5), (rayleigh, Some(2.0), 0.4)] {
        let motion = sine(travel_m, 0.88, 440);
        let parts = uniform(1.0).damping(damping);
        let parts = match gravity_m_s2 {
            Some(own) => parts.gravity([0.0, -own], 0.5),
            None => parts,
        };
        let sprung = parts.clone().root_stiffness_n_m_rad(12.0).build().unwrap();
        let exact = invert(&sprung, &plan_of(&sprung, 30), &motion, &Analysis::default()).unwrap();
        let mut before = f64::INFINITY;
        for length_m in [1e-3, 1e-4] {
            let mut parts = parts.clone();
            parts.segments.insert(0, Segment::uniform(length_m, 12.0 * length_m, 0.0));
            let link = parts.build().unwrap();
            let plan = MeshPlan::new(&link, &[Some(1), Some(30)], None, 1e-6).unwrap();
            let solution = invert(&link, &plan, &motion, &Analysis::default()).unwrap();
            let off = (Metrics::of(&solution).hub().peak_torque_n_m.value
                / Metrics::of(&exact).hub().peak_torque_n_m.value
                - 1.0)
                .abs();
            // The mesh leaves an error, too.
            let falls = off < 0.2 * before || off < 3e-6;
            assert!(off < 3.0 * length_m && falls, "{gravity_m_s2:?}: {off:e} after {before:e}");
            before = off;
        }
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// A reference case: its link, its motion and its numbers.
fn case(name: &str) -> (Link, MeshPlan, TipMotion, Value) {
    let all: Value = serde_json::from_str(include_str!("reference.json")).unwrap();
    let case = all[name].clone();
    let (of, number) = (&case["link"], |value: &Value| value.as_f64().unwrap_or(0.0));
    let mut parts = Link::builder()
        .carriage(Carriage { mass_kg: number(&of["mc"]), ..Carriage::default() })
        .payload(Payload {
            mass_kg: number(&of["mt"]),
            inertia_kg_m2: number(&of["Jt"]),
            offset_m: number(&of["c"]),
        })
        .damping(Damping::Rayleigh { alpha_per_s: 0.0, beta_s: number(&of["beta"]) });
    parts.root_stiffness_n_m_rad = of["kroot"].as_f64();
    parts.output_m = of["station"].as_f64();
    if let Some(g) = of["g"].as_f64() {
        parts = parts.gravity([0.0, -g], TAU / 4.0);
    }
    let mut elements = Vec::new();
    for own in of["segments"].as_array().unwrap() {
        let [length_m, ei, mass] = ["L", "EI", "m"].map(|key| number(&own[key]));
        parts = parts.segment(Segment::uniform(length_m, ei, mass));
        elements.push(own["n"].as_u64().map(|count| usize::try_from(count).unwrap()));
    }
    for own in of["masses"].as_array().into_iter().flatten() {
        let [at_m, mass_kg, inertia_kg_m2] = [0, 1, 2].map(|k| number(&own[k]));
        parts = parts.mass(LumpedMass { at_m, mass_kg, inertia_kg_m2 });
    }
    let link = parts.build().unwrap();
    let plan = MeshPlan::new(&link, &elements, None, 1e-6).unwrap();
    let [distance_m, duration_s, step_s] =
        ["distance", "duration", "step"].map(|key| number(&case["motion"][key]));
    let count = (duration_s / step_s).round();
    // The second derivative of 462 s⁶ − 1980 s⁷ + 3465 s⁸ − 3080 s⁹ + 1386 s¹⁰ − 252 s¹¹.
    let factors = [13860.0, -83160.0, 194_040.0, -221_760.0, 124_740.0, -27720.0];
    let acceleration = |s: f64| {
        let sum = factors.iter().rev().fold(0.0, |sum, factor| sum * s + factor);
        sum * s.powi(4) * distance_m / duration_s.powi(2)
    };
    let steps = (0..).take_while(|k| f64::from(*k) <= count);
    let time_s = steps.clone().map(|k| f64::from(k) * step_s).collect();
    let motion = accelerated(time_s, steps.map(|k| acceleration(f64::from(k) / count)).collect());
    (link, plan, motion, case)
}

/// Largest distance of a history from the reference, whose times outside the window have next to nothing.
fn distance(solution: &Solution, history: &[f64], case: &Value, key: &str) -> f64 {
    let times_s = numbers(&case["time_s"]);
    let off = times_s.iter().zip(numbers(&case[key])).map(|(time_s, exact)| {
        let row = ((time_s - solution.grid.time_s(0)) / solution.grid.step_s).round();
        let (first, last) = (history[0], history[history.len() - 1]);
        let found = if row < 0.0 {
            first
        } else {
            (0..).zip(history).find(|(k, _)| f64::from(*k) >= row).map_or(last, |(_, own)| *own)
        };
        (found - exact).abs()
    });
    off.fold(0.0, f64::max)
}

/// Reference: dense matrices over 25 durations with a quarter of the step; they move by at most 3.2e-7.
#[test]
fn force_and_carriage_follow_the_reference() {
    for name in
        ["bayo", "mast", "slim", "slim_spring", "mast_station", "mast_weight", "slim_weight"]
    {
        let (link, plan, motion, case) = case(name);
        let mesh = Mesh::new(&link, &plan).unwrap();
        if !link.has_weight() {
            let hertz =
                |omegas: Vec<f64>| omegas.iter().map(|omega| omega / TAU).collect::<Vec<_>>();
            close(&hertz(natural_frequencies(&mesh, 4)), &numbers(&case["free_hz"]), 1e-7);
            close(
                &hertz(held_frequencies(&mesh, f64::INFINITY, 4)),
                &numbers(&case["held_hz"]),
                1e-7,
            );
            close(&torque_zeros(&mesh, 3), &numbers(&case["zeros_per_s"]), 1e-7);
            let blocked = hertz(real_frequency_zeros(&mesh, TAU * 80.0));
            close(&blocked, &numbers(&case["blocked_hz"]), 1e-7);
        }
        let order = if link.has_weight() { SecondOrder::First } else { SecondOrder::None };
        let analysis = Analysis::default().with_tip_tolerance(1e-10).unwrap();
        let analysis = analysis.with_second_order(order);
        let solution = invert(&link, &plan, &motion, &analysis).unwrap();
        let force = &solution.hub().torque_n_m;
        let peak_n = case["peak_force_n"].as_f64().unwrap();
        // The reference has the largest sample.
        let peak_found_n = peak(force);
        assert!((peak_found_n / peak_n - 1.0).abs() < 3e-6, "{name}: {peak_found_n} N of {peak_n}");
        let off = distance(&solution, force, &case, "force_n") / peak_n;
        assert!(off < 3e-6, "{name}: the force is {off:e} off");
        let travel_m = motion.travel_m();
        let off = distance(&solution, &solution.hub().angle_rad, &case, "carriage_m") / travel_m;
        assert!(off < 3e-6, "{name}: the carriage is {off:e} off");
    }
}

#[test]
fn a_hub_with_a_very_long_radius_is_a_carriage() {
    let motion = sine(0.5, 0.88, 880);
    let damping = Damping::Hysteretic { ratio: 0.02 };
    let carriage = Carriage { mass_kg: 1.0, viscous_friction_n_s_m: 0.7 };
    // A belt of 400 N/m behind a pinion and a gear with 5 rad of the motor for 1 m.
    let drive = Drive {
        joint_stiffness_n_m_rad: 400.0,
        rotor_inertia_kg_m2: 0.02,
        gear_ratio: 5.0,
        ..Drive::DIRECT
    };
    let parts = LinkParts { drive: Some(drive), ..uniform(1.0).carriage(carriage) };
    let slid = parts.damping(damping.clone()).build().unwrap();
    let analysis = Analysis::new(1e-6, Some(1.5), Some(1.5)).unwrap();
    let on_carriage = invert(&slid, &plan_of(&slid, 40), &motion, &analysis).unwrap();
    let mut before = f64::INFINITY;
    for radius_m in [1e3, 1e4, 1e5] {
        let turned = LinkParts {
            carriage: None,
            drive: Some(Drive {
                joint_stiffness_n_m_rad: drive.joint_stiffness_n_m_rad * radius_m * radius_m,
                gear_ratio: drive.gear_ratio * radius_m,
                ..drive
            }),
            hub: Hub {
                inertia_kg_m2: radius_m * radius_m,
                radius_m,
                viscous_friction_n_m_s_rad: 0.7 * radius_m * radius_m,
            },
            ..uniform(1.0).damping(damping.clone())
        };
        let turned = turned.build().unwrap();
        let plan = MeshPlan::new(&turned, &[None], Some(ElementCount::Total(40)), 1e-4).unwrap();
        let on_hub = invert(&turned, &plan, &motion, &analysis).unwrap();
        let force: Vec<f64> = on_hub.hub().torque_n_m.iter().map(|t| t / radius_m).collect();
        let place: Vec<f64> = on_hub.hub().angle_rad.iter().map(|a| a * radius_m).collect();
        let off =
            apart(&force, &on_carriage.hub().torque_n_m) / peak(&on_carriage.hub().torque_n_m);
        let off_m = apart(&place, &on_carriage.hub().angle_rad) / 0.5;
        assert!(off < 3.0 * 1.5 / radius_m && off_m < 3.0 * 1.5 / radius_m, "{off:e} {off_m:e}");
        let [own, of_hub] = [&on_carriage, &on_hub].map(|own| own.hub().motor.as_ref().unwrap());
        for (own, of_hub) in [
            (&own.torque_n_m, &of_hub.torque_n_m),
            (&own.rate_rad_s, &of_hub.rate_rad_s),
            (&own.power_w, &of_hub.power_w),
        ] {
            let off = apart(own, of_hub) / peak(own);
            assert!(off < 3.0 * 1.5 / radius_m, "motor: {off:e}");
        }
        // The rotor held behind the belt.
        let [own, of_hub] = [(&slid, 1.0), (&turned, radius_m)].map(|(link, radius_m)| {
            held_frequencies(&mesh_of(link, 20), 400.0 * radius_m * radius_m, 2)
        });
        close(&own, &of_hub, 3.0 * 1.5 / radius_m);
        assert!(off < 0.2 * before, "{off:e} after {before:e}");
        before = off;
    }
}

/// Computed with dense matrices: the peak between samples, 0.06 s before the tip moves.
#[test]
fn the_papers_motion_takes_a_third_of_the_force_of_a_rigid_link() {
    let link = uniform(1.0).damping_ratio(0.02).build().unwrap();
    let motion = sine(0.5, 0.88, 880);
    let solution = invert(&link, &plan_of(&link, 40), &motion, &Analysis::default()).unwrap();
    let metrics = Metrics::of(&solution);
    let hub = metrics.hub();
    close(&[hub.peak_torque_n_m.value, hub.peak_rigid_torque_n_m.value], &[3.485_93, 8.925], 1e-5);
    assert!((hub.peak_torque_n_m.time_s + 0.060).abs() < 1e-3, "{}", hub.peak_torque_n_m.time_s);
    let [lead_s, lag_s] = [hub.lead_s.unwrap(), hub.lag_s.unwrap()];
    assert!((lead_s - 0.781).abs() < 1e-3 && (lag_s - 0.797).abs() < 1e-3, "{lead_s} {lag_s}");
}

#[test]
fn the_force_played_forward_brings_the_tip_along_the_motion() {
    let damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-3 };
    let link = furnished(damping).root_stiffness_n_m_rad(60.0).build().unwrap();
    let motion = sine(0.3, 1.2, 1200);
    let plan = plan_of(&link, 12);
    let solution = invert(&link, &plan, &motion, &Analysis::default()).unwrap();
    let torque = Torque::new(
        &(0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect::<Vec<_>>(),
        solution.hub().torque_n_m.clone(),
    )
    .unwrap();
    let played = simulate(&link.into(), &[plan], &Play::of(&torque), &|_| {}).unwrap();
    let off = apart(&played.tip[0].displacement_m, &solution.tip[0].displacement_m) / 0.3;
    assert!(off < 2e-6, "the tip is {off:e} of its travel off");
    let off = apart(&played.hub().angle_rad, &solution.hub().angle_rad) / 0.3;
    assert!(off < 2e-6, "the carriage is {off:e} of the travel off");
}

#[test]
fn a_rigid_link_takes_the_force_of_its_mass() {
    let link = Link::builder()
        .segment(Segment::uniform(1.5, 5e9, 0.8))
        .carriage(Carriage { mass_kg: 1.0, viscous_friction_n_s_m: 2.0 })
        .payload_kg(0.3)
        .build()
        .unwrap();
    let motion = sine(0.5, 0.88, 440);
    let solution = invert(&link, &plan_of(&link, 4), &motion, &Analysis::default()).unwrap();
    let tip = &solution.tip[0];
    let exact: Vec<f64> = tip
        .acceleration_m_s2
        .iter()
        .zip(&tip.velocity_m_s)
        .map(|(a, v)| (1.0 + 1.2 + 0.3) * a + 2.0 * v)
        .collect();
    assert!(apart(&solution.hub().torque_n_m, &exact) < 1e-6 * peak(&exact));
    assert!(apart(&solution.hub().rigid_torque_n_m, &exact) < 1e-12 * peak(&exact));
    assert!(apart(&solution.hub().angle_rad, &tip.displacement_m) < 1e-8);
}

/// A tip that swings for ever takes the force of the closed form at its one frequency.
#[test]
fn a_cycle_takes_the_force_of_its_frequency() {
    let (frequency_hz, steps) = (2.0, 100_u32);
    let link = uniform(1.0).damping_ratio(0.02).build().unwrap();
    let omega = TAU * frequency_hz;
    let time_s: Vec<f64> =
        (0..steps).map(|k| f64::from(k) / f64::from(steps) / frequency_hz).collect();
    let acceleration = time_s.iter().map(|t| (omega * t).cos()).collect();
    let columns = MotionColumns {
        time_s: time_s.clone(),
        acceleration_m_s2: Some(acceleration),
        ..MotionColumns::default()
    };
    let motion = TipMotion::with_ends(columns, Ends::Periodic).unwrap();
    let solution = invert(&link, &plan_of(&link, 100), &motion, &Analysis::default()).unwrap();
    let [position, force, _] = closed_form(1.0, 0.02, frequency_hz);
    let turned = |t: &f64| Complex64::new((omega * t).cos(), (omega * t).sin());
    let exact: Vec<f64> = time_s.iter().map(|t| (force * turned(t)).re).collect();
    assert!(apart(&solution.hub().torque_n_m, &exact) < 1e-6 * peak(&exact));
    let exact: Vec<f64> = time_s.iter().map(|t| (position * turned(t)).im / omega).collect();
    assert!(apart(&solution.hub().rate_rad_s, &exact) < 1e-6 * peak(&exact));
}

/// The forces, motions, gains and samples of a carriage times 1, R and R², as those of a hub of this radius.
#[test]
fn simulations_are_those_of_a_hub_with_a_very_long_radius() {
    const RADIUS_M: f64 = 1e6;
    let damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-3 };
    let carriage = Carriage { mass_kg: 1.0, viscous_friction_n_s_m: 0.7 };
    let slid = uniform(1.0).carriage(carriage).damping(damping.clone()).build().unwrap();
    let hub = Hub {
        inertia_kg_m2: RADIUS_M.powi(2),
        radius_m: RADIUS_M,
        viscous_friction_n_m_s_rad: 0.7 * RADIUS_M.powi(2),
    };
    let turned = LinkParts { carriage: None, hub, ..uniform(1.0).damping(damping) };
    let turned = turned.build().unwrap();
    let time_s: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
    let bell = |t: f64| (-(2.0 * (t - 1.6)).powi(2)).exp() * (3.0 * (t - 1.6)).sin();
    let played = |link: &Link, radius_m: f64, kind: usize| {
        let each = |of: &dyn Fn(f64) -> f64| time_s.iter().map(|t| of(*t)).collect::<Vec<_>>();
        let torque = Torque::new(&time_s, each(&|t| radius_m * bell(t))).unwrap();
        let place = each(&|t| 0.2 * bell(t) / radius_m);
        let reference = HubReference::new(&time_s, place, None).unwrap();
        let stiffness = 40.0 * radius_m * radius_m;
        let feedback = [Feedback::new(stiffness, 0.1 * stiffness, reference.clone()).unwrap()];
        let play = match kind {
            0 => Play { until_s: Some(5.0), ..Play::of(&torque) },
            1 => Play {
                feedback: &feedback,
                interpolation: Interpolation::Zero,
                ..Play::of(&torque)
            },
            2 => Play { cycle_turn_rad: Some(0.0), ..Play::of(&torque) },
            _ => Play::with(Input::Angles(std::slice::from_ref(&reference))),
        };
        let plan = MeshPlan::new(link, &[None], Some(ElementCount::Total(12)), 1e-4).unwrap();
        let played = simulate(&link.clone().into(), &[plan], &play, &|_| {}).unwrap();
        let tip = played.tip[0].displacement_m.clone();
        let hub = played.hub();
        let force: Vec<f64> = hub.torque_n_m.iter().map(|own| own / radius_m).collect();
        let place: Vec<f64> = hub.angle_rad.iter().map(|own| own * radius_m).collect();
        [tip, force, place, played.tip_deflection_m()]
    };
    for kind in 0..4 {
        let [found, exact] = [played(&slid, 1.0, kind), played(&turned, RADIUS_M, kind)];
        for (quantity, (found, exact)) in found.iter().zip(&exact).enumerate() {
            let off = apart(found, exact) / peak(exact);
            assert!(off < 3e-5, "play {kind}, quantity {quantity}: {off:e}");
        }
    }
}

/// The long hub, with its chord turning by next to nothing, under weight along the link, hanging, upright and across it.
#[test]
fn weight_is_that_of_a_hub_with_a_very_long_radius() {
    let motion = sine(0.1, 0.9, 180);
    let damping = Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 2e-3 };
    let carriage = Carriage { mass_kg: 0.5, viscous_friction_n_s_m: 0.7 };
    let analysis = Analysis::new(1e-6, Some(1.5), Some(1.5)).unwrap();
    for (order, direction_rad, spring_n_m_rad) in [
        (SecondOrder::First, TAU / 4.0, None),
        (SecondOrder::None, -TAU / 4.0, Some(9.0)),
        (SecondOrder::First, 0.3, Some(20.0)),
    ] {
        let analysis = analysis.with_second_order(order);
        let parts = uniform(0.5).damping(damping.clone()).payload_kg(0.1);
        let parts = LinkParts { root_stiffness_n_m_rad: spring_n_m_rad, ..parts };
        let parts = parts.gravity([0.0, -3.0], direction_rad);
        let slid = LinkParts { carriage: Some(carriage), ..parts.clone() }.build().unwrap();
        let on_carriage = invert(&slid, &plan_of(&slid, 6), &motion, &analysis).unwrap();
        let (mut before, mut before_m) = (f64::INFINITY, f64::INFINITY);
        for radius_m in [1e3, 1e4] {
            let hub = Hub {
                inertia_kg_m2: 0.5 * radius_m * radius_m,
                radius_m,
                viscous_friction_n_m_s_rad: 0.7 * radius_m * radius_m,
            };
            let turned = LinkParts { carriage: None, hub, ..parts.clone() }.build().unwrap();
            let plan = MeshPlan::new(&turned, &[None], Some(ElementCount::Total(6)), 1e-4).unwrap();
            let on_hub = invert(&turned, &plan, &motion, &analysis).unwrap();
            // The hub's own weight acts at its axis; that of the carriage is held, too.
            let held_n = 0.5 * 3.0 * direction_rad.cos();
            let force: Vec<f64> =
                on_hub.hub().torque_n_m.iter().map(|t| t / radius_m + held_n).collect();
            let place: Vec<f64> =
                on_hub.hub().angle_rad.iter().map(|a| (a - direction_rad) * radius_m).collect();
            let own = &on_carriage.hub();
            let off = apart(&force, &own.torque_n_m) / peak(&own.torque_n_m);
            let off_m = apart(&place, &own.angle_rad) / 0.1;
            assert!(
                off < 0.2 * before && off_m < 0.2 * before_m,
                "{order:?}, {direction_rad} rad: {off:e} {off_m:e} after {before:e} {before_m:e}"
            );
            (before, before_m) = (off, off_m);
        }
        assert!(
            before < 3e-3 && before_m < 3e-3,
            "{order:?}, {direction_rad} rad: {before:e} {before_m:e}"
        );
    }
}

/// Value and three derivatives at the root of an upright uniform beam that moves as `w = Σ a_n ξⁿ` from its free end, where
/// a₂ = a₃ = 0:
///
/// ```text
/// w'''' + γ (ξ w')' − k w = 0,    γ = m̄gL³/EI,   k = m̄ω²L⁴/EI
/// ```
fn of_series(gamma: f64, k: f64, start: [f64; 2]) -> [f64; 4] {
    series_at(1.0, gamma, k, start)
}

/// [`of_series`] at another distance ξ from the free end.
fn series_at(xi: f64, gamma: f64, k: f64, [a0, a1]: [f64; 2]) -> [f64; 4] {
    let mut a = vec![a0, a1, 0.0, 0.0];
    for n in 0..80_u32 {
        let (at, number) = (n as usize, f64::from(n));
        let next = k * a[at] - gamma * (number + 1.0).powi(2) * a[at + 1];
        let product = (number + 1.0) * (number + 2.0) * (number + 3.0) * (number + 4.0);
        a.push(next / product);
    }
    let mut derivatives = [0.0; 4];
    for (n, a) in (0..84_u32).zip(&a) {
        let mut factor = 1.0;
        for (order, derivative) in (0..4_u32).zip(&mut derivatives) {
            // ξ⁰ has no derivatives.
            if order <= n {
                *derivative += factor * a * xi.powi((n - order).cast_signed());
            }
            factor *= f64::from(n) - f64::from(order);
        }
    }
    derivatives
}

/// Slope of the carriage below a beam of [`of_series`] on a spring of `EI/(sL)`, and force on its root: `w' + s w''` and
/// `w''' + γ w'` at ξ = 1. A clamped root has s = 0.
fn at_spring(softness: f64, gamma: f64, [_, slope, bend, third]: [f64; 4]) -> [f64; 2] {
    [slope + softness * bend, third + gamma * slope]
}

/// The uniform link on a spring of this softness.
fn on_spring(parts: LinkParts, softness: f64) -> LinkParts {
    let stiffness = (softness > 0.0).then(|| 5.0 / (1.5 * softness));
    LinkParts { root_stiffness_n_m_rad: stiffness, ..parts }
}

#[test]
fn an_upright_beam_has_the_frequencies_zeros_and_buckling_weight_of_its_power_series() {
    for softness in [0.0, 0.05, 0.4] {
        upright(softness);
    }
}

/// Frequencies of the beam with its root held, and on a carriage without mass; zeros of force → tip; and the weight that
/// buckles it.
fn upright(softness: f64) {
    let mesh = mesh_of(&on_spring(uniform(0.0), softness).build().unwrap(), 40);
    let unit = unit_per_s();
    let both = |gamma: f64, k: f64| {
        [[1.0, 0.0], [0.0, 1.0]].map(|a| {
            let own = of_series(gamma, k, a);
            let [slope, force] = at_spring(softness, gamma, own);
            [own[0], slope, force]
        })
    };
    let held = |gamma: f64, k: f64| {
        let [a, b] = both(gamma, k);
        a[0] * b[1] - b[0] * a[1]
    };
    let free = |gamma: f64, k: f64| {
        let [a, b] = both(gamma, k);
        a[1] * b[2] - b[1] * a[2]
    };
    let blocked = |gamma: f64, k: f64| both(gamma, k)[1][1];
    // On a spring γ = 7 falls.
    for gamma in [2.0, -5.0].into_iter().chain((softness == 0.0).then_some(7.0)) {
        let outward_m_s2 = -gamma * 5.0 / (0.8 * 1.5_f64.powi(3));
        let is_root = |of: &dyn Fn(f64, f64) -> f64, k: f64| {
            // Ten times the error of the elements.
            of(gamma, k * (1.0 - 1e-5)) * of(gamma, k * (1.0 + 1e-5)) < 0.0
        };
        let modes = pose_modes(&mesh, outward_m_s2, PoseHub::Spring(f64::INFINITY), 3).unwrap();
        for (square, _) in modes {
            assert!(is_root(&held, square / unit.powi(2)), "held, γ = {gamma}: {square}");
        }
        // The first is the motion of the whole link.
        for (square, _) in &pose_modes(&mesh, outward_m_s2, PoseHub::Free, 4).unwrap()[1..] {
            assert!(is_root(&free, square / unit.powi(2)), "free, γ = {gamma}: {square}");
        }
        let [zeros, at_frequencies] = pose_zeros(&mesh, outward_m_s2, 3, 500.0).unwrap();
        assert!(zeros.len() == 3 && at_frequencies.is_empty(), "{zeros:?} {at_frequencies:?}");
        for zero in zeros {
            assert!(is_root(&blocked, -(zero / unit).powi(2)), "zero, γ = {gamma}: {zero}");
        }
        let share = buckling_share(&mesh, outward_m_s2);
        if gamma < 0.0 || softness == 0.0 {
            let exact = if gamma > 0.0 { gamma / 7.837_347_438_9 } else { 0.0 };
            assert!((share - exact).abs() < 1e-6, "{share} is not {exact}");
        } else {
            // A beam that stays bent has the frequency 0.
            let [more, less] = [1.0 - 1e-5, 1.0 + 1e-5].map(|own| held(gamma / (share * own), 0.0));
            assert!(more * less < 0.0, "{share} of γ = {gamma} on a spring of {softness}");
        }
    }
}

/// No force moves the output where the sum of both series is 0 there and at the slope of the root.
#[test]
fn zeros_of_a_station_on_an_upright_beam_are_those_of_its_power_series() {
    for (at_m, softness) in [(1.0, 0.0), (1.3, 0.4)] {
        let mesh = mesh_of(&on_spring(uniform(0.0).output_m(at_m), softness).build().unwrap(), 60);
        let unit = unit_per_s();
        for gamma in [2.0, -5.0] {
            let blocked = |k: f64| {
                let [a, b] = [[1.0, 0.0], [0.0, 1.0]].map(|start| {
                    let [slope, _] = at_spring(softness, gamma, of_series(gamma, k, start));
                    [series_at(1.0 - at_m / 1.5, gamma, k, start)[0], slope]
                });
                a[0] * b[1] - b[0] * a[1]
            };
            // Ten times the error of the elements.
            let is_root = |k: f64| blocked(k * (1.0 - 1e-5)) * blocked(k * (1.0 + 1e-5)) < 0.0;
            let outward_m_s2 = -gamma * 5.0 / (0.8 * 1.5_f64.powi(3));
            let [zeros, at_frequencies] = pose_zeros(&mesh, outward_m_s2, 2, 500.0).unwrap();
            assert!(zeros.len() == 2 && !at_frequencies.is_empty(), "{zeros:?} {at_frequencies:?}");
            let squares = zeros.iter().map(|zero| -zero * zero);
            for square in squares.chain(at_frequencies.iter().map(|omega| omega * omega)) {
                assert!(is_root(square / unit.powi(2)), "{at_m} m, γ = {gamma}: {square}");
            }
        }
    }
}

/// A soft link with masses, its carriage, and the long hub of the radius that replaces it.
fn soft(direction_rad: f64, gravity_m_s2: f64, radius_m: Option<f64>) -> Link {
    let parts = Link::builder()
        .segment(Segment::uniform(0.7, 14.0, 0.6))
        .segment(Segment::uniform(0.5, 9.0, 0.4))
        .mass(LumpedMass { at_m: 0.5, mass_kg: 0.1, inertia_kg_m2: 1e-3 })
        .payload(Payload { mass_kg: 0.2, inertia_kg_m2: 2e-3, offset_m: 0.05 })
        .damping(Damping::Rayleigh { alpha_per_s: 0.0, beta_s: 3e-3 });
    // Without weight the output is a station.
    let parts = match gravity_m_s2 {
        0.0 => parts.output_m(0.9 + radius_m.unwrap_or(0.0)),
        _ => parts.gravity([0.0, -gravity_m_s2], direction_rad),
    };
    // Tilted, it stands on a spring, with a body at the root that turns with the link.
    let body = LumpedMass { at_m: 0.0, mass_kg: 0.05, inertia_kg_m2: 4e-3 };
    let parts = match direction_rad {
        0.4 => parts.root_stiffness_n_m_rad(60.0).mass(body),
        _ => parts,
    };
    let Some(radius_m) = radius_m else {
        let carriage = Carriage { mass_kg: 0.8, viscous_friction_n_s_m: 0.7 };
        return parts.carriage(carriage).build().unwrap();
    };
    let mut parts = parts.hub(Hub {
        inertia_kg_m2: 0.8 * radius_m * radius_m,
        radius_m,
        viscous_friction_n_m_s_rad: 0.7 * radius_m * radius_m,
    });
    parts.masses.iter_mut().for_each(|mass| mass.at_m += radius_m);
    parts.build().unwrap()
}

/// Tip, force, place and deflection of a soft link under a force, under feedback and with its joint moved.
fn played_with_all_terms(
    direction_rad: f64,
    gravity_m_s2: f64,
    radius_m: Option<f64>,
    kind: usize,
) -> [Vec<f64>; 4] {
    let link = soft(direction_rad, gravity_m_s2, radius_m);
    let r = radius_m.unwrap_or(1.0);
    // The hub's angle counts from x, and its axis carries the carriage's weight.
    let (from, held_n) = match radius_m {
        Some(_) => (direction_rad, 0.8 * gravity_m_s2 * direction_rad.cos()),
        None => (0.0, 0.0),
    };
    let weight_n = (link.mass_kg() + 0.8) * gravity_m_s2 * direction_rad.cos();
    let time_s: Vec<f64> = (0..160).map(|k| 0.01 * f64::from(k)).collect();
    let bell = |t: f64| 25.0 * (-(4.0 * (t - 0.6)).powi(2)).exp() * (6.0 * (t - 0.6)).sin();
    let each = |of: &dyn Fn(f64) -> f64| time_s.iter().map(|t| of(*t)).collect::<Vec<_>>();
    let force =
        |of: &dyn Fn(f64) -> f64| Torque::new(&time_s, each(&|t| r * (of(t) - held_n))).unwrap();
    let torque = force(&|t| weight_n + bell(t));
    let reference = HubReference::new(&time_s, each(&|t| from + 0.02 * bell(t) / r), None).unwrap();
    let gains = [Feedback::new(40.0 * r * r, 4.0 * r * r, reference.clone()).unwrap()];
    let is_large = true;
    let play = match kind {
        0 => Play { is_large, until_s: Some(1.8), ..Play::of(&torque) },
        1 => Play {
            is_large,
            feedback: &gains,
            interpolation: Interpolation::Linear,
            ..Play::of(&torque)
        },
        _ => Play { is_large, ..Play::with(Input::Angles(std::slice::from_ref(&reference))) },
    };
    let plan = MeshPlan::new(&link, &[None, None], Some(ElementCount::Total(8)), 1e-6).unwrap();
    let played = simulate(&link.into(), &[plan], &play, &|_| {}).unwrap();
    let hub = played.hub();
    let force = hub.torque_n_m.iter().map(|own| own / r + held_n).collect();
    let place = hub.angle_rad.iter().map(|own| (own - from) * r).collect();
    [played.tip[0].displacement_m.clone(), force, place, played.tip_deflection_m()]
}

/// The axis of the long hub keeps its place, and the direction of its link turns by displacement over radius.
#[test]
fn all_terms_are_those_of_a_hub_with_a_very_long_radius() {
    for (direction_rad, gravity_m_s2) in
        [(0.0, 0.0), (TAU / 4.0, 4.0), (-TAU / 4.0, 4.0), (0.4, 2.0)]
    {
        for kind in 0..3 {
            let found = played_with_all_terms(direction_rad, gravity_m_s2, None, kind);
            let mut before = [f64::INFINITY; 4];
            for radius_m in [1e3, 1e4] {
                let exact =
                    played_with_all_terms(direction_rad, gravity_m_s2, Some(radius_m), kind);
                let off: Vec<f64> = found
                    .iter()
                    .zip(&exact)
                    .map(|(own, of_hub)| apart(own, of_hub) / peak(own))
                    .collect();
                for (quantity, (off, before)) in off.iter().zip(&mut before).enumerate() {
                    assert!(
                        *off < 10.0 / radius_m && (*off < 0.2 * *before || *off < 1e-9),
                        "{direction_rad} rad, play {kind}, quantity {quantity}: {off:e} after {before:e}"
                    );
                    *before = *off;
                }
            }
        }
    }
}

fn times(solution: &Solution) -> Vec<f64> {
    (0..solution.grid.len).map(|k| solution.grid.time_s(k)).collect()
}

/// The slim mast upright and lying, its tip deflected by a tenth of the length; the output is the tip or a station.
#[test]
fn the_force_with_all_terms_brings_the_output_along_the_motion_and_keeps_the_energy() {
    let motion = sine(0.6, 1.3, 1300);
    for (direction_rad, gravity_m_s2, spring_n_m_rad, output_m) in [
        (TAU / 4.0, 9.81, None, None),
        (0.3, 3.0, None, None),
        (0.3, 3.0, Some(60.0), None),
        (TAU / 4.0, 9.81, None, Some(1.1)),
        (0.3, 1.0, Some(60.0), Some(1.15)),
    ] {
        let parts = Link::builder();
        let parts = LinkParts { root_stiffness_n_m_rad: spring_n_m_rad, output_m, ..parts };
        // The part beyond a station swings.
        let beta_s = if output_m.is_some() { 4e-3 } else { 1e-3 };
        let link = parts
            .segment(Segment::uniform(1.2, 12.0, 0.5))
            .mass(LumpedMass { at_m: 0.0, mass_kg: 0.0, inertia_kg_m2: 5e-3 })
            .carriage(Carriage { mass_kg: 2.0, viscous_friction_n_s_m: 0.5 })
            .payload_kg(0.4)
            .damping(Damping::Rayleigh { alpha_per_s: 0.0, beta_s })
            .gravity([0.0, -gravity_m_s2], direction_rad)
            .build()
            .unwrap();
        let plan = MeshPlan::automatic(&link);
        let analysis = Analysis::default().with_tip_tolerance(1e-7).unwrap();
        let analysis = analysis.with_second_order(SecondOrder::Full);
        let solution = invert(&link, &plan, &motion, &analysis).unwrap();
        let force = Torque::new(&times(&solution), solution.hub().torque_n_m.clone()).unwrap();
        let initial_tip_m = solution.tip[0].displacement_m[0];
        let play = Play { initial_tip_m, ..Play::of(&force) };
        let played = simulate(&link.clone().into(), &[plan], &play, &|_| {}).unwrap();
        let bends = peak(&played.tip_deflection_m());
        assert!(bends > 0.08, "{bends}");
        let off = apart(&played.tip[0].displacement_m, &solution.tip[0].displacement_m) / 0.6;
        assert!(off < 1e-5, "{direction_rad} rad: the output is {off:e} of its travel off");
        let off = apart(&played.hub().angle_rad, &solution.hub().angle_rad) / 0.6;
        assert!(off < 1e-5, "{direction_rad} rad: the carriage is {off:e} off");
        // Weight across the link holds the carriage, too.
        let held_n = 3.0 * gravity_m_s2 * direction_rad.cos();
        let off = played.hub().holding_n_m.unwrap() - held_n;
        assert!(off.abs() < 1e-9, "{off:e}");
        let account = played.energy(8);
        let largest = account.balances.iter().map(|own| own.kinetic_j).fold(0.0, f64::max);
        for own in &account.balances {
            let held = own.kinetic_j + own.strain_j - account.start_j;
            let missing = (own.work_j - held - own.dissipated_j).abs() / largest;
            assert!(missing < 1e-7, "{direction_rad} rad at {} s: {missing:e}", own.time_s);
        }
    }
}

/// Place of the end of an elastica on a spring that points along x and carries its weight: `EI θ'' = w (L − s) cos θ`, by steps
/// of Runge and Kutta and by shooting for the moment at the root.
fn sagging(stiffness_n_m2: f64, weight_n_m: f64, length_m: f64, softness_rad_n_m: f64) -> f64 {
    let steps = 4000_u32;
    let h = length_m / f64::from(steps);
    let shot = |root_curvature: f64| {
        let slope = |s: f64, [theta, bend, _]: [f64; 3]| {
            [bend, weight_n_m * (length_m - s) * theta.cos() / stiffness_n_m2, theta.sin()]
        };
        let mut state = [softness_rad_n_m * stiffness_n_m2 * root_curvature, root_curvature, 0.0];
        for k in 0..steps {
            let s = h * f64::from(k);
            let after = |by: [f64; 3], share: f64| [0, 1, 2].map(|i| state[i] + share * h * by[i]);
            let first = slope(s, state);
            let second = slope(s + 0.5 * h, after(first, 0.5));
            let third = slope(s + 0.5 * h, after(second, 0.5));
            let fourth = slope(s + h, after(third, 1.0));
            state = [0, 1, 2].map(|i| {
                state[i] + h / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i])
            });
        }
        state
    };
    let (mut low, mut high) = (-weight_n_m * length_m.powi(2) / stiffness_n_m2, 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shot(middle)[1] < 0.0 { low = middle } else { high = middle }
    }
    shot(low)[2]
}

#[test]
fn a_mast_across_gravity_sags_as_the_elastica_and_stays_there() {
    sags(uniform(1.0), 0.0);
    sags(uniform(1.0).root_stiffness_n_m_rad(16.0), 1.0 / 16.0);
}

fn sags(parts: LinkParts, softness_rad_n_m: f64) {
    let link = parts.gravity([0.0, -9.81], 0.0).build().unwrap();
    let time_s: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k)).collect();
    let weight_n = 9.81 * (1.0 + 0.8 * 1.5);
    let torque = Torque::new(&time_s, vec![weight_n; 50]).unwrap();
    let play = Play { initial_tip_m: 0.2, ..Play::of(&torque) };
    let plan = plan_of(&link, 12);
    let played = simulate(&link.into(), &[plan], &play, &|_| {}).unwrap();
    let sag_m = sagging(5.0, 0.8 * 9.81, 1.5, softness_rad_n_m);
    assert!(sag_m < -0.5, "{sag_m}");
    assert!((played.hub().holding_n_m.unwrap() / weight_n - 1.0).abs() < 1e-10);
    for sample in [0, 49] {
        let tip_m = played.tip[0].displacement_m[sample];
        let bends_m = played.tip_deflection_m()[sample];
        let place_m = played.hub().angle_rad[sample];
        assert!((tip_m - 0.2).abs() < 1e-7, "{tip_m}");
        assert!((bends_m / sag_m - 1.0).abs() < 1e-6, "{bends_m} is not {sag_m}");
        assert!((place_m - 0.2 + sag_m).abs() < 1e-6, "{place_m}");
    }
}

#[test]
fn a_motion_with_all_terms_goes_on_from_its_state() {
    let link = soft(0.4, 2.0, None);
    let plan = MeshPlan::new(&link, &[None, None], Some(ElementCount::Total(8)), 1e-9).unwrap();
    let arm = link.into();
    let torque = |from: u32| {
        let time_s: Vec<f64> = (from..=120).map(|k| 0.01 * f64::from(k)).collect();
        let force = time_s.iter().map(|t| 4.0 + 3.0 * (TAU * t).sin()).collect();
        Torque::new(&time_s, force).unwrap()
    };
    let (whole, rest) = (torque(0), torque(60));
    let first = Torque::new(
        &(0..=60).map(|k| 0.01 * f64::from(k)).collect::<Vec<_>>(),
        whole.torque_n_m()[..=60].to_vec(),
    )
    .unwrap();
    // Straight lines do not depend on later samples.
    let of = |torque| Play { interpolation: Interpolation::Linear, ..Play::of(torque) };
    let played =
        |play: &Play<'_>| simulate(&arm, std::slice::from_ref(&plan), play, &|_| {}).unwrap();
    let state = played(&of(&first)).state();
    let [all, after] =
        [of(&whole), Play { state: Some(&state), ..of(&rest) }].map(|own| played(&own));
    for (whole, after) in [
        (&all.tip[0].displacement_m, &after.tip[0].displacement_m),
        (&all.hub().angle_rad, &after.hub().angle_rad),
    ] {
        let off = apart(&whole[60..], after) / peak(whole);
        assert!(off < 1e-7, "{off:e}");
    }
}

/// The tip of [`of_series`] moves by 1, and the slope of the carriage is 0: the force on the root is the inertia of the whole beam,
/// whose mean motion is the third derivative there over k.
#[test]
fn an_upright_beam_responds_over_frequency_as_its_power_series() {
    let mesh_kg = 0.8 * 1.5;
    for (gamma, carriage_kg, softness) in
        [(5.0, 0.7, 0.0), (-3.0, 0.0, 0.0), (0.0, 2.0, 0.0), (1.5, 0.7, 0.3), (-3.0, 0.2, 0.1)]
    {
        let gravity_m_s2 = gamma * 5.0 / (0.8 * 1.5_f64.powi(3));
        let link = on_spring(uniform(carriage_kg), softness)
            .gravity([0.0, -gravity_m_s2.abs() - 1e-300], TAU / 4.0 * f64::signum(gamma));
        let link = link.build().unwrap();
        let on_mesh = LinkOnMesh::new(&link, mesh_of(&link, 60)).unwrap();
        let frequencies_hz = [1e-3, 0.2, 0.9, 3.0, 8.0];
        let (rows, changes) = responses_with_weight(&on_mesh, &frequencies_hz).unwrap();
        for ((row, frequency_hz), change) in rows.iter().zip(frequencies_hz).zip(changes.unwrap()) {
            let k = (TAU * frequency_hz / unit_per_s()).powi(2);
            let [a, b] = [[1.0, 0.0], [0.0, 1.0]].map(|start| {
                let own = of_series(gamma, k, start);
                let [slope, force] = at_spring(softness, gamma, own);
                [own[0], slope, force]
            });
            let [position, _, force] = [0, 1, 2].map(|d| a[d] - a[1] / b[1] * b[d]);
            let inertia = carriage_kg * position + mesh_kg * force / k;
            let off = (row.torque_per_tip_acceleration_kg_m / inertia - 1.0).norm();
            let off_m = (row.hub_angle_per_tip_displacement_rad_m / position - 1.0).norm();
            assert!(
                off < 2e-6 && off_m < 2e-6,
                "γ = {gamma}, {frequency_hz} Hz: {off:e} {off_m:e}"
            );
            assert!(change < 1e-5, "{change:e}");
        }
    }
}

#[test]
fn a_link_across_gravity_responds_over_frequency_as_one_without() {
    for damping in [
        Damping::None,
        Damping::Hysteretic { ratio: 0.03 },
        Damping::Rayleigh { alpha_per_s: 0.4, beta_s: 2e-3 },
    ] {
        let link = furnished(damping).gravity([0.0, -9.81], 0.0).build().unwrap();
        let model = model_of(&link, mesh_of(&link, 8), KeptModes::All).unwrap();
        let frequencies_hz = [0.3, 2.0, 11.0];
        let exact = FrequencyResponse::at_all(&*model, &frequencies_hz);
        let found = responses_with_weight(model.on_mesh(), &frequencies_hz).unwrap().0;
        for (found, exact) in found.iter().zip(&exact) {
            for (found, exact) in [
                (found.torque_per_tip_acceleration_kg_m, exact.torque_per_tip_acceleration_kg_m),
                (
                    found.hub_angle_per_tip_displacement_rad_m,
                    exact.hub_angle_per_tip_displacement_rad_m,
                ),
                (found.tip_displacement_per_torque_1_n, exact.tip_displacement_per_torque_1_n),
            ] {
                assert!((found / exact - 1.0).norm() < 1e-9, "{found} is not {exact}");
            }
        }
    }
    let modal = furnished(Damping::Modal { ratios: vec![0.05] }).gravity([0.0, -9.81], 0.0);
    let modal = modal.build().unwrap();
    let on_mesh = LinkOnMesh::new(&modal, mesh_of(&modal, 8)).unwrap();
    assert!(responses_with_weight(&on_mesh, &[1.0]).is_none());
}

/// Sensors per force of the carriage, and per torque of a hub of the radius R, times the powers of R of both units.
#[test]
fn sensors_per_force_are_those_of_a_hub_with_a_very_long_radius() {
    let slid = soft(0.0, 0.0, None);
    let omegas = [1.0, 9.0, 40.0, 200.0];
    let sensed = |link: &Link, sensor: Sensor| {
        let plan = MeshPlan::new(link, &[None, None], Some(ElementCount::Total(20)), 1e-6).unwrap();
        let model = model_of(link, Mesh::new(link, &plan).unwrap(), KeptModes::All).unwrap();
        sensor.per_torque(&*model, &omegas)
    };
    for (own, of_hub, power) in [
        (Sensor::Carriage, Sensor::HubAngle, 2),
        (Sensor::CarriageVelocity, Sensor::HubRate, 2),
        (Sensor::TipDeflection, Sensor::TipDeflection, 1),
        (Sensor::TipAcceleration, Sensor::TipAcceleration, 1),
        (Sensor::RootStrain, Sensor::RootStrain, 1),
    ] {
        let mut before = f64::INFINITY;
        for radius_m in [1e3_f64, 1e4] {
            let turned = soft(0.0, 0.0, Some(radius_m));
            let pairs = sensed(&slid, own).into_iter().zip(sensed(&turned, of_hub));
            let off = pairs.map(|(own, of_hub)| (of_hub * radius_m.powi(power) / own - 1.0).norm());
            let off = off.fold(0.0, f64::max);
            assert!(
                off < 30.0 / radius_m && off < 0.2 * before,
                "{own:?}: {off:e} after {before:e}"
            );
            before = off;
        }
    }
}

/// A carriage on the spring and the damper of its feedback, and one that friction alone holds, under weight across and along
/// the link.
#[test]
fn a_bent_link_settles_to_its_cycle() {
    const SAMPLES: u32 = 80;
    const CYCLES: u32 = 40;
    let link = soft(0.4, 2.0, None);
    let weight_n = (link.mass_kg() + 0.8) * 2.0 * 0.4_f64.cos();
    let plan = MeshPlan::new(&link, &[None, None], Some(ElementCount::Total(8)), 1e-6).unwrap();
    let arm = link.into();
    let times =
        |cycles: u32| -> Vec<f64> { (0..cycles * SAMPLES).map(|k| 0.02 * f64::from(k)).collect() };
    let wave = |cycles: u32| {
        let time_s = times(cycles);
        let force = time_s.iter().map(|t| weight_n + 6.0 * (TAU * t / 1.6).sin()).collect();
        Torque::new(&time_s, force).unwrap()
    };
    let holding = |cycles: u32| {
        let time_s = times(cycles);
        let place = time_s.iter().map(|t| 0.05 * (TAU * t / 1.6).cos()).collect();
        [Feedback::new(40.0, 4.0, HubReference::new(&time_s, place, None).unwrap()).unwrap()]
    };
    for is_held in [true, false] {
        let played = |cycles: u32| {
            let (force, feedback) = (wave(cycles), holding(cycles));
            let play = Play {
                interpolation: Interpolation::Linear,
                cycle_turn_rad: (cycles == 1).then_some(0.0),
                feedback: if is_held { &feedback } else { &[] },
                ..Play::of(&force)
            };
            simulate(&arm, std::slice::from_ref(&plan), &play, &|_| {}).unwrap()
        };
        let (cycle, all) = (played(1), played(CYCLES));
        // A spline through the reference feels its end.
        let last = usize::try_from((CYCLES - 3) * SAMPLES).unwrap();
        for (found, all) in [
            (&cycle.hub().rate_rad_s, &all.hub().rate_rad_s),
            (&cycle.tip_deflection_m(), &all.tip_deflection_m()),
            (&cycle.tip[0].velocity_m_s, &all.tip[0].velocity_m_s),
        ] {
            let off = apart(found, &all[last..]) / peak(found);
            assert!(off < 1e-5, "held: {is_held}: {off:e}");
        }
    }
}
