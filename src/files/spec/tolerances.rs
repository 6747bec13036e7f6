use serde::Deserialize;

use super::document::{located, shown};
use super::error::{Fault, SpecError};
use super::tree::Node;
use super::value::tables;
use crate::compare::{Change, ColumnRule, Tolerance, Tolerances};

/// The whole file of tolerances, key by key.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawTolerances {
    rtol: Option<f64>,
    atol: Option<f64>,
    common_rows: Option<bool>,
    #[serde(default, deserialize_with = "tables")]
    columns: Vec<RawColumnRule>,
}

/// `[[columns]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
struct RawColumnRule {
    file: Option<String>,
    column: Option<String>,
    rtol: Option<f64>,
    atol: Option<f64>,
    ignore: Option<bool>,
}

/// Reads the text of a file of tolerances; errors call it `name`.
///
/// ```
/// use flexlink::compare::Rule;
/// use flexlink::spec::read_tolerances;
/// let text = "rtol = 1e-6\n[[columns]]\ncolumn = 'wall_time_*'\nignore = true\n";
/// let tolerances = read_tolerances("tolerances.toml", text)?;
/// assert_eq!(tolerances.rule("sweep.csv", "wall_time_s"), Rule::Ignore);
/// # Ok::<(), flexlink::spec::SpecError>(())
/// ```
///
/// # Errors
/// [`SpecError`] names the line and the wrong value.
pub fn read_tolerances(name: &str, text: &str) -> Result<Tolerances, SpecError> {
    let tree = Node::document(name, text)?;
    let raw = RawTolerances::deserialize(&tree).map_err(Fault::from);
    let place_of = |path: &str| shown(tree.place_of(path), name, &[]);
    raw.and_then(|raw| convert(raw, place_of)).map_err(|fault| located(fault, &tree, (name, &[])))
}

fn convert(raw: RawTolerances, place_of: impl Fn(&str) -> String) -> Result<Tolerances, Fault> {
    let usual = Tolerance::default();
    let general = Tolerance {
        rtol: checked("rtol", raw.rtol)?.unwrap_or(usual.rtol),
        atol: checked("atol", raw.atol)?.unwrap_or(usual.atol),
    };
    let entries = raw.columns.into_iter().enumerate().map(|(number, raw)| {
        let path = format!("columns.{number}");
        entry(&path, place_of(&path), raw)
    });
    let entries = entries.collect::<Result<_, _>>()?;
    Ok(Tolerances { general, entries, common_rows: raw.common_rows.unwrap_or(false) })
}

fn entry(path: &str, place: String, raw: RawColumnRule) -> Result<ColumnRule, Fault> {
    let rtol = checked(&format!("{path}.rtol"), raw.rtol)?;
    let atol = checked(&format!("{path}.atol"), raw.atol)?;
    let change = match (raw.ignore, rtol.or(atol)) {
        (Some(true), None) => Change::Ignore,
        (Some(true), Some(_)) => {
            let words = "= true, but must not stand beside rtol or atol";
            return Err(Fault::on(format!("{path}.ignore"), words));
        }
        (None, None) => {
            return Err(Fault::on(path, "has no rtol, atol or ignore, but must have one"));
        }
        _ => Change::Tolerance { rtol, atol },
    };
    if raw.file.is_none() && raw.column.is_none() {
        return Err(Fault::on(path, "has no file and no column, but must have one"));
    }
    let column = raw.column.unwrap_or_else(|| "*".to_owned());
    Ok(ColumnRule { place, file: raw.file, column, change })
}

/// A tolerance, refused below 0.
fn checked(path: &str, number: Option<f64>) -> Result<Option<f64>, Fault> {
    match number {
        Some(number) if number < 0.0 => {
            Err(Fault::on(path, format!("= {number}, but must be 0 or above")))
        }
        number => Ok(number),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> (String, Option<String>) {
        let error = read_tolerances("t.toml", text).unwrap_err();
        (error.to_string(), error.hint().map(str::to_owned))
    }

    #[test]
    fn a_file_says_what_holds_in_general_and_for_which_columns_not() {
        let text = "atol = 1\ncommon_rows = true\n[[columns]]\nfile = 'a.csv'\ncolumn = '*'\nrtol = 1e-3\n\
                    [[columns]]\ncolumn = 'x'\nignore = false\n";
        let read = read_tolerances("t.toml", text).unwrap();
        assert_eq!(read.general, Tolerance { rtol: 1e-9, atol: 1.0 });
        let change = Change::Tolerance { rtol: Some(1e-3), atol: None };
        assert!(read.common_rows);
        let (place, file) = ("t.toml:3".to_owned(), Some("a.csv".to_owned()));
        assert_eq!(read.entries[0], ColumnRule { place, file, column: "*".into(), change });
        assert_eq!(read.entries[1].change, Change::Tolerance { rtol: None, atol: None });
        assert_eq!(read_tolerances("t.toml", ""), Ok(Tolerances::default()));
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_its_line() {
        let (message, hint) = refused("rtoll = 1e-6");
        assert_eq!(message, "t.toml:1: unknown key `rtoll`");
        assert_eq!(hint.unwrap(), "did you mean `rtol`?");
        let (message, hint) = refused("[[columns]]\ncolumn = 'a'\n\nignored = true");
        assert_eq!(message, "t.toml:4: unknown key `ignored` in columns.0");
        assert_eq!(hint.unwrap(), "did you mean `ignore`?");
        for (text, expected) in [
            ("\nrtol = -1.0", "2: rtol = -1, but must be 0 or above"),
            ("atol = inf", "1: atol = inf, but must be finite"),
            ("atol = nan", "1: atol = NaN, but must be finite"),
            ("atol = '1'", "1: atol = \"1\", but must be a number"),
            ("columns = 1", "1: columns = 1, but must be tables headed [[columns]]"),
            ("[[columns]]\nrtol = 1", "1: columns.0 has no file and no column, but must have one"),
            (
                "[[columns]]\ncolumn = 'a'",
                "1: columns.0 has no rtol, atol or ignore, but must have one",
            ),
            (
                "[[columns]]\ncolumn = 'a'\natol = 1\nignore = true",
                "4: columns.0.ignore = true, but must not stand beside rtol or atol",
            ),
        ] {
            assert_eq!(refused(text).0, format!("t.toml:{expected}"));
        }
    }
}
