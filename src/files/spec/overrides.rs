use std::str::FromStr;

use super::error::{Fault, SpecError, of_segments};
use super::raw::PROPERTIES;
use super::tree::{Kind, Node, Place};
use crate::numeric::split_number;
use crate::text::{did_you_mean, excerpt, visible};

/// Largest number of steps in a path; link files are less deep.
const MOST_STEPS: usize = 16;

/// Keys whose text is no quantity, even if it begins with a number: they have no multiples.
const WORDS: [&str; 4] = ["title", "name", "shape", "model"];

/// One change of the link file from the command line: `PATH=VALUE` replaces a value, `PATH*=FACTOR` multiplies it.
///
/// PATH is the dotted TOML path; a step names a segment, its number from 0, or `*` for all. A value also replaces the
/// keys for the same property: EI replaces E and I, `mesh.elements` the elements of the segments.
#[derive(Debug, Clone, PartialEq)]
pub struct Override {
    /// Place of the change, as errors name it.
    pub(super) place: String,
    path: Vec<String>,
    change: Change,
}

#[derive(Debug, Clone, PartialEq)]
enum Change {
    Replace(String),
    Multiply(f64),
}

impl Override {
    /// Reads a change; errors call it `place`.
    ///
    /// # Errors
    /// [`SpecError`] if the text is no change.
    pub fn placed(place: &str, text: &str) -> Result<Self, SpecError> {
        let refused = |message: &str| {
            let hint = "write it like segments.0.EI=20 or payload.mass*=1.1";
            Fault::new("", message).hinting(hint.to_owned()).at(place.to_owned())
        };
        let Some((path, value)) = text.split_once('=') else {
            return Err(refused("has no `=`, but must read PATH=VALUE or PATH*=FACTOR"));
        };
        let (path, value) = (path.trim(), value.trim());
        let (path, change) = match path.strip_suffix('*') {
            None if value.is_empty() => return Err(refused("has no value after the `=`")),
            None => (path, Change::Replace(value.to_owned())),
            Some(path) => match value.parse::<f64>() {
                Ok(factor) if factor.is_finite() => (path, Change::Multiply(factor)),
                _ => {
                    let value = excerpt(value);
                    return Err(refused(&format!(
                        "{value:?} must be a finite number without unit"
                    )));
                }
            },
        };
        let path: Vec<String> = path.split('.').map(|step| step.trim().to_owned()).collect();
        if path.iter().any(String::is_empty) {
            return Err(refused("has an empty step in its path"));
        }
        if path.len() > MOST_STEPS {
            let found = path.len();
            return Err(refused(&format!(
                "has a path of {found} steps, but must have at most {MOST_STEPS}"
            )));
        }
        Ok(Self { place: place.to_owned(), path, change })
    }
}

impl Override {
    /// True for `PATH*=FACTOR`.
    pub(super) fn is_factor(&self) -> bool {
        matches!(self.change, Change::Multiply(_))
    }
}

impl FromStr for Override {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        Self::placed(&format!("--set '{}'", visible(&excerpt(text))), text)
    }
}

/// Applies the `number`-th override to the tree.
pub(super) fn apply(tree: &mut Node, number: usize, change: &Override) -> Result<(), SpecError> {
    let step = Step { change: &change.change, place: Place::Override(number) };
    step.descend(tree, "", &change.path).map_err(|fault| fault.at(change.place.clone()))?;
    if matches!(change.change, Change::Replace(_)) && change.path == ["mesh", "elements"] {
        remove_own_elements(tree);
    }
    Ok(())
}

/// Removes the elements of single segments, which a number for the whole link replaces.
fn remove_own_elements(tree: &mut Node) {
    let Kind::Table(entries) = &mut tree.kind else { return };
    for (_, links) in entries.iter_mut().filter(|(key, _)| key == "links") {
        if let Kind::List(links) = &mut links.kind {
            links.iter_mut().for_each(remove_own_elements);
        }
    }
    let segments = entries.iter_mut().filter(|(key, _)| key == "segments");
    for (_, segments) in segments {
        let Kind::List(segments) = &mut segments.kind else { continue };
        for segment in segments {
            if let Kind::Table(entries) = &mut segment.kind {
                entries.retain(|(key, _)| key != "elements");
            }
        }
    }
}

#[derive(Clone, Copy)]
struct Step<'a> {
    change: &'a Change,
    place: Place,
}

