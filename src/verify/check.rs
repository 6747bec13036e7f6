/// One measured number against what it may be.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Name for machines: `tip_error`, `mesh_halving`, ….
    pub name: &'static str,
    /// What was measured, for people.
    pub what: &'static str,
    /// What the number is a share of.
    pub of: &'static str,
    /// What came of it.
    pub outcome: Outcome,
}

/// What came of a check.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// A number, which may be as large as its bound.
    Measured {
        /// What was found.
        found: f64,
        /// What it may be at most.
        bound: f64,
    },
    /// Nothing, and why.
    NotMeasured {
        /// The reason.
        reason: String,
    },
}

/// A check before its number is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Question {
    pub(super) name: &'static str,
    pub(super) what: &'static str,
    pub(super) of: &'static str,
}

impl Question {
    /// A number against its bound.
    pub(super) fn measured(self, found: f64, bound: f64) -> Check {
        self.answered(Outcome::Measured { found, bound })
    }

    /// A check that was not made.
    pub(super) fn not_measured(self, reason: String) -> Check {
        self.answered(Outcome::NotMeasured { reason })
    }

    fn answered(self, outcome: Outcome) -> Check {
        let Self { name, what, of } = self;
        Check { name, what, of, outcome }
    }
}

impl Check {
    /// True if the value exceeds its bound or is NaN.
    pub fn fails(&self) -> bool {
        match self.outcome {
            Outcome::Measured { found, bound } => found.is_nan() || found > bound,
            Outcome::NotMeasured { .. } => false,
        }
    }

    /// What helps where it fails.
    pub fn hint(&self) -> &'static str {
        match self.name {
            "tip_error" | "tip_error_viscous" => {
                "a tighter analysis.tolerance, no analysis.lead and analysis.lag of your own, or more --digits"
            }
            "wrap_around" => {
                "a looser analysis.tolerance, or a longer analysis.lead and analysis.lag"
            }
            "tip_solved" => "a shorter step, a smoother motion or a looser analysis.tip_tolerance",
            "step_halving" | "step_halving_motor" | "energy" => {
                "a shorter step or a smoother motion"
            }
            "mesh_halving" => "more elements, or mesh.elements = \"auto\"",
            "truncation" => "more modes: analysis.modes",
            "tip_deflection" => "a slower motion or a stiffer link",
            name if name.starts_with("limit") => "a slower motion, or another limit",
            _ => "please report this as an error of the program",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_is_nan_fails() {
        let question = Question { name: "x", what: "", of: "" };
        let fails = |found| question.measured(found, 1.0).fails();
        assert!(!fails(1.0) && fails(1.1) && fails(f64::NAN));
        assert!(!question.not_measured("too large".into()).fails());
    }
}
