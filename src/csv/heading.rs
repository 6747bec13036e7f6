use super::rows::{Place, TableError, quoted};
use crate::numeric::{Dimension, Unit};

/// A quantity that a column may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Quantity {
    /// The name, without prefix and unit.
    pub(super) word: &'static str,
    /// Ending of a name that states the SI unit, as this program writes it.
    suffix: &'static str,
    dimension: Dimension,
    /// The SI unit, and another common one.
    pub(super) units: [&'static str; 2],
}

const fn quantity(
    word: &'static str,
    suffix: &'static str,
    dimension: Dimension,
    units: [&'static str; 2],
) -> Quantity {
    Quantity { word, suffix, dimension, units }
}

pub(super) const TIME: Quantity = quantity("time", "_s", Dimension::TIME, ["s", "ms"]);
pub(super) const ACCELERATION: Quantity =
    quantity("acceleration", "_m_s2", Dimension::ACCELERATION, ["m/s^2", "cm/s^2"]);
pub(super) const VELOCITY: Quantity =
    quantity("velocity", "_m_s", Dimension::VELOCITY, ["m/s", "cm/s"]);
pub(super) const DISPLACEMENT: Quantity =
    quantity("displacement", "_m", Dimension::LENGTH, ["m", "cm"]);
/// Displacement divided by the length of the link.
pub(super) const ANGLE: Quantity = quantity("angle", "_rad", Dimension::NONE, ["rad", "deg"]);
pub(super) const TORQUE: Quantity = quantity("torque", "_n_m", Dimension::TORQUE, ["N m", "N cm"]);
pub(super) const HUB_ANGLE: Quantity =
    quantity("hub_angle", "_rad", Dimension::NONE, ["rad", "deg"]);
pub(super) const HUB_RATE: Quantity =
    quantity("hub_rate", "_rad_s", Dimension::RATE, ["rad/s", "deg/s"]);

impl Quantity {
    /// True if the name ends with the suffix of the SI unit.
    pub(super) fn is_suffixed(self, name: &str) -> bool {
        name.to_lowercase().ends_with(self.suffix)
    }
}

/// The columns that a kind of table may have.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vocabulary {
    pub(super) quantities: &'static [Quantity],
    /// May precede any name, without meaning.
    pub(super) prefix: &'static str,
    /// A row of names.
    pub(super) example: &'static str,
    /// What to do about two columns of one quantity.
    pub(super) choice: Option<&'static str>,
}

impl Vocabulary {
    /// The name in lower case, without the prefix.
    pub(super) fn plain(&self, name: &str) -> String {
        let lower = name.to_lowercase();
        lower.strip_prefix(self.prefix).map_or_else(|| lower.clone(), str::to_owned)
    }

    /// The quantity of a name, and true if the name states its unit.
    fn quantity(&self, name: &str) -> Option<(Quantity, bool)> {
        let plain = self.plain(name);
        self.quantities.iter().find_map(|quantity| {
            let ending = plain.strip_prefix(quantity.word)?;
            let suffixed = ending == quantity.suffix;
            (ending.is_empty() || suffixed).then_some((*quantity, suffixed))
        })
    }

    /// Reads the first row of a table: the headings that this vocabulary knows, from the left.
    ///
    /// # Errors
    /// [`TableError`] for a row without names, a unit of another quantity, and two columns of one
    /// quantity.
    pub(super) fn read(&self, fields: &[&str], place: Place) -> Result<Vec<Heading>, TableError> {
        self.check_names(fields, place)?;
        let mut headings: Vec<Heading> = Vec::new();
        for (index, field) in fields.iter().enumerate() {
            let Some((quantity, suffixed)) = self.quantity(split_unit(field).0) else { continue };
            let heading = Heading::of(index, field, quantity, suffixed, place)?;
            if let Some(earlier) = find(&headings, quantity) {
                let must = format!("must not repeat {}", earlier.named());
                let choice = self.choice.map(str::to_owned);
                return Err(place.refuse_column(index, &heading.name, must).with_hint(choice));
            }
            headings.push(heading);
        }
        Ok(headings)
    }

    /// Refuses a first row of numbers only, or with other separators than commas.
    fn check_names(&self, fields: &[&str], place: Place) -> Result<(), TableError> {
        if fields.iter().all(|field| field.parse::<f64>().is_ok()) {
            let hint = format!(
                "begin with a row like {}; a line that starts with # is a comment",
                self.example
            );
            let found = quoted(&fields.join(","));
            return Err(place.refuse("first row", found, "must name the columns").with_hint(hint));
        }
        check_separator(fields, place)
    }
}

