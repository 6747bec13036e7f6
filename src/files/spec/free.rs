//! Values of a link file that a fit may change, and the file's text with the changed values.

use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::document::LinkDocument;
use super::error::{Fault, SpecError};
use super::overrides::{Override, apply};
use super::tree::{Kind, Node, Place};
use crate::fit::{Free, FreeNumber, Replaced};
use crate::numeric::{Unit, split_number};
use crate::text::{excerpt, visible};

/// Smallest and largest factor without bounds.
const USUAL_FACTORS: [f64; 2] = [1e-3, 1e3];

/// Largest factor between the file's value and a bound.
const WIDEST: f64 = 1e12;

/// Significant digits of a fitted value in its file: more than any measurement determines.
const DIGITS: usize = 7;

/// Argument `PATH` or `PATH=LOW:HIGH` of the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeValue {
    place: String,
    path: String,
    bounds: Option<[String; 2]>,
}

impl std::str::FromStr for FreeValue {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let place = format!("--free '{}'", visible(&excerpt(text)));
        let refused = || {
            let hint = "write it like segments.*.EI or payload.mass='5 g':'50 g'";
            let message = "must read PATH or PATH=LOW:HIGH";
            Fault::new("", message).hinting(hint.to_owned()).at(place.clone())
        };
        let (path, bounds) = match text.split_once('=') {
            None => (text, None),
            Some((path, bounds)) => {
                let (low, high) = bounds.split_once(':').ok_or_else(refused)?;
                let end = |text: &str| text.trim().trim_matches(['\'', '"']).to_owned();
                (path, Some([end(low), end(high)]))
            }
        };
        let path = path.trim().to_owned();
        if path.is_empty() || path.ends_with('*') && !path.ends_with(".*") {
            return Err(refused());
        }
        Ok(Self { place, path, bounds })
    }
}

impl FreeValue {
    /// The change that multiplies the value by a factor.
    ///
    /// # Errors
    /// [`SpecError`] for an invalid path.
    pub fn times(&self, factor: f64) -> Result<Override, SpecError> {
        Override::placed(&self.place, &format!("{}*={factor:?}", self.path))
    }

    fn refused(&self, message: String, hint: Option<String>) -> SpecError {
        Fault::new("", message).hinting(hint).at(self.place.clone())
    }

    /// The bounds as factors on `value`, which is `None` for a common factor of several values.
    fn factors(&self, value: Option<&Quantity>) -> Result<[f64; 2], SpecError> {
        let Some(bounds) = &self.bounds else { return Ok(USUAL_FACTORS) };
        let mut factors = [0.0; 2];
        for (factor, text) in factors.iter_mut().zip(bounds) {
            let bound = split_number(text)
                .and_then(Quantity::of)
                .ok_or_else(|| self.refused(format!("{text:?} must be a number"), None))?;
            *factor = match value {
                // A number without unit is in SI, as in the file.
                Some(value)
                    if bound.unit.is_some()
                        && value.unit.is_some()
                        && bound.dimension() != value.dimension() =>
                {
                    return Err(
                        self.refused(format!("{text:?} must have the unit of the value"), None)
                    );
                }
                Some(value) => bound.si / value.si,
                None if bound.unit.is_some() => {
                    let message = format!(
                        "{text:?} must be a factor without unit: several values are free together"
                    );
                    return Err(self.refused(message, None));
                }
                None => bound.si,
            };
        }
        let [low, high] = factors;
        if low > 0.0 && low < 1.0 / WIDEST || high > WIDEST && high.is_finite() {
            let message =
                format!("LOW and HIGH must be within a factor of {WIDEST:e} of the file's value");
            return Err(self.refused(message, None));
        }
        if !(low > 0.0 && low <= 1.0 && high >= 1.0 && high > low && high.is_finite()) {
            let file = value.map_or("1".to_owned(), |value| format!("{:?} in SI", value.si));
            let must = format!(
                "LOW must be above 0 and not above the file's value, {file}, and HIGH not below it"
            );
            let hint = "a bound without unit is in SI; start elsewhere with --set";
            return Err(self.refused(must, Some(hint.to_owned())));
        }
        Ok(factors)
    }
}

/// A number with or without a unit.
struct Quantity {
    si: f64,
    unit: Option<Unit>,
}

impl Quantity {
    fn of((number, unit): (f64, &str)) -> Option<Self> {
        if unit.trim().is_empty() {
            return Some(Self { si: number, unit: None });
        }
        let unit = Unit::parse(unit.trim()).ok()?;
        Some(Self { si: unit.to_si(number), unit: Some(unit) })
    }

    fn dimension(&self) -> Option<crate::numeric::Dimension> {
        self.unit.as_ref().map(Unit::dimension)
    }
}

