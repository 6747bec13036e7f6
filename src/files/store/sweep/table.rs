//! The table of a sweep: writes and checks a row for every case.

use csv::ReaderBuilder;

use super::identity::SweepIdentity;
use crate::csv::{NumberFormat, Place, TableError, quoted};
use crate::numeric::rounded;
use crate::sweep::{CaseNumbers, CaseValues, SweepKind, SweepPlan, Variation};

/// Significant digits of a number in the table. Rows are written at once, before the peak of their column is known.
const DIGITS: usize = 12;

/// The column of the kinds of a case's warnings, with `;` between them.
pub(super) const WARNINGS: &str = "warnings";

/// The last column: the error of a case without numbers.
pub(super) const ERROR: &str = "error";

/// The row that names the columns, with its line end.
pub fn sweep_header(plan: &SweepPlan, kind: SweepKind) -> String {
    let varied = plan.variations().iter().map(|variation| field(&variation.heading()));
    line(varied.chain(kind.names()).chain([WARNINGS, ERROR].map(str::to_owned)))
}

/// The row of a case, with its line end: its values, its numbers or its error, and the kinds of its warnings.
pub fn sweep_row(
    case: &CaseValues,
    outcome: &Result<CaseNumbers, String>,
    kind: SweepKind,
    warnings: &[&str],
) -> String {
    let number = |value: Option<f64>| {
        let mut text = Vec::new();
        if let Some(value) = value.filter(|value| value.is_finite()) {
            NumberFormat::Shortest.write(&mut text, rounded(value, DIGITS));
        }
        String::from_utf8_lossy(&text).into_owned()
    };
    let (numbers, error) = match outcome {
        Ok(numbers) => (numbers.clone(), ""),
        Err(error) => (vec![None; kind.names().len()], error.as_str()),
    };
    let values = case.values.iter().map(|value| field(value));
    let last = [field(&warnings.join(";")), field(error)];
    line(values.chain(numbers.into_iter().map(number)).chain(last))
}

fn line(fields: impl Iterator<Item = String>) -> String {
    fields.collect::<Vec<_>>().join(",") + "\n"
}

/// Text on one line.
fn one_line(text: &str) -> String {
    text.replace(char::is_control, " ")
}

/// Text as one field of one line.
fn field(text: &str) -> String {
    let text = one_line(text);
    let plain = !text.contains([',', '"']) && text.trim() == text && !text.starts_with('#');
    if plain { text } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// Refuses a row of names unless it is the sweep's.
pub(super) fn check_names(
    identity: &SweepIdentity,
    names: &[String],
    place: Place,
) -> Result<(), TableError> {
    let headings = identity.plan().variations().iter().map(Variation::heading);
    for (k, heading) in headings.enumerate() {
        let found = names.get(k).map_or("", String::as_str);
        if found != heading {
            return Err(place.refuse_column(k, found, format!("must be {}", quoted(&heading))));
        }
    }
    if names.ends_with(&[WARNINGS.to_owned(), ERROR.to_owned()]) {
        return Ok(());
    }
    let must = format!("must end with {WARNINGS}, {ERROR}");
    Err(place.refuse("columns", quoted(&names.join(",")), must))
}

/// Refuses row `k` unless it matches its case: the values of the case, then numbers, or empty fields after a failure.
pub(super) fn check_row(
    identity: &SweepIdentity,
    names: &[String],
    k: usize,
    fields: &[String],
    place: Place,
) -> Result<(), TableError> {
    place.check_width(fields.len(), names.len())?;
    let case = identity.shard().case(k);
    let values = identity.plan().case(case).values;
    for ((name, found), value) in names.iter().zip(fields).zip(&values) {
        let value = one_line(value);
        if *found != value {
            let must = format!("must be {}, the value of case {}", quoted(&value), case + 1);
            return Err(place.refuse(name, quoted(found), must));
        }
    }
    let numbers = values.len()..fields.len() - 1;
    let failed = fields.last().is_some_and(|error| !error.is_empty());
    for (name, found) in names[numbers.clone()].iter().zip(&fields[numbers]) {
        let is_number = found.parse().is_ok_and(f64::is_finite);
        let must = match found.as_str() {
            "" => continue,
            _ if failed => "must be nothing: the case has an error",
            _ if !is_number && name != WARNINGS => "must be a finite number or nothing",
            _ => continue,
        };
        return Err(place.refuse(name, quoted(found), must));
    }
    Ok(())
}

/// The fields of one row; empty if the row is not CSV.
pub(super) fn fields(row: &str) -> Vec<String> {
    let mut reader = ReaderBuilder::new().has_headers(false).from_reader(row.as_bytes());
    let record = reader.records().next().and_then(Result::ok);
    record.map(|fields| fields.iter().map(str::to_owned).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::MotionScale;

    const SWEPT: SweepKind = SweepKind::Solved { joints: 1, motor: None, slides: false };

    #[test]
    fn fields_that_would_part_or_comment_a_row_are_quoted() {
        assert_eq!(field("segments.*.EI [N cm^2]"), "segments.*.EI [N cm^2]");
        assert_eq!(field("[0.01, 0.02]"), "\"[0.01, 0.02]\"");
        assert_eq!(field("link \"a\"\nline"), "\"link \"\"a\"\" line\"");
        assert_eq!(field("#1"), "\"#1\"");
    }

    #[test]
    fn a_failed_case_has_empty_numbers_and_says_why() {
        let case = CaseValues {
            values: vec!["2".into()],
            link_changes: vec![],
            motion: MotionScale::default(),
        };
        let row = sweep_row(&case, &Err("damping.ratio = 2, too much".into()), SWEPT, &[]);
        assert_eq!(row, format!("2{}\"damping.ratio = 2, too much\"\n", ",".repeat(23)));
        let plan = SweepPlan::new(vec!["damping.ratio=2".parse().unwrap()]).unwrap();
        let header = sweep_header(&plan, SWEPT);
        assert_eq!(header.matches(',').count(), 23);
        assert!(header.starts_with("damping.ratio,period_1_s,zero_1_per_s,peak_torque_n_m,"));
        assert!(
            header.ends_with(
                ",torque_window_error,torque_model_error,tip_model_error,warnings,error\n"
            )
        );
    }
}
