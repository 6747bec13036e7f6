//! Variation in a sweep: a value of the link or the motion, over a list `a,b,c` or a range `START:STOP:COUNT[:log]`.

use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::numeric::{rounded, split_number};
use crate::text::excerpt;

/// Significant digits of the values between the ends of a range.
const DIGITS: usize = 15;

/// Largest number of values in one range.
const MOST: usize = 1_000_000;

/// One quantity of the link file or the motion, and its values in order: `PATH=START:STOP:COUNT`,
/// `PATH=START:STOP:COUNT:log`, `PATH=a,b,c`, or these with `*=` for factors.
///
/// ```
/// use flexlink::sweep::Variation;
/// let stiffer: Variation = "segments.*.EI*=1:8:4:log".parse()?;
/// assert_eq!(stiffer.values(), ["1", "2", "4", "8"]);
/// assert_eq!(stiffer.changes()[1], "segments.*.EI*=2");
/// # Ok::<(), flexlink::sweep::VariationError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variation {
    path: String,
    operation: Operation,
    unit: String,
    values: Vec<String>,
}

/// Effect of a value on the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// `=`: the value replaces the file's value.
    Replace,
    /// `*=`: the value multiplies the file's value.
    Multiply,
}

impl fmt::Display for Operation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Replace => "=",
            Self::Multiply => "*=",
        })
    }
}

impl Variation {
    /// Dotted path of the value.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Effect of the values on the file.
    pub fn operation(&self) -> Operation {
        self.operation
    }

    /// Values in their order, as text, without their common unit.
    pub fn values(&self) -> &[String] {
        &self.values
    }

    /// Value of this number as shown in a table: without quotes.
    ///
    /// # Panics
    /// If there is no such value.
    pub(super) fn shown(&self, number: usize) -> &str {
        unquoted(&self.values[number])
    }

    /// Heading of the column: the path, `*` if the values are factors, and their common unit in brackets.
    pub fn heading(&self) -> String {
        let factor = if self.operation == Operation::Multiply { "*" } else { "" };
        let Self { path, unit, .. } = self;
        if unit.is_empty() { format!("{path}{factor}") } else { format!("{path}{factor} [{unit}]") }
    }

    /// True if all values have a common unit.
    pub(super) fn has_unit(&self) -> bool {
        !self.unit.is_empty()
    }

    /// Changes of the link file by all values, in the form of `--set`.
    pub fn changes(&self) -> Vec<String> {
        (0..self.values.len()).map(|number| self.change(number)).collect()
    }

    /// Change by the value of this number.
    ///
    /// # Panics
    /// If there is no such value.
    pub(super) fn change(&self, number: usize) -> String {
        let blank = if self.unit.is_empty() { "" } else { " " };
        let Self { path, operation, unit, values } = self;
        format!("{path}{operation}{}{blank}{unit}", values[number])
    }
}

impl FromStr for Variation {
    type Err = VariationError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let refuse = |what: &str| Err(VariationError(what.to_owned()));
        let Some((path, values)) = text.split_once('=') else {
            return refuse("no `=`, but must read PATH=VALUES or PATH*=FACTORS");
        };
        let (path, operation) = match path.trim().strip_suffix('*') {
            Some(path) => (path.trim(), Operation::Multiply),
            None => (path.trim(), Operation::Replace),
        };
        if path.is_empty() {
            return refuse("no path before the `=`");
        }
        if text.contains(char::is_control) {
            return refuse("control characters, but must be one line of text");
        }
        let (values, unit) = read_values(values)?;
        let mut seen = HashSet::new();
        if let Some(value) = values.iter().find(|value| !seen.insert(value.as_str())) {
            return refuse(&format!("value = {} twice, but must be listed once", excerpt(value)));
        }
        Ok(Self { path: path.to_owned(), operation, unit, values })
    }
}

/// Text that cannot be read as a variation.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct VariationError(String);

impl VariationError {
    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        "write it like 'segments.*.EI*=1:8:4:log' or 'payload.mass=0,0.05,0.1'"
    }
}

/// Values as text, and their common unit, if any.
type Values = (Vec<String>, String);

/// Reads a list or a range.
fn read_values(text: &str) -> Result<Values, VariationError> {
    match &parts(text, ':')?[..] {
        [_] => list(&parts(text, ',')?),
        parts => range(parts),
    }
}

fn list(values: &[&str]) -> Result<Values, VariationError> {
    if values.contains(&"") {
        let found = values.join(",");
        let what = format!("values = {:?}, but none may be empty", excerpt(&found));
        return Err(VariationError(what));
    }
    let quantity = |value: &&str| {
        let bare = unquoted(value);
        let (_, unit) = split_number(bare).filter(|(_, unit)| !unit.trim().is_empty())?;
        Some((bare[..bare.len() - unit.len()].trim().to_owned(), unit.trim().to_owned()))
    };
    let quantities: Option<Vec<_>> = values.iter().map(quantity).collect();
    match quantities {
        Some(all) if all.iter().all(|(_, unit)| *unit == all[0].1) => {
            let unit = all[0].1.clone();
            Ok((all.into_iter().map(|(number, _)| number).collect(), unit))
        }
        _ => Ok((values.iter().map(|value| (*value).to_owned()).collect(), String::new())),
    }
}

