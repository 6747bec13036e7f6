use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use super::range::Range;

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

    /// The path, and the unit of the values in brackets where they share one.
    pub fn heading(&self) -> String {
        if self.unit.is_empty() {
            self.path.clone()
        } else {
            format!("{} [{}]", self.path, self.unit)
        }
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
        let values = values.trim();
        let range = Range::read(values)?.map_or_else(|| listed(values), Ok)?;
        let Range { values, unit } = range;
        let twice = values.iter().enumerate().find(|(k, value)| values[..*k].contains(value));
        // Ranges have none, and may be long.
        if let Some((_, value)) = twice.filter(|_| values.len() <= 1000) {
            return refuse(&format!("value = {value} twice, but must be given once"));
        }
        Ok(Self { path: path.to_owned(), operation, unit, values })
    }
}

/// The values of a list; commas within quotes and brackets part none.
fn listed(text: &str) -> Result<Range, VariationError> {
    let (mut depth, mut quote) = (0_i32, None);
    let mut values = vec![String::new()];
    for c in text.chars() {
        match (quote, c) {
            (Some(open), _) => quote = quote.filter(|_| c != open),
            (None, '"' | '\'') => quote = Some(c),
            (None, '[' | '{') => depth += 1,
            (None, ']' | '}') => depth -= 1,
            (None, ',') if depth == 0 => {
                values.push(String::new());
                continue;
            }
            _ => {}
        }
        if let Some(value) = values.last_mut() {
            value.push(c);
        }
    }
    let values: Vec<String> = values.iter().map(|value| value.trim().to_owned()).collect();
    if values.iter().any(String::is_empty) {
        let what = format!("values = {text:?}, but none of them must be empty");
        return Err(VariationError::refusing(what));
    }
    Ok(Range { values, unit: String::new() })
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
        let titles = read("title = \"a, b\" , 'c'");
        assert_eq!(titles.values(), ["\"a, b\"", "'c'"]);
        assert_eq!(titles.change(0), "title=\"a, b\"");
    }

    #[test]
    fn a_shared_unit_stands_in_the_heading_and_not_in_the_values() {
        let mass = read("payload.mass=0 g:100 g:3");
        assert_eq!(mass.heading(), "payload.mass [g]");
        assert_eq!(mass.values(), ["0", "50", "100"]);
        assert_eq!(mass.change(1), "payload.mass=50 g");
        let factor = read("segments.*.EI *= 1,4");
        assert_eq!((factor.path(), factor.operation()), ("segments.*.EI", Operation::Multiply));
        assert_eq!(factor.heading(), "segments.*.EI");
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
        assert!(refusal("title=a\nb").contains("control characters"));
    }
}
