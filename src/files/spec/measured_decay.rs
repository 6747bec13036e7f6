//! Free decays in separate files.

use std::fmt;

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};

use super::error::Fault;
use super::measured_files::{RawSensor, checked};
use super::measured_values::{MeasuredOf, ModeKeys, RawHub};
use super::value::{Angle, Count, Si, Time};
use crate::fit::{DecayValues, Observable};
use crate::model::Sensor;

/// A free decay in a separate file.
#[derive(Debug, Clone, PartialEq)]
pub struct DecayFile {
    /// The file, relative to the file that names it.
    pub file: String,
    /// Frequencies of the modes in the decay.
    pub frequencies: Vec<Observable>,
    /// Values to take from the decay.
    pub values: DecayValues,
    /// Relative uncertainty of each value from other causes than noise of the samples.
    pub uncertainty: Option<f64>,
    /// The sensor; `None` for a table in which only one column changes.
    pub sensor: Option<Sensor>,
    /// Times in s of the first and the last sample to use.
    pub span_s: [Option<f64>; 2],
    /// Number of lines to skip at the beginning.
    pub skip: usize,
    /// Columns of the quantities, as for `--columns`.
    pub columns: Vec<String>,
}

/// `[[decay]]`
#[derive(Debug, serde::Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RawDecay {
    file: String,
    mode: Option<Modes>,
    hub: Option<RawHub>,
    joints: Option<RawHub>,
    at: Option<Vec<Angle>>,
    sensor: Option<RawSensor>,
    only: Option<RawOnly>,
    uncertainty: Option<f64>,
    from: Option<Time>,
    until: Option<Time>,
    skip: Option<Count>,
    #[serde(default)]
    columns: Vec<String>,
}

#[derive(Debug, Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "lowercase", expecting = "a string")]
enum RawOnly {
    Frequency,
    Ratio,
}

/// The number of a mode, or a list of them.
#[derive(Debug)]
struct Modes(Vec<Count>);

impl<'de> Deserialize<'de> for Modes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct OneOrMore;
        impl<'de> Visitor<'de> for OneOrMore {
            type Value = Modes;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(formatter, "{}, or a list of such numbers", Count::WORDS)
            }

            fn visit_i64<E: Error>(self, number: i64) -> Result<Modes, E> {
                Count::try_from(number).map(|count| Modes(vec![count])).map_err(E::custom)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Modes, A::Error> {
                let mut modes = Vec::new();
                while let Some(mode) = list.next_element()? {
                    modes.push(mode);
                }
                Ok(Modes(modes))
            }
        }
        deserializer.deserialize_any(OneOrMore)
    }
}

impl RawDecay {
    pub(super) fn convert(self, path: &str, of: &MeasuredOf) -> Result<DecayFile, Fault> {
        let Self { file, mode, hub, joints, at, sensor, only, uncertainty, .. } = self;
        uncertainty.map_or(Ok(()), |uncertainty| checked(path, "uncertainty", uncertainty))?;
        let modes = mode.map_or(vec![Count(1)], |Modes(modes)| modes);
        let refused = |key: &str, must: &str| {
            let path = format!("{path}.{key}");
            Err(Fault::new(path.clone(), format!("{path} {must}")))
        };
        let is_twice = |k: usize| modes[..k].contains(&modes[k]);
        if modes.is_empty() || (0..modes.len()).any(is_twice) {
            return refused("mode", "must be the number of a mode, or a list of different ones");
        }
        let span_s = [self.from, self.until].map(|time| time.map(Si::si));
        if let [Some(from_s), Some(until_s)] = span_s
            && from_s >= until_s
        {
            return refused("until", "must be after from");
        }
        let frequency = |Count(mode): &Count| {
            of.frequency(path, ModeKeys { mode: *mode, hub, joints, at: at.clone() })
        };
        Ok(DecayFile {
            file,
            frequencies: modes.iter().map(frequency).collect::<Result<_, _>>()?,
            values: match only {
                None => DecayValues::Both,
                Some(RawOnly::Frequency) => DecayValues::Frequencies,
                Some(RawOnly::Ratio) => DecayValues::Ratios,
            },
            uncertainty,
            sensor: sensor.map(RawSensor::sensor),
            span_s,
            skip: self.skip.map_or(0, |Count(lines)| lines),
            columns: self.columns,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::read_measurements;
    use super::*;
    use crate::fit::HubEnd;

    #[test]
    fn one_mode_or_several_are_read() {
        let read = |more: &str| {
            let text = format!("[[decay]]\nfile = 'd.csv'\nhub = 'held'\n{more}");
            read_measurements("m.toml", &text, 1).map(|mut read| read.decays.remove(0))
        };
        let mode = |mode| Observable::Frequency { mode, hub: HubEnd::Held };
        assert_eq!(read("").unwrap().frequencies, [mode(1)]);
        assert_eq!(read("mode = 2").unwrap().frequencies, [mode(2)]);
        let several = read("mode = [1, 3]\nfrom = '200 ms'\nonly = 'ratio'").unwrap();
        assert_eq!(several.frequencies, [mode(1), mode(3)]);
        assert_eq!((several.span_s, several.values), ([Some(0.2), None], DecayValues::Ratios));
        for (more, expected) in [
            ("mode = [1, 1]", "m.toml:4: decay.0.mode must be the number of a mode"),
            ("mode = []", "m.toml:4: decay.0.mode must be the number of a mode"),
            ("mode = 0", "m.toml:4: decay.0.mode = 0, but must be a whole number from 1"),
            ("mode = [0]", "m.toml:4: decay.0.mode.0 = 0, but must be a whole number from 1"),
            ("from = 2\nuntil = 1", "m.toml:5: decay.0.until must be after from"),
            ("at = ['0 deg']", "m.toml:4: decay.0.at is given, but one link takes none"),
            ("only = 'phase'", "m.toml:4: decay.0.only"),
        ] {
            let refused = read(more).unwrap_err().to_string();
            assert!(refused.starts_with(expected), "{refused}");
        }
    }
}
