//! The heading of a table as loggers write it: titles, names in a comment or in two rows, and a row of units.

use csv::{ReaderBuilder, Trim};

use super::clock::{ClockTime, is_date};
use super::format::{ColumnName, Delimiter, TableFormat};
use super::heading::{FREQUENCY, Quantity, TIME, Vocabulary, all_quantities};
use super::input::quoted;
use super::unit_name::{parse_unit, split_any_unit};
use crate::numeric::Dimension;

/// Largest number of lines that are searched for the first sample.
const MOST_LINES: usize = 1000;

/// Number of rows that show where the samples begin.
const ROWS: usize = 3;

/// A heading other than one row of names directly above the samples.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Head {
    /// Names of the columns, with their units in brackets.
    pub(super) names: Vec<String>,
    /// Line of the names, from 1.
    pub(super) line: u64,
    /// Number of lines above the samples.
    pub(super) above: u64,
    pub(super) delimiter: Delimiter,
    /// True if the rows may have no field for the last name.
    pub(super) is_long: bool,
    /// First time and step in s, where the first column counts the samples.
    pub(super) sequence: Option<[f64; 2]>,
    /// Deviations from the standard form, for the user.
    pub(super) found: Vec<String>,
}

/// A line that is not blank.
#[derive(Debug, Clone, Copy)]
struct Line<'a> {
    number: u64,
    text: &'a str,
}

impl Line<'_> {
    fn is_comment(&self) -> bool {
        self.text.starts_with('#')
    }

    /// True for a line of dashes or equals signs.
    fn is_rule(&self) -> bool {
        self.text.bytes().all(|byte| b"-=_+| \t;,".contains(&byte))
    }

    /// The fields without the sign of a comment.
    fn fields(&self, delimiter: Delimiter) -> Vec<String> {
        let text = self.text.trim_start_matches(['#', '%']).trim_matches(' ');
        let Some(byte) = delimiter.byte() else {
            return delimiter.split(text).into_iter().map(str::to_owned).collect();
        };
        let mut reader = ReaderBuilder::new();
        let reader = reader.has_headers(false).trim(Trim::All).delimiter(byte);
        let record = reader.from_reader(text.as_bytes()).into_records().next();
        let fields = record.and_then(Result::ok).unwrap_or_default();
        fields.iter().map(|field| field.trim_matches('"').trim().to_owned()).collect()
    }
}

/// True for a number with any decimal sign, and for a date or a time of day.
fn is_value(field: &str) -> bool {
    let number = field.trim_matches('"').replacen(',', ".", 1);
    number.parse::<f64>().is_ok() || is_date(field) || ClockTime::parse(field).is_some()
}

/// True if the first field that is not empty is a number or a time.
fn is_sample(fields: &[String]) -> bool {
    fields.iter().find(|field| !field.is_empty()).is_some_and(|field| is_value(field))
}

/// Least and largest number of fields of the first rows, if they are samples of one width. The first one may have one field
/// more, for a comment.
fn widths_of(rows: &[Line], delimiter: Delimiter) -> Option<[usize; 2]> {
    let fields: Vec<_> = rows.iter().take(ROWS).map(|row| row.fields(delimiter)).collect();
    let [first, others @ ..] = &fields[..] else { return None };
    let least = others.first()?.len();
    let are_alike = others.iter().all(|row| row.len() == least);
    let is_first = first.len() == least || first.len() == least + 1;
    let are_samples = fields.iter().all(|row| is_sample(row));
    (are_alike && is_first && are_samples).then_some([least, first.len()])
}

/// Rows above the samples, and the form of the samples.
struct Rows<'a> {
    lines: Vec<Line<'a>>,
    delimiter: Delimiter,
    /// Least and largest number of fields of a sample.
    widths: [usize; 2],
    given: &'a TableFormat,
    /// True for comments.
    are_comments: bool,
}

/// The names in a row, or in two rows.
struct Names {
    fields: Vec<String>,
    /// Indices of the first row and the last one.
    first: usize,
    last: usize,
}

