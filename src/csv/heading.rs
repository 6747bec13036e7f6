use super::error::{Place, TableError, quoted};
use crate::numeric::{Dimension, Unit};

/// What a column of a table that is read holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Acceleration,
    Velocity,
    Displacement,
    /// Displacement over the link's length.
    Angle,
    Torque,
    HubAngle,
    HubRate,
}

/// How the column of a quantity is headed.
struct Description {
    word: &'static str,
    /// This program's own ending of the name, which tells the SI unit.
    suffix: &'static str,
    dimension: Dimension,
    /// The SI unit, and another that is much used.
    units: [&'static str; 2],
}

impl Quantity {
    fn description(self) -> Description {
        let of = |word, suffix, dimension, units| Description { word, suffix, dimension, units };
        match self {
            Self::Time => of("time", "_s", Dimension::TIME, ["s", "ms"]),
            Self::Acceleration => {
                of("acceleration", "_m_s2", Dimension::ACCELERATION, ["m/s^2", "cm/s^2"])
            }
            Self::Velocity => of("velocity", "_m_s", Dimension::VELOCITY, ["m/s", "cm/s"]),
            Self::Displacement => of("displacement", "_m", Dimension::LENGTH, ["m", "cm"]),
            Self::Angle => of("angle", "_rad", Dimension::NONE, ["rad", "deg"]),
            Self::Torque => of("torque", "_n_m", Dimension::TORQUE, ["N m", "N cm"]),
            Self::HubAngle => of("hub_angle", "_rad", Dimension::NONE, ["rad", "deg"]),
            Self::HubRate => of("hub_rate", "_rad_s", Dimension::RATE, ["rad/s", "deg/s"]),
        }
    }

    /// The name, without prefix and unit.
    pub(super) fn word(self) -> &'static str {
        self.description().word
    }

    pub(super) fn dimension(self) -> Dimension {
        self.description().dimension
    }

    /// The SI unit, and another that is much used.
    pub(super) fn units(self) -> [&'static str; 2] {
        self.description().units
    }

    /// Whether a name ends with this program's own suffix.
    pub(super) fn is_suffixed(self, name: &str) -> bool {
        name.to_lowercase().ends_with(self.description().suffix)
    }
}

/// The columns that one kind of table may hold.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vocabulary {
    pub(super) quantities: &'static [Quantity],
    /// May stand before any name, and changes nothing.
    prefix: &'static str,
    /// A row of names.
    pub(super) example: &'static str,
    /// What to do about two columns of one quantity, where that is not plain.
    pub(super) choice: Option<&'static str>,
}

/// The tip's motion.
pub(super) const TRAJECTORY: Vocabulary = Vocabulary {
    quantities: &[
        Quantity::Time,
        Quantity::Acceleration,
        Quantity::Velocity,
        Quantity::Displacement,
        Quantity::Angle,
    ],
    prefix: "tip_",
    example: "time,acceleration",
    choice: None,
};

/// A torque at the hub.
pub(super) const TORQUE: Vocabulary = Vocabulary {
    quantities: &[Quantity::Time, Quantity::Torque],
    prefix: "hub_",
    example: "time,torque",
    choice: Some("rename one of them; among torques --column chooses"),
};

/// The hub's motion.
pub(super) const HUB_MOTION: Vocabulary = Vocabulary {
    quantities: &[Quantity::Time, Quantity::HubAngle, Quantity::HubRate],
    prefix: "",
    example: "time,hub_angle",
    choice: Some("rename one of them"),
};

impl Vocabulary {
    /// A name in small letters, without the prefix.
    pub(super) fn plain(&self, name: &str) -> String {
        let lower = name.to_lowercase();
        lower.strip_prefix(self.prefix).map_or_else(|| lower.clone(), str::to_owned)
    }

    /// The quantity of a name, and whether the name tells its unit.
    pub(super) fn quantity(&self, name: &str) -> Option<(Quantity, bool)> {
        let plain = self.plain(name);
        self.quantities.iter().find_map(|quantity| {
            let Description { word, suffix, .. } = quantity.description();
            let ending = plain.strip_prefix(word)?;
            (ending.is_empty() || ending == suffix).then_some((*quantity, ending == suffix))
        })
    }
}

/// The row that names the columns.
#[derive(Debug, Clone)]
pub(super) struct Header {
    /// Number of columns.
    pub(super) width: usize,
    /// The columns that are read, from left to right.
    pub(super) headings: Vec<Heading>,
}

