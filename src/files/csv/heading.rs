//! Headings of columns: the quantity and its unit.

use super::clock::{ClockTime, CountUnit};
use super::input::{Place, TableError, quoted};
use super::unit_name::{UnitName, parse_unit, split_any_unit, split_unit};
use crate::numeric::{Dimension, Unit, reads_as_unit};

/// A quantity that a column may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Quantity {
    /// Standard name, without prefix and unit.
    pub(super) word: &'static str,
    /// Ending of a name with the SI unit, as this program writes it.
    suffix: &'static str,
    pub(super) dimension: Dimension,
    /// The SI unit, and another common one.
    pub(super) units: [&'static str; 2],
    /// Other names used by instruments and people, in lower case.
    aliases: &'static [&'static str],
}

pub(super) const fn quantity(
    word: &'static str,
    suffix: &'static str,
    dimension: Dimension,
    units: [&'static str; 2],
) -> Quantity {
    Quantity { word, suffix, dimension, units, aliases: &[] }
}

pub(super) const TIME: Quantity = quantity("time", "_s", Dimension::TIME, ["s", "ms"]).or(&[
    "t",
    "zeit",
    "temps",
    "timestamp",
    "elapsed_time",
    "x_value",
    "uhrzeit",
    "zeitstempel",
    "heure",
    "horodatage",
    "datetime",
    "date_time",
]);
pub(super) const ACCELERATION: Quantity =
    quantity("acceleration", "_m_s2", Dimension::ACCELERATION, ["m/s^2", "cm/s^2"]).or(&[
        "a",
        "acc",
        "accel",
        "beschleunigung",
        "accélération",
    ]);
pub(super) const VELOCITY: Quantity =
    quantity("velocity", "_m_s", Dimension::VELOCITY, ["m/s", "cm/s"]).or(&[
        "v",
        "vel",
        "speed",
        "geschwindigkeit",
        "vitesse",
    ]);
pub(super) const DISPLACEMENT: Quantity =
    quantity("displacement", "_m", Dimension::LENGTH, ["m", "cm"]).or(&[
        "x",
        "disp",
        "pos",
        "position",
        "weg",
        "déplacement",
    ]);
/// Displacement divided by the length of the link.
pub(super) const ANGLE: Quantity =
    quantity("angle", "_rad", Dimension::NONE, ["rad", "deg"]).or(&["winkel"]);
pub(super) const TORQUE: Quantity = quantity("torque", "_n_m", Dimension::TORQUE, ["N m", "N cm"])
    .or(&["tau", "trq", "drehmoment", "couple"]);
pub(super) const HUB_ANGLE: Quantity =
    quantity("hub_angle", "_rad", Dimension::NONE, ["rad", "deg"]);
pub(super) const HUB_RATE: Quantity =
    quantity("hub_rate", "_rad_s", Dimension::RATE, ["rad/s", "deg/s"]);
/// Force on a carriage, and its position and velocity.
pub(super) const FORCE: Quantity =
    quantity("force", "_n", Dimension::FORCE, ["N", "kN"]).or(&["kraft"]);
pub(super) const CARRIAGE: Quantity = quantity("carriage", "_m", Dimension::LENGTH, ["m", "mm"]);
pub(super) const CARRIAGE_VELOCITY: Quantity =
    quantity("carriage_velocity", "_m_s", Dimension::VELOCITY, ["m/s", "mm/s"]);

/// Displacement of the tip besides other channels of a recording.
pub(super) const TIP: Quantity = quantity("tip", "_m", Dimension::LENGTH, ["m", "cm"]);
/// Tip deflection from the hub's tangent line, after the prefix of the tip.
pub(super) const DEFLECTION: Quantity =
    quantity("deflection", "_m", Dimension::LENGTH, ["m", "cm"]);
pub(super) const ROOT_STRAIN: Quantity =
    quantity("root_strain", "_1", Dimension::NONE, ["1", "um/m"]);
/// Voltage, which is no unit of the link's mechanics: V counts as a pure number here.
pub(super) const VOLTAGE: Quantity = quantity("voltage", "_v", Dimension::NONE, ["V", "mV"]);

/// Columns of a frequency response. Their units are those of the response.
pub(super) const FREQUENCY: Quantity =
    quantity("frequency", "_hz", Dimension::RATE, ["Hz", "rad/s"]).or(&[
        "f",
        "freq",
        "frequenz",
        "fréquence",
    ]);
pub(super) const REAL: Quantity = quantity("real", "_1", Dimension::NONE, ["1", "1"]).or(&["re"]);
pub(super) const IMAGINARY: Quantity =
    quantity("imaginary", "_1", Dimension::NONE, ["1", "1"]).or(&["imag", "im"]);
pub(super) const GAIN: Quantity =
    quantity("gain", "_1", Dimension::NONE, ["1", "dB"]).or(&["magnitude", "mag", "amplitude"]);
pub(super) const PHASE: Quantity = quantity("phase", "_rad", Dimension::NONE, ["rad", "deg"]);

/// Places of an arm's tip.
pub(super) const PATH_X: Quantity = quantity("x", "_m", Dimension::LENGTH, ["m", "mm"]);
pub(super) const PATH_Y: Quantity = quantity("y", "_m", Dimension::LENGTH, ["m", "mm"]);
/// Directions of an arm's links.
pub(super) const ANGLES: [Quantity; 9] = nine(
    ["angle1", "angle2", "angle3", "angle4", "angle5", "angle6", "angle7", "angle8", "angle9"],
    quantity("", "_rad", Dimension::NONE, ["rad", "deg"]),
);
/// Angles of an arm's joints.
pub(super) const JOINTS: [Quantity; 9] = nine(
    ["joint1", "joint2", "joint3", "joint4", "joint5", "joint6", "joint7", "joint8", "joint9"],
    quantity("", "_rad", Dimension::NONE, ["rad", "deg"]),
);
/// Rates of an arm's joints.
pub(super) const JOINT_RATES: [Quantity; 9] = nine(
    [
        "joint1_rate",
        "joint2_rate",
        "joint3_rate",
        "joint4_rate",
        "joint5_rate",
        "joint6_rate",
        "joint7_rate",
        "joint8_rate",
        "joint9_rate",
    ],
    quantity("", "_rad_s", Dimension::RATE, ["rad/s", "deg/s"]),
);
/// Torques of an arm's joints.
pub(super) const JOINT_TORQUES: [Quantity; 9] = nine(
    [
        "torque1", "torque2", "torque3", "torque4", "torque5", "torque6", "torque7", "torque8",
        "torque9",
    ],
    quantity("", "_n_m", Dimension::TORQUE, ["N m", "N cm"]),
);

/// Copies a quantity for each link or joint.
pub(super) const fn nine(words: [&'static str; 9], of: Quantity) -> [Quantity; 9] {
    let mut each = [of; 9];
    let mut number = 0;
    while number < 9 {
        each[number].word = words[number];
        number += 1;
    }
    each
}

/// Joins lists of quantities.
pub(super) const fn joined<const N: usize>(lists: &[&[Quantity]]) -> [Quantity; N] {
    let mut all = [TIME; N];
    let (mut at, mut list) = (0, 0);
    while list < lists.len() {
        let mut item = 0;
        while item < lists[list].len() {
            all[at] = lists[list][item];
            (at, item) = (at + 1, item + 1);
        }
        list += 1;
    }
    all
}

/// All quantities that an option may name.
pub(super) fn all_quantities() -> impl Iterator<Item = Quantity> {
    let of_links = [ANGLES, JOINTS, JOINT_RATES, JOINT_TORQUES];
    QUANTITIES.into_iter().chain([TIP]).chain(of_links.into_iter().flatten())
}

/// Quantities that an option may name, besides those of an arm's links.
pub(super) const QUANTITIES: [Quantity; 21] = [
    TIME,
    ACCELERATION,
    VELOCITY,
    DISPLACEMENT,
    ANGLE,
    TORQUE,
    HUB_ANGLE,
    HUB_RATE,
    FORCE,
    CARRIAGE,
    CARRIAGE_VELOCITY,
    DEFLECTION,
    ROOT_STRAIN,
    VOLTAGE,
    PATH_X,
    PATH_Y,
    FREQUENCY,
    REAL,
    IMAGINARY,
    GAIN,
    PHASE,
];

impl Quantity {
    const fn or(self, aliases: &'static [&'static str]) -> Self {
        Self { aliases, ..self }
    }

    /// True if numbers of this quantity may have the unit. Only angles take rad and deg, which are pure numbers as strains
    /// are. A voltage, which counts as a pure number here, takes no unit.
    pub(super) fn takes(self, unit: &UnitName) -> bool {
        let is_angle = |text: &str| text.contains("rad") || text.contains("deg") || text == "°";
        let of_angle = is_angle(self.units[0]) == is_angle(&unit.text) && self != VOLTAGE;
        let dimension = unit.unit.dimension();
        dimension == self.dimension && (dimension != Dimension::NONE || of_angle)
    }

    /// True if the name ends with the suffix of the SI unit.
    pub(super) fn is_suffixed(self, name: &str) -> bool {
        name.to_lowercase().ends_with(self.suffix)
    }
}

/// Possible columns of a kind of table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vocabulary {
    pub(super) quantities: &'static [Quantity],
    /// Optional prefix of any name.
    pub(super) prefix: &'static str,
    /// Example of a row of names.
    pub(super) example: &'static str,
    /// Remedy for two columns of one quantity.
    pub(super) choice: Option<&'static str>,
    /// Option that assigns columns.
    pub(super) by_option: &'static str,
}

