use super::wording::check_words;
use flexlink::compare::{
    Comparison, FileComparison, FileOutcome, Table, TableComparison, Tolerance, Tolerances,
    compare_tables,
};
use flexlink::csv::read_table;
use flexlink::spec::read_tolerances;
use flexlink::store::comparison_json;

/// What divides EXPECTED, ACTUAL and the file of tolerances.
const DIVIDER: &[u8] = b"\n===\n";

/// Laws: tables and tolerances are refused with words. A table equals itself; of two tables that begin
/// with the same column each equals the other or neither does, within a tolerance in units.
///
/// # Panics
/// If one is broken.
pub fn compare_csv(bytes: &[u8]) {
    let mut parts = parted(bytes).into_iter();
    let mut table = || match read_table("t.csv", parts.next()?) {
        Ok(table) => Some(table),
        Err(error) => {
            check_words("t.csv", &error, error.hint());
            None
        }
    };
    let (expected, actual) = (table(), table());
    let tolerances = parts.next().and_then(tolerances);
    for table in [&expected, &actual].into_iter().flatten() {
        check_itself(table, tolerances.as_ref());
    }
    if let (Some(expected), Some(actual)) = (expected, actual) {
        check_pair(&expected, &actual, tolerances.as_ref());
    }
}

fn parted(bytes: &[u8]) -> Vec<&[u8]> {
    let mut parts = Vec::new();
    let mut rest = bytes;
    while let Some(at) = rest.windows(DIVIDER.len()).position(|window| window == DIVIDER) {
        parts.push(&rest[..at]);
        rest = &rest[at + DIVIDER.len()..];
    }
    parts.push(rest);
    parts
}

fn tolerances(bytes: &[u8]) -> Option<Tolerances> {
    match read_tolerances("t.toml", std::str::from_utf8(bytes).ok()?) {
        Ok(tolerances) => Some(tolerances),
        Err(error) => {
            check_words("t.toml", &error, error.hint());
            None
        }
    }
}

fn check_itself(table: &Table, tolerances: Option<&Tolerances>) {
    let exact = Tolerances { general: Tolerance { rtol: 0.0, atol: 0.0 }, ..Tolerances::default() };
    for tolerances in [Some(&exact), tolerances].into_iter().flatten() {
        let found = compared(table, table, tolerances);
        assert!(found.is_equal() && found.failing().is_empty(), "{found:?}");
        assert!(found.columns.iter().all(|column| column.worst.is_none()), "{found:?}");
        let pairs = if table.columns.is_empty() { 0 } else { table.lines.len() };
        assert_eq!(found.rows, pairs);
    }
}

fn check_pair(expected: &Table, actual: &Table, given: Option<&Tolerances>) {
    for tolerances in [Some(&Tolerances::default()), given].into_iter().flatten() {
        compared(expected, actual, tolerances);
    }
    let absolute =
        Tolerances { general: Tolerance { rtol: 0.0, atol: 0.5 }, ..Tolerances::default() };
    if expected.names().next() == actual.names().next() {
        let there = compared(expected, actual, &absolute);
        let back = compared(actual, expected, &absolute);
        assert_eq!((there.is_equal(), there.rows), (back.is_equal(), back.rows));
        assert_eq!(there.columns_expected, back.columns_actual);
    }
}

/// The comparison, whose JSON is one, without numbers that JSON has no words for.
fn compared(expected: &Table, actual: &Table, tolerances: &Tolerances) -> TableComparison {
    let found = compare_tables("t.csv", expected, actual, tolerances);
    assert_eq!(found.is_equal(), {
        let alone = found.columns_expected.len() + found.columns_actual.len();
        let unmatched = found.rows_expected.is_some() || found.rows_actual.is_some();
        alone == 0 && !unmatched && found.failing().is_empty()
    });
    let outcome = FileOutcome::Compared(found.clone());
    let files = vec![FileComparison { name: "t.csv".to_owned(), outcome, inputs: vec![] }];
    let json = comparison_json(&Comparison { files, not_compared: 0 }, None);
    let json: serde_json::Value = serde_json::from_str(&json).expect(&json);
    assert!(json.is_object());
    found
}
