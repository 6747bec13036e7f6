//! What there is to say about all cases of a sweep together.

use std::fmt::Display;

use crate::terminal::{Exit, Failure, console};
use flexlink::result::{Exceeded, Remark};
use flexlink::store::SweptCase;

const NAMED: &str = "the columns warnings and error name them";

/// A warning of one case.
pub(crate) struct CaseWarning {
    kind: String,
    /// Its words and what to do about it; a row of a table has the kind alone.
    words: Option<(String, &'static str)>,
}

impl CaseWarning {
    pub(crate) fn new(kind: &str, message: &impl Display, hint: &'static str) -> Self {
        Self { kind: kind.to_owned(), words: Some((message.to_string(), hint)) }
    }

    /// The warning of an exceeded limit, whose key its kind names.
    pub(crate) fn of_limit(limit: &Exceeded) -> Self {
        Self::new(&format!("{}:{}", Exceeded::KIND, limit.0.key), limit, limit.hint())
    }

    /// The kind, for the table.
    pub(crate) fn kind(&self) -> &str {
        &self.kind
    }

    fn is_of_limit(&self) -> bool {
        self.kind.split(':').next() == Some(Exceeded::KIND)
    }
}

/// Failures and warnings, counted.
#[derive(Default)]
pub(crate) struct Tally {
    rows: usize,
    failed: usize,
    /// Cases that exceed a limit, and cases with any warning.
    exceeding: usize,
    warned: usize,
    failure: Option<(usize, String)>,
    warnings: Vec<Counted<CaseWarning>>,
    remarks: Vec<Counted<Remark>>,
}

/// Cases that have the same kind of warning or remark.
struct Counted<T> {
    cases: usize,
    /// Numbers of the first and the last of them, from 1.
    first: usize,
    last: usize,
    /// That of the first case.
    told: T,
}

/// Counts what a case, numbered from 1, has to tell: each kind once, however often it has it.
fn count<T>(counted: &mut Vec<Counted<T>>, case: usize, told: Vec<T>, kind: fn(&T) -> &str) {
    for told in told {
        match counted.iter_mut().find(|of| kind(&of.told) == kind(&told)) {
            Some(of) => {
                of.cases += usize::from(of.last != case);
                of.last = case;
            }
            None => counted.push(Counted { cases: 1, first: case, last: case, told }),
        }
    }
}

impl Tally {
    /// Counts cases whose rows are there already; `remarks` tells those of a case, numbered from 0.
    pub(crate) fn of_cases(
        cases: impl Iterator<Item = SweptCase>,
        remarks: impl Fn(usize) -> Vec<Remark>,
    ) -> Self {
        let mut tally = Self::default();
        for SweptCase { number, warnings, error } in cases {
            let own = warnings.into_iter().map(|kind| CaseWarning { kind, words: None });
            tally.add(number + 1, error.as_ref(), own.collect(), remarks(number));
        }
        tally
    }

    /// Counts a case, numbered from 1: its failure, or its warnings, and its remarks.
    pub(crate) fn add(
        &mut self,
        case: usize,
        failure: Option<&String>,
        warnings: Vec<CaseWarning>,
        remarks: Vec<Remark>,
    ) {
        self.rows += 1;
        if let Some(message) = failure {
            self.failed += 1;
            self.failure.get_or_insert_with(|| (case, message.clone()));
        }
        self.exceeding += usize::from(warnings.iter().any(CaseWarning::is_of_limit));
        self.warned += usize::from(!warnings.is_empty());
        count(&mut self.warnings, case, warnings, CaseWarning::kind);
        count(&mut self.remarks, case, remarks, |remark| remark.kind());
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

    /// Fails where a case failed or exceeds a limit.
    pub(crate) fn refuse_exceeding(&self) -> Result<(), Failure> {
        self.refuse("--strict: cases that failed or exceed a limit", self.failed + self.exceeding)
    }

    /// Fails where a case failed or has a warning.
    pub(crate) fn refuse_warned(&self) -> Result<(), Failure> {
        self.refuse("--deny-warnings: cases that failed or warn", self.failed + self.warned)
    }

    /// Fails where there are such cases.
    fn refuse(&self, what: &str, cases: usize) -> Result<(), Failure> {
        if cases == 0 {
            return Ok(());
        }
        let of = format!("{cases} of {}", self.rows);
        let message = format!("{what} = {of}, but must be none; the table is written");
        Err(Failure::new(Exit::NotSolvable, &message, Some(NAMED)))
    }

    /// Prints remarks and warnings, each kind once.
    pub(crate) fn warn(&self) {
        let of = |cases: usize| format!("{cases} of {} cases", self.rows);
        for Counted { cases, first, told, .. } in &self.remarks {
            let text = format!("{}, the first is case {first}: {told}", of(*cases));
            console::remark(&text, told.hint());
        }
        if let Some((case, message)) = &self.failure {
            let text = format!("{} failed, the first is case {case}: {message}", of(self.failed));
            console::warning(text, "the column error says why");
        }
        for Counted { cases, first, told, .. } in &self.warnings {
            let (words, hint) = match &told.words {
                Some((message, hint)) => (message, *hint),
                None => (&told.kind, "flexlink solve tells more of a single case"),
            };
            let text = format!("{}, the first is case {first}: {words}", of(*cases));
            console::warning(text, hint);
        }
    }
}