impl Head {
    /// Finds the heading of a text whose lines end with `end`; `None` for a row of names directly above the samples, for
    /// samples without names, and where no row names a time.
    pub(super) fn of<'a>(
        text: &'a str,
        end: char,
        given: &'a TableFormat,
        delimiter: Option<Delimiter>,
    ) -> Option<Self> {
        let lines = (1..)
            .zip(text.split(end))
            .map(|(number, line)| Line { number, text: line.trim_end_matches('\r') });
        let lines = lines.filter(|line| !line.text.trim().is_empty()).take(MOST_LINES);
        let lines: Vec<Line> = lines.collect();
        let plain: Vec<Line> = lines.iter().filter(|line| !line.is_comment()).copied().collect();
        let shown = |line: &Line| delimiter.unwrap_or_else(|| Delimiter::of_row(line.text));
        let (first, widths) = (0..plain.len()).find_map(|first| {
            let widths = widths_of(&plain[first..], shown(&plain[first]))?;
            Some((first, widths))
        })?;
        let delimiter = shown(&plain[first]);
        let sample = plain[first].number;
        let rows = |mut lines: Vec<Line<'a>>, are_comments| {
            lines.retain(|line| !line.is_rule());
            Rows { lines, delimiter, widths, given, are_comments }
        };
        // A quoted name may have several lines.
        let has_open_quote = |line: &Line| !line.text.matches('"').count().is_multiple_of(2);
        if plain[..first].iter().any(has_open_quote) {
            return None;
        }
        let after = first.checked_sub(1).map_or(0, |last| plain[last].number);
        let is_between = |line: &&Line| (after + 1..sample).contains(&line.number);
        let comments: Vec<Line> = lines.iter().filter(is_between).copied().collect();
        let above = rows(plain[..first].to_vec(), false);
        let found = above.sequence().or_else(|| above.head());
        found.or_else(|| rows(comments, true).head()).map(|head| Self { above: sample - 1, ..head })
    }
}

