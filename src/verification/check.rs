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