impl Step<'_> {
    /// Walks from the `node` at `path` along the `rest` of the path, and changes its value.
    fn descend(self, node: &mut Node, path: &str, rest: &[String]) -> Result<(), Fault> {
        let Some((step, rest)) = rest.split_first() else {
            return match self.change {
                Change::Replace(text) => {
                    *node = Node::value(text, self.place);
                    Ok(())
                }
                Change::Multiply(factor) => self.multiply(node, path, *factor),
            };
        };
        match &mut node.kind {
            Kind::List(items) => {
                for number in chosen(items, path, step)? {
                    self.descend(&mut items[number], &below(path, &number.to_string()), rest)?;
                }
                if rest.is_empty() {
                    node.place = self.place;
                }
                Ok(())
            }
            Kind::Table(entries) => {
                let inner = below(path, step);
                let at = |wanted: &str| entries.iter().position(|(key, _)| key == wanted);
                // Four times EI is four times E, if the file has E.
                let is_factor = rest.is_empty() && matches!(self.change, Change::Multiply(_));
                let product = PROPERTIES.iter().find(|product| product.whole == step && is_factor);
                let factor = product.and_then(|product| at(product.material));
                let number = match at(step).or(factor) {
                    Some(number) => number,
                    None => self.create(entries, &inner, step, rest)?,
                };
                self.descend(&mut entries[number].1, &inner, rest)
            }
            _ => {
                let found = node.shown();
                let message =
                    format!("{} = {found}, which holds no {}", excerpt(path), excerpt(step));
                Err(Fault::new(path, message))
            }
        }
    }

    /// Adds an empty table at the absent key `step`, for replacing or filling.
    fn create(
        self,
        entries: &mut Entries,
        path: &str,
        step: &str,
        rest: &[String],
    ) -> Result<usize, Fault> {
        let absent = format!("{} is not in the file", excerpt(path));
        if matches!(self.change, Change::Multiply(_)) {
            let message = format!("{absent}, so it cannot be multiplied");
            let is_arm = entries.iter().any(|(key, _)| key == "links");
            let hint = of_segments(path, is_arm).unwrap_or_else(|| instead(entries, step));
            return Err(Fault::new(path, message).hinting(hint));
        }
        if matches!(step, "links" | "segments" | "masses") && !rest.is_empty() {
            return Err(Fault::new(path, absent));
        }
        if rest.is_empty() {
            make_room(entries, step);
        }
        let kind = Kind::Table(Vec::new());
        entries.push((step.to_owned(), Node { place: self.place, kind }));
        Ok(entries.len() - 1)
    }

    fn multiply(self, node: &mut Node, path: &str, factor: f64) -> Result<(), Fault> {
        let product = match &mut node.kind {
            Kind::Integer(number) => Some(whole_where_possible(*number as f64 * factor)),
            Kind::Number(number) => Some(Kind::Number(*number * factor)),
            Kind::Text(text) => split_number(text)
                .filter(|_| !holds_words(path))
                .map(|(number, unit)| Kind::Text(format!("{:?}{unit}", number * factor))),
            Kind::List(items) => {
                for (number, item) in items.iter_mut().enumerate() {
                    self.multiply(item, &below(path, &number.to_string()), factor)?;
                }
                node.place = self.place;
                return Ok(());
            }
            Kind::Boolean(_) | Kind::Date(_) | Kind::Table(_) => None,
        };
        let message = format!("{path} = {}, which cannot be multiplied", node.shown());
        let kind = product.ok_or_else(|| Fault::new(path, message))?;
        *node = Node { place: self.place, kind };
        Ok(())
    }
}

/// An integer if the product is whole, for numbers of elements.
fn whole_where_possible(product: f64) -> Kind {
    let exact = product.fract() == 0.0 && product.abs() < 9e15;
    #[expect(clippy::cast_possible_truncation, reason = "a whole number below 2^53")]
    if exact { Kind::Integer(product as i64) } else { Kind::Number(product) }
}

/// True if the value at a path is text, not a quantity.
fn holds_words(path: &str) -> bool {
    let key = path.rsplit('.').next();
    key.is_some_and(|key| WORDS.contains(&key))
}

fn below(path: &str, step: &str) -> String {
    let dot = if path.is_empty() { "" } else { "." };
    format!("{path}{dot}{step}")
}

/// Numbers of the list items that match a step of the path.
fn chosen(items: &[Node], path: &str, step: &str) -> Result<Vec<usize>, Fault> {
    let name = |item: &Node| match item.get("name").map(|node| &node.kind) {
        Some(Kind::Text(name)) => Some(name.clone()),
        _ => None,
    };
    let number = match step.parse::<usize>() {
        _ if step == "*" && !items.is_empty() => return Ok((0..items.len()).collect()),
        Ok(number) => Some(number).filter(|number| *number < items.len()),
        Err(_) => items.iter().position(|item| name(item).as_deref() == Some(step)),
    };
    number.map(|number| vec![number]).ok_or_else(|| {
        let names: Vec<_> = items.iter().filter_map(name).collect();
        let known = items.iter().enumerate().map(|(number, item)| match name(item) {
            Some(name) => format!("{number} ({name})"),
            None => number.to_string(),
        });
        let known: Vec<String> = known.collect();
        let known = if known.is_empty() { "none".into() } else { known.join(", ") };
        let path = below(path, step);
        let message =
            format!("{} is not in the file, which has {}", excerpt(&path), excerpt(&known));
        Fault::new(path, message).hinting(did_you_mean(step, names.iter().map(String::as_str)))
    })
}