/// Values of a range, from its parts between colons.
fn range(parts: &[&str]) -> Result<Values, VariationError> {
    let text = parts.join(":");
    let text = excerpt(&text);
    let refuse = |must: &str| Err(VariationError(format!("range = {text:?}, but {must}")));
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
    Ok(((0..count).map(|k| shortest(at(k))).collect(), unit))
}

/// Value `k` of `0 ..= last`, with exact ends.
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

/// The shortest text that reads back to the same number, also in a link file.
fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if (1e-4..1e15).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}

/// Parts of a text between separators outside quotes and brackets.
fn parts(text: &str, separator: char) -> Result<Vec<&str>, VariationError> {
    let (mut depth, mut quote) = (0_i32, None);
    let (mut parts, mut start) = (Vec::new(), 0);
    for (place, c) in text.char_indices() {
        match (quote, c) {
            (Some(open), _) => quote = quote.filter(|_| c != open),
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            _ if c == separator && depth == 0 => {
                parts.push(text[start..place].trim());
                start = place + 1;
            }
            _ => {}
        }
    }
    if quote.is_some() || depth != 0 {
        let what = format!("values = {:?}, but quotes and brackets must be closed", excerpt(text));
        return Err(VariationError(what));
    }
    parts.push(text[start..].trim());
    Ok(parts)
}

/// Removes the quotes of a text in a link file.
fn unquoted(value: &str) -> &str {
    let inner = |quote: char| value.strip_prefix(quote)?.strip_suffix(quote);
    let plain = |inner: &&str| !inner.contains(['"', '\'', '\\']);
    inner('"').or_else(|| inner('\'')).filter(plain).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Variation {
        text.parse().unwrap()
    }

    #[test]
    fn a_list_is_parted_by_commas_outside_quotes_and_brackets() {
        let ratios = read("damping.ratios=[0.01, 0.02],[0.03]");
        assert_eq!(ratios.values(), ["[0.01, 0.02]", "[0.03]"]);
        let titles = read("title = \"a: b, b\" , 'c'");
        assert_eq!(titles.values(), ["\"a: b, b\"", "'c'"]);
        assert_eq!(titles.shown(0), "a: b, b");
        assert_eq!(titles.change(0), "title=\"a: b, b\"");
    }

    #[test]
    fn a_shared_unit_stands_in_the_heading_and_not_in_the_values() {
        let mass = read("payload.mass=0 g:100 g:3");
        assert_eq!(mass.heading(), "payload.mass [g]");
        assert_eq!(mass.values(), ["0", "50", "100"]);
        assert_eq!(mass.change(1), "payload.mass=50 g");
        let mass = read("payload.mass='10 g', 50 g");
        assert_eq!((mass.heading().as_str(), mass.shown(0)), ("payload.mass [g]", "10"));
        let mixed = read("payload.mass='10 g',1 kg");
        assert_eq!((mixed.heading().as_str(), mixed.shown(0)), ("payload.mass", "10 g"));
        let factor = read("segments.*.EI *= 1,4");
        assert_eq!((factor.path(), factor.operation()), ("segments.*.EI", Operation::Multiply));
        assert_eq!(factor.heading(), "segments.*.EI*");
        let replaced =
            ["hub.inertia=1,2", "hub.inertia*=1,2", "distance*=1,2"].map(|t| read(t).heading());
        assert_eq!(replaced, ["hub.inertia", "hub.inertia*", "distance*"]);
    }

    #[test]
    fn slips_are_refused() {
        let refusal = |text: &str| text.parse::<Variation>().unwrap_err().to_string();
        assert!(refusal("payload.mass").contains("no `=`"));
        assert!(refusal("=1,2").contains("no path"));
        assert!(refusal("*=1,2").contains("no path"));
        assert!(refusal("hub.inertia=1,,2").contains("none may be empty"));
        assert!(refusal("hub.inertia=").contains("none may be empty"));
        assert!(refusal("hub.inertia=1,2,1").contains("value = 1 twice"));
        assert!(refusal("hub.inertia=1:1:2").contains("value = 1 twice"));
        assert!(refusal("title=Bob's,Al").contains("quotes and brackets must be closed"));
        assert!(refusal("damping.ratios=[1,2").contains("quotes and brackets must be closed"));
        assert!(refusal("title=a\nb").contains("control characters"));
    }

    fn values(text: &str) -> Vec<String> {
        read_values(text).unwrap().0
    }

    fn refusal(text: &str) -> String {
        read_values(text).unwrap_err().to_string()
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
        let (values, unit) = read_values("5e4 N cm^2:2e5 N cm^2:2").unwrap();
        assert_eq!((values[1].as_str(), unit.as_str()), ("200000", "N cm^2"));
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
