//! Cases by name: those of reports, and one of each kind that there is.

use super::case::{Case, Expect, Mesh};
use super::link::{Body, Damping, Drive, Link, Payload, Segment};
use super::motion::{Column, Motion, Profile};

const ELEMENTS: fn(usize) -> Mesh = Mesh::Elements;

/// Every case by name.
pub(crate) fn cases() -> Vec<Case> {
    [tube(), rome(), paper(), rounded(), tails(), laws(), shapes(), whole_band(), windows()]
        .concat()
}

/// A light tube with a heavy tip: the torque of a kink grows with the frequency that is let in.
fn tube() -> Vec<Case> {
    // Accelerations at 2 ms would say another motion: the kink's content folds back into the band.
    let motion =
        Motion { column: Column::Displacement, ..Motion::new(Profile::MinJerk, 0.3, 1.0, 0.002) };
    let known = [(1e-6, 3.15, 0.01), (1e-5, 2.417, 0.002), (1e-4, 2.447, 0.002)];
    let at = |(share, peak, to)| {
        Case::new(format!("tube, tip {share:e}"), Link::tube(), motion, ELEMENTS(20)).with(|c| {
            c.tip_tolerance = Some(share);
            c.peaks = vec![("peak_torque_n_m", peak, to)];
        })
    };
    known.into_iter().map(at).collect()
}

/// The motor behind a joint spring, which sees T̈/k.
fn rome() -> Vec<Case> {
    let motion = Motion::new(Profile::MinJerk, 0.3, 1.0, 0.002);
    let known = [(1e-6, 3.47), (1e-5, 3.176), (1e-4, 2.939)];
    let at = |(share, peak)| {
        Case::new(format!("rome, tip {share:e}"), Link::rome(), motion, ELEMENTS(80)).with(|c| {
            c.tip_tolerance = Some(share);
            c.peaks = vec![("peak_motor_torque_n_m", peak, 0.005)];
        })
    };
    let coarse = Case::new("rome, 10 elements", Link::rome(), motion, ELEMENTS(10));
    let auto = Case::new("rome, auto", Link::rome(), motion, Mesh::Auto(1e-6));
    let mut geared = Link::paper();
    geared.drive = Some(Drive { stiffness_n_m: 300.0, rotor_kg_m2: 2e-4, gear: 100.0 });
    let septic = Motion::new(Profile::Septic, 0.5, 1.0, 0.002);
    let geared = Case::new("gear of 100", geared, septic, ELEMENTS(20));
    known.into_iter().map(at).chain([coarse, auto, geared]).collect()
}

/// The paper's first example.
fn paper() -> Vec<Case> {
    let sine = Motion::new(Profile::Sine, 0.5, 0.88, 0.001);
    let paper = |name: &str, motion, mesh| Case::new(name, Link::paper(), motion, mesh);
    vec![
        paper("paper, sine", sine, ELEMENTS(10)).with(|c| {
            c.peaks = vec![("peak_torque_n_m", 1.358_17, 1e-5)];
        }),
        paper("paper, sine, tip 1e-5", sine, ELEMENTS(10)).with(|c| {
            c.tip_tolerance = Some(1e-5);
            c.peaks = vec![("peak_torque_n_m", 1.3576, 1e-4)];
        }),
        paper("paper, sine, auto", sine, Mesh::Auto(1e-6)),
        paper("paper, sine, auto 1e-8", sine, Mesh::Auto(1e-8)).with(|c| c.tolerance = 1e-8),
        paper("paper, sine, two modes", sine, ELEMENTS(10)).with(|c| c.modes = Some(2)),
        paper("paper, sine, two elements", sine, ELEMENTS(2)),
        paper("paper, fast septic", Motion::new(Profile::Septic, 0.3, 0.2, 0.001), ELEMENTS(4)),
    ]
}

