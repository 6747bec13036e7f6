/// One measured number against what it may be.
#[derive(Debug, Clone, PartialEq)]
pub struct Check {
    /// Name for machines: `tip_error`, `mesh_halving`, ….
    pub name: &'static str,
    /// What was measured, for people.
    pub what: String,
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

impl Check {
    /// A number against its bound.
    pub(super) fn measured(name: &'static str, what: String, found: f64, bound: f64) -> Self {
        Self { name, what, outcome: Outcome::Measured { found, bound } }
    }

    /// A check that was not made.
    pub(super) fn not_measured(name: &'static str, what: String, reason: String) -> Self {
        Self { name, what, outcome: Outcome::NotMeasured { reason } }
    }

    /// Whether the number is out of its bound; a number that is none is.
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
    fn a_number_that_is_none_fails() {
        let check = |found| Check::measured("x", String::new(), found, 1.0);
        assert!(!check(1.0).fails() && check(1.1).fails() && check(f64::NAN).fails());
        assert!(!Check::not_measured("x", String::new(), "too large".into()).fails());
    }
}
