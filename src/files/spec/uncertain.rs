//! Intervals of values of a link file: `KEY=±5%` of `--uncertain`, and the table `[uncertainty]`.

use std::fmt;
use std::str::FromStr;

use super::document::{LinkDocument, shown};
use super::error::{Fault, SpecError};
use super::free::{leaves_of, number};
use super::overrides::{Override, apply};
use super::raw::UNCERTAINTY as TABLE;
use super::tree::{Kind, Node, Place};
use crate::numeric::{Dimension, Unit, split_number};
use crate::robust::{How, Key};
use crate::text::{excerpt, visible};

/// Key of the delay, which the link file does not have.
const DELAY: &str = "delay";

const HINT: &str =
    "write it like 'segments.*.EI*=±5%', 'payload.mass=±20 g' or damping.ratio=0.005..0.02";

/// A value of the link file with an interval, as written.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertain {
    place: String,
    text: String,
    path: String,
    interval: Interval,
}

#[derive(Debug, Clone, PartialEq)]
enum Interval {
    /// The file's value times 1 less and 1 plus this.
    Share(f64),
    /// The file's value less and plus this number in this unit.
    Around(f64, String),
    /// Two values in this unit.
    Values([f64; 2], String),
    /// Two factors on the file's value.
    Factors([f64; 2]),
}

impl fmt::Display for Uncertain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.place)
    }
}

impl FromStr for Uncertain {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let place = format!("--uncertain '{}'", visible(&excerpt(text)));
        match text.rsplit_once('=') {
            Some((key, interval)) => Self::placed(&place, key, interval),
            None => Err(refused("has no `=`, but must read KEY=INTERVAL").at(place)),
        }
    }
}

fn refused(message: &str) -> Fault {
    Fault::new("", message).hinting(HINT.to_owned())
}

impl Uncertain {
    /// Reads a key and its interval; errors call it `place`.
    fn placed(place: &str, key: &str, interval: &str) -> Result<Self, SpecError> {
        let (key, written) = (key.trim(), interval.trim());
        let is_factor = key.ends_with('*') && !key.ends_with(".*");
        let path = if is_factor { key.trim_end_matches('*').trim_end() } else { key };
        let fault = |message: &str| refused(message).at(place.to_owned());
        if path.is_empty() {
            return Err(fault("has no key before the `=`"));
        }
        let interval = interval_of(written, is_factor).map_err(|message| fault(&message))?;
        let text = format!("{key}={written}");
        Ok(Self { place: place.to_owned(), text, path: path.to_owned(), interval })
    }

    fn refused(&self, message: &str, hint: Option<String>) -> SpecError {
        Fault::new("", message).hinting(hint).at(self.place.clone())
    }

    /// Key and interval as written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// True for the delay of the drives.
    pub fn is_delay(&self) -> bool {
        self.path == DELAY
    }

    /// The interval of a delay in s.
    fn delay(&self) -> Result<Key, SpecError> {
        let must = || self.refused("must be two times with unit, from 0 on: delay=0..2ms", None);
        let Interval::Values(ends, unit) = &self.interval else { return Err(must()) };
        let unit = Unit::parse(unit).ok().filter(|unit| unit.dimension() == Dimension::TIME);
        let ends = unit.map(|unit| ends.map(|end| unit.to_si(end))).ok_or_else(must)?;
        if ends[0] < 0.0 {
            return Err(must());
        }
        Ok(Key { path: self.path.clone(), how: How::Delay, nominal: Some(0.0), ends })
    }
}

/// A number with its unit.
fn quantity(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim().trim_matches(['\'', '"']);
    let found = split_number(text).filter(|(number, _)| number.is_finite());
    found.ok_or_else(|| format!("{:?} must be a number, with or without a unit", excerpt(text)))
}

