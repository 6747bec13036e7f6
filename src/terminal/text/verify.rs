//! The table that `verify` prints.

use flexlink::verify::{Check, Outcome, Verification};

/// Numbers below it are round-off, another one on every machine.
const ROUND_OFF: f64 = 1e-9;

/// Decimals that fit the column.
const MOST_DECIMALS: usize = 5;

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
                beyond(*found, *bound)
            };
            format!("{what:<34} {found:>9}   {bound:>9.1e}   {}{verdict}", check.of)
        }
        Outcome::NotMeasured { reason } => format!("{what:<34} not made: {reason}"),
    }
}

/// A number in two digits, in more where its bound has the same two and it exceeds it.
fn beyond(found: f64, bound: f64) -> String {
    let decimals = (1..MOST_DECIMALS)
        .find(|n| found <= bound || format!("{found:.n$e}") != format!("{bound:.n$e}"));
    let decimals = decimals.unwrap_or(MOST_DECIMALS);
    format!("{found:.decimals$e}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_just_beyond_its_bound_looks_larger() {
        assert_eq!(beyond(1.0004, 1.0), "1.0004e0");
        assert_eq!(beyond(1.03e-6, 1e-6), "1.03e-6");
        assert_eq!(beyond(0.9996, 1.0), "1.0e0");
        assert_eq!(beyond(5.4e-1, 1e-2), "5.4e-1");
        assert_eq!(beyond(1.0 + 1e-12, 1.0), "1.00000e0");
    }
}
