//! Units of columns, as headings and options spell them.

use std::fmt;
use std::str::FromStr;

use crate::numeric::{Dimension, Unit, UnitError, may_count_turns};

/// A unit as it was written.
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
const SPELLINGS: [(&[&str], &str); 11] = [
    (&["sec", "secs", "second", "seconds", "Sekunden", "secondes"], "s"),
    (&["msec", "millisecond", "milliseconds"], "ms"),
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

/// Reads a unit as headings spell it, `Nm` and `m/s2` included; refuses a rate that may count turns.
pub(super) fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let known = SPELLINGS.iter().find(|(spellings, _)| spellings.contains(&text));
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

/// The name in front of a unit in brackets, and that unit.
pub(super) fn split_unit(field: &str) -> (&str, Option<&str>) {
    match field.strip_suffix(']').and_then(|f| f.split_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (field, None),
    }
}

/// The name in front of a unit in square brackets or in parentheses, and that unit.
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