/// Reads an interval; `is_factor`: after `*=`.
fn interval_of(text: &str, is_factor: bool) -> Result<Interval, String> {
    for sign in ["±", "+-", "+/-"] {
        let Some(rest) = text.strip_prefix(sign) else { continue };
        let (amount, unit) = quantity(rest)?;
        let unit = unit.trim();
        if amount <= 0.0 {
            return Err(format!("{sign}{amount:?} must be above 0"));
        }
        return match unit {
            "%" if amount < 100.0 => Ok(Interval::Share(0.01 * amount)),
            "%" => Err(format!("±{amount:?} % must be below 100 %")),
            _ if is_factor => Err(format!("{:?} must be in % after `*=`", excerpt(text))),
            unit => Ok(Interval::Around(amount, unit.to_owned())),
        };
    }
    let Some((low, high)) = text.split_once("..") else {
        return Err(format!("{:?} must be ±SHARE%, ±AMOUNT or LOW..HIGH", excerpt(text)));
    };
    let ((low, of_low), (high, of_high)) = (quantity(low)?, quantity(high)?);
    let (of_low, of_high) = (of_low.trim(), of_high.trim());
    let (ends, unit) = if of_low.is_empty() || of_low == of_high {
        if of_high == "%" {
            return Err(format!("{:?} has %, but a share must read ±SHARE%", excerpt(text)));
        }
        ([low, high], of_high)
    } else if of_high.is_empty() {
        return Err(format!("HIGH = {high:?} must have a unit, as LOW has"));
    } else {
        let unit = |text: &str| Unit::parse(text).map_err(|error| format!("{text:?} {error}"));
        let (of_low, of_high) = (unit(of_low)?, unit(of_high)?);
        if of_low.dimension() != of_high.dimension() {
            return Err("LOW and HIGH must have units of the same dimension".to_owned());
        }
        ([of_low.to_si(low), of_high.to_si(high)], of_low.dimension().si_unit())
    };
    if ends[0] >= ends[1] {
        return Err(format!("LOW = {:?} must be below HIGH = {:?}", ends[0], ends[1]));
    }
    match (is_factor, unit) {
        (true, "") if ends[0] > 0.0 => Ok(Interval::Factors(ends)),
        (true, _) => Err("factors must be above 0 and without unit".to_owned()),
        (false, unit) => Ok(Interval::Values(ends, unit.to_owned())),
    }
}

impl LinkDocument {
    /// The intervals of the table `[uncertainty]`, in the order of the file; errors call the file `name`.
    ///
    /// # Errors
    /// [`SpecError`] of the first wrong one.
    pub fn uncertainties(&self, name: &str) -> Result<Vec<Uncertain>, SpecError> {
        let Some(Node { kind: Kind::Table(entries), .. }) = self.tree.get(TABLE) else {
            return Ok(Vec::new());
        };
        let read = |(key, node): &(String, Node)| {
            // No change of the command line is in the text.
            let place = format!("{}: {TABLE}.{:?}", shown(node.place, name, &[]), excerpt(key));
            let Kind::Text(interval) = &node.kind else {
                let message = format!("= {}, but must be text", node.shown());
                return Err(refused(&message).at(place));
            };
            Uncertain::placed(&place, key, interval)
        };
        entries.iter().map(read).collect()
    }

