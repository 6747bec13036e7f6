//! What there is to say about all cases of a sweep together.

use std::fmt::Display;

use super::console;

/// A warning of one case: its kind, its words and what to do about it.
pub(crate) struct Remark {
    kind: &'static str,
    message: String,
    hint: &'static str,
}

impl Remark {
    pub(crate) fn new(kind: &'static str, message: &impl Display, hint: &'static str) -> Self {
        Self { kind, message: message.to_string(), hint }
    }
}

/// Failures and warnings, counted.
#[derive(Default)]
pub(crate) struct Tally {
    rows: usize,
    failed: usize,
    failure: Option<(usize, String)>,
    remarks: Vec<Counted>,
}

struct Counted {
    cases: usize,
    /// Number of the first case with it, from 1.
    first: usize,
    remark: Remark,
}

impl Tally {
    /// Counts a case, numbered from 1: its failure, or its remarks.
    pub(crate) fn add(&mut self, case: usize, failure: Option<&String>, remarks: Vec<Remark>) {
        self.rows += 1;
        if let Some(message) = failure {
            self.failed += 1;
            self.failure.get_or_insert_with(|| (case, message.clone()));
        }
        for remark in remarks {
            match self.remarks.iter_mut().find(|counted| counted.remark.kind == remark.kind) {
                Some(counted) => counted.cases += 1,
                None => self.remarks.push(Counted { cases: 1, first: case, remark }),
            }
        }
    }

    /// Cases counted.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Whether no case at all has numbers, and why the first has none.
    pub(crate) fn all_failed(&self) -> Option<&str> {
        let failure = self.failure.as_ref().filter(|_| self.failed == self.rows);
        failure.map(|(_, message)| message.as_str())
    }

    /// Prints the warnings, each kind once.
    pub(crate) fn warn(&self) {
        let of = |cases: usize| format!("{cases} of {} cases", self.rows);
        if let Some((case, message)) = &self.failure {
            let text = format!("{} failed, the first is case {case}: {message}", of(self.failed));
            console::warning(text, "the column error says why");
        }
        for Counted { cases, first, remark } in &self.remarks {
            let text = format!("{}, the first is case {first}: {}", of(*cases), remark.message);
            console::warning(text, remark.hint);
        }
    }
}
