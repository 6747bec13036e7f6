//! The table that `verify` prints.

use flexlink::verification::{Check, Outcome, Verification};

/// Numbers below it are round-off, another one on every machine.
const ROUND_OFF: f64 = 1e-9;

/// One line a check, lines of at most 80 columns.
pub(crate) fn verify_text(verification: &Verification) -> String {
    let header = format!("{:<34} {:>9}   {:>9}   of", "check", "found", "at most");
    let lines = verification.checks.iter().map(line);
    std::iter::once(header).chain(lines).map(|line| line.trim_end().to_owned() + "\n").collect()
}

fn line(check: &Check) -> String {
    let what = check.what;
    match &check.outcome {
        Outcome::Measured { found, bound } => {
            let verdict = if check.fails() { "  FAILS" } else { "" };
            let found = if *found < ROUND_OFF {
                format!("< {ROUND_OFF:.0e}")
            } else {
                format!("{found:.1e}")
            };
            format!("{what:<34} {found:>9}   {bound:>9.1e}   {}{verdict}", check.of)
        }
        Outcome::NotMeasured { reason } => format!("{what:<34} not made: {reason}"),
    }
}