/// One column's heading.
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
    /// Reads the heading of a column; `None` if the vocabulary does not know its name.
    pub(super) fn read(
        index: usize,
        field: &str,
        vocabulary: &Vocabulary,
        place: Place,
    ) -> Result<Option<Self>, TableError> {
        let (name, _) = split_unit(field);
        let known = vocabulary.quantity(name);
        let heading =
            known.map(|(quantity, suffixed)| Self::of(index, field, quantity, suffixed, place));
        heading.transpose()
    }

    /// Reads the heading of a column that holds `quantity`; `suffixed` names tell its SI unit.
    pub(super) fn of(
        index: usize,
        field: &str,
        quantity: Quantity,
        suffixed: bool,
        place: Place,
    ) -> Result<Self, TableError> {
        let (name, unit_text) = split_unit(field);
        if let (true, Some(unit)) = (suffixed, unit_text) {
            let must = format!("must not stand beside the unit that {name} names itself");
            return Err(place.refuse(format!("unit of {name}"), quoted(unit), must));
        }
        let unit = unit_text.map(|text| read_unit(text, name, quantity, place)).transpose()?;
        Ok(Self {
            index,
            quantity,
            name: name.to_owned(),
            unit_text: unit_text.unwrap_or(quantity.units()[0]).to_owned(),
            unit,
        })
    }

    /// A value of this column in SI.
    pub(super) fn to_si(&self, value: f64) -> f64 {
        self.unit.as_ref().map_or(value, |unit| unit.to_si(value))
    }

    /// The heading as a message names it.
    pub(super) fn subject(&self) -> String {
        format!("column {}", self.index + 1)
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
        let must = format!("must be a unit such as {}", quantity.units().join(" or "));
        place.refuse(format!("unit of {name}"), quoted(text), must).with_hint(hint)
    };
    if text.is_empty() {
        return Err(refuse(None));
    }
    let unit = Unit::parse(text).map_err(|error| refuse(error.hint()))?;
    if unit.dimension() == quantity.dimension() { Ok(unit) } else { Err(refuse(None)) }
}

/// Refuses a first row that does not name columns, or separates them otherwise than by commas.
pub(super) fn check_names(
    fields: &[&str],
    vocabulary: &Vocabulary,
    place: Place,
) -> Result<(), TableError> {
    if fields.iter().all(|field| field.parse::<f64>().is_ok()) {
        let must = "must name the columns";
        let hint = format!(
            "begin with a row like {}; a line that starts with # is a comment",
            vocabulary.example
        );
        return Err(place.refuse("first row", quoted(&fields.join(",")), must).with_hint(hint));
    }
    check_separator(fields, place)
}

/// Refuses a first row that separates its columns otherwise than by commas.
pub(crate) fn check_separator(fields: &[&str], place: Place) -> Result<(), TableError> {
    // Where decimals follow a comma, some commas are there all the same.
    if let Some(field) = fields.iter().find(|field| field.contains([';', '\t'])) {
        let must = "must name columns that are separated by commas";
        let hint = "separate the columns with commas".to_owned();
        return Err(place.refuse("first row", quoted(field), must).with_hint(hint));
    }
    Ok(())
}

/// Refuses a column that holds the quantity of one before it.
pub(super) fn check_single(
    before: &[Heading],
    heading: &Heading,
    place: Place,
) -> Result<(), TableError> {
    let twice = before.iter().find(|earlier| earlier.quantity == heading.quantity);
    twice.map_or(Ok(()), |earlier| Err(refuse_repeated(earlier, heading, place)))
}

fn refuse_repeated(earlier: &Heading, heading: &Heading, place: Place) -> TableError {
    let must = format!("must not repeat {}, {}", earlier.subject(), quoted(&earlier.name));
    place.refuse(heading.subject(), quoted(&heading.name), must)
}

/// The one column of `quantity`, if there is one, whatever stands beside it.
pub(super) fn find_column(
    fields: &[&str],
    quantity: Quantity,
    vocabulary: &Vocabulary,
    place: Place,
) -> Result<Option<Heading>, TableError> {
    let mut found: Option<Heading> = None;
    for (index, field) in fields.iter().enumerate() {
        let (name, _) = split_unit(field);
        let Some((_, suffixed)) = vocabulary.quantity(name).filter(|known| known.0 == quantity)
        else {
            continue;
        };
        let heading = Heading::of(index, field, quantity, suffixed, place)?;
        if let Some(earlier) = &found {
            let choice = vocabulary.choice.map(str::to_owned);
            return Err(refuse_repeated(earlier, &heading, place).with_hint(choice));
        }
        found = Some(heading);
    }
    Ok(found)
}

/// The one column of time.
pub(super) fn find_time(
    fields: &[&str],
    vocabulary: &Vocabulary,
    place: Place,
) -> Result<Heading, TableError> {
    let time = find_column(fields, Quantity::Time, vocabulary, place)?;
    time.ok_or_else(|| refuse_missing(&names(fields), Quantity::Time.word(), place))
}

/// The names of all columns, without their units.
pub(super) fn names<'a>(fields: &[&'a str]) -> Vec<&'a str> {
    fields.iter().map(|field| split_unit(field).0).collect()
}

/// Refuses columns with these names for want of one, and asks whether one is that misspelt.
pub(crate) fn refuse_missing(names: &[&str], wanted: &str, place: Place) -> TableError {
    let must = format!("must include {wanted}");
    // A slip changes a letter or two; a longer name is another thing.
    let is_slip = |name: &&&str| name.len().abs_diff(wanted.len()) <= 2;
    let near = nearest(wanted, names.iter().filter(is_slip).copied());
    let hint = near.map(|name| format!("did you mean {wanted} by {}?", quoted(name)));
    place.refuse("columns", quoted(&names.join(",")), must).with_hint(hint)
}

/// The word that `name` is spelt most like, if one is near at all.
pub(super) fn nearest<'a>(name: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Likeness, from 0 to 1, from which a name is taken for a slip or an abbreviation.
    const ALIKE: f64 = 0.7;
    let ranked = words.into_iter().map(|word| (strsim::jaro_winkler(name, word), word));
    let (best, word) = ranked.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best > ALIKE).then_some(word)
}