impl Rows<'_> {
    /// The heading in these rows.
    fn head(&self) -> Option<Head> {
        let last = self.lines.len().checked_sub(1)?;
        let with_units = last.checked_sub(1).and_then(|upper| {
            let names = self.names_in(upper)?;
            let units = self.fields(last);
            let fields = Self::with_units(&names.fields, &units)?;
            Some((Names { fields, ..names }, Some(last)))
        });
        let (names, units) = with_units.or_else(|| Some((self.names_in(last)?, None)))?;
        let number = |index: usize| self.lines[index].number;
        let mut found = Vec::new();
        if let (Some(first), Some(last), false) =
            (self.lines.first(), names.first.checked_sub(1), self.are_comments)
        {
            let lines = match (first.number, number(last)) {
                (first, last) if first == last => format!("line {first}"),
                (first, last) => format!("lines {first} to {last}"),
            };
            found.push(format!("{lines} above the names left out"));
        }
        let is_marked = self.are_comments || self.lines[names.last].text.starts_with('%');
        let comment = if is_marked { " in a comment" } else { "" };
        match (number(names.first), number(names.last)) {
            (first, last) if first != last => {
                found.push(format!("names from lines {first} and {last}{comment}"));
            }
            (line, _) if is_marked => found.push(format!("names from line {line}{comment}")),
            _ => {}
        }
        found.extend(units.map(|line| format!("units from line {}", number(line))));
        let surplus = self.surplus(&names.fields);
        let told =
            |name: &String| format!("rows without a field of the last name {}", quoted(name));
        found.extend(surplus.map(told));
        if found.is_empty() {
            return None;
        }
        Some(Head {
            is_long: surplus.is_some(),
            sequence: None,
            line: number(names.last),
            above: 0,
            names: names.fields,
            delimiter: self.delimiter,
            found,
        })
    }

    /// The heading of Rigol: `X,CH1,Start,Increment` above `Sequence,Volt,-3e-3,5e-6`. X counts the samples, and the rows
    /// may have no field below the last two names.
    fn sequence(&self) -> Option<Head> {
        let [.., upper, lower] = &self.lines[..] else { return None };
        let [names, units] = [upper, lower].map(|line| line.fields(self.delimiter));
        let channels = names.iter().position(|name| name == "Start")?;
        let is_sequence = names[0] == "X" && units.first()? == "Sequence";
        let number =
            |index: usize| units.get(index)?.parse().ok().filter(|own: &f64| own.is_finite());
        let (start_s, step_s) = (number(channels)?, number(channels + 1)?);
        if !is_sequence
            || names.get(channels + 1)? != "Increment"
            || step_s <= 0.0
            || self.widths[1] < channels
        {
            return None;
        }
        let named = names[1..channels].iter().zip(&units[1..]);
        let named = named.map(|(name, unit)| format!("{name} [{unit}]"));
        let mut names: Vec<String> = ["time [s]".to_owned()].into_iter().chain(named).collect();
        names.resize(self.widths[1], String::new());
        let line = lower.number;
        let found = format!("units, and time by Start and Increment, from line {line}");
        Some(Head {
            names,
            line: upper.number,
            above: 0,
            delimiter: self.delimiter,
            is_long: false,
            sequence: Some([start_s, step_s]),
            found: vec![found],
        })
    }

    /// The fields of a row. A comment may have another delimiter than the samples.
    fn fields(&self, index: usize) -> Vec<String> {
        let line = &self.lines[index];
        let of_comment = Delimiter::of_row(line.text.trim_start_matches('#').trim());
        let fields = line.is_comment().then(|| line.fields(of_comment));
        let fields = fields.filter(|fields| fields.len() == self.widths[1]);
        fields.unwrap_or_else(|| line.fields(self.delimiter))
    }

    /// The names in the row `last`, or in this row and the one above it.
    fn names_in(&self, last: usize) -> Option<Names> {
        let lower = self.fields(last);
        if !self.fits(&lower) {
            return None;
        }
        if self.is_named(&lower) {
            return Some(Names { fields: lower, first: last, last });
        }
        let first = last.checked_sub(1)?;
        let upper = self.fields(first);
        let has_unit = |(upper, lower): (&String, &String)| {
            !lower.is_empty() && split_any_unit(upper).1.is_some()
        };
        let is_other = upper.len() != lower.len() || upper.iter().zip(&lower).any(has_unit);
        if !self.fits(&upper) || !self.is_named(&upper) || is_other {
            return None;
        }
        // A name over several columns stands above the first of them.
        let mut fields = Vec::new();
        let mut over = String::new();
        for (upper, lower) in upper.iter().zip(&lower) {
            if !upper.is_empty() {
                over.clone_from(upper);
            }
            let name = if lower.is_empty() { upper.clone() } else { format!("{over} {lower}") };
            fields.push(name.trim().to_owned());
        }
        Some(Names { fields, first, last })
    }

    /// The last name, if samples have no field for it and it means no quantity.
    fn surplus<'n>(&self, names: &'n [String]) -> Option<&'n String> {
        let is_long = names.len() == self.widths[0] + 1 && self.delimiter != Delimiter::Blanks;
        let last = names.last().filter(|_| is_long);
        last.filter(|name| !is_quantity(name) && !self.is_chosen(name))
    }

    /// True for a row of words as wide as a sample. The last name may have no field in the samples.
    fn fits(&self, fields: &[String]) -> bool {
        (fields.len() == self.widths[1] || self.surplus(fields).is_some())
            && fields.iter().any(|field| !field.is_empty())
            && !fields.iter().any(|field| is_value(field))
    }

    /// True if a name is the time or a frequency, or the user's choice; with a sample rate any quantity.
    fn is_named(&self, fields: &[String]) -> bool {
        let by_number = self.given.columns.iter().any(|choice| match choice.column {
            ColumnName::Number(number) => {
                [TIME, FREQUENCY].contains(&choice.quantity) && number <= self.widths[1]
            }
            ColumnName::Heading(_) => false,
        });
        let has_rate = self.given.sample_rate.is_some();
        let is_named = |name: &String| {
            let is_base = [TIME, FREQUENCY].into_iter().any(|own| names(name, own));
            is_base || self.is_chosen(name) || (has_rate && is_quantity(name))
        };
        // Any words may stand in a comment.
        (by_number && !self.are_comments) || fields.iter().any(is_named)
    }

    /// True if the user chose a column by this name.
    fn is_chosen(&self, name: &str) -> bool {
        let plain = split_any_unit(name).0;
        self.given.columns.iter().any(|choice| match &choice.column {
            ColumnName::Number(_) => false,
            ColumnName::Heading(heading) => {
                [name, plain].into_iter().any(|own| own.to_lowercase() == heading.to_lowercase())
            }
        })
    }

    /// The names with the units below them in brackets; `None` for a row that holds no units.
    ///
    /// The time has a unit of time, a frequency one of Hz, kHz or rad/s. If its field is empty, all other fields must be
    /// units.
    fn with_units(fields: &[String], units: &[String]) -> Option<Vec<String>> {
        let plain = |unit: &String| {
            let unit = unit.trim_start_matches(['[', '(']).trim_end_matches([']', ')']).trim();
            if unit == "-" { String::new() } else { unit.to_owned() }
        };
        let units: Vec<String> = units.iter().map(plain).collect();
        let unit_of = |index: usize| units.get(index).filter(|unit| !unit.is_empty());
        let is_base = |name: &String| [TIME, FREQUENCY].into_iter().any(|own| names(name, own));
        let of_time = fields.iter().position(is_base).and_then(unit_of);
        let is_time = |unit: &String| {
            let is_known = unit.contains(':') || ["Hz", "kHz", "rad/s"].contains(&unit.as_str());
            is_known || parse_unit(unit).is_ok_and(|unit| unit.dimension() == Dimension::TIME)
        };
        let others = || units.iter().filter(|unit| !unit.is_empty());
        let are_units = match of_time {
            Some(unit) => is_time(unit),
            None => others().count() > 0 && others().all(|unit| parse_unit(unit).is_ok()),
        };
        // A pure number has the unit 1.
        let is_one = |unit: &&String| *unit == "1";
        let has_value = others().any(|unit| is_value(unit) && !is_one(&unit));
        if units.len() > fields.len() || !are_units || has_value || others().all(|own| is_one(&own))
        {
            return None;
        }
        let joined = fields.iter().enumerate().map(|(index, name)| {
            match (unit_of(index), split_any_unit(name).1) {
                (None, _) => Some(name.clone()),
                (Some(unit), None) => Some(format!("{name} [{unit}]")),
                (Some(unit), Some(own)) => (own == unit).then(|| name.clone()),
            }
        });
        joined.collect()
    }
}

