use crate::numeric::{Dimension, Unit};

use super::table_error::{Place, TableError, quoted};

/// What a column of a trajectory holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Acceleration,
    Velocity,
    Displacement,
    /// Displacement over the link's length.
    Angle,
}

impl Quantity {
    const ALL: [Self; 5] =
        [Self::Time, Self::Acceleration, Self::Velocity, Self::Displacement, Self::Angle];

    fn word(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Acceleration => "acceleration",
            Self::Velocity => "velocity",
            Self::Displacement => "displacement",
            Self::Angle => "angle",
        }
    }

    /// The word with this program's own suffix.
    fn suffixed(self) -> &'static str {
        match self {
            Self::Time => "time_s",
            Self::Acceleration => "acceleration_m_s2",
            Self::Velocity => "velocity_m_s",
            Self::Displacement => "displacement_m",
            Self::Angle => "angle_rad",
        }
    }

    fn dimension(self) -> Dimension {
        match self {
            Self::Time => Dimension::TIME,
            Self::Acceleration => Dimension::ACCELERATION,
            Self::Velocity => Dimension::VELOCITY,
            Self::Displacement => Dimension::LENGTH,
            Self::Angle => Dimension::NONE,
        }
    }

    /// The SI unit, and another that is much used.
    fn units(self) -> [&'static str; 2] {
        match self {
            Self::Time => ["s", "ms"],
            Self::Acceleration => ["m/s^2", "cm/s^2"],
            Self::Velocity => ["m/s", "cm/s"],
            Self::Displacement => ["m", "cm"],
            Self::Angle => ["rad", "deg"],
        }
    }
}

/// One column's heading.
#[derive(Debug, Clone)]
pub(super) struct Heading {
    pub(super) quantity: Quantity,
    /// The name as written, without the unit in brackets.
    pub(super) name: String,
    /// The unit as written, or the SI unit.
    pub(super) unit_text: String,
    /// `None`: SI.
    unit: Option<Unit>,
}

impl Heading {
    /// A value of this column in SI.
    pub(super) fn to_si(&self, value: f64) -> f64 {
        self.unit.as_ref().map_or(value, |unit| unit.to_si(value))
    }
}

/// Reads the row that names the columns, and checks that together they describe a motion.
pub(super) fn read_header(fields: &[&str], place: Place) -> Result<Vec<Heading>, TableError> {
    if fields.iter().all(|field| field.parse::<f64>().is_ok()) {
        let must = "must name the columns";
        let hint =
            "begin with a row like time,acceleration; a line that starts with # is a comment";
        return Err(place
            .refuse("first row", quoted(&fields.join(",")), must)
            .with_hint(hint.to_owned()));
    }
    if let [field] = fields
        && field.contains([';', '\t'])
    {
        let must = "must name columns that are separated by commas";
        let hint = "separate the columns with commas";
        return Err(place.refuse("first row", quoted(field), must).with_hint(hint.to_owned()));
    }
    let mut headings: Vec<Heading> = Vec::new();
    for (index, field) in fields.iter().enumerate() {
        let heading = read_heading(field, index, place)?;
        refuse_double(&headings, &heading, place)?;
        headings.push(heading);
    }
    refuse_missing(&headings, place)?;
    Ok(headings)
}

fn read_heading(field: &str, index: usize, place: Place) -> Result<Heading, TableError> {
    let (name, unit_text) = match field.strip_suffix(']').and_then(|f| f.split_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (field, None),
    };
    let lower = name.to_lowercase();
    let plain = lower.strip_prefix("tip_").unwrap_or(&lower);
    let known = Quantity::ALL.into_iter().find_map(|quantity| {
        let suffixed = plain == quantity.suffixed();
        (suffixed || plain == quantity.word()).then_some((quantity, suffixed))
    });
    let Some((quantity, suffixed)) = known else {
        return Err(unknown_column(field, plain, index, place));
    };
    if let (true, Some(unit)) = (suffixed, unit_text) {
        let must = format!("must not stand beside the unit that {name} names itself");
        return Err(place.refuse(format!("unit of {name}"), quoted(unit), must));
    }
    let unit = unit_text.map(|text| read_unit(text, name, quantity, place)).transpose()?;
    Ok(Heading {
        quantity,
        name: name.to_owned(),
        unit_text: unit_text.unwrap_or(quantity.units()[0]).to_owned(),
        unit,
    })
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

fn unknown_column(field: &str, plain: &str, index: usize, place: Place) -> TableError {
    let subject = format!("column {}", index + 1);
    let words = Quantity::ALL.map(Quantity::word);
    let must = format!("must be one of {}", words.join(", "));
    place.refuse(subject, quoted(field), must).with_hint(hint_for(plain))
}

/// What the user may have meant by a name that is not known.
fn hint_for(name: &str) -> Option<String> {
    /// Likeness, from 0 to 1, from which a name is taken for a slip or an abbreviation.
    const ALIKE: f64 = 0.7;
    if name.is_empty() {
        return Some("a comma at the end of the row begins a column of its own".to_owned());
    }
    if name.starts_with("hub_") {
        return Some("a trajectory holds the tip's motion; the hub's follows from it".to_owned());
    }
    let begins = |quantity: &Quantity| {
        let rest = name.strip_prefix(quantity.word());
        rest.is_some_and(|rest| rest.starts_with(['_', '(', '[', ' ']))
    };
    if let Some(quantity) = Quantity::ALL.into_iter().find(begins) {
        let [_, unit] = quantity.units();
        let word = quantity.word();
        return Some(format!("a unit follows in brackets: {word} [{unit}]"));
    }
    let likeness = |quantity: Quantity| strsim::jaro_winkler(name, quantity.word());
    let ranked = Quantity::ALL.map(|quantity| (likeness(quantity), quantity.word()));
    let (best, word) = ranked.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best > ALIKE).then(|| format!("did you mean {word}?"))
}

/// Refuses a column that says what one before it says.
fn refuse_double(before: &[Heading], heading: &Heading, place: Place) -> Result<(), TableError> {
    let arc = |quantity| matches!(quantity, Quantity::Displacement | Quantity::Angle);
    let twice = before.iter().enumerate().find(|(_, earlier)| {
        let both_arcs = arc(earlier.quantity) && arc(heading.quantity);
        both_arcs || earlier.quantity == heading.quantity
    });
    let Some((index, earlier)) = twice else {
        return Ok(());
    };
    let subject = format!("column {}", before.len() + 1);
    let same = format!("column {}, {}", index + 1, quoted(&earlier.name));
    let found = quoted(&heading.name);
    if earlier.quantity == heading.quantity {
        let must = format!("must not repeat {same}");
        return Err(place.refuse(subject, found, must));
    }
    let must = format!("must not stand beside {same}: they are two names of one thing");
    let hint = "displacement = angle * link length; keep one of them";
    Err(place.refuse(subject, found, must).with_hint(hint.to_owned()))
}

fn refuse_missing(headings: &[Heading], place: Place) -> Result<(), TableError> {
    let has = |wanted| headings.iter().any(|heading| heading.quantity == wanted);
    let names: Vec<&str> = headings.iter().map(|h| h.name.as_str()).collect();
    let refuse = |must| Err(place.refuse("columns", quoted(&names.join(",")), must));
    if !has(Quantity::Time) {
        return refuse("must include time");
    }
    let moves = has(Quantity::Acceleration) || has(Quantity::Displacement) || has(Quantity::Angle);
    if !moves {
        return refuse("must include acceleration, displacement or angle");
    }
    Ok(())
}
