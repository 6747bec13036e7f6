//! Output of `compare` and `solve --repeat`.

use std::path::Path;

use crate::compare::{
    ColumnComparison, Comparison, FileComparison, FileOutcome, RowPlace, TableComparison,
    Unmatched, Worst,
};
use crate::result::{LineDifference, Repeated, RepeatedFile};
use crate::store::GoldenChanges;
use crate::text::{counted, shown_path, significant, visible};

/// Largest number of listed columns for one file; `--json` lists all.
const MOST_COLUMNS: usize = 20;
/// Number of shown characters of a word.
const LONGEST_WORD: usize = 20;
/// Largest number of characters of a key that is shown exactly.
const LONGEST_KEY: usize = 10;

/// A line for each file, and for a different one a line for each column, the worst first.
pub(crate) fn comparison_text(comparison: &Comparison) -> String {
    let is_equal = comparison.is_equal();
    // Different inputs alone are no difference, but explain one, even in a table.
    let inputs_text = |file: &FileComparison| {
        let inputs = file.inputs.iter().filter(|_| !is_equal);
        inputs.fold(String::new(), |text, input| text + "  " + input + "\n")
    };
    let files = comparison.files.iter().map(|file| file_text(file) + &inputs_text(file));
    files.chain([result_line(comparison)]).collect()
}

/// Changes of the golden files.
pub(crate) fn blessed_text(expected: &Path, changes: &GoldenChanges) -> String {
    let (written, removed) = (changes.written.len(), changes.removed.len());
    if written + removed == 0 {
        return format!("blessed  nothing: {} is as it was\n", shown_path(expected));
    }
    let files = counted(written, "file");
    format!("blessed  {}: {files} written, {removed} removed\n", shown_path(expected))
}

fn file_text(file: &FileComparison) -> String {
    let name = visible(&file.name);
    match &file.outcome {
        FileOutcome::OnlyExpected(_) => format!("missing  {name}: only in EXPECTED\n"),
        FileOutcome::OnlyActual(_) => format!("new      {name}: only in ACTUAL\n"),
        FileOutcome::Compared(table) if table.is_equal() => {
            format!("equal    {name}: {}{}\n", size(table), apart(table))
        }
        FileOutcome::Compared(table) => {
            format!("differs  {name}: {}\n", size(table)) + &differences(table)
        }
    }
}

fn size(table: &TableComparison) -> String {
    let ignored = table.columns.iter().filter(|column| column.tolerance.is_none()).count();
    let columns = counted(table.columns.len() - ignored, "column");
    let ignored = if ignored > 0 { format!(", {ignored} ignored") } else { String::new() };
    let aside = match table.rows_aside {
        0 => String::new(),
        rows => format!(" and {rows} at the ends that do not count"),
    };
    format!("{columns}, {}{aside}{ignored}", counted(table.rows, "row"))
}

/// Distance of a file within tolerance from the expected one, unless it is 0.
fn apart(table: &TableComparison) -> String {
    let worst = table.columns.iter().max_by(|a, b| a.relative().total_cmp(&b.relative()));
    match worst {
        Some(column) if column.relative() > 0.0 => {
            format!(", to {:.1e} of the peak of {}", column.relative(), visible(&column.name))
        }
        _ => String::new(),
    }
}

fn differences(table: &TableComparison) -> String {
    let failing = table.failing();
    let columns = [("EXPECTED", &table.columns_expected), ("ACTUAL", &table.columns_actual)];
    let columns = columns.into_iter().filter(|(_, names)| !names.is_empty());
    let columns =
        columns.map(|(side, names)| format!("  only in {side}: {}\n", visible(&names.join(", "))));
    let rows = [("EXPECTED", table.rows_expected), ("ACTUAL", table.rows_actual)];
    let key = table.matched_by.as_deref();
    let rows = rows.into_iter().filter_map(|(side, rows)| Some(unmatched(side, rows?, key)));
    [columns_text(table, &failing)].into_iter().chain(columns).chain(rows).collect()
}

fn unmatched(side: &str, rows: Unmatched, key: Option<&str>) -> String {
    let RowPlace { line, key: value } = rows.first;
    let at = key.zip(value).map(|(key, value)| format!("{key} = {value:?}, "));
    let which = if rows.count == 1 { "" } else { ", the first" };
    let (rows, at) = (counted(rows.count, "row"), at.unwrap_or_default());
    format!("  {rows} only in {side}{which}: {at}line {line}\n")
}

fn columns_text(table: &TableComparison, failing: &[&ColumnComparison]) -> String {
    let shown = &failing[..failing.len().min(MOST_COLUMNS)];
    let Some(longest) = shown.iter().map(|column| visible(&column.name).chars().count()).max()
    else {
        return String::new();
    };
    let key = table.matched_by.as_deref().unwrap_or_default();
    let (width, key_width) = (longest.max(6), key.len().max(LONGEST_KEY));
    let line = |name: &str, amounts: &str, rows: &str, line: &str, key: &str| {
        let places = format!("{rows:>6} {line:>7} {key:>key_width$}");
        format!("  {name:<width$}{amounts:>27} {places}").trim_end().to_owned() + "\n"
    };
    let head = line("column", "    worst  of peak  allowed", "rows", "line", key);
    let columns = shown.iter().filter_map(|column| {
        let worst = column.worst.as_ref()?;
        let key = worst.expected.key.map_or_else(String::new, key_text);
        let (rows, number) = (column.rows_beyond.to_string(), worst.expected.line.to_string());
        Some(line(&visible(&column.name), &amounts(column, worst), &rows, &number, &key))
    });
    let more = failing.len() - shown.len();
    let rest = (more > 0).then(|| format!("  and {}, see --json\n", counted(more, "column")));
    [head].into_iter().chain(columns).chain(rest).collect()
}

