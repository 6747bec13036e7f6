use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::range::Range;
use crate::numeric::{excerpt, split_number};

/// One value of the link file or the motion, and what it takes in turn: `PATH=START:STOP:COUNT`,
/// `PATH=START:STOP:COUNT:log`, `PATH=a,b,c`, or these with `*=` for factors.
///
/// ```
/// use flexlink::sweep::Variation;
/// let stiffer: Variation = "segments.*.EI*=1:8:4:log".parse()?;
/// assert_eq!(stiffer.values(), ["1", "2", "4", "8"]);
/// assert_eq!(stiffer.change(1), "segments.*.EI*=2");
/// # Ok::<(), flexlink::sweep::VariationError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variation {
    path: String,
    operation: Operation,
    unit: String,
    values: Vec<String>,
}

/// What is done with a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// `=`: it takes the place of the file's own.
    Replace,
    /// `*=`: the file's own is multiplied with it.
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

impl Variation {
    /// The dotted path of the value.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// What is done with the values.
    pub fn operation(&self) -> Operation {
        self.operation
    }

    /// The values in their order, as text, without the unit that all of them share.
    pub fn values(&self) -> &[String] {
        &self.values
    }

    /// The value of this number as a table shows it: without quotes.
    ///
    /// # Panics
    /// If there is no such value.
    pub fn shown(&self, number: usize) -> &str {
        unquoted(&self.values[number])
    }

    /// The path, with `*` behind it where the values are factors, and the unit of the values in
    /// brackets where they share one.
    pub fn heading(&self) -> String {
        let factor = if self.operation == Operation::Multiply { "*" } else { "" };
        let Self { path, unit, .. } = self;
        if unit.is_empty() { format!("{path}{factor}") } else { format!("{path}{factor} [{unit}]") }
    }

    /// Whether the values have a unit that all of them share.
    pub(super) fn has_unit(&self) -> bool {
        !self.unit.is_empty()
    }

    /// The change of the link file that the value of this number asks for, as `--set` reads it.
    ///
    /// # Panics
    /// If there is no such value.
    pub fn change(&self, number: usize) -> String {
        let blank = if self.unit.is_empty() { "" } else { " " };
        let Self { path, operation, unit, values } = self;
        format!("{path}{operation}{}{blank}{unit}", values[number])
    }
}

impl FromStr for Variation {
    type Err = VariationError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let refuse = |what: &str| Err(VariationError::refusing(what.to_owned()));
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
        let pieces = Pieces::of(values)?;
        let Range { values, unit } = match &pieces.colons[..] {
            [_] => listed(&pieces.commas)?,
            parts => Range::read(parts)?,
        };
        let mut seen = HashSet::new();
        if let Some(value) = values.iter().find(|value| !seen.insert(value.as_str())) {
            return refuse(&format!("value = {} twice, but must be given once", excerpt(value)));
        }
        Ok(Self { path: path.to_owned(), operation, unit, values })
    }
}

/// Text parted by colons and by commas, both outside quotes and brackets.
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

/// The values of a list, and the unit that all of them share.
fn listed(values: &[&str]) -> Result<Range, VariationError> {
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
        return Ok(Range { values: numbers.collect(), unit: unit.clone() });
    }
    let values = values.iter().map(|value| (*value).to_owned()).collect();
    Ok(Range { values, unit: String::new() })
}

/// A text without the quotes that a link file has around it.
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
        assert!(refusal("hub.inertia=1,,2").contains("none of them must be empty"));
        assert!(refusal("hub.inertia=").contains("none of them must be empty"));
        assert!(refusal("hub.inertia=1,2,1").contains("value = 1 twice"));
        assert!(refusal("hub.inertia=1:1:2").contains("value = 1 twice"));
        assert!(refusal("title=Bob's,Al").contains("quotes and brackets must be closed"));
        assert!(refusal("damping.ratios=[1,2").contains("quotes and brackets must be closed"));
        assert!(refusal("title=a\nb").contains("control characters"));
    }
}
