//! The values of a variation: a list `a,b,c`, or a range `START:STOP:COUNT[:log]`.

use thiserror::Error;

use crate::numeric::{excerpt, rounded, split_number};

/// Significant digits of the values between the ends of a range.
const DIGITS: usize = 15;

/// Most values of one range.
const MOST: usize = 1_000_000;

/// A variation that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct VariationError {
    message: String,
}

impl VariationError {
    pub(super) fn refusing(message: String) -> Self {
        Self { message }
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "it reads like 'segments.*.EI*=1:8:4:log' or 'payload.mass=0,0.05,0.1'"
    }
}

/// Values as text, and the unit that all of them share; empty where they share none.
pub(super) struct Values {
    pub(super) values: Vec<String>,
    pub(super) unit: String,
}

impl Values {
    /// Reads a list or a range.
    pub(super) fn read(text: &str) -> Result<Self, VariationError> {
        let Pieces { colons, commas } = Pieces::of(text)?;
        match &colons[..] {
            [_] => Self::list(&commas),
            parts => Self::range(parts),
        }
    }

    fn list(values: &[&str]) -> Result<Self, VariationError> {
        if values.contains(&"") {
            let found = values.join(",");
            let what = format!("values = {:?}, but none of them must be empty", excerpt(&found));
            return Err(VariationError::refusing(what));
        }
        let quantity = |value: &str| {
            let bare = unquoted(value);
            let (_, unit) = split_number(bare).filter(|(_, unit)| !unit.trim().is_empty())?;
            Some((bare[..bare.len() - unit.len()].trim().to_owned(), unit.trim().to_owned()))
        };
        let quantities: Option<Vec<_>> = values.iter().map(|value| quantity(value)).collect();
        if let Some([(_, unit), ..]) = quantities.as_deref()
            && let Some(quantities) = quantities.as_ref()
            && quantities.iter().all(|(_, other)| other == unit)
        {
            let numbers = quantities.iter().map(|(number, _)| number.clone());
            return Ok(Self { values: numbers.collect(), unit: unit.clone() });
        }
        let values = values.iter().map(|value| (*value).to_owned()).collect();
        Ok(Self { values, unit: String::new() })
    }

    /// The values of the parts that colons separate.
    fn range(parts: &[&str]) -> Result<Self, VariationError> {
        let text = parts.join(":");
        let text = excerpt(&text);
        let refuse =
            |must: &str| Err(VariationError::refusing(format!("range = {text:?}, but {must}")));
        let (start, stop, count, logarithmic) = match *parts {
            [start, stop, count] => (start, stop, count, false),
            [start, stop, count, "log"] => (start, stop, count, true),
            _ => return refuse("must read START:STOP:COUNT or START:STOP:COUNT:log"),
        };
        let number = |text: &str| {
            let split = split_number(text).filter(|(number, _)| number.is_finite());
            split.map(|(number, unit)| (number, unit.trim().to_owned()))
        };
        let (Some((start, unit)), Some((stop, stop_unit))) = (number(start), number(stop)) else {
            return refuse("must begin with two finite numbers");
        };
        if unit != stop_unit {
            return refuse("must have the same unit at both ends");
        }
        let count = match count.parse::<usize>() {
            Ok(count) if (1..=MOST).contains(&count) => count,
            _ => return refuse(&format!("must have a count from 1 to {MOST}")),
        };
        if count == 1 && start.total_cmp(&stop).is_ne() {
            return refuse("must have a count of 2 or more to reach both ends");
        }
        let one_sign = start.signum() * stop.signum() > 0.0 && start != 0.0 && stop != 0.0;
        if logarithmic && !one_sign {
            return refuse("must have ends of one sign, neither of them 0, to be logarithmic");
        }
        let at = |k: usize| value(start, stop, (k, count - 1), logarithmic);
        Ok(Self { values: (0..count).map(|k| shortest(at(k))).collect(), unit })
    }
}

/// Value `k` of `0 ..= last`, the ends exact.
fn value(start: f64, stop: f64, (k, last): (usize, usize), logarithmic: bool) -> f64 {
    if k == 0 {
        return start;
    }
    if k == last {
        return stop;
    }
    let share = k as f64 / last as f64;
    let between = if logarithmic {
        // Product and quotient of the ends could overflow.
        start.signum() * libm::pow(start.abs(), 1.0 - share) * libm::pow(stop.abs(), share)
    } else {
        (1.0 - share) * start + share * stop
    };
    rounded(between, DIGITS)
}

