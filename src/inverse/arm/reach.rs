//! Whether the first two links of an arm reach the places that a path prescribes.

use super::error::ArmError;
use super::warning::ArmWarning;
use crate::elastica::STRETCHED;
use crate::link::Arm;
use crate::motion::{ArmPath, Prescribed};

/// Sine of the elbow's angle below which the user is warned.
const NEARLY_STRETCHED: f64 = 0.15;

/// Refuses a path whose places of the tip an arm does not reach, or only stretched or folded, as [`invert_arm`] does;
/// returns the warning of an elbow that is nearly so. A path of directions has no such places.
///
/// [`invert_arm`]: super::invert_arm
///
/// # Errors
/// [`ArmError`] with the sample.
pub fn check_reach(arm: &Arm, path: &ArmPath) -> Result<Option<ArmWarning>, ArmError> {
    if path.prescribed() == Prescribed::Angles {
        return Ok(None);
    }
    if arm.elbow().is_none() {
        return Err(ArmError::NoElbow);
    }
    let lengths_m = arm.lengths_m();
    let [l1, l2] = [lengths_m[0], lengths_m[1]];
    let (least_m, most_m) = ((l1 - l2).abs(), l1 + l2);
    let mut least = (0, 1.0);
    for (sample, (distance_m, cosine)) in elbows(path, &lengths_m).enumerate() {
        if !(-1.0..=1.0).contains(&cosine) {
            return Err(ArmError::OutOfReach { sample, distance_m, least_m, most_m });
        }
        let sine = (1.0 - cosine * cosine).sqrt();
        if sine < STRETCHED {
            return Err(ArmError::Stretched { sample, sine, least: STRETCHED });
        }
        if sine < least.1 {
            least = (sample, sine);
        }
    }
    let (sample, sine) = least;
    let time_s = path.grid().time_s(sample);
    Ok((sine < NEARLY_STRETCHED).then_some(ArmWarning::NearlyStretched { sine, time_s }))
}

/// Distance in m of the second link's end from the first joint, and cosine of the elbow's angle, at each sample.
fn elbows(path: &ArmPath, lengths_m: &[f64]) -> impl Iterator<Item = (f64, f64)> {
    let given = path.given();
    (0..path.grid().len).map(move |k| {
        let outer = given[2..].iter().zip(&lengths_m[2..]);
        let [x, y] = outer.fold([given[0][k], given[1][k]], |[x, y], (angle, length_m)| {
            [x - length_m * libm::cos(angle[k]), y - length_m * libm::sin(angle[k])]
        });
        let [l1, l2] = [lengths_m[0], lengths_m[1]];
        let squared = x * x + y * y;
        (squared.sqrt(), (squared - l1 * l1 - l2 * l2) / (2.0 * l1 * l2))
    })
}