impl Vocabulary {
    /// No quantities, in a table that options do not describe.
    pub(super) const NONE: Self = Self {
        quantities: &[],
        prefix: "",
        example: "",
        choice: Some("rename one of them"),
        by_option: "",
    };

    /// The name in lower case, without the prefix. output.csv has another prefix than tip.csv.
    pub(super) fn plain(&self, name: &str) -> String {
        let lower = name.to_lowercase();
        let output = Some("output_").filter(|_| self.prefix == "tip_");
        let mut prefixes = [Some(self.prefix), output].into_iter().flatten();
        let plain = prefixes.find_map(|prefix| lower.strip_prefix(prefix));
        plain.map_or_else(|| lower.clone(), str::to_owned)
    }

    /// Spelling of a quantity in a heading, if it names the quantity.
    pub(super) fn spelling(&self, field: &str, quantity: Quantity) -> Option<Spelling> {
        let name = split_unit(field).0;
        // The prefix may also be the word: tip_m.
        for plain in [self.plain(name), name.to_lowercase()] {
            match plain.strip_prefix(quantity.word) {
                Some("") => return Some(Spelling::Exact),
                Some(ending) if ending == quantity.suffix => return Some(Spelling::Suffixed),
                _ => {}
            }
        }
        let words = split_any_unit(field).0.replace([' ', '-'], "_");
        let plain = self.plain(&words);
        let is_word = plain == quantity.word;
        (is_word || quantity.aliases.contains(&plain.as_str())).then_some(if is_word {
            Spelling::Free
        } else {
            Spelling::Alias
        })
    }