impl LinkDocument {
    /// The bounds of a free value as factors on the file's value.
    ///
    /// # Errors
    /// [`SpecError`] if the path names no value above 0, and for bounds that do not enclose it.
    pub fn free(&self, value: &FreeValue, changes: &[Override]) -> Result<Free, SpecError> {
        let mut tree = self.changed(changes)?;
        let hint =
            || format!("write a value above 0 to start from into the link file: {}", value.path);
        apply(&mut tree, changes.len(), &value.times(1.0)?)
            .map_err(|error| error.hinting(hint()))?;
        let mut leaves = Vec::new();
        leaves_of(&tree, Place::Override(changes.len()), &mut leaves);
        let mut quantities: Vec<Option<Quantity>> =
            leaves.iter().map(|leaf| number(leaf).and_then(Quantity::of)).collect();
        if let Some(wrong) = quantities.iter().position(|q| !q.as_ref().is_some_and(|q| q.si > 0.0))
        {
            let message = format!(
                "{} = {}, but must be above 0 to be free",
                value.path,
                leaves[wrong].shown()
            );
            return Err(value.refused(message, Some(hint())));
        }
        let is_single = quantities.len() == 1 && !value.path.split('.').any(|step| step == "*");
        let single = if is_single { quantities.pop().flatten() } else { None };
        let number = leaves.first().filter(|_| single.is_some()).and_then(|leaf| number(leaf));
        let number = number.map(|(value, unit)| FreeNumber { value, unit: unit.trim().to_owned() });
        Ok(Free { path: value.path.clone(), factors: value.factors(single.as_ref())?, number })
    }
}

/// A number of the file and its unit.
pub(super) fn number(node: &Node) -> Option<(f64, &str)> {
    match &node.kind {
        Kind::Integer(number) => Some((*number as f64, "")),
        Kind::Number(number) => Some((*number, "")),
        Kind::Text(text) => split_number(text),
        _ => None,
    }
}

/// Collects the values below a node that a change has written.
pub(super) fn leaves_of<'a>(node: &'a Node, place: Place, found: &mut Vec<&'a Node>) {
    match &node.kind {
        Kind::Table(entries) => entries.iter().for_each(|(_, node)| leaves_of(node, place, found)),
        Kind::List(items) => items.iter().for_each(|node| leaves_of(node, place, found)),
        _ if node.place == place => found.push(node),
        _ => {}
    }
}

/// Replaces the multiplied values in the text of a link file in place: comments, order and all else stay. Changes that
/// add or replace a key are not possible.
///
/// # Errors
/// [`SpecError`] for a change that does not fit the file.
pub fn rewrite(
    name: &str,
    text: &str,
    changes: &[Override],
) -> Result<(String, Vec<Replaced>), SpecError> {
    rewritten((name, text), changes, Some(DIGITS))
}

/// The text with the changes and the replaced values. Numbers have this many significant digits, without a limit all,
/// and then words are replaced, too.
pub(super) fn rewritten(
    (name, text): (&str, &str),
    changes: &[Override],
    digits: Option<usize>,
) -> Result<(String, Vec<Replaced>), SpecError> {
    let tree = LinkDocument::read(name, text)?.changed(changes)?;
    let mut places = Vec::new();
    if let Ok(table) = DeTable::parse(text) {
        for (key, value) in table.get_ref() {
            if let Some(node) = tree.get(key.get_ref()) {
                compare(key.get_ref(), (value.get_ref(), value.span()), node, digits, &mut places);
            }
        }
    }
    places.sort_by_key(|(span, ..)| span.start);
    let (mut out, mut end, mut replaced) = (String::new(), 0, Vec::new());
    for (span, path, after) in places {
        out.push_str(&text[end..span.start]);
        out.push_str(&after);
        end = span.end;
        replaced.push(Replaced { path, before: text[span].to_owned(), after });
    }
    out.push_str(&text[end..]);
    let written = LinkDocument::read(name, &out)?.changed(&[])?;
    if !is_close(&written, &tree, digits.map_or(0.0, |_| CLOSE)) {
        let hint = "write the change into the link file first";
        let message = "a change removes or adds a key, which is not rewritten";
        return Err(Fault::new("", message).hinting(hint.to_owned()).at(name.to_owned()));
    }
    Ok((out, replaced))
}

/// Largest difference of a fitted value from its written digits, over the value.
const CLOSE: f64 = 1e-6;

