//! Counts of failures, warnings and remarks of all cases of a sweep.

use crate::link::Arm;
use crate::result::{Exceeded, Notice, Remark};
use crate::store::SweptCase;

use crate::cli::terminal::{Exit, Failure, console};

const NAMED: &str = "the columns warnings and error name them";

/// The warning of an exceeded limit. Its kind contains the limit's key, as in the file.
pub fn of_limit(limit: &Exceeded, arm: &Arm) -> Notice {
    let own = &limit.0;
    let of = own.joint.map(|joint| arm.name_of_joint(joint).replace(' ', "") + ".");
    let joint = arm.joints().nth(own.joint.unwrap_or(0));
    let key = joint.map_or(own.key.to_owned(), |joint| joint.named(own.key));
    let kind = format!("{}:{}{key}", Exceeded::KIND, of.unwrap_or_default());
    Notice { kind, ..Notice::from(limit) }
}

fn is_of_limit(notice: &Notice) -> bool {
    notice.kind.split(':').next() == Some(Exceeded::KIND)
}

/// Counts of failures, warnings and remarks.
#[derive(Default)]
pub struct Tally {
    rows: usize,
    failed: usize,
    /// Cases that exceed a limit, and cases with any warning.
    exceeding: usize,
    warned: usize,
    /// Number and message of the first failed case.
    failure: Option<(usize, String)>,
    warnings: Vec<Counted>,
    remarks: Vec<Counted>,
}

/// Cases with the same kind of warning or remark.
struct Counted {
    cases: usize,
    /// Numbers of the first and the last case, from 1.
    first: usize,
    last: usize,
    /// Notice of the first case.
    notice: Notice,
}

impl Counted {
    fn line(&self, rows: usize, named: impl Fn(usize) -> String) -> String {
        let Self { cases, first, notice: Notice { message, .. }, .. } = self;
        format!("{cases} of {rows} cases, the first is {}: {message}", named(*first))
    }
}

/// Counts the warnings or remarks of a case, numbered from 1: each kind once.
fn count(counted: &mut Vec<Counted>, case: usize, notices: impl IntoIterator<Item = Notice>) {
    for notice in notices {
        match counted.iter_mut().find(|of| of.notice.kind == notice.kind) {
            Some(of) => {
                of.cases += usize::from(of.last != case);
                of.last = case;
            }
            None => counted.push(Counted { cases: 1, first: case, last: case, notice }),
        }
    }
}

impl Tally {
    /// Counts cases of earlier rows; `remarks` returns the remarks of a case, numbered from 0.
    pub(crate) fn of_cases(
        cases: impl Iterator<Item = SweptCase>,
        remarks: impl Fn(usize) -> Vec<Remark>,
    ) -> Self {
        let mut tally = Self::default();
        for SweptCase { number, warnings, error } in cases {
            // The row has the kind alone.
            let hint = "solve the case alone with flexlink solve for more";
            let notices = warnings.iter().map(|kind| Notice::new(kind, kind, hint));
            tally.add(number + 1, error.as_ref(), notices.collect(), &remarks(number));
        }
        tally
    }

    /// Counts a case, numbered from 1: its failure, or its warnings, and its remarks.
    pub fn add(
        &mut self,
        case: usize,
        failure: Option<&String>,
        warnings: Vec<Notice>,
        remarks: &[Remark],
    ) {
        self.rows += 1;
        if let Some(message) = failure {
            self.failed += 1;
            self.failure.get_or_insert_with(|| (case, message.clone()));
        }
        self.exceeding += usize::from(warnings.iter().any(is_of_limit));
        self.warned += usize::from(!warnings.is_empty());
        count(&mut self.warnings, case, warnings);
        let remarks = remarks.iter().map(Notice::from);
        count(&mut self.remarks, case, remarks);
    }

    /// Cases counted.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// Fails if all cases failed, with the message of the first.
    pub(crate) fn refuse_all_failed(&self) -> Result<(), Failure> {
        let Some((_, message)) = self.failure.as_ref().filter(|_| self.failed == self.rows) else {
            return Ok(());
        };
        let message = format!("no case could be solved; the first: {message}");
        Err(Failure::new(Exit::NotSolvable, &message, None))
    }

    /// Fails if a case failed or exceeds a limit.
    pub(crate) fn refuse_exceeding(&self) -> Result<(), Failure> {
        self.refuse("--strict: cases that failed or exceed a limit", self.failed + self.exceeding)
    }

    /// Fails if a case failed or has a warning.
    pub(crate) fn refuse_warned(&self) -> Result<(), Failure> {
        self.refuse("--deny-warnings: cases that failed or warn", self.failed + self.warned)
    }

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
        let named = |case| format!("case {case}");
        for of in &self.remarks {
            console::remark(&of.line(self.rows, named), &of.notice.hint);
        }
        console::warnings(self.warnings(named));
    }

    /// The failures, then each kind of warning once; `named` is the name of a case by its number from 1.
    pub fn warnings(&self, named: impl Fn(usize) -> String) -> Vec<Notice> {
        let failure = self.failure.as_ref().map(|(first, message)| {
            let failed = format!("{} of {} cases failed", self.failed, self.rows);
            let words = format!("{failed}, the first is {}: {message}", named(*first));
            Notice::new("failed", &words, "the column error says why")
        });
        let of_kind =
            |of: &Counted| Notice { message: of.line(self.rows, &named), ..of.notice.clone() };
        failure.into_iter().chain(self.warnings.iter().map(of_kind)).collect()
    }
}