    /// The columns that name quantities, each quantity in its best spelling. `is_sought` decides whether a quantity counts
    /// in some spellings, from the columns found in better ones.
    ///
    /// # Errors
    /// [`TableError`] if two columns name a quantity alike.
    pub(super) fn columns(
        &self,
        (fields, place): (&[&str], Place),
        is_sought: impl Fn(Quantity, &[Spelling], &[NamedColumn]) -> bool,
    ) -> Result<Vec<NamedColumn>, TableError> {
        let mut found: Vec<NamedColumn> = Vec::new();
        for ways in WAYS {
            for &quantity in self.quantities {
                let is_found = found.iter().any(|(own, ..)| *own == quantity);
                if !is_found && is_sought(quantity, ways, &found) {
                    let column = self.column(fields, quantity, ways, place)?;
                    found.extend(column.map(|(index, way)| (quantity, index, way)));
                }
            }
        }
        Ok(found)
    }

    /// The only column that names a quantity in one of these spellings, with its spelling.
    ///
    /// # Errors
    /// [`TableError`] if there are two.
    fn column(
        &self,
        fields: &[&str],
        quantity: Quantity,
        ways: &[Spelling],
        place: Place,
    ) -> Result<Option<(usize, Spelling)>, TableError> {
        let spelt = |(index, field): (usize, &&str)| {
            let way = self.spelling(field, quantity).filter(|way| ways.contains(way))?;
            Some((index, way))
        };
        let mut found = fields.iter().enumerate().filter_map(spelt);
        let first = found.next();
        let (Some((earlier, _)), Some((index, _))) = (first, found.next()) else {
            return Ok(first);
        };
        let name = split_unit(fields[index]).0;
        let must = format!("must not repeat {}", named(earlier, split_unit(fields[earlier]).0));
        let word = quantity.word;
        let by_number = format!("--columns {word}={} reads the first of them", earlier + 1);
        let by_option = quantity == TIME && !self.by_option.is_empty();
        let choice = self.choice.filter(|_| !by_option);
        let hint = choice.map_or(by_number, str::to_owned);
        Err(place.refuse_column(index, name, must).with_hint(hint))
    }