    /// The interval of a value in numbers.
    ///
    /// # Errors
    /// [`SpecError`] where a share or an amount has no value above or below 0 to refer to, and for a unit of another
    /// dimension.
    pub fn uncertain(&self, own: &Uncertain, changes: &[Override]) -> Result<Key, SpecError> {
        if own.is_delay() {
            return own.delay();
        }
        let mut tree = self.changed(changes)?;
        let touched = |change: &str, tree: &mut Node| {
            apply(
                tree,
                changes.len(),
                &Override::placed(&own.place, &format!("{}{change}", own.path))?,
            )
        };
        let key = |how, nominal, ends| Key { path: own.path.clone(), how, nominal, ends };
        let ends = match &own.interval {
            Interval::Values(ends, unit) => {
                let leaf = touched("*=1", &mut tree).ok().and_then(|()| {
                    let mut leaves = Vec::new();
                    leaves_of(&tree, Place::Override(changes.len()), &mut leaves);
                    match leaves[..] {
                        [leaf] => number(leaf),
                        _ => None,
                    }
                });
                let nominal = leaf.and_then(|(value, of_leaf)| in_unit(value, of_leaf, unit));
                return Ok(key(How::Value(unit.clone()), nominal, *ends));
            }
            Interval::Share(share) => [1.0 - share, 1.0 + share],
            Interval::Factors(ends) => *ends,
            Interval::Around(..) => [0.0; 2],
        };
        let hint = || format!("give its values: {}=LOW..HIGH", own.path);
        touched("*=1", &mut tree).map_err(|error| {
            // A value that the file lacks, but may have.
            let set = Override::placed(&own.place, &format!("{}=1", own.path)).ok();
            let set = set.map(|set| [changes, &[set]].concat());
            if set.is_some_and(|set| self.specification("", &set).is_ok()) {
                error.hinting(hint())
            } else {
                error
            }
        })?;
        let mut leaves = Vec::new();
        leaves_of(&tree, Place::Override(changes.len()), &mut leaves);
        let numbers: Vec<Option<(f64, &str)>> = leaves.iter().map(|leaf| number(leaf)).collect();
        let zero = numbers.iter().position(|own| own.is_none_or(|(value, _)| value == 0.0));
        if let Some(zero) = zero {
            let found = leaves[zero].shown();
            let message =
                format!("{} = {found}, of which a share or an amount has no meaning", own.path);
            return Err(own.refused(&message, leaves.get(1).is_none().then(hint)));
        }
        let Interval::Around(amount, unit) = &own.interval else {
            return Ok(key(How::Factor, Some(1.0), ends));
        };
        let [Some((value, of_leaf))] = numbers[..] else {
            let message =
                format!("{} names several values, of which ± must be a share in %", own.path);
            return Err(own.refused(&message, None));
        };
        let of_leaf = of_leaf.trim();
        let amount = in_unit(*amount, unit, of_leaf).ok_or_else(|| {
            let message =
                format!("±{amount:?} {unit} must have the unit of the value, {of_leaf:?}");
            own.refused(&message, None)
        })?;
        Ok(key(How::Value(of_leaf.to_owned()), Some(value), [value - amount, value + amount]))
    }
}

impl LinkDocument {
    /// Numbers of the first two of these keys that change one value of the file both; such intervals contradict each other.
    pub fn overlapping(&self, keys: &[Key], changes: &[Override]) -> Option<[usize; 2]> {
        let mut tree = self.changed(changes).ok()?;
        let mut counts = Vec::new();
        for (number, key) in keys.iter().enumerate() {
            let change = key.change(key.ends[1]);
            let change = change.and_then(|change| Override::placed("", &change).ok());
            if let Some(change) = change {
                apply(&mut tree, changes.len() + number, &change).ok()?;
            }
            counts.push(0);
            for (before, count) in counts.iter_mut().enumerate() {
                let mut leaves = Vec::new();
                leaves_of(&tree, Place::Override(changes.len() + before), &mut leaves);
                if leaves.len() < *count {
                    return Some([before, number]);
                }
                *count = leaves.len();
            }
        }
        None
    }
}