/// True if a name means a quantity.
fn names(name: &str, quantity: Quantity) -> bool {
    Vocabulary::NONE.spelling(name, quantity).is_some()
}

/// True if a name means any quantity, of a tip, a hub or a joint.
fn is_quantity(name: &str) -> bool {
    let plain = ["tip_", "hub_", "output_"].into_iter().find_map(|own| name.strip_prefix(own));
    all_quantities()
        .any(|quantity| names(name, quantity) || plain.is_some_and(|own| names(own, quantity)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head_as(text: &str, columns: &[&str]) -> Option<Head> {
        let columns = columns.iter().map(|choice| choice.parse().unwrap()).collect();
        Head::of(text, '\n', &TableFormat { columns, ..TableFormat::default() }, None)
    }

    /// The names, the number of lines above the samples, and the remarks.
    fn head(text: &str) -> Option<(String, u64, String)> {
        head_as(text, &[]).map(|head| (head.names.join("|"), head.above, head.found.join(", ")))
    }

    #[test]
    fn names_units_and_titles_are_told_apart() {
        for (text, names, above, found) in [
            ("time,x\ns,mm\n0,1\n1,2\n", "time [s]|x [mm]", 2, "units from line 2"),
            (
                "Messung 12;Stand 3\nZeit;Weg;Kraft\nms;mm;N\n0;0,5;1\n5;0,6;1\n",
                "Zeit [ms]|Weg [mm]|Kraft [N]",
                3,
                "line 1 above the names left out, units from line 3",
            ),
            ("#t\tn\n0\t1\n1\t2\n", "t|n", 1, "names from line 1 in a comment"),
            (
                "# run\n# t, x\n# s, mm\n0 1\n1 2\n",
                "t [s]|x [mm]",
                3,
                "names from line 2 in a comment, units from line 3",
            ),
            (
                "%time,field.data\n0,1\n1,2\n",
                "time|field.data",
                1,
                "names from line 1 in a comment",
            ),
            (
                "Zeit;Position;;Kraft\n;Soll;Ist;\n0;1;2;3\n1;1;2;3\n",
                "Zeit|Position Soll|Position Ist|Kraft",
                2,
                "names from lines 1 and 2",
            ),
            (
                "Zeit;Position;\n;Soll;Ist\ns;mm;mm\n0;1;2\n1;1;2\n",
                "Zeit [s]|Position Soll [mm]|Position Ist [mm]",
                3,
                "names from lines 1 and 2, units from line 3",
            ),
            (
                "A\tB\nX_Value\tPosition\tComment\n0\t1\n1\t2\n",
                "X_Value|Position|Comment",
                2,
                "line 1 above the names left out, rows without a field of the last name \"Comment\"",
            ),
            (
                "Time,Channel A\n(ms),(V)\n\n0,1\n1,2\n",
                "Time [ms]|Channel A [V]",
                3,
                "units from line 2",
            ),
            (
                "time,gain,x\ns,1,mm\n0,1,2\n1,2,3\n",
                "time [s]|gain [1]|x [mm]",
                2,
                "units from line 2",
            ),
            ("t,x\n-----\n[s],[mm]\n0,1\n1,2\n", "t [s]|x [mm]", 3, "units from line 3"),
            (
                "A,b\nB,1\n\ndate_time,x\n2026-11-30 10:00:00,1\n2026-11-30 10:00:01,2\n",
                "date_time|x",
                4,
                "lines 1 to 2 above the names left out",
            ),
        ] {
            let expected = (names.to_owned(), above, found.to_owned());
            assert_eq!(head(text), Some(expected), "{text}");
        }
    }

    #[test]
    fn one_row_of_names_and_doubts_are_no_other_heading() {
        for text in [
            "time,x\n0,1\n1,2\n",
            "0,1\n1,2\n",
            "# made by hand\n0,1\n1,2\n",
            "time,x\n# s, mm\n0,1\n1,2\n",
            "\"a\nb\",time\n0,1\n1,2\n",
            // Any name may lack its column.
            "time,x,force\n0,1\n1,2\n",
            "Time Tip position\n0 1\n1 2\n",
            // Two units of one column.
            "time [s],x\nms,mm\n0,1\n1,2\n",
            "run,state\nA,b\n0,1\n1,2\n",
            // One row lacks a field.
            "time,x,state\n0,1,a\n1,2,b\n2,3\n3,4,b\n",
            "time,x\n",
            "",
        ] {
            assert_eq!(head(text), None, "{text}");
        }
    }

    #[test]
    fn a_chosen_name_marks_the_row_of_names() {
        let text = "A,B\nclock,pos\n0,1\n1,2\n";
        assert_eq!(head(text), None);
        assert_eq!(head_as("# made by\n0 1\n1 2\n", &["time=1", "displacement=2"]), None);
        let found = head_as(text, &["time=clock"]).unwrap();
        assert_eq!((found.names.join(","), found.line, found.above), ("clock,pos".into(), 2, 2));
    }
}