    /// Refuses a first row of numbers only.
    pub(super) fn check_names(&self, fields: &[&str], place: Place) -> Result<(), TableError> {
        if !fields.iter().all(|field| field.parse::<f64>().is_ok()) {
            return Ok(());
        }
        let begin = format!("begin with a row like {}", self.example);
        let hint = format!("{begin}; a line that starts with # is a comment; {}", self.by_option);
        let hint = hint.trim_end_matches("; ").to_owned();
        let found = quoted(&fields.join(","));
        Err(place.refuse("first row", found, "must name the columns").with_hint(hint))
    }
}

/// Spelling of a quantity in a heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Spelling {
    /// The standard word, with or without a unit in square brackets.
    Exact,
    /// The standard word with the suffix of the SI unit, `torque_n_m`.
    Suffixed,
    /// The standard word with a unit in parentheses, or in several words, `Hub angle (deg)`.
    Free,
    /// Another name, `pos [mm]`.
    Alias,
}

/// Spellings in the order of the search.
const WAYS: [&[Spelling]; 3] =
    [&[Spelling::Exact, Spelling::Suffixed], &[Spelling::Free], &[Spelling::Alias]];

/// A quantity with the column that names it, and the spelling.
pub(super) type NamedColumn = (Quantity, usize, Spelling);

/// The heading of a quantity, if the table has one.
pub(super) fn find(headings: &[Heading], quantity: Quantity) -> Option<&Heading> {
    headings.iter().find(|heading| heading.quantity == quantity)
}

/// The user's unit and factor for the numbers of a column.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Measure<'a> {
    pub(super) unit: Option<&'a UnitName>,
    /// Factor on the numbers of the file, before their unit.
    pub(super) factor: Option<f64>,
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
    /// True for times of a rate of samples, which are no column.
    pub(super) is_counted: bool,
    /// True if the table or the user names the unit.
    has_unit: bool,
    /// Unit of the column; `None` for SI.
    unit: Option<Unit>,
    factor: Option<f64>,
}