/// The shortest text that reads back to the same number, in a link file, too.
fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if (1e-4..1e15).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Text split at colons and at commas, both outside quotes and brackets.
struct Pieces<'a> {
    colons: Vec<&'a str>,
    commas: Vec<&'a str>,
}

impl<'a> Pieces<'a> {
    fn of(text: &'a str) -> Result<Self, VariationError> {
        let (mut depth, mut quote) = (0_i32, None);
        let (mut colons, mut commas) = (vec![0], vec![0]);
        for (place, c) in text.char_indices() {
            match (quote, c) {
                (Some(open), _) => quote = quote.filter(|_| c != open),
                (None, '"' | '\'') => quote = Some(c),
                (None, '[' | '{') => depth += 1,
                (None, ']' | '}') => depth -= 1,
                (None, ':') if depth == 0 => colons.push(place + 1),
                (None, ',') if depth == 0 => commas.push(place + 1),
                _ => {}
            }
        }
        if quote.is_some() || depth != 0 {
            let what =
                format!("values = {:?}, but quotes and brackets must be closed", excerpt(text));
            return Err(VariationError::refusing(what));
        }
        let parted = |starts: &[usize]| {
            let ends = starts[1..].iter().map(|start| start - 1).chain([text.len()]);
            starts.iter().zip(ends).map(|(start, end)| text[*start..end].trim()).collect()
        };
        Ok(Self { colons: parted(&colons), commas: parted(&commas) })
    }
}

/// A text without the quotes that a link file has around it.
pub(super) fn unquoted(value: &str) -> &str {
    let inner = |quote: char| value.strip_prefix(quote)?.strip_suffix(quote);
    let plain = |inner: &&str| !inner.contains(['"', '\'', '\\']);
    inner('"').or_else(|| inner('\'')).filter(plain).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<String> {
        range(text).unwrap().values
    }

    fn range(text: &str) -> Result<Values, VariationError> {
        Values::range(&text.split(':').map(str::trim).collect::<Vec<_>>())
    }

    fn refusal(text: &str) -> String {
        range(text).err().unwrap().to_string()
    }

    #[test]
    fn a_range_holds_both_ends_and_even_steps_between() {
        assert_eq!(values("0.1:0.5:5"), ["0.1", "0.2", "0.3", "0.4", "0.5"]);
        assert_eq!(values("10:30:3"), ["10", "20", "30"]);
        assert_eq!(values("1:-1:3"), ["1", "0", "-1"]);
        assert_eq!(values("7:7:1"), ["7"]);
        assert_eq!(values("1e20 : 3e20 : 3"), ["1e20", "2e20", "3e20"]);
    }

    #[test]
    fn a_logarithmic_range_has_even_ratios() {
        assert_eq!(values("0.01:100:5:log"), ["0.01", "0.1", "1", "10", "100"]);
        assert_eq!(values("-8:-1:4:log"), ["-8", "-4", "-2", "-1"]);
        assert_eq!(values("1e-200:1e-150:3:log")[1], "1e-175");
        assert_eq!(values("1e-200:1e200:3:log")[1], "1");
        let found: Vec<f64> = values("2:5:4:log").iter().map(|v| v.parse().unwrap()).collect();
        assert!((found[1] / found[0] - 2.5_f64.cbrt()).abs() < 1e-14);
    }

    #[test]
    fn a_unit_stands_at_both_ends() {
        let range = range("5e4 N cm^2:2e5 N cm^2:2").unwrap();
        assert_eq!((range.values[1].as_str(), range.unit.as_str()), ("200000", "N cm^2"));
        assert!(refusal("10 g:1 kg:3").ends_with("must have the same unit at both ends"));
    }

    #[test]
    fn what_is_no_range_is_refused_with_what_it_must_be() {
        assert!(refusal("1:2").contains("must read START:STOP:COUNT"));
        assert!(refusal("1:2:3:cubic").contains("must read START:STOP:COUNT"));
        assert!(refusal("a:2:3").contains("two finite numbers"));
        assert!(refusal("1:2:0").contains("a count from 1"));
        assert!(refusal("1:2:2.5").contains("a count from 1"));
        assert!(refusal("1:2:1").contains("a count of 2 or more"));
        assert!(refusal("-1:2:3:log").contains("one sign"));
        assert!(refusal("0:2:3:log").contains("neither of them 0"));
    }
}
