//! Units of columns, as headings and options spell them.

use std::fmt;
use std::str::FromStr;

use crate::numeric::{Dimension, Unit, UnitError, may_count_turns};

/// A unit as written.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitName {
    pub(super) text: String,
    pub(super) unit: Unit,
}

impl FromStr for UnitName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let unit = parse_unit(text).map_err(|error| match error.hint() {
            Some(hint) => format!("{error}; {hint}"),
            None => error.to_string(),
        })?;
        Ok(Self { text: text.to_owned(), unit })
    }
}

impl fmt::Display for UnitName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Spellings of units in headings that cannot mean another unit.
const SPELLINGS: [(&[&str], &str); 16] = [
    (&["sec", "secs", "second", "seconds", "Sekunden", "secondes"], "s"),
    (&["msec", "millisecond", "milliseconds"], "ms"),
    (&["usec", "µsec", "μsec", "microsecond", "microseconds"], "us"),
    (&["nsec", "nanosecond", "nanoseconds"], "ns"),
    (&["mins", "minute", "minutes", "Minuten"], "min"),
    (&["hr", "hrs", "hour", "hours", "Stunden", "heures"], "h"),
    (&["day", "days", "Tage", "jours"], "d"),
    (&["meter", "meters", "metre", "metres"], "m"),
    (&["degree", "degrees", "°"], "deg"),
    (&["radian", "radians"], "rad"),
    (&["Nm", "N.m", "N-m"], "N m"),
    (&["mNm"], "mN m"),
    (&["Ncm"], "N cm"),
    (&["Nmm"], "N mm"),
    (&["°/s", "degrees/s"], "deg/s"),
    (&["microstrain", "µε", "με"], "um/m"),
];

/// Reads a unit as spelt in headings, including `Nm` and `m/s2`; refuses a rate that may count turns.
pub(super) fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    // The first letter of a word may be large: Sec, Seconds.
    let is_small = |word: &String| word.chars().skip(1).eq(text.chars().skip(1));
    let word = Some(text.to_lowercase()).filter(|word| word.len() > 2 && is_small(word));
    let is_spelt = |own: &&str| *own == text || word.as_deref() == Some(*own);
    let known = SPELLINGS.iter().find(|(spellings, _)| spellings.iter().any(is_spelt));
    let text = known.map_or(text, |(_, unit)| unit);
    let unit = Unit::parse(text).or_else(|error| {
        let squared = text.strip_suffix('2').map(|base| Unit::parse(&format!("{base}^2")));
        squared.and_then(Result::ok).ok_or(error)
    })?;
    if unit.dimension() == Dimension::RATE && may_count_turns(text) {
        return Err(UnitError::TurnsOrRadians { unit: text.into() });
    }
    Ok(unit)
}

/// The name before a unit in square brackets, and the unit.
pub(super) fn split_unit(field: &str) -> (&str, Option<&str>) {
    match field.strip_suffix(']').and_then(|f| f.split_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (field, None),
    }
}

/// The name before a unit in square brackets or parentheses, and the unit.
pub(super) fn split_any_unit(field: &str) -> (&str, Option<&str>) {
    let round = || field.strip_suffix(')').and_then(|f| f.split_once('('));
    match split_unit(field) {
        (name, None) => match round() {
            Some((name, unit)) if !name.is_empty() => (name.trim(), Some(unit.trim())),
            _ => (name, None),
        },
        found => found,
    }
}

/// Fields of a row divided by blanks. Quotes and brackets are not divided, and a unit in brackets belongs to the name
/// before it: `Time (s)`.
pub(super) fn in_brackets(row: &str) -> Vec<&str> {
    let mut spans: Vec<(usize, usize)> = Vec::new();
    let (mut open, mut depth, mut in_quotes) = (None, 0_usize, false);
    for (at, letter) in row.char_indices() {
        if letter.is_whitespace() && depth == 0 && !in_quotes {
            spans.extend(open.take().map(|start| (start, at)));
            continue;
        }
        match letter {
            '"' => in_quotes = !in_quotes,
            '(' | '[' if !in_quotes => {
                if open.is_none() && depth == 0 {
                    open = spans.pop().map(|(start, _)| start);
                }
                depth += 1;
            }
            ')' | ']' if !in_quotes => depth = depth.saturating_sub(1),
            _ => {}
        }
        open = open.or(Some(at));
    }
    spans.extend(open.map(|start| (start, row.len())));
    let field = |(start, end): (usize, usize)| {
        let field = row[start..end].trim();
        field.strip_prefix('"').and_then(|f| f.strip_suffix('"')).unwrap_or(field)
    };
    spans.into_iter().map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_belongs_to_the_name_before_it() {
        let fields = in_brackets("  Time (s)\tTip position [m / s]  \"a b\" (x) 1 ");
        assert_eq!(fields, ["Time (s)", "Tip", "position [m / s]", "\"a b\" (x)", "1"]);
        assert_eq!(in_brackets("(s) \"a b\" )"), ["(s)", "a b", ")"]);
    }
}