/// The worst difference in numbers, or the two fields if one is not a number.
fn amounts(column: &ColumnComparison, worst: &Worst) -> String {
    if worst.difference.is_infinite() {
        let [expected, actual] = [&worst.expected_field, &worst.actual_field].map(|f| word(f));
        return format!(" not {expected} but {actual}");
    }
    let allowed = column.allowed().unwrap_or_default();
    let amounts = [worst.difference, column.relative(), allowed];
    amounts.map(|number| format!(" {:>8}", format!("{number:.1e}"))).concat()
}

fn word(field: &str) -> String {
    if field.is_empty() {
        return "empty".to_owned();
    }
    if field.parse::<f64>().is_ok() {
        return field.to_owned();
    }
    let shown: String = field.chars().take(LONGEST_WORD).collect();
    let more = if shown.len() < field.len() { ".." } else { "" };
    format!("\"{}{more}\"", shown.escape_debug())
}

fn key_text(key: f64) -> String {
    let exact = format!("{key:?}");
    if exact.len() <= LONGEST_KEY { exact } else { significant(key, 5) }
}

fn result_line(comparison: &Comparison) -> String {
    let counts = [
        ("equal", (|file| file.is_equal()) as fn(&FileComparison) -> bool),
        ("different", |f| matches!(f.outcome, FileOutcome::Compared(_)) && !f.is_equal()),
        ("missing", |f| matches!(f.outcome, FileOutcome::OnlyExpected(_))),
        ("new", |f| matches!(f.outcome, FileOutcome::OnlyActual(_))),
    ];
    let counts = counts.map(|(what, is)| (comparison.files.iter().filter(|f| is(f)).count(), what));
    let counts = counts.iter().filter(|(number, _)| *number > 0);
    let counts: Vec<String> = counts.map(|(number, what)| format!("{number} {what}")).collect();
    let not_compared = match comparison.not_compared {
        0 => String::new(),
        files => format!("; not compared: {}, neither table nor results", counted(files, "file")),
    };
    format!("result   {}{not_compared}\n", counts.join(", "))
}

/// Number of shown characters of a line before the first different one, and in all.
const BEFORE: usize = 20;
const IN_ALL: usize = 48;

/// A line for each file that differs from the run's, and the result for all.
pub(crate) fn repetition_text(files: &[RepeatedFile], run: &Path, kept: Option<&Path>) -> String {
    let (all, run) = (files.len(), shown_path(run));
    let lines: Vec<String> = files.iter().filter_map(file_line).collect();
    let result = match lines.len() {
        0 => format!("same     {all} files of {run}, byte for byte\n"),
        differ => format!("result   {differ} of {all} files of {run} not the same\n"),
    };
    let kept = kept.map(|folder| format!("written  {}\n", shown_path(folder)));
    lines.into_iter().chain([result]).chain(kept).collect()
}

fn file_line(file: &RepeatedFile) -> Option<String> {
    let name = visible(&file.name);
    match &file.outcome {
        Repeated::Same => None,
        Repeated::Missing => Some(format!("missing  {name}: the run wrote it\n")),
        Repeated::Extra => Some(format!("extra    {name}: the run does not write it\n")),
        Repeated::Differs(found) => {
            let LineDifference { line, differing, lines, run, repetition } = found;
            let shown = |own: &Option<Vec<u8>>, other: &Option<Vec<u8>>| match own {
                Some(text) => excerpt(text, other.as_deref().unwrap_or_default()),
                None => "nothing".to_owned(),
            };
            let (was, now) = (shown(run, repetition), shown(repetition, run));
            let place = format!("line {line}, {differing} of {lines} in all");
            Some(format!("differs  {name}: {place}: was {was}, now {now}\n"))
        }
    }
}

/// Part of a line around its first difference from another one.
fn excerpt(line: &[u8], other: &[u8]) -> String {
    let [text, other] = [line, other].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    let same = text.chars().zip(other.chars()).take_while(|(a, b)| a == b).count();
    // The line end is shown if it is the difference.
    let content = text.trim_end_matches(['\r', '\n']);
    let is_content = same < content.chars().count();
    let text = if is_content { content } else { text.as_str() };
    let start = same.saturating_sub(BEFORE);
    let shown: String = text.chars().skip(start).take(IN_ALL).collect();
    let before = if start > 0 { "…" } else { "" };
    let after = if text.chars().nth(start + IN_ALL).is_some() { "…" } else { "" };
    format!("\"{before}{}{after}\"", shown.escape_debug())
}

#[cfg(test)]
mod tests {
    use super::*;

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
