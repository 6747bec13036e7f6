//! Every refusal of a valid link and a valid motion.

use std::f64::consts::TAU;
use std::num::NonZeroUsize;

use super::{Smooth, accelerated, link, plan_of, refused, sine, whole_band};
use crate::common::mesh_of;
use flexlink::beam::{ElementCount, Mesh, MeshPlan, tip_transfer};
use flexlink::inverse::{Analysis, InversionError, Resources, Warning, invert, invert_motion};
use flexlink::link::{Damping, Link, Taper};
use flexlink::modal::{DampingError, real_frequency_zeros};
use flexlink::model::ModelError;
use flexlink::motion::Motion;

fn through_modes(modes: [usize; 2], ratios: [f64; 2]) -> Link {
    link(|parts| parts.damping = Damping::RayleighThroughModes { modes, ratios })
}

/// The refusal on a mesh of two elements, which has four flexible modes.
fn refused_on_two_elements(link: &Link, analysis: &Analysis) -> InversionError {
    refused(link, &plan_of(link, 2), &Smooth::MOVE.motion(), analysis)
}

#[test]
fn a_plan_of_another_link_and_nodes_of_another_mesh() {
    let link = link(|_| ());
    let two_segments = super::link(|parts| parts.segments.push(parts.segments[0].clone()));
    let plan = plan_of(&two_segments, 10);
    let motion = Smooth::MOVE.motion();
    let error = refused(&link, &plan, &motion, &Analysis::default());
    assert_eq!(
        error.to_string(),
        "mesh plan = that of another link, but must be that of this link: another has other \
         segments, or masses elsewhere"
    );
    assert!(error.hint().is_some());
    assert!(Mesh::new(&link, &plan).is_err());
    let solution = invert(&link, &plan_of(&link, 10), &motion, &Analysis::default()).unwrap();
    let refused = solution.deflections(&[3, 11], NonZeroUsize::MIN).err().unwrap();
    assert_eq!(refused.to_string(), "nodes = 11, but must be nodes of the mesh, 0 to 10");
}

#[test]
fn a_mode_that_the_mesh_does_not_have() {
    let error = refused_on_two_elements(
        &through_modes([1, 5], [0.02, 0.02]),
        &whole_band(Analysis::default()),
    );
    let no_such_mode = DampingError::NoSuchMode { asked: 5, found: 4 };
    assert_eq!(error, InversionError::Model(no_such_mode.into()));
}

#[test]
fn two_ratios_that_need_negative_damping() {
    for (ratios, negative) in [([0.001, 0.1], "alpha = -"), ([0.1, 0.001], "beta = -")] {
        let link = through_modes([1, 2], ratios);
        let error = refused_on_two_elements(&link, &whole_band(Analysis::default()));
        assert!(
            matches!(
                error,
                InversionError::Model(ModelError::Damping(DampingError::NegativeDamping { .. }))
            ),
            "{error}"
        );
        let message = error.to_string();
        assert!(message.starts_with("damping.ratios give alpha = "), "{message}");
        assert!(message.contains(negative), "{message}");
        assert!(message.ends_with("but both must be at least 0"), "{message}");
        assert!(error.hint().unwrap().contains("bring the two ratios closer together"));
    }
}

#[test]
fn numbers_beyond_double_precision() {
    let link = link(|parts| parts.hub.inertia_kg_m2 = 1e200);
    let faster = Smooth::MOVE.acceleration_m_s2().iter().map(|a| 1e110 * a).collect();
    let motion = accelerated(Smooth::MOVE.time_s(), faster);
    let error = refused(&link, &plan_of(&link, 2), &motion, &whole_band(Analysis::default()));
    let InversionError::Model(ModelError::NotFinite { frequency_hz }) = error else {
        panic!("{error}");
    };
    // Of a torque without end the lowest frequency but zero is named, one period's.
    let periods_s = 1.0 / frequency_hz;
    assert!((1.0..20.0).contains(&periods_s), "{periods_s} s");
    assert!((periods_s * 256.0 - (periods_s * 256.0).round()).abs() < 1e-6, "{periods_s} s");
}

/// An undamped payload's rotary inertia holds the tip still at one frequency.
fn blocked() -> Link {
    link(|parts| {
        parts.damping = Damping::None;
        parts.payload.inertia_kg_m2 = 0.01;
    })
}