type Entries = Vec<(String, Node)>;

/// Removes the keys that a new value at `step` replaces.
///
/// A product replaces its factors, and the section if no other key needs it. `ratio` and `ratios` replace each other;
/// so do shear stiffness and the constants behind it.
fn make_room(entries: &mut Entries, step: &str) {
    let given: Vec<String> = entries.iter().map(|(key, _)| key.clone()).collect();
    let is_given = |key: &str| given.iter().any(|other| other == key);
    let mut replaced = match step {
        "ratio" => vec!["ratios", "modes"],
        "ratios" => vec!["ratio"],
        "shear_stiffness" => vec!["shear_modulus", "poisson_ratio"],
        "shear_modulus" | "poisson_ratio" => vec!["shear_stiffness"],
        _ => vec![],
    };
    if let Some(property) = PROPERTIES.iter().find(|property| property.whole == step) {
        replaced.extend([property.material, property.shape]);
        let mut others = PROPERTIES.iter().filter(|other| other.whole != step);
        if !others.any(|other| is_given(other.material)) {
            replaced.push("section");
        }
    }
    entries.retain(|(key, _)| !replaced.contains(&key.as_str()));
}

/// Hint for a factor on the absent key `step`.
fn instead(entries: &Entries, step: &str) -> String {
    let given: Vec<&str> = entries.iter().map(|(key, _)| key.as_str()).collect();
    let is_factor = |key: &str| PROPERTIES.iter().find(|p| [p.material, p.shape].contains(&key));
    let others = match step {
        "ratio" => vec!["ratios"],
        "ratios" => vec!["ratio"],
        "shear_stiffness" => vec!["shear_modulus", "poisson_ratio"],
        "shear_modulus" => vec!["poisson_ratio", "shear_stiffness"],
        _ => is_factor(step).map_or(vec![], |property| vec![property.whole, property.material]),
    };
    if let Some(other) = others.iter().find(|other| given.contains(other)) {
        return format!("multiply {other}, which the file has there");
    }
    // A product can be multiplied by its factor.
    let products = PROPERTIES.iter().filter(|property| given.contains(&property.material));
    let known = given.iter().copied().chain(products.map(|property| property.whole));
    did_you_mean(step, known).unwrap_or_else(|| "set a value with `=`".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_before_the_sign_multiplies_and_one_in_the_path_is_for_all() {
        let set: Override = "segments.*.EI *= 4".parse().unwrap();
        assert_eq!(set.path, ["segments", "*", "EI"]);
        assert_eq!(set.change, Change::Multiply(4.0));
        let set: Override = "payload.mass = 50 g".parse().unwrap();
        assert_eq!(set.change, Change::Replace("50 g".into()));
    }

    #[test]
    fn a_slip_in_a_product_of_which_a_factor_is_given_is_asked_about() {
        let text = "[[segments]]\nlength = 1\nE = 2e11\nI = 1e-10\ndensity = 7800\narea = 1e-4\n";
        let mut tree = Node::document("", text).unwrap();
        for (slip, meant) in
            [("EII", "EI"), ("mass_per_lenght", "mass_per_length"), ("lenght", "length")]
        {
            let change = format!("segments.*.{slip}*=2").parse().unwrap();
            let error = apply(&mut tree, 0, &change).unwrap_err();
            assert_eq!(error.hint(), Some(format!("did you mean `{meant}`?").as_str()));
        }
    }

    #[test]
    fn what_an_override_writes_is_placed_there_and_the_rest_is_not() {
        let mut tree = Node::document("", "[hub]\ninertia = '2 kg m^2'\nradius = 1\n").unwrap();
        apply(&mut tree, 3, &"hub.inertia*=1.5".parse().unwrap()).unwrap();
        let place = |path| tree.place_of(path);
        assert_eq!(place("hub.inertia"), Place::Override(3));
        assert_eq!(place("hub.radius"), Place::Line(3));
        assert_eq!(tree.get("hub").unwrap().get("inertia").unwrap().shown(), "\"3.0 kg m^2\"");
    }
}
