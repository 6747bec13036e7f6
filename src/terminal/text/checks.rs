//! What `verify`, `solve --repeat` and `trajectory --fit-limit` have found.

use std::path::Path;

use flexlink::numeric::{plain, significant};
use flexlink::result::{Fit, Limits, LineDifference, Metrics, Reached, Repeated, RepeatedFile};
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
    let what = &check.what;
    match &check.outcome {
        Outcome::Measured { found, bound } => {
            let verdict = if check.fails() { "  FAILS" } else { "" };
            let found = if *found <= ROUND_OFF {
                format!("< {ROUND_OFF:.0e}")
            } else if found >= bound && !check.fails() {
                format!("< {bound:.1e}")
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

/// Characters of a line that are told before the first one that differs, and in all.
const BEFORE: usize = 20;
const IN_ALL: usize = 48;

/// A line a file that is not the same, and what came of all.
pub(crate) fn repetition_text(files: &[RepeatedFile], run: &Path, kept: Option<&Path>) -> String {
    let (all, run) = (files.len(), run.display());
    let lines: Vec<String> = files.iter().filter_map(file_line).collect();
    let result = match lines.len() {
        0 => format!("same     {all} files of {run}, byte for byte\n"),
        differ => format!("result   {differ} of {all} files of {run} not the same\n"),
    };
    let kept = kept.map(|folder| format!("written  {}\n", folder.display()));
    lines.into_iter().chain([result]).chain(kept).collect()
}

fn file_line(file: &RepeatedFile) -> Option<String> {
    let name = &file.name;
    match &file.outcome {
        Repeated::Same => None,
        Repeated::Missing => Some(format!("missing  {name}: the run wrote it\n")),
        Repeated::Extra => Some(format!("extra    {name}: the run does not write it\n")),
        Repeated::Differs(found) => {
            let LineDifference { line, differing, lines, run, repetition } = found;
            let told = |own: &Option<Vec<u8>>, other: &Option<Vec<u8>>| match own {
                Some(text) => excerpt(text, other.as_deref().unwrap_or_default()),
                None => "nothing".to_owned(),
            };
            let (was, now) = (told(run, repetition), told(repetition, run));
            let place = format!("line {line}, {differing} of {lines} in all");
            Some(format!("differs  {name}: {place}: was {was}, now {now}\n"))
        }
    }
}

/// A line about the first character in which it differs from another one.
fn excerpt(line: &[u8], other: &[u8]) -> String {
    let [text, other] = [line, other].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    let same = text.chars().zip(other.chars()).take_while(|(a, b)| a == b).count();
    // The line end is told where it is what differs.
    let content = text.trim_end_matches(['\r', '\n']);
    let is_content = same < content.chars().count();
    let text = if is_content { content } else { text.as_str() };
    let start = same.saturating_sub(BEFORE);
    let shown: String = text.chars().skip(start).take(IN_ALL).collect();
    let before = if start > 0 { "…" } else { "" };
    let after = if text.chars().nth(start + IN_ALL).is_some() { "…" } else { "" };
    format!("\"{before}{}{after}\"", shown.escape_debug())
}

/// What a duration is among those that were tried, with all limits that it is within.
pub(crate) fn found_text(fit: &Fit, limits: &Limits) -> String {
    let values = limits.limited_values(&Metrics::of(&fit.solution));
    let each = values.iter().map(|v| format!("{}={} {}", v.key, plain(v.limit), v.unit));
    let within = each.collect::<Vec<_>>().join(", ");
    if fit.is_shortest() {
        return format!("the shortest within {within}");
    }
    let (tried, shorter) = (fit.shorter_tried, fit.shorter());
    format!("within {within}; {tried} of the {shorter} shorter durations were tried, none fits")
}

/// Which limit a motion comes closest to, and by how much.
pub(crate) fn binding_text(fit: &Fit) -> String {
    if fit.has_fewest_steps() {
        return "; no limit binds: the profile has no fewer steps".to_owned();
    }
    let Some(Reached { value, error }) = fit.binding else { return String::new() };
    let below = 100.0 * (1.0 - Reached { value, error }.share());
    let below = if below < 0.01 { "less than 0.01".to_owned() } else { format!("{below:.2}") };
    format!(
        "; limits.{} binds: {} of {} {}, {below} % below it with the error of {error:.1e}",
        value.key,
        significant(value.found, 5),
        plain(value.limit),
        value.unit,
    )
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

    #[test]
    fn a_long_line_is_told_where_it_differs() {
        let line = |number: &str| format!("{}{number}{}\n", "0,".repeat(100), ",1".repeat(100));
        let (a, b) = (line("7"), line("8"));
        let expected = format!("\"…{}7{},…\"", "0,".repeat(10), ",1".repeat(13));
        assert_eq!(excerpt(a.as_bytes(), b.as_bytes()), expected);
        assert_eq!(excerpt(b"1,2\n", b"1,3\n"), "\"1,2\"");
    }

    #[test]
    fn a_line_end_is_told_where_nothing_else_differs() {
        assert_eq!(excerpt(b"1\r\n", b"1\n"), "\"1\\r\\n\"");
        assert_eq!(excerpt(b"1\n", b"1"), "\"1\\n\"");
        assert_eq!(excerpt(b"1", b"1\n"), "\"1\"");
        assert_eq!(excerpt(b"1,\xff\n", b"1,2\n"), "\"1,\u{fffd}\"");
    }
}
