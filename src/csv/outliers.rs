//! Bad samples of a table: refused, or taken out and counted.

use super::place::{Place, TableError};
use crate::recording::{Outlier, outliers};
use crate::text::significant;

/// The hint of a refused sample.
const BY_OPTION: &str =
    "correct the sample; --drop-outliers puts what its neighbours lead to in its place";

/// A column of a table over time, in SI.
pub(super) struct Judged<'a> {
    pub(super) name: &'a str,
    /// The unit that messages show, and how much of SI it is.
    pub(super) unit: (&'a str, f64),
    pub(super) time_s: &'a [f64],
    pub(super) values: &'a [f64],
}

impl Judged<'_> {
    /// Refuses samples that are far from what their neighbours lead to.
    pub(super) fn check(&self, file: &str, lines: &[u64]) -> Result<(), TableError> {
        let found = outliers(self.time_s, self.values);
        let Some(Outlier { sample, expected }) = found.first() else { return Ok(()) };
        let place = Place { file, line: lines.get(*sample).copied() };
        let (unit, of_si) = self.unit;
        let shown = |si: f64, digits| {
            let number = significant(si / of_si, digits);
            if unit.is_empty() { number } else { format!("{number} {unit}") }
        };
        let value = self.values[*sample];
        // Samples of no file have numbers.
        let name = match place.line {
            Some(_) => self.name.to_owned(),
            None => format!("{}[{sample}]", self.name),
        };
        let must = format!(
            "must follow its neighbours: they lead to {}, it is {} off",
            shown(*expected, 6),
            shown((value - expected).abs(), 3)
        );
        let hint = match found.len() - 1 {
            0 => BY_OPTION.to_owned(),
            1 => format!("{BY_OPTION}; one more sample is as bad"),
            more => format!("{BY_OPTION}; {more} more samples are as bad"),
        };
        Err(place.refuse(name, shown(value, 6), must).with_hint(hint))
    }
}

/// Puts what their neighbours lead to in the place of samples that are far from it; returns how many there were.
pub(super) fn mend(time_s: &[f64], values: &mut [f64]) -> usize {
    let found = outliers(time_s, values);
    for Outlier { sample, expected } in &found {
        values[*sample] = *expected;
    }
    found.len()
}

#[cfg(test)]
mod tests {
    use super::super::format::TableFormat;
    use super::super::motion::read_motion_table_as;
    use super::super::path::read_path_table;

    /// A table of a wave, in which one sample of a column is off.
    fn file(heading: &str, columns: usize, bad: Option<(usize, f64)>) -> String {
        let row = |k: usize| {
            let wave = |column: usize| {
                let off = bad.filter(|_| k == 50 && bad.is_some_and(|bad| bad.0 == column));
                100.0 * libm::sin(0.05 * k as f64 + column as f64) + off.map_or(0.0, |bad| bad.1)
            };
            let values: Vec<String> = (0..columns).map(|c| format!("{:.3}", wave(c))).collect();
            format!("{:.2},{}\n", 0.01 * k as f64, values.join(","))
        };
        format!("{heading}\n{}", (0..=100).map(row).collect::<String>())
    }

    #[test]
    fn a_bad_sample_is_refused_with_line_value_and_distance_or_replaced() {
        let drop = TableFormat { drop_outliers: true, ..TableFormat::default() };
        for heading in ["time,displacement [mm]", "time,angle [deg]", "time,velocity [mm/s]"] {
            let read = |bad, format: &TableFormat| {
                let file = file(heading, 1, bad);
                read_motion_table_as("m.csv", file.as_bytes(), 1.0, format)
            };
            let good = read(None, &TableFormat::default()).unwrap();
            let error = read(Some((0, 2.0)), &TableFormat::default()).unwrap_err().to_string();
            let (name, unit) = heading[5..].split_once(" [").unwrap();
            let unit = unit.trim_end_matches(']');
            let expected = format!(
                "m.csv:52: {name} = 61.8470 {unit}, but must follow its neighbours: they lead to 59.84"
            );
            assert!(error.starts_with(&expected), "{error}");
            assert!(error.ends_with(&format!("2.00 {unit} off")), "{error}");
            let mended = read(Some((0, 2.0)), &drop).unwrap();
            assert_eq!((good.reading().dropped(), mended.reading().dropped()), (0, 1));
            let [a, b] = [&good, &mended].map(|table| {
                let columns = table.columns();
                columns.displacement_m.clone().or(columns.velocity_m_s.clone()).unwrap()
            });
            assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 2e-5), "off");
        }
    }

    #[test]
    fn a_bad_sample_of_a_path_is_refused_in_any_column() {
        let heading = "time,x [mm],y [mm],angle3 [deg]";
        for (column, name) in [(0, "x"), (1, "y"), (2, "angle3")] {
            let file = file(heading, 3, Some((column, -3.0)));
            let read = |format: &TableFormat| read_path_table("p.csv", file.as_bytes(), format);
            let error = read(&TableFormat::default()).unwrap_err().to_string();
            assert!(error.starts_with(&format!("p.csv:52: {name} = ")), "{error}");
            let drop = TableFormat { drop_outliers: true, ..TableFormat::default() };
            assert_eq!(read(&drop).unwrap().reading().dropped(), 1);
        }
    }
}