/// A number of one unit in another one of the same dimension; a number without unit is in SI.
fn in_unit(value: f64, from: &str, to: &str) -> Option<f64> {
    let parse = |text: &str| {
        let text = text.trim();
        if text.is_empty() { Some(None) } else { Unit::parse(text).ok().map(Some) }
    };
    let (from, to) = (parse(from)?, parse(to)?);
    if let (Some(from), Some(to)) = (&from, &to)
        && from.dimension() != to.dimension()
    {
        return None;
    }
    let si = from.map_or(value, |unit| unit.to_si(value));
    Some(to.map_or(si, |unit| si / unit.to_si(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: &str = "payload.mass = '50 g'\ndamping.ratio = 0.01\n\
        segments = [{ length = 0.5, EI = 20, mass_per_length = 0.3 }, { length = 0.5, EI = 30, mass_per_length = 0.3 }]\n\
        [uncertainty]\n\"segments.*.EI*\" = \"±5%\"\n\"hub.inertia\" = \"0.1..0.2\"\n";

    fn key(text: &str) -> Result<Key, String> {
        let document = LinkDocument::read("link.toml", LINK).unwrap();
        let own: Uncertain = text.parse().map_err(|error: SpecError| error.to_string())?;
        document.uncertain(&own, &[]).map_err(|error| error.to_string())
    }

    fn shown(key: &Key) -> String {
        format!("{:?}", key.ends)
    }

    #[test]
    fn an_interval_reads_as_it_is_written() {
        let factor = key("segments.*.EI*=±5%").unwrap();
        assert_eq!(factor, key("segments.*.EI=+-5 %").unwrap());
        assert_eq!((&factor.how, shown(&factor)), (&How::Factor, "[0.95, 1.05]".to_owned()));
        assert_eq!(factor.change(0.95).unwrap(), "segments.*.EI*=0.95");
        let around = key("payload.mass=±0.02 kg").unwrap();
        assert_eq!((around.nominal, &*shown(&around)), (Some(50.0), "[30.0, 70.0]"));
        assert_eq!(around.change(30.0).unwrap(), "payload.mass=30.0 g");
        let values = key("damping.ratio=0.005..0.02").unwrap();
        assert_eq!((values.nominal, &*shown(&values)), (Some(0.01), "[0.005, 0.02]"));
        let mixed = key("payload.mass='20 g'..'0.1 kg'").unwrap();
        assert_eq!((mixed.how, mixed.nominal), (How::Value("kg".into()), Some(0.05)));
        assert_eq!(key("hub.inertia=0.1..0.2").unwrap().nominal, None);
        assert_eq!(shown(&key("delay=0..2ms").unwrap()), "[0.0, 0.002]");
        assert_eq!(shown(&key("segments.0.EI*=0.8..1.3").unwrap()), "[0.8, 1.3]");
    }

    #[test]
    fn what_is_no_interval_is_refused_in_words() {
        for (text, part) in [
            ("segments.*.EI", "no `=`"),
            ("segments.*.EI=5%", "must be ±SHARE%"),
            ("segments.*.EI=-5%..5%", "a share must read ±SHARE%"),
            ("payload.mass=10 g..0.3", "HIGH = 0.3 must have a unit"),
            ("segments.*.EI=±120%", "below 100 %"),
            ("segments.*.EI*=±2 kg", "must be in % after"),
            ("payload.mass=9..4", "must be below HIGH"),
            ("payload.mass=±2 m", "must have the unit of the value"),
            ("hub.inertia=±5%", "hub.inertia"),
            ("segments.*.EI=±2", "names several values"),
            ("delay=±5%", "two times"),
        ] {
            let found = key(text).unwrap_err();
            assert!(found.contains(part), "{text}: {found}");
        }
    }

    #[test]
    fn two_intervals_of_one_value_are_found() {
        let document = LinkDocument::read("link.toml", LINK).unwrap();
        let overlapping = |texts: &[&str]| {
            let keys: Vec<Key> = texts.iter().map(|text| key(text).unwrap()).collect();
            document.overlapping(&keys, &[])
        };
        assert_eq!(overlapping(&["segments.*.EI=±5%", "payload.mass=±2 g", "delay=0..1ms"]), None);
        assert_eq!(overlapping(&["segments.0.EI=±5%", "segments.1.EI=±5%"]), None);
        assert_eq!(
            overlapping(&["payload.mass=0..1", "segments.*.EI*=±5%", "segments.1.EI=±5%"]),
            Some([1, 2])
        );
        assert_eq!(overlapping(&["payload.mass=0..1", "payload.mass=±2 g"]), Some([0, 1]));
    }

    #[test]
    fn the_table_of_the_file_is_read_in_its_order_and_by_no_other_command() {
        let document = LinkDocument::read("link.toml", LINK).unwrap();
        let paths: Vec<String> =
            document.uncertainties("link.toml").unwrap().into_iter().map(|own| own.path).collect();
        assert_eq!(paths, ["segments.*.EI", "hub.inertia"]);
        assert!(document.specification("link.toml", &[]).is_ok());
    }
}