/// The heading of a quantity, if the table has one.
pub(super) fn find(headings: &[Heading], quantity: Quantity) -> Option<&Heading> {
    headings.iter().find(|heading| heading.quantity == quantity)
}

/// Refuses a table that has no column of this quantity.
pub(super) fn require(
    headings: &[Heading],
    quantity: Quantity,
    fields: &[&str],
    place: Place,
) -> Result<(), TableError> {
    match find(headings, quantity) {
        Some(_) => Ok(()),
        None => Err(refuse_missing(&names(fields), quantity.word, place)),
    }
}

/// The heading of one column.
#[derive(Debug, Clone)]
pub(super) struct Heading {
    /// Number of the column, from 0.
    pub(super) index: usize,
    pub(super) quantity: Quantity,
    /// The name as written, without the unit in brackets.
    pub(super) name: String,
    /// The unit as written, or the SI unit.
    pub(super) unit_text: String,
    /// `None`: SI.
    unit: Option<Unit>,
}

impl Heading {
    /// Reads the heading of a column of `quantity`; a `suffixed` name states the SI unit.
    pub(super) fn of(
        index: usize,
        field: &str,
        quantity: Quantity,
        suffixed: bool,
        place: Place,
    ) -> Result<Self, TableError> {
        let (name, unit_text) = split_unit(field);
        if let (true, Some(unit)) = (suffixed, unit_text) {
            let must = format!("must be left out: the name {name} has its unit");
            return Err(place.refuse(format!("unit of {name}"), quoted(unit), must));
        }
        let unit = unit_text.map(|text| read_unit(text, name, quantity, place)).transpose()?;
        Ok(Self {
            index,
            quantity,
            name: name.to_owned(),
            unit_text: unit_text.unwrap_or(quantity.units[0]).to_owned(),
            unit,
        })
    }

    /// A value of this column in SI.
    pub(super) fn to_si(&self, value: f64) -> f64 {
        self.unit.as_ref().map_or(value, |unit| unit.to_si(value))
    }

    /// The column in a message: `column 2, "torque"`.
    pub(super) fn named(&self) -> String {
        format!("column {}, {}", self.index + 1, quoted(&self.name))
    }
}

/// The name in front of a unit in brackets, and that unit.
pub(super) fn split_unit(field: &str) -> (&str, Option<&str>) {
    match field.strip_suffix(']').and_then(|f| f.split_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (field, None),
    }
}

fn read_unit(text: &str, name: &str, quantity: Quantity, place: Place) -> Result<Unit, TableError> {
    let refuse = |hint| {
        let must = format!("must be a unit such as {}", quantity.units.join(" or "));
        place.refuse(format!("unit of {name}"), quoted(text), must).with_hint(hint)
    };
    if text.is_empty() {
        return Err(refuse(None));
    }
    let unit = Unit::parse(text).map_err(|error| refuse(error.hint()))?;
    if unit.dimension() == quantity.dimension { Ok(unit) } else { Err(refuse(None)) }
}

/// Refuses a first row with other separators than commas.
pub(crate) fn check_separator(fields: &[&str], place: Place) -> Result<(), TableError> {
    // Such a row may have commas too, as decimal points.
    if let Some(field) = fields.iter().find(|field| field.contains([';', '\t'])) {
        let must = "must name columns that are separated by commas";
        let hint = "separate the columns with commas".to_owned();
        return Err(place.refuse("first row", quoted(field), must).with_hint(hint));
    }
    Ok(())
}

/// The names of all columns, without their units.
pub(super) fn names<'a>(fields: &[&'a str]) -> Vec<&'a str> {
    fields.iter().map(|field| split_unit(field).0).collect()
}

/// Refuses columns without the `wanted` one; the hint names a column that may be that one misspelt.
pub(crate) fn refuse_missing(names: &[&str], wanted: &str, place: Place) -> TableError {
    let must = format!("must include {wanted}");
    // A slip changes a letter or two.
    let is_slip = |name: &&&str| name.len().abs_diff(wanted.len()) <= 2;
    let near = nearest(wanted, names.iter().filter(is_slip).copied());
    let hint = near.map(|name| format!("did you mean {wanted} by {}?", quoted(name)));
    place.refuse("columns", quoted(&names.join(",")), must).with_hint(hint)
}

/// The word that is most similar to `name`, if one is similar.
pub(super) fn nearest<'a>(name: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Similarity, from 0 to 1, of a slip or an abbreviation.
    const ALIKE: f64 = 0.7;
    let ranked = words.into_iter().map(|word| (strsim::jaro_winkler(name, word), word));
    let (best, word) = ranked.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best > ALIKE).then_some(word)
}
