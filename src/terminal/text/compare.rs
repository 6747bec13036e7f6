//! The tables that `compare` prints.

use flexlink::compare::{
    ColumnComparison, Comparison, FileComparison, FileOutcome, RowPlace, TableComparison,
    Unmatched, Worst,
};
use flexlink::numeric::significant;
use flexlink::store::GoldenChanges;

use super::lines::counted;

/// Columns told of one file; `--json` tells all.
const MOST_COLUMNS: usize = 20;
/// Characters of a word that is told.
const LONGEST_WORD: usize = 20;
/// Characters of a key that is told as it is.
const LONGEST_KEY: usize = 10;

/// A line a file, for one that differs a line a column more, the worst first.
pub(crate) fn comparison_text(comparison: &Comparison) -> String {
    let files = comparison.files.iter().map(file_text);
    files.chain([result_line(comparison)]).collect()
}

/// What became of the golden files.
pub(crate) fn blessed_text(changes: &GoldenChanges) -> String {
    let (written, removed) = (changes.written.len(), changes.removed.len());
    if written + removed == 0 {
        return "blessed  nothing: EXPECTED is as it was\n".to_owned();
    }
    format!("blessed  EXPECTED: {} written, {} removed\n", counted(written, "file"), removed)
}

fn file_text(file: &FileComparison) -> String {
    let name = &file.name;
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
    format!("{columns}, {}{ignored}", counted(table.rows, "row"))
}

/// How far a file within tolerance is from the expected one, if it is at all.
fn apart(table: &TableComparison) -> String {
    let worst = table.columns.iter().max_by(|a, b| a.relative().total_cmp(&b.relative()));
    match worst {
        Some(column) if column.relative() > 0.0 => {
            format!(", to {:.1e} of the peak of {}", column.relative(), column.name)
        }
        _ => String::new(),
    }
}

fn differences(table: &TableComparison) -> String {
    let failing = table.failing();
    let columns = [("EXPECTED", &table.columns_expected), ("ACTUAL", &table.columns_actual)];
    let columns = columns.into_iter().filter(|(_, names)| !names.is_empty());
    let columns = columns.map(|(side, names)| format!("  only in {side}: {}\n", names.join(", ")));
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
    let told = &failing[..failing.len().min(MOST_COLUMNS)];
    let Some(longest) = told.iter().map(|column| column.name.chars().count()).max() else {
        return String::new();
    };
    let key = table.matched_by.as_deref().unwrap_or_default();
    let (width, key_width) = (longest.max(6), key.len().max(LONGEST_KEY));
    let line = |name: &str, amounts: &str, rows: &str, line: &str, key: &str| {
        let places = format!("{rows:>6} {line:>7} {key:>key_width$}");
        format!("  {name:<width$}{amounts:>27} {places}").trim_end().to_owned() + "\n"
    };
    let head = line("column", "    worst  of peak  allowed", "rows", "line", key);
    let columns = told.iter().filter_map(|column| {
        let worst = column.worst.as_ref()?;
        let key = worst.expected.key.map_or_else(String::new, key_text);
        let (rows, number) = (column.rows_beyond.to_string(), worst.expected.line.to_string());
        Some(line(&column.name, &amounts(column, worst), &rows, &number, &key))
    });
    let more = failing.len() - told.len();
    let rest = (more > 0).then(|| format!("  and {}, see --json\n", counted(more, "column")));
    [head].into_iter().chain(columns).chain(rest).collect()
}

/// The worst difference in numbers, or what stands where it has none.
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
    let number = field.parse::<f64>().is_ok();
    let shown: String = field.chars().take(LONGEST_WORD).collect();
    let more = if shown.len() < field.len() { ".." } else { "" };
    if number { field.to_owned() } else { format!("\"{}{more}\"", shown.escape_debug()) }
}

fn key_text(key: f64) -> String {
    let exact = format!("{key:?}");
    if exact.len() <= LONGEST_KEY { exact } else { significant(key, 5) }
}

fn result_line(comparison: &Comparison) -> String {
    let number =
        |is: fn(&FileComparison) -> bool| comparison.files.iter().filter(|f| is(f)).count();
    let only_expected = |f: &FileComparison| matches!(f.outcome, FileOutcome::OnlyExpected(_));
    let only_actual = |f: &FileComparison| matches!(f.outcome, FileOutcome::OnlyActual(_));
    let counts = [
        (number(FileComparison::is_equal), "equal"),
        (number(|f| matches!(f.outcome, FileOutcome::Compared(_)) && !f.is_equal()), "different"),
        (number(only_expected), "missing"),
        (number(only_actual), "new"),
    ];
    let told = counts.iter().filter(|(number, _)| *number > 0);
    let told: Vec<String> = told.map(|(number, what)| format!("{number} {what}")).collect();
    let passed_over = match comparison.not_compared {
        0 => String::new(),
        files => format!("; not compared: {}, no CSV", counted(files, "file")),
    };
    format!("result   {}{passed_over}\n", told.join(", "))
}