impl Heading {
    /// Reads the heading of a column of `quantity`; a `suffixed` name contains the SI unit.
    pub(super) fn of(
        index: usize,
        field: &str,
        quantity: Quantity,
        suffixed: bool,
        measure: Measure,
        place: Place,
    ) -> Result<Self, TableError> {
        let (name, unit_text) = if suffixed { split_unit(field) } else { split_any_unit(field) };
        if let (true, Some(unit)) = (suffixed, unit_text) {
            let must = format!("must be left out: the name {name} has its unit");
            return Err(place.refuse(format!("unit of {name}"), quoted(unit), must));
        }
        let unit_text = if suffixed { Some(quantity.units[0]) } else { unit_text };
        // A pattern such as hh:mm:ss describes times of day.
        let unit_text = unit_text.filter(|text| quantity != TIME || !text.contains(':'));
        let own = unit_text.map(|text| read_unit(text, name, quantity, place)).transpose();
        let own = match own {
            // An unknown unit, such as counts: the user's factor or unit converts it.
            Err(_) if measure.unit.is_some() || measure.factor.is_some() => None,
            own => own?,
        };
        if let (Some(own), Some(given), Some(text)) = (own, measure.unit, unit_text)
            && own != given.unit
        {
            let must = format!("must be {}, as the options say", quoted(&given.text));
            let error = place.refuse(format!("unit of {name}"), quoted(text), must);
            return Err(error.with_hint("leave the option out, or correct the heading".to_owned()));
        }
        let own_text = unit_text.filter(|_| own.is_some());
        let text = own_text.or(measure.unit.map(|given| given.text.as_str()));
        Ok(Self {
            index,
            quantity,
            name: name.to_owned(),
            unit_text: text.unwrap_or(quantity.units[0]).to_owned(),
            is_counted: false,
            has_unit: text.is_some(),
            unit: own.filter(|_| !suffixed).or(measure.unit.map(|given| given.unit)),
            factor: measure.factor,
        })
    }

    /// The time of a table without times, at a rate of samples.
    pub(super) fn counted(index: usize) -> Self {
        Self {
            index,
            quantity: TIME,
            name: TIME.word.to_owned(),
            unit_text: TIME.units[0].to_owned(),
            is_counted: true,
            has_unit: false,
            unit: None,
            factor: None,
        }
    }

    /// The heading of numbers that count steps of this size.
    pub(super) fn counting(self, step: f64) -> Self {
        Self { factor: Some(step), ..self }
    }

    /// Takes the unit that stands in the fields of a column of times, if nothing else names one.
    pub(super) fn takes_unit(&mut self, text: &str) -> bool {
        let unit = parse_unit(text).ok().filter(|unit| unit.dimension() == Dimension::TIME);
        let is_new = unit.is_some() && !self.has_measure();
        if is_new {
            text.clone_into(&mut self.unit_text);
            (self.unit, self.has_unit) = (unit, true);
        }
        is_new
    }

    /// True if the table or the user names a unit or a factor.
    pub(super) fn has_measure(&self) -> bool {
        self.has_unit || self.factor.is_some()
    }

