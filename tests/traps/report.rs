//! What a case came to, in words.

use super::case::{Case, Expect};
use super::judge::{Judgement, Peak, judged};
use super::run::{Nodes, Outcome, solved};
use super::steps::compared;

/// What a drawn case may be refused for: it asks for what there is not, or for more than the program
/// can do, and says so.
const REFUSALS: [&str; 3] = ["the mesh has no more modes", "for modal damping", "mesh error = "];

/// Lines of the table, and what is wrong.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Report {
    pub(crate) name: String,
    pub(crate) lines: Vec<String>,
    /// Steps at which files want the same tip and no warning says that the peak hangs on the step.
    pub(crate) same_motion: usize,
    pub(crate) is_refused: bool,
    /// Claims that are judged, and those that a warning excuses.
    pub(crate) claims: usize,
    pub(crate) excused: usize,
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
                    let found = written.number(&format!("/results/{}", written.named(key)));
                    if found.is_none_or(|found| (found / value - 1.0).abs() > *to) {
                        report.wrong.push(format!("{key} is {found:?}, not {value}"));
                    }
                }
            }
        }
        let compared = compared(case);
        let bands =
            compared.bands_hz.iter().map(|f| f.map_or("–".to_owned(), |f| format!("{f:.1}")));
        report.lines.push(format!("bands in Hz: {}", bands.collect::<Vec<_>>().join(" ")));
        for (key, peaks) in compared.peaks {
            let peaks = peaks.iter().map(|p| p.map_or("–".to_owned(), |p| format!("{p:.5}")));
            let peaks = peaks.collect::<Vec<_>>().join(" ");
            report.lines.push(format!("{key} at 1, 1/2, 1/4, 1/8 of the step: {peaks}"));
        }
        report.same_motion = compared.same;
        report.wrong.extend(compared.wrong);
        report
    }

    fn refused(&mut self, case: &Case, code: Option<i32>, message: &str) {
        self.lines.push(format!("refused with {code:?}: {}", message.replace('\n', " ")));
        let named = matches!(case.expect, Expect::Refusal(words) if message.contains(words));
        let may_be = case.expect == Expect::Claims && code == Some(4);
        let known = may_be && REFUSALS.iter().any(|words| message.contains(words));
        self.is_refused = true;
        if !named && !known {
            self.wrong.push("an unexpected refusal".to_owned());
        }
    }

    fn claims(&mut self, case: &Case, judgement: &Judgement) {
        let Judgement { verdicts, peaks, warnings, band_hz } = judgement;
        let band = band_hz.map_or("whole band".to_owned(), |hz| format!("{hz:.1} Hz"));
        let told = warnings.iter().map(|w| w.kind.as_str()).collect::<Vec<_>>().join(" ");
        self.lines.push(format!("{band} {told}"));
        let cells = verdicts.iter().map(|v| {
            let claimed = v.claimed.map_or("–".to_owned(), |c| format!("{c:.1e}"));
            let mark = match (v.holds, v.excused) {
                (true, _) => "",
                (false, true) => " (!)",
                (false, false) => " (!!)",
            };
            format!("{} {claimed} | {:.1e}{mark}", v.quantity, v.truth)
        });
        self.lines.push(cells.collect::<Vec<_>>().join(", "));
        self.claims = verdicts.len();
        self.excused = verdicts.iter().filter(|v| v.excused).count();
        for Peak { key, found, truth, .. } in peaks.iter().filter(|peak| !peak.holds) {
            let told = format!("{key} is {found:.5}, not {truth:.5}, {:+.1e}", found / truth - 1.0);
            // Of every frequency of the samples, a summary has the peaks of its rows.
            let is_whole = case.tip_share() == 0.0;
            (if is_whole { &mut self.lines } else { &mut self.wrong }).push(told);
        }
        let fails = verdicts.iter().filter(|v| !v.holds && !v.excused).map(|v| v.quantity);
        let fails: Vec<_> = fails.collect();
        if !fails.is_empty() {
            self.wrong.push(format!("the claim of {} without a word", fails.join(", ")));
        }
        match case.expect {
            Expect::Warning(kind) if !warnings.iter().any(|w| w.kind == kind) => {
                self.wrong.push(format!("no warning {kind}"));
            }
            Expect::Quiet if !warnings.is_empty() => self.wrong.push("a warning".to_owned()),
            Expect::Refusal(words) => self.wrong.push(format!("no refusal with {words:?}")),
            _ => {}
        }
    }
}
