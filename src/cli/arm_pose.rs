//! An arm in a pose, as `modes` and `frf` ask for it.

use flexlink::beam::MeshPlan;
use flexlink::response::{ArmModes, ArmResponses, arm_modes, arm_responses};
use flexlink::spec::ArmSpecification;
use flexlink::text::significant;

use crate::options::common::directions;
use crate::terminal::{Failure, console};

/// Relative error above which the user is warned.
pub(crate) const COARSE: f64 = 1e-2;

/// An arm, and the directions in which its links point.
pub(crate) struct ArmInPose {
    pub(crate) specification: Box<ArmSpecification>,
    directions_rad: Vec<f64>,
}

impl ArmInPose {
    /// The arm in the directions of `--at`, in rad.
    pub(crate) fn of(
        specification: Box<ArmSpecification>,
        at: Option<&[f64]>,
    ) -> Result<Self, Failure> {
        let directions_rad = directions(at, specification.arm.links().len())?;
        Ok(Self { specification, directions_rad })
    }

    fn tolerance(&self) -> f64 {
        MeshPlan::smallest_tolerance(&self.specification.meshes)
    }

    /// The swings and `count` modes more.
    pub(crate) fn modes(&self, count: usize) -> Result<ArmModes, Failure> {
        let arm = &self.specification.arm;
        Ok(arm_modes(arm, &self.directions_rad, count, self.tolerance())?)
    }

    pub(crate) fn responses(&self, frequencies_hz: &[f64]) -> Result<ArmResponses, Failure> {
        let arm = &self.specification.arm;
        Ok(arm_responses(arm, &self.directions_rad, frequencies_hz, self.tolerance())?)
    }

    /// Prints the largest error and whether the arm falls; returns the number of warnings.
    pub(crate) fn tell_responses(&self, modes: &ArmModes, found: &ArmResponses) -> usize {
        console::remarks(&self.specification.remarks);
        let errors = found.rows.iter().map(|row| row.frequency_hz).zip(&found.errors);
        let worst = errors.max_by(|a, b| a.1.total_cmp(b.1));
        let mut warnings = 0;
        if let Some((hertz, error)) = worst {
            let hertz = significant(hertz, 4);
            let words =
                format!("{error:.1e} of the magnitude at the worst, at {hertz} Hz (orders raised)");
            if error.is_nan() || *error > COARSE {
                console::warning(format!("the mesh error is {words}"), "a lower --to");
                warnings += 1;
            } else {
                console::note(&format!("the mesh error is {words}"));
            }
        }
        let falls = is_unstable(modes.free.modes.iter().map(|mode| mode.square_per_s2));
        if falls {
            let words = "the arm falls from this pose if its joints are free: only under control does it respond so";
            console::warning(words, "modes --at tells how fast it falls");
        }
        warnings + usize::from(falls)
    }
}

/// True if one of these squares of natural frequencies is that of a motion away from the pose.
pub(crate) fn is_unstable(squares_per_s2: impl IntoIterator<Item = f64>) -> bool {
    squares_per_s2.into_iter().any(|square| square < 0.0)
}

/// Warns of a pose that a link or an arm leaves if its hubs are free, or even if they are held; returns the number of
/// warnings.
pub(crate) fn warn_of_fall([free, held]: [bool; 2], [what, hubs]: [&str; 2]) -> usize {
    let are = if hubs.ends_with('s') { "are" } else { "is" };
    let warn = |state: &str, hint: &str| {
        let words = format!(
            "the {what} falls from this pose if its {hubs} {are} {state}: it leaves it, and does not vibrate about it"
        );
        console::warning(words, hint);
    };
    if held {
        warn("held", "a stiffer link, or less mass at its tip: the weight buckles it");
    } else if free {
        warn("free", "the table tells how fast; a controller that holds the pose changes that");
    }
    usize::from(free || held)
}