/// Rounding leaves a tip displacement of its own size where the tip is blocked, and would make a torque
/// of any size of it.
#[test]
fn a_frequency_at_which_no_torque_moves_the_tip() {
    let link = blocked();
    let plan = plan_of(&link, 6);
    let blocked_rad_s = real_frequency_zeros(&Mesh::new(&link, &plan).unwrap(), 1e3)[0];
    let analysis = whole_band(Analysis::new(1e-6, Some(0.1), Some(0.1)).unwrap());
    let found = |step_s: f64| {
        let motion = Smooth { duration_s: 256.0 * step_s, ..Smooth::MOVE }.motion();
        invert(&link, &plan, &motion, &analysis)
    };
    // A bin of the period is moved onto that frequency by a change of the step.
    let step_s = Smooth::MOVE.step_s();
    let beside = found(step_s).unwrap();
    assert!(beside.warnings.iter().any(|w| matches!(w.warning, Warning::BlockedTip { .. })));
    let bin = (blocked_rad_s * beside.band.period_s / TAU).round();
    let samples = beside.band.fft_length as f64;
    let step_s = bin * TAU / (samples * blocked_rad_s);
    let error = found(step_s).map(|_| ()).unwrap_err();
    let InversionError::BlockedTip { frequency_hz } = error else { panic!("{error}") };
    assert!((frequency_hz * TAU / blocked_rad_s - 1.0).abs() < 1e-12, "{frequency_hz} Hz");
    let message = error.to_string();
    assert!(message.starts_with("no torque moves the tip at "), "{message}");
    assert!(error.hint().unwrap().starts_with(
        "use damping, more elements or a smoother motion; the cause is a payload's inertia"
    ));
    // A billionth beside it the tip moves.
    assert!(found(step_s * (1.0 + 1e-9)).is_ok());
}

#[test]
fn a_blocked_tip_is_known_from_a_moving_one_on_any_mesh() {
    let link = blocked();
    for elements in [1, 6, 32, 400, 4000] {
        let mesh = mesh_of(&link, elements);
        let blocked_rad_s = real_frequency_zeros(&mesh, 1e3)[0];
        let is_blocked = |beside: f64| {
            let lambda = (blocked_rad_s * (1.0 + beside)).powi(2);
            tip_transfer(&mesh, lambda.into()).is_blocked(&mesh)
        };
        for hairs in -3..=3 {
            assert!(is_blocked(f64::from(hairs) * f64::EPSILON), "{elements} elements, {hairs}");
        }
        assert!(!is_blocked(3e-11) && !is_blocked(-3e-11), "{elements} elements");
    }
}

#[test]
fn an_automatic_mesh_that_does_not_converge() {
    // Rounding adds up over thousands of elements that are not equal.
    let link = link(|parts| {
        parts.damping = Damping::None;
        parts.segments[0].bending_stiffness_n_m2 = Taper { inner: 6.0, outer: 4.0 };
    });
    let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Auto), 1e-12).unwrap();
    let error = refused(&link, &plan, &sine(0.5, 0.2, 20), &whole_band(Analysis::default()));
    let InversionError::NotConverged { error: reached, elements, tolerance } = error else {
        panic!("{error}");
    };
    assert!(reached > 1e-12 && elements >= 2048, "{error}");
    assert!((tolerance - 1e-12).abs() < 1e-24);
    let expected = format!(
        "mesh error = {reached:.2e} of the peak torque with {elements} elements, but must be at \
         most 1e-12"
    );
    assert_eq!(error.to_string(), expected);
    assert_eq!(error.hint(), Some("loosen mesh.tolerance, or sample the motion more smoothly"));
}

#[test]
fn a_window_longer_than_can_be_transformed() {
    let analysis = whole_band(Analysis::new(1e-6, None, Some(1e6)).unwrap());
    let error = refused_on_two_elements(&link(|_| ()), &analysis);
    let InversionError::TooLong { samples, limit } = error else {
        panic!("{error}");
    };
    assert!(samples > 256_000_000 && limit == 1 << 24, "{error}");
}

#[test]
fn the_memory_that_a_refusal_names_is_what_it_takes() {
    // No slow tail lengthens the period.
    let link = link(|parts| parts.damping = Damping::None);
    let motion = Motion::Tip(Smooth::SHORT.motion());
    let within = |bytes: usize| {
        let analysis = whole_band(Analysis::new(1e-4, None, None).unwrap());
        let resources = Resources { memory_bytes: Some(bytes), ..Resources::default() };
        invert_motion(&link.clone().into(), &[plan_of(&link, 4)], &motion, &analysis, &resources)
            .map(|solution| solution.band.fft_length)
    };
    // A period that is lengthened takes more than the first one.
    let mut bytes = 1;
    let samples = loop {
        match within(bytes) {
            Ok(samples) => break samples,
            Err(InversionError::TooMuchMemory { bytes: more, allowed }) => {
                assert!(allowed == bytes && more > bytes, "{more} after {bytes}");
                bytes = more;
            }
            Err(other) => panic!("{other}"),
        }
    };
    // Torque, motion and their amplitudes at least, of two meshes.
    assert!(bytes > 100 * samples && bytes < 1000 * samples, "{bytes} for {samples}");
    let refused = within(bytes - 1).unwrap_err();
    assert_eq!(refused, InversionError::TooMuchMemory { bytes, allowed: bytes - 1 });
}
