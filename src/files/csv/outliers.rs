//! Bad samples of a table: refused, replaced and counted, or remarked in a table that may contain pulses.

use super::format::TableFormat;
use super::heading::{
    ANGLE, ANGLES, DISPLACEMENT, Heading, JOINT_TORQUES, PATH_X, PATH_Y, TORQUE, VOLTAGE,
};
use super::place::{Place, TableError};
use super::samples::Samples;
use crate::recording::{Change, Outlier, outliers};
use crate::text::significant;

/// Hint for a refused sample.
const BY_OPTION: &str = "correct the sample, or let --drop-outliers replace it by the value that its neighbours predict";

/// A column of a table over time, in SI.
pub(super) struct Judged<'a> {
    pub(super) name: &'a str,
    /// Unit in messages, and its size in SI.
    pub(super) unit: (&'a str, f64),
    pub(super) change: Change,
    /// True if it commands a motor.
    pub(super) is_command: bool,
    pub(super) time_s: &'a [f64],
    pub(super) values: &'a [f64],
}

impl<'a> Judged<'a> {
    /// All columns of a table except the time.
    fn all(samples: &'a Samples) -> impl Iterator<Item = Self> {
        let time = samples.time();
        let columns = samples.headings.iter().zip(&samples.values).enumerate();
        columns.filter(move |(index, _)| time != Some(*index)).filter_map(
            move |(_, (heading, values))| {
                let time_s = &samples.values[time?];
                let unit = (&*heading.unit_text, heading.to_si(1.0));
                let (name, change) = (&heading.name, change(heading));
                let is_command = [TORQUE, VOLTAGE].contains(&heading.quantity)
                    || JOINT_TORQUES.contains(&heading.quantity);
                Some(Self { name, unit, change, is_command, time_s, values })
            },
        )
    }

    /// Samples far from their neighbours' prediction.
    fn outliers(&self) -> Vec<Outlier> {
        outliers(self.time_s, self.values, self.change)
    }

    /// Refuses samples far from their neighbours' prediction.
    pub(super) fn check(&self, file: &str, lines: &[u64]) -> Result<(), TableError> {
        let found = self.outliers();
        let Some(Outlier { sample, expected }) = found.first() else { return Ok(()) };
        let place = Place { file, line: lines.get(*sample).copied() };
        let value = self.values[*sample];
        // Samples without a file have numbers.
        let name = match place.line {
            Some(_) => self.name.to_owned(),
            None => format!("{}[{sample}]", self.name),
        };
        let must = format!(
            "must follow its neighbours: they predict {}, it is {} off",
            self.shown(*expected, 6),
            self.shown((value - expected).abs(), 3)
        );
        let hint = match found.len() - 1 {
            0 => BY_OPTION.to_owned(),
            1 => format!("{BY_OPTION}; one more sample is as bad"),
            more => format!("{BY_OPTION}; {more} more samples are as bad"),
        };
        Err(place.refuse(name, self.shown(value, 6), must).with_hint(hint))
    }

    /// Remark on samples far from their neighbours' prediction. A value that a command also keeps for two samples or
    /// more is a level; a single sample of it is a pulse.
    pub(super) fn doubt(&self, lines: &[u64]) -> Option<String> {
        let found = self.outliers();
        let is_level = |own: &Outlier| {
            let value = self.values[own.sample];
            let is_held = |two: &[f64]| two.iter().all(|other| other.total_cmp(&value).is_eq());
            self.is_command && self.values.windows(2).any(is_held)
        };
        let found: Vec<&Outlier> = found.iter().filter(|own| !is_level(own)).collect();
        let Outlier { sample, expected } = found.first()?;
        let told = format!(
            "line {}: {} = {} does not follow its neighbours, which predict {}",
            lines.get(*sample)?,
            self.name,
            self.shown(self.values[*sample], 6),
            self.shown(*expected, 6)
        );
        Some(match found.len() - 1 {
            0 => told,
            1 => format!("{told}, nor does one more sample"),
            more => format!("{told}, nor do {more} more samples"),
        })
    }

    fn shown(&self, si: f64, digits: usize) -> String {
        let (unit, of_si) = self.unit;
        let number = significant(si / of_si, digits);
        if unit.is_empty() { number } else { format!("{number} {unit}") }
    }
}

/// Kind of change of a column's quantity.
fn change(heading: &Heading) -> Change {
    let places = [DISPLACEMENT, ANGLE, PATH_X, PATH_Y];
    let is_place = places.contains(&heading.quantity) || ANGLES.contains(&heading.quantity);
    if is_place { Change::Continuous } else { Change::Jumping }
}

/// Refuses bad samples of a motion or a path, or, with the option to drop them, replaces them by their neighbours'
/// prediction and counts them.
pub(super) fn settle(
    samples: &mut Samples,
    file: &str,
    format: &TableFormat,
) -> Result<(), TableError> {
    if format.drop_outliers {
        let found: Vec<Vec<Outlier>> = Judged::all(samples).map(|own| own.outliers()).collect();
        let time = samples.time();
        let columns = samples.values.iter_mut().enumerate();
        let columns = columns.filter(|(index, _)| time != Some(*index));
        for ((_, values), found) in columns.zip(&found) {
            for Outlier { sample, expected } in found {
                values[*sample] = *expected;
            }
        }
        samples.reading.dropped = found.iter().map(Vec::len).sum();
        return Ok(());
    }
    Judged::all(samples).try_for_each(|own| own.check(file, &samples.lines))
}

/// Records a remark on samples of a torque, a reference or a record that do not follow their neighbours. They are
/// allowed, because a command may have a pulse of one step, and a record a shock.
pub(super) fn doubt(samples: &mut Samples) {
    let all: Vec<String> =
        Judged::all(samples).filter_map(|own| own.doubt(&samples.lines)).collect();
    samples.reading.doubt = (!all.is_empty()).then(|| all.join("; "));
}

#[cfg(test)]
mod tests {
    use super::super::format::TableFormat;
    use super::super::motion::read_motion_table_as;

    /// A table of a wave with a bad sample in one column.
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
                read_motion_table_as("m.csv", file.as_bytes(), &[1.0], format)
            };
            let good = read(None, &TableFormat::default()).unwrap();
            let error = read(Some((0, 2.0)), &TableFormat::default()).unwrap_err().to_string();
            let (name, unit) = heading[5..].split_once(" [").unwrap();
            let unit = unit.trim_end_matches(']');
            let expected = format!(
                "m.csv:52: {name} = 61.8470 {unit}, but must follow its neighbours: they predict 59.84"
            );
            assert!(error.starts_with(&expected), "{error}");
            assert!(error.ends_with(&format!("2.00 {unit} off")), "{error}");
            let mended = read(Some((0, 2.0)), &drop).unwrap();
            assert_eq!((good.reading().dropped(), mended.reading().dropped()), (0, 1));
            let [a, b] = [&good, &mended].map(|table| {
                let columns = table.columns().unwrap();
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
            let read = |format: &TableFormat| {
                read_motion_table_as("p.csv", file.as_bytes(), &[1.0; 3], format)
            };
            let error = read(&TableFormat::default()).unwrap_err().to_string();
            assert!(error.starts_with(&format!("p.csv:52: {name} = ")), "{error}");
            let drop = TableFormat { drop_outliers: true, ..TableFormat::default() };
            assert_eq!(read(&drop).unwrap().reading().dropped(), 1);
        }
    }
}
