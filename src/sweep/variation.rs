use std::collections::HashSet;
use std::fmt;
use std::str::FromStr;

use super::values::{Values, VariationError, unquoted};
use crate::numeric::excerpt;

/// One quantity of the link file or the motion, and its values in turn: `PATH=START:STOP:COUNT`,
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

/// How a value changes the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operation {
    /// `=`: it replaces the value of the file.
    Replace,
    /// `*=`: it multiplies the value of the file.
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
    /// The dotted path of the value.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// How the values change the file.
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

    /// Heading of the column: the path, `*` if the values are factors, and in brackets the unit if they
    /// share one.
    pub fn heading(&self) -> String {
        let factor = if self.operation == Operation::Multiply { "*" } else { "" };
        let Self { path, unit, .. } = self;
        if unit.is_empty() { format!("{path}{factor}") } else { format!("{path}{factor} [{unit}]") }
    }

    /// True if all values share a unit.
    pub(super) fn has_unit(&self) -> bool {
        !self.unit.is_empty()
    }

    /// The change of the link file by the value of this number, as `--set` reads it.
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
        let Values { values, unit } = Values::read(values)?;
        let mut seen = HashSet::new();
        if let Some(value) = values.iter().find(|value| !seen.insert(value.as_str())) {
            return refuse(&format!("value = {} twice, but must be given once", excerpt(value)));
        }
        Ok(Self { path: path.to_owned(), operation, unit, values })
    }
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