/// Displacements in few digits.
fn rounded() -> Vec<Case> {
    let septic = Motion::new(Profile::Septic, 0.5, 1.0, 0.001);
    let of = |name: &str, column, share| {
        let motion = Motion { column, ..septic };
        Case::new(name, Link::paper(), motion, ELEMENTS(10)).with(|c| c.tip_tolerance = share)
    };
    vec![
        of("four decimals, tip 2e-4", Column::Rounded(4), Some(2e-4)).with(|c| {
            c.peaks = vec![("peak_torque_n_m", 1.310, 0.004)];
        }),
        of("four decimals", Column::Rounded(4), None),
        of("seven decimals", Column::Rounded(7), None),
        of("all decimals", Column::Displacement, None).with(|c| {
            c.peaks = vec![("peak_torque_n_m", 1.313, 0.001)];
        }),
    ]
}

/// The hub angle's slow tail with hysteretic damping.
fn tails() -> Vec<Case> {
    let heavy = |mass_kg: f64| {
        let mut link = Link::uniform(1.5, 5.0, 0.8, 0.1);
        link.payload.mass_kg = mass_kg;
        link
    };
    let motion = Motion::new(Profile::Septic, 0.5, 1.5, 0.003);
    let at = |name: &str, mass, tolerance| {
        Case::new(name, heavy(mass), motion, ELEMENTS(20)).with(|c| c.tolerance = tolerance)
    };
    vec![
        at("heavy tip, tolerance 1e-3", 5.0, 1e-3),
        at("heavy tip, tolerance 1e-6", 5.0, 1e-6),
        at("heavy tip, tolerance 1e-8", 5.0, 1e-8),
        at("heavier tip, tolerance 1e-2", 20.0, 1e-2),
        at("light tip, strong damping", 0.1, 1e-6)
            .with(|c| c.link.damping = Damping::Hysteretic(0.2)),
    ]
}

/// Other damping laws.
fn laws() -> Vec<Case> {
    let mut rayleigh = Link::uniform(1.57, 0.41, 1.09, 1.56);
    rayleigh.payload.mass_kg = 3.03;
    rayleigh.damping = Damping::RayleighThrough { modes: [1, 3], ratios: [0.02, 0.03] };
    let slow = Motion::new(Profile::Septic, 0.078, 5.34, 5.34 / 400.0);
    let motion = Motion::new(Profile::Sine, 0.4, 1.2, 0.002);
    let damped = |name: &str, damping, mesh| {
        let link = Link { damping, ..Link::paper() };
        Case::new(name, link, motion, mesh)
    };
    let mut viscous = damped(
        "rayleigh, friction",
        Damping::Rayleigh { alpha_per_s: 0.3, beta_s: 2e-3 },
        ELEMENTS(10),
    );
    viscous.link.friction_n_m_s = 0.2;
    vec![
        Case::new("rayleigh through modes", rayleigh, slow, ELEMENTS(20)).with(|c| {
            c.peaks = vec![("peak_torque_n_m", 0.1642, 0.006)];
        }),
        viscous,
        damped(
            "rayleigh through modes, coarse",
            Damping::RayleighThrough { modes: [1, 3], ratios: [0.02, 0.1] },
            ELEMENTS(4),
        ),
        damped("modal", Damping::Modal(vec![0.02]), ELEMENTS(10)),
        damped("modal, each its own", Damping::Modal(vec![0.01, 0.05, 0.1]), ELEMENTS(20)),
        damped("modal, auto", Damping::Modal(vec![0.02]), Mesh::Auto(1e-5)),
        damped("caughey", Damping::Caughey(vec![0.02, 0.03]), ELEMENTS(20)),
        damped("hardly damped", Damping::Hysteretic(1e-4), ELEMENTS(20)),
        damped("undamped", Damping::Hysteretic(0.0), ELEMENTS(20)),
    ]
}

