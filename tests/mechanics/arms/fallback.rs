//! Arms whose second-order terms do not converge: those of first order, and how far the tip strays for that.

use flexlink::beam::ElementCount;
use flexlink::elastica::{ElasticaError, SecondOrder};
use flexlink::inverse::{
    Analysis, InversionError, Resources, Solution, Straying, Warning, invert_motion,
};
use flexlink::link::Arm;
use flexlink::motion::{ArmPath, Motion, PathColumns};
use flexlink::spec::read_specification;

use super::inversion::{column, largest, moved, path, plans, solved};
use crate::recordings::septic;

const DURATION_S: f64 = 3.0;
const ROWS: u32 = 300;
const START_M: [f64; 2] = [0.7, -0.4];
const BY_M: [f64; 2] = [-0.4, 1.1];

/// The arm of De Luca and Siciliano with this damping.
fn heavy_elbow(damping: &str) -> Arm {
    let text = include_str!("../../../specs/arms/deluca_siciliano.toml");
    let text = text.replace("{ model = \"rayleigh\", beta = 1e-3 }", damping);
    read_specification("arm.toml", &text, &[]).expect("an arm").arm
}

/// The tip on a line across the workspace in 3 s, by the step of seventh order.
fn across(arm: &Arm) -> ArmPath {
    let rows = f64::from(ROWS);
    let shares: Vec<f64> = (0..=ROWS).map(|k| septic(f64::from(k) / rows)[0]).collect();
    let time_s = (0..=ROWS).map(|k| DURATION_S * f64::from(k) / rows).collect();
    let tip = [0, 1].map(|axis| column(["x", "y"][axis], &shares, START_M[axis], BY_M[axis]));
    path(arm, PathColumns { time_s, tip: Some(tip), angles: vec![], carriage: None })
}

fn straying(found: &Solution) -> Straying {
    assert_eq!(found.second_order.expect("second-order terms").order, SecondOrder::First);
    let told = found.warnings.iter().find_map(|found| match found.warning {
        Warning::FellBack { straying } => Some(straying),
        _ => None,
    });
    assert_eq!(found.second_order.expect("second-order terms").fallback, told);
    told.expect("a warning")
}

/// What is told is what Lagrange's equations of the arm do, and no error claims less; the estimate is about as large.
#[test]
fn a_heavy_elbow_that_is_too_fast_for_all_terms_is_told_how_far_its_tip_strays() {
    let arm = heavy_elbow("{ model = \"rayleigh\", beta = 1e-3 }");
    let path = across(&arm);
    let found = solved(&arm, &path, ElementCount::Total(6), &Analysis::default());
    let Straying::Measured(told) = straying(&found) else { panic!("not measured") };
    let played = moved(&found).expect("a motion");
    let off = (0..found.grid.len).map(|k| {
        let along = septic((found.grid.time_s(k) / DURATION_S).clamp(0.0, 1.0))[0];
        let [x, y] = [0, 1].map(|a| played.tip[a].displacement_m[k] - START_M[a] - BY_M[a] * along);
        x.hypot(y) / BY_M[0].hypot(BY_M[1])
    });
    let strays = largest(off);
    assert!((told / strays - 1.0).abs() < 1e-2 && strays > 1e-3, "{told:e} {strays:e}");
    assert!((found.expected_tip_error() - told).abs() < 1e-15);

    let hysteretic = heavy_elbow("{ model = \"hysteretic\", ratio = 0.02 }");
    let found = solved(&hysteretic, &path, ElementCount::Total(6), &Analysis::default());
    let Straying::Estimated(about) = straying(&found) else { panic!("measured") };
    assert!((0.4..2.5).contains(&(about / strays)), "{about:e} {strays:e}");

    let full = Analysis::default().with_second_order(SecondOrder::Full);
    let plans = plans(&arm, ElementCount::Total(6));
    let refused =
        invert_motion(&arm, &plans, &Motion::Path(path), &full, &Resources::default()).err();
    let diverges = |error: &InversionError| {
        matches!(error, InversionError::Elastica(ElasticaError::Diverges { .. }))
    };
    assert!(refused.as_ref().is_some_and(diverges), "{refused:?}");
}
