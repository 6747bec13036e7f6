//! Which claims a warning excuses, by what it says.
//!
//! A warning excuses a claim only where it is about the quantity and about the kind of error that the
//! claim mostly consists of. Those of the window (`wrap_around`, `torque_cut`, `inexact_window`) and of
//! `blocked_tip` excuse none: what they tell is measured, and part of the claim. Those of the step
//! (`near_nyquist`, `coarse_step`, `unsettled_torque`) are about the motion between the samples; the
//! truth has the samples.

use super::run::Warned;

/// What a kind of warning says about a claim.
struct Excuse {
    kind: &'static str,
    /// Kind of error that it is about.
    error: &'static str,
    of: Of,
}

/// Which quantities a warning is about.
enum Of {
    These(&'static [&'static str]),
    /// The one that its message names, and those that claim as much themselves.
    NamedOrAbove(f64),
}

/// The error by halved elements, or by the modes that are left out, is no longer small beside the
/// value from here on, and so not the error itself.
const LARGE: f64 = 1e-2;

const EXCUSES: [Excuse; 4] = [
    Excuse { kind: "tip_missed", error: "tip", of: Of::These(&["tip"]) },
    Excuse { kind: "coarse_mesh", error: "mesh", of: Of::NamedOrAbove(LARGE) },
    Excuse {
        kind: "above_mesh",
        error: "mesh",
        of: Of::These(&["torque", "bending_moment", "motor_torque"]),
    },
    Excuse { kind: "few_modes", error: "modes", of: Of::NamedOrAbove(LARGE) },
];

/// Kinds that say that a peak, and the band, hangs on the step of the motion.
const OF_THE_STEP: [&str; 4] = ["tip_missed", "near_nyquist", "coarse_step", "unsettled_torque"];

/// What a run claims of one quantity: kinds of error and how large each is.
pub(crate) type Claim = Vec<(String, f64)>;

/// Whether a warning says why the claim of a quantity may be wrong. `named` is the program's name of the quantity.
pub(crate) fn excuses(warnings: &[Warned], (quantity, named): (&str, &str), claim: &Claim) -> bool {
    let Some((most, error)) = claim.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return false;
    };
    warnings.iter().any(|warned| {
        let own = EXCUSES.iter().find(|excuse| excuse.kind == warned.kind);
        own.is_some_and(|excuse| {
            excuse.error == most
                && match excuse.of {
                    Of::These(quantities) => quantities.contains(&quantity),
                    Of::NamedOrAbove(large) => *error > large || warned.names(named),
                }
        })
    })
}

/// Whether a warning says that the peak hangs on the step.
pub(crate) fn hangs_on_the_step(warnings: &[Warned]) -> bool {
    warnings.iter().any(|warned| OF_THE_STEP.contains(&warned.kind.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_excuses_only_what_it_is_about() {
        let warned = |kind: &str, message: &str| Warned {
            kind: kind.to_owned(),
            message: message.to_owned(),
        };
        let claim = |mesh, window| vec![("mesh".to_owned(), mesh), ("window".to_owned(), window)];
        let mesh =
            [warned("coarse_mesh", "the mesh changes the motor torque by 2.0e-2 of its peak")];
        assert!(excuses(&mesh, ("motor_torque", "motor_torque"), &claim(2e-2, 0.0)));
        assert!(!excuses(&mesh, ("hub_angle", "hub_angle"), &claim(1e-3, 0.0)));
        assert!(!excuses(&mesh, ("torque", "torque"), &claim(1e-3, 2e-3)));
        assert!(excuses(&mesh, ("torque", "torque"), &claim(3e-2, 2e-3)));
        assert!(!excuses(
            &[warned("tip_missed", "the tip strays")],
            ("torque", "torque"),
            &claim(0.1, 0.0)
        ));
    }
}
