//! What a case came to, in words.

use super::case::{Case, Expect};
use super::judge::{Judgement, judged, names_a_cause};
use super::run::{Nodes, Outcome, solved};
use super::steps::compared;

/// Lines of the table, and what is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Report {
    pub(crate) name: String,
    pub(crate) lines: Vec<String>,
    /// Steps at which files want the same tip and no warning names a cause.
    pub(crate) same_motion: usize,
    pub(crate) wrong: Vec<String>,
}

impl Report {
    pub(crate) fn of(case: &Case) -> Self {
        let mut report = Self { name: case.name.clone(), ..Self::default() };
        let samples = case.motion.samples();
        match solved(case, &samples, &Nodes::of(case, &samples)) {
            Outcome::Refused(code, message) => report.refused(case, code, message.trim()),
            Outcome::Written(written) => {
                report.claims(case, &judged(case, &samples, &written));
                for (key, value, to) in &case.peaks {
                    let found = written.number(&format!("/results/{key}"));
                    if found.is_none_or(|found| (found / value - 1.0).abs() > *to) {
                        report.wrong.push(format!("{key} is {found:?}, not {value}"));
                    }
                }
            }
        }
        let steps = compared(case);
        let bands =
            steps.bands_hz.iter().map(|f| f.map_or("–".to_owned(), |f| format!("{f:.1}")));
        report.lines.push(format!("bands in Hz: {}", bands.collect::<Vec<_>>().join(" ")));
        for (key, peaks) in steps.peaks {
            let peaks = peaks.iter().map(|p| p.map_or("–".to_owned(), |p| format!("{p:.5}")));
            let peaks = peaks.collect::<Vec<_>>().join(" ");
            report.lines.push(format!("{key} at 1, 1/2, 1/4, 1/8 of the step: {peaks}"));
        }
        report.same_motion = steps.same;
        report.wrong.extend(steps.wrong);
        report
    }

    fn refused(&mut self, case: &Case, code: Option<i32>, message: &str) {
        self.lines.push(format!("refused with {code:?}: {}", message.replace('\n', " ")));
        let named = matches!(case.expect, Expect::Refusal(words) if message.contains(words));
        // A drawn case may ask for what there is not; a listed one says so.
        let drawn = case.expect == Expect::Claims && code == Some(4);
        if !named && !drawn {
            self.wrong.push("an unexpected refusal".to_owned());
        }
    }

    fn claims(&mut self, case: &Case, judgement: &Judgement) {
        let Judgement { verdicts, warnings, band_hz } = judgement;
        let band = band_hz.map_or("whole band".to_owned(), |hz| format!("{hz:.1} Hz"));
        let told = warnings.join(" ");
        self.lines.push(format!("{band} {told}"));
        let cells = verdicts.iter().map(|v| {
            let claimed = v.claimed.map_or("–".to_owned(), |c| format!("{c:.1e}"));
            let mark = if v.holds { "" } else { " (!)" };
            format!("{} {claimed} | {:.1e}{mark}", v.quantity, v.truth)
        });
        self.lines.push(cells.collect::<Vec<_>>().join(", "));
        let fails = verdicts.iter().filter(|v| !v.holds).map(|v| v.quantity);
        let fails: Vec<_> = fails.collect();
        if !fails.is_empty() && !names_a_cause(warnings) {
            self.wrong.push(format!("the claim of {} without a word", fails.join(", ")));
        }
        match case.expect {
            Expect::Warning(kind) if !warnings.iter().any(|w| w == kind) => {
                self.wrong.push(format!("no warning {kind}"));
            }
            Expect::Quiet if !warnings.is_empty() => self.wrong.push("a warning".to_owned()),
            Expect::Refusal(words) => self.wrong.push(format!("no refusal with {words:?}")),
            _ => {}
        }
    }
}