    /// The instant of a count of s, ms, us, ns or days that began long ago, as loggers and spreadsheets write it: in one
    /// number a time would lose digits.
    ///
    /// In the first row, which has `notes`, a time without a unit is in ms, us or ns if this makes it 28 to 133 years. As
    /// seconds it would be 30000 years or more.
    pub(super) fn instant(
        &mut self,
        (field, number): (&str, f64),
        notes: Option<&mut Vec<String>>,
    ) -> Option<ClockTime> {
        /// Digits that are exact in a float, and s of 28 and of 133 years.
        const EXACT: usize = 15;
        const FAR_S: f64 = 883_612_800.0;
        const FARTHEST_S: f64 = 4.2e9;
        let units = [("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
        let is_of = |(_, unit_s): &(&str, f64)| (FAR_S..FARTHEST_S).contains(&(number * unit_s));
        if let (Some(notes), false) = (notes, self.has_measure())
            && let Some((unit, _)) = units.into_iter().find(is_of)
        {
            self.unit = parse_unit(unit).ok();
            unit.clone_into(&mut self.unit_text);
            notes.push(format!("time in {unit} since 1970, by its size"));
        }
        let unit_s = self.to_si(1.0);
        let unit = CountUnit::of_seconds(unit_s)?;
        let (whole, decimals) = field.split_once('.').unwrap_or((field, ""));
        let are_digits =
            [whole, decimals].iter().all(|own| own.bytes().all(|own| own.is_ascii_digit()));
        if !are_digits || whole.len() <= EXACT && number * unit_s < FAR_S {
            return None;
        }
        let count = (whole.parse().ok()?, format!("0.{decimals}").parse().ok()?);
        Some(ClockTime::of_count(format!("{field} {}", self.unit_text), count, unit))
    }

    /// Converts a value of this column to SI.
    pub(super) fn to_si(&self, value: f64) -> f64 {
        let value = self.factor.map_or(value, |factor| factor * value);
        self.unit.as_ref().map_or(value, |unit| unit.to_si(value))
    }

    /// Description of the column in messages: `column 2, "torque"`.
    pub(super) fn named(&self) -> String {
        named(self.index, &self.name)
    }
}

fn named(index: usize, name: &str) -> String {
    format!("column {}, {}", index + 1, quoted(name))
}

fn read_unit(text: &str, name: &str, quantity: Quantity, place: Place) -> Result<Unit, TableError> {
    let refuse = |hint| {
        let must = format!("must be a unit such as {}", quantity.units.join(" or "));
        place.refuse(format!("unit of {name}"), quoted(text), must).with_hint(hint)
    };
    if text.is_empty() {
        return Err(refuse(None));
    }
    let text = match text {
        _ if quantity != VOLTAGE => text,
        "V" | "Volt" => "1",
        "mV" => "mm/m",
        _ => return Err(refuse(None)),
    };
    let unit = parse_unit(text).map_err(|error| refuse(error.hint()))?;
    if unit.dimension() == quantity.dimension { Ok(unit) } else { Err(refuse(None)) }
}

/// The last word of a name without a unit in brackets, if it looks like a unit other than the suffix of the SI unit:
/// `torque_n_cm`, `pos_mm`. Such a column may not be in SI.
pub(super) fn unread_unit(field: &str, quantity: Quantity) -> Option<&str> {
    let (name, unit) = split_unit(field);
    if unit.is_some() || quantity.is_suffixed(name) {
        return None;
    }
    let mut words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    words.next()?;
    words.next_back().filter(|word| reads_as_unit(word))
}

/// Refuses a first row with other separators than commas.
pub(crate) fn check_separator(fields: &[&str], place: Place) -> Result<(), TableError> {
    // Such a row may also contain commas, as decimal signs.
    if let Some(field) = fields.iter().find(|field| field.contains([';', '\t'])) {
        let must = "must name columns that are separated by commas";
        let hint = "separate the columns with commas".to_owned();
        return Err(place.refuse("first row", quoted(field), must).with_hint(hint));
    }
    Ok(())
}

/// The names of all columns, without their units in square brackets.
pub(super) fn names<'a>(fields: &[&'a str]) -> Vec<&'a str> {
    fields.iter().map(|field| split_unit(field).0).collect()
}

/// Error for columns without the `wanted` one; the hint names a column that may be a misspelling of it.
pub(crate) fn refuse_missing(names: &[&str], wanted: &str, place: Place) -> TableError {
    let must = format!("must include {wanted}");
    // A slip changes a letter or two.
    let is_slip = |name: &&&str| name.len().abs_diff(wanted.len()) <= 2;
    let near = nearest(wanted, names.iter().filter(is_slip).copied());
    let hint = near.map(|name| format!("did you write {wanted} as {}?", quoted(name)));
    place.refuse("columns", quoted(&names.join(",")), must).with_hint(hint)
}

/// The word most similar to `name`, if one is similar.
pub(super) fn nearest<'a>(name: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Letters of a name that is more than a slip.
    const SHORTEST: usize = 3;
    let lower = name.to_lowercase();
    let slips = |word: &str| strsim::damerau_levenshtein(&lower, word);
    let ranked = words.into_iter().map(|word| (word, word.to_lowercase()));
    let (word, own) = ranked.min_by_key(|(_, own)| slips(own))?;
    let is_begun = own.starts_with(&lower) || lower.starts_with(&own);
    let is_short = lower.len().min(own.len()) < SHORTEST;
    // A letter in three may be wrong.
    (!is_short && (is_begun || 3 * slips(&own) <= lower.len().max(own.len()))).then_some(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pure_numbers_have_units_of_their_own() {
        for (unit, takes) in [("deg", [true, false, false]), ("um/m", [false, true, false])] {
            let unit = unit.parse().unwrap();
            assert_eq!([HUB_ANGLE, ROOT_STRAIN, VOLTAGE].map(|own| own.takes(&unit)), takes);
        }
    }
}
