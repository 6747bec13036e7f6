//! What there is to say about all cases of a sweep together.

use std::fmt::Display;

use flexlink::tables::SweepRows;

use super::console;
use super::exit::{Exit, Failure};

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
    /// Begins with rows that are there already: their number, and those that failed.
    pub(crate) fn of_rows(rows: &SweepRows) -> Self {
        let failures = rows.failures();
        let first = failures.first().map(|(case, message)| (case + 1, message.clone()));
        Self { rows: rows.len(), failed: failures.len(), failure: first, remarks: Vec::new() }
    }

    /// Joins what is known of another part of the same sweep.
    pub(crate) fn join(&mut self, other: Self) {
        self.rows += other.rows;
        self.failed += other.failed;
        let failures = [self.failure.take(), other.failure].into_iter().flatten();
        self.failure = failures.min_by_key(|(case, _)| *case);
    }

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

    /// Fails where no case at all has numbers, with why the first has none.
    pub(crate) fn refuse_all_failed(&self) -> Result<(), Failure> {
        let Some((_, message)) = self.failure.as_ref().filter(|_| self.failed == self.rows) else {
            return Ok(());
        };
        let message = format!("no case could be solved; the first: {message}");
        Err(Failure::new(Exit::NotSolvable, &message, None))
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