/// Links of every shape.
fn shapes() -> Vec<Case> {
    let septic = Motion::new(Profile::Septic, 0.3, 0.9, 0.0015);
    let uniform = || Link::uniform(1.2, 6.0, 0.7, 0.15);
    let case = |name: &str, change: &dyn Fn(&mut Link)| {
        let mut link = uniform();
        change(&mut link);
        Case::new(name, link, septic, ELEMENTS(12))
    };
    vec![
        case("hub radius", &|link| link.radius_m = 0.1),
        case("body on the link", &|link| {
            link.bodies.push(Body { at_m: 0.5, mass_kg: 0.4, inertia_kg_m2: 0.0 });
        }),
        case("body that turns", &|link| {
            link.bodies.push(Body { at_m: 0.5, mass_kg: 0.4, inertia_kg_m2: 2e-4 });
        }),
        case("payload beyond the tip", &|link| {
            link.payload = Payload { mass_kg: 0.2, inertia_kg_m2: 1e-3, offset_m: 0.05 };
        }),
        case("blocked tip in the band", &|link| {
            link.payload = Payload { mass_kg: 0.3, inertia_kg_m2: 0.05, offset_m: 0.0 };
        }),
        case("three segments", &|link| {
            let part = |length_m, ei: f64, m: f64| Segment {
                length_m,
                stiffness_n_m2: [ei; 2],
                mass_kg_m: [m; 2],
            };
            link.segments = vec![part(0.3, 30.0, 1.5), part(0.5, 8.0, 0.9), part(0.4, 2.0, 0.4)];
        }),
        case("taper", &|link| {
            link.segments[0].stiffness_n_m2 = [10.0, 3.0];
            link.segments[0].mass_kg_m = [1.0, 0.5];
        }),
        case("taper, auto", &|link| {
            link.segments[0].stiffness_n_m2 = [10.0, 3.0];
            link.segments[0].mass_kg_m = [1.0, 0.5];
        })
        .with(|c| c.mesh = Mesh::Auto(1e-5)),
        case("no hub inertia", &|link| link.hub_kg_m2 = 0.0),
        case("huge hub inertia", &|link| link.hub_kg_m2 = 50.0),
        case("stiff link", &|link| link.segments[0].stiffness_n_m2 = [5000.0; 2]),
    ]
}

/// Every frequency of the samples: nothing keeps the torque of a kink or a fine step within bounds.
fn whole_band() -> Vec<Case> {
    let whole = |name: &str, link: Link, motion, mesh| {
        Case::new(name, link, motion, mesh).with(|c| c.tip_tolerance = Some(0.0))
    };
    let jerk = Motion::new(Profile::MinJerk, 0.3, 1.0, 0.002);
    let bang = Motion::new(Profile::BangBang, 0.5, 1.0, 0.004);
    let gaussian = Motion::new(Profile::Gaussian, 0.5, 1.5, 0.004);
    vec![
        whole("tube, whole band", Link::tube(), jerk, ELEMENTS(20)),
        whole("rome, whole band", Link::rome(), jerk, ELEMENTS(40)),
        whole("paper, bang-bang, whole band", Link::paper(), bang, ELEMENTS(10)),
        whole("paper, gaussian, whole band", Link::paper(), gaussian, ELEMENTS(20)),
    ]
}

/// Windows that cut, limits, steps that are too long.
fn windows() -> Vec<Case> {
    let sine = Motion::new(Profile::Sine, 0.5, 0.88, 0.002);
    let paper = |name: &str, motion| Case::new(name, Link::paper(), motion, ELEMENTS(10));
    vec![
        paper("mesh too large for modal damping", sine).with(|c| {
            c.link.damping = Damping::Modal(vec![0.02]);
            c.mesh = ELEMENTS(600);
            c.expect = Expect::Refusal("modal damping");
        }),
        paper("window cut", sine).with(|c| {
            c.window_s = Some([0.1, 0.2]);
            c.expect = Expect::Warning("torque_cut");
        }),
        paper("limit exceeded", sine).with(|c| {
            c.limits = Some("torque = 1.357".to_owned());
            c.expect = Expect::Warning("limit_exceeded");
        }),
        paper("limit kept", sine).with(|c| {
            c.limits = Some("torque = 1.3595".to_owned());
            c.expect = Expect::Quiet;
        }),
        paper("step too long", Motion::new(Profile::MinJerk, 0.5, 0.5, 0.02)),
        paper("bang-bang", Motion::new(Profile::BangBang, 0.5, 1.0, 0.002)),
        paper("trapezoid", Motion::new(Profile::Trapezoid, 0.5, 1.2, 0.002)),
        paper("s-curve", Motion::new(Profile::SCurve, 0.5, 1.0, 0.002)),
        paper("versine", Motion::new(Profile::Versine, 0.5, 1.0, 0.002)),
        paper("gaussian", Motion::new(Profile::Gaussian, 0.5, 1.5, 0.004)),
    ]
}