/// True if two trees have the same keys and words, and numbers that differ by at most this share.
pub(super) fn is_close(a: &Node, b: &Node, share: f64) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= share * b.abs();
    match (&a.kind, &b.kind) {
        (Kind::Table(a), Kind::Table(b)) => {
            let mut pairs = a.iter().zip(b);
            a.len() == b.len() && pairs.all(|((k, a), (l, b))| k == l && is_close(a, b, share))
        }
        (Kind::List(a), Kind::List(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| is_close(a, b, share))
        }
        (Kind::Text(a), Kind::Text(b)) => {
            a == b
                || matches!(
                    (split_number(a), split_number(b)),
                    (Some((a, unit)), Some((b, other))) if unit == other && near(a, b)
                )
        }
        (Kind::Number(a), Kind::Number(b)) => near(*a, *b),
        (Kind::Integer(a), Kind::Number(b)) => near(*a as f64, *b),
        (Kind::Number(a), Kind::Integer(b)) => near(*a, *b as f64),
        (a, b) => a == b,
    }
}

/// Collects the file's values that a change has written, with their new text of so many digits.
fn compare(
    path: &str,
    (value, span): (&DeValue<'_>, Range<usize>),
    node: &Node,
    digits: Option<usize>,
    found: &mut Vec<(Range<usize>, String, String)>,
) {
    match value {
        DeValue::Table(entries) => {
            for (key, value) in entries {
                if let Some(node) = node.get(key.get_ref()) {
                    let path = format!("{path}.{}", key.get_ref());
                    compare(&path, (value.get_ref(), value.span()), node, digits, found);
                }
            }
        }
        DeValue::Array(items) => {
            for (number, item) in items.iter().enumerate() {
                if let Some(node) = node.get(&number.to_string()) {
                    let path = format!("{path}.{number}");
                    compare(&path, (item.get_ref(), item.span()), node, digits, found);
                }
            }
        }
        _ if matches!(node.place, Place::Override(_)) => {
            let number = |number: f64| {
                let rounded = digits.and_then(|count| {
                    let digits = format!("{number:.*e}", count.saturating_sub(1));
                    digits.parse::<f64>().ok()
                });
                format!("{:?}", rounded.unwrap_or(number))
            };
            let after = match &node.kind {
                Kind::Integer(whole) => whole.to_string(),
                Kind::Number(value) => number(*value),
                Kind::Text(text) => match split_number(text) {
                    Some((value, unit)) => format!("\"{}{unit}\"", number(value)),
                    None if digits.is_none() => toml::Value::from(text.as_str()).to_string(),
                    None => return,
                },
                _ => return,
            };
            found.push((span, path.to_owned(), after));
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINK: &str = "# A strip.\n[[segments]]\nname = 'root' # stiff\nlength = '15 cm'\nE = '200 GPa'\n\
        I = 1e-11 # by hand\ndensity = 7800\narea = 1e-5\n\n[payload]\nmass = '50 g'\n";

    #[test]
    fn values_are_replaced_and_comments_stay() {
        let changes = ["segments.*.EI*=0.5", "payload.mass*=1.1"].map(|c| c.parse().unwrap());
        let (text, replaced) = rewrite("l.toml", LINK, &changes).unwrap();
        let expected = LINK.replace("'200 GPa'", "\"100.0 GPa\"").replace("'50 g'", "\"55.0 g\"");
        assert_eq!(text, expected);
        assert_eq!(replaced.len(), 2);
        assert_eq!(replaced[1].path, "payload.mass");
        assert_eq!(replaced[1].before, "'50 g'");
    }

    #[test]
    fn a_change_that_adds_a_key_is_refused() {
        for change in ["hub.inertia=1", "segments.0.name=\"tip\"", "segments.0.EI=5"] {
            assert!(rewrite("l.toml", LINK, &[change.parse().unwrap()]).is_err(), "{change}");
        }
        assert!(rewrite("l.toml", LINK, &["payload.mass=0.1".parse().unwrap()]).is_ok());
    }

    #[test]
    fn bounds_are_values_of_one_path_and_factors_of_several() {
        let document = LinkDocument::read("l.toml", LINK).unwrap();
        let free = |text: &str| document.free(&text.parse().unwrap(), &[]);
        let bounds = free("payload.mass='5 g':0.1").unwrap().factors;
        let number = free("payload.mass").unwrap().number;
        assert_eq!(number, Some(FreeNumber { value: 50.0, unit: "g".to_owned() }));
        assert_eq!(free("segments.*.EI").unwrap().number, None);
        assert!((bounds[0] - 0.1).abs() < 1e-12 && (bounds[1] - 2.0).abs() < 1e-12);
        let usual = free("segments.*.EI").unwrap().factors;
        assert_eq!(usual.map(f64::to_bits), USUAL_FACTORS.map(f64::to_bits));
        for wrong in
            ["payload.mass=1:2", "payload.inertia", "payload.mass='1 m':'2 m'", "hub.inertia"]
        {
            assert!(free(wrong).is_err(), "{wrong}");
        }
        assert!("segments.*.EI*".parse::<FreeValue>().is_err());
        assert!("payload.mass=1".parse::<FreeValue>().is_err());
    }
}
