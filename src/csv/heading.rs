use super::error::{Place, TableError, quoted};
use crate::numeric::{Dimension, Unit};

/// The quantity of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Acceleration,
    Velocity,
    Displacement,
    /// Displacement divided by the length of the link.
    Angle,
    Torque,
    HubAngle,
    HubRate,
}

/// The heading of a quantity.
struct Description {
    word: &'static str,
    /// Ending of the name that states the SI unit, as this program writes it.
    suffix: &'static str,
    dimension: Dimension,
    /// The SI unit, and another common one.
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

    /// The SI unit, and another common one.
    pub(super) fn units(self) -> [&'static str; 2] {
        self.description().units
    }

    /// True if the name ends with the suffix of the SI unit.
    pub(super) fn is_suffixed(self, name: &str) -> bool {
        name.to_lowercase().ends_with(self.description().suffix)
    }
}

/// The columns that a kind of table may have.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vocabulary {
    pub(super) quantities: &'static [Quantity],
    /// May precede any name, without meaning.
    prefix: &'static str,
    /// A row of names.
    pub(super) example: &'static str,
    /// What to do about two columns of one quantity.
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
    /// The name in lower case, without the prefix.
    pub(super) fn plain(&self, name: &str) -> String {
        let lower = name.to_lowercase();
        lower.strip_prefix(self.prefix).map_or_else(|| lower.clone(), str::to_owned)
    }

    /// The quantity of a name, and true if the name states its unit.
    pub(super) fn quantity(&self, name: &str) -> Option<(Quantity, bool)> {
        let plain = self.plain(name);
        self.quantities.iter().find_map(|quantity| {
            let Description { word, suffix, .. } = quantity.description();
            let ending = plain.strip_prefix(word)?;
            (ending.is_empty() || ending == suffix).then_some((*quantity, ending == suffix))
        })
    }
}

/// The first row of a table.
#[derive(Debug, Clone)]
pub(super) struct Header {
    /// Number of columns.
    pub(super) width: usize,
    /// The columns that the program reads, from the left.
    pub(super) headings: Vec<Heading>,
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

    /// The column in a message.
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

/// Refuses a first row of numbers only, or with other separators than commas.
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

/// Refuses a second column of a quantity.
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

/// The one column of `quantity`, if there is one, among any other columns.
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
