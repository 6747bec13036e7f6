//! Values with their unit as text, such as `"5e4 N cm^2"`, and their conversion to SI.

use std::f64::consts::PI;

use thiserror::Error;

use crate::text::{excerpt, visible};

/// A unit, such as `N m^2` or `kg/m`: a factor to SI and a dimension.
///
/// Blanks, `*`, `·` or `⋅` separate factors; a power is written `^2`, `^-1`, `**2` or `²`; one `/` may precede the last
/// factor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Unit {
    /// Factor without its power of ten, so that 135 cm is 1.35 m to the last bit.
    coefficient: f64,
    exponent: i32,
    dimension: Dimension,
}

impl Unit {
    /// Reads a unit.
    ///
    /// ```
    /// use flexlink::numeric::{Dimension, Unit};
    /// let unit = Unit::parse("N cm^2")?;
    /// assert_eq!(unit.dimension(), Dimension::BENDING_STIFFNESS);
    /// assert_eq!(unit.to_si(5e4), 5.0);
    /// # Ok::<(), flexlink::numeric::UnitError>(())
    /// ```
    ///
    /// # Errors
    /// [`UnitError`] for an unknown unit, more than one unit below the stroke, or no unit at all.
    pub fn parse(text: &str) -> Result<Self, UnitError> {
        let malformed = || UnitError::Malformed { unit: text.trim().into() };
        let plain = text.trim().replace("**", "^");
        let (above, below) = match plain.split_once('/') {
            Some((above, below)) => (above.trim(), Some(below.trim())),
            None => (plain.as_str(), None),
        };
        // A stroke may have nothing above it: `/s`.
        let above = if above.is_empty() && below.is_some() { vec![] } else { factors(above) };
        let mut powers: Vec<(&str, i8)> = above.into_iter().map(|factor| (factor, 1)).collect();
        if let Some(below) = below {
            let [factor] = factors(below)[..] else { return Err(UnitError::Ambiguous) };
            if below.contains('/') {
                return Err(UnitError::Ambiguous);
            }
            powers.push((factor, -1));
        }
        let mut unit = Self { coefficient: 1.0, exponent: 0, dimension: Dimension::NONE };
        for (factor, sign) in powers {
            let (word, power) = word_and_power(factor).ok_or_else(malformed)?;
            let found = known(word).ok_or_else(|| UnitError::UnknownUnit {
                unit: word.into(),
                nearest: nearest(word),
            })?;
            let power = power.checked_mul(sign).ok_or_else(malformed)?;
            unit.coefficient *= found.coefficient.powi(power.into());
            unit.exponent += found.exponent * i32::from(power);
            unit.dimension = unit.dimension.times(found.dimension, power).ok_or_else(malformed)?;
        }
        // The unit `um^60 m^-59` is a length, but its factor underflows.
        let is_in_range = unit.coefficient.is_normal() && unit.to_si(1.0).is_normal();
        if is_in_range { Ok(unit) } else { Err(malformed()) }
    }

    /// Converts `value` in this unit to SI.
    pub fn to_si(&self, value: f64) -> f64 {
        let product = if self.coefficient.to_bits() == 1.0_f64.to_bits() {
            value
        } else {
            value * self.coefficient
        };
        // Powers of ten up to 22 are exact, negative powers are not.
        let scale = 10.0_f64.powi(self.exponent.abs());
        if self.exponent < 0 { product / scale } else { product * scale }
    }

    /// Dimension of the unit.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }
}

/// Factors of a product; an empty one where a sign of multiplication lacks a factor.
fn factors(product: &str) -> Vec<&str> {
    let mut found = Vec::new();
    for part in product.split(['*', '·', '⋅']) {
        let before = found.len();
        found.extend(part.split_whitespace());
        if found.len() == before {
            found.push("");
        }
    }
    found
}

/// Splits `cm^2` or `cm²` into word and power.
fn word_and_power(factor: &str) -> Option<(&str, i8)> {
    let end = factor.find(|c| c == '^' || superscript(c).is_some()).unwrap_or(factor.len());
    let (word, power) = factor.split_at(end);
    if word.is_empty() || !word.chars().all(char::is_alphanumeric) {
        return None;
    }
    let power = match power.strip_prefix('^') {
        _ if power.is_empty() => 1,
        Some(digits) => digits.parse().ok()?,
        None => {
            let digits: Option<String> = power.chars().map(superscript).collect();
            digits?.parse().ok()?
        }
    };
    Some((word, power))
}

/// The digit or sign of a superscript.
fn superscript(c: char) -> Option<char> {
    const RAISED: [char; 11] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹', '⁻'];
    let place = RAISED.iter().position(|raised| *raised == c)?;
    "0123456789-".chars().nth(place)
}

/// SI value of text such as `"150 cm"`, which must have the expected dimension.
///
/// ```
/// use flexlink::numeric::{Dimension, parse_quantity};
/// assert_eq!(parse_quantity("150 cm", Dimension::LENGTH), Ok(1.5));
/// assert!(parse_quantity("150 kg", Dimension::LENGTH).is_err());
/// ```
///
/// # Errors
/// [`UnitError`] for a wrong number, unit or dimension.
pub fn parse_quantity(text: &str, expected: Dimension) -> Result<f64, UnitError> {
    let (number, unit) = split_number(text).ok_or(UnitError::NotANumber)?;
    let unit = unit.trim();
    let value = if unit.is_empty() {
        if expected != Dimension::NONE {
            return Err(UnitError::NoUnit { expected });
        }
        number
    } else {
        let parsed = Unit::parse(unit)?;
        if parsed.dimension() != expected {
            return Err(UnitError::WrongDimension {
                unit: unit.into(),
                found: parsed.dimension(),
                expected,
            });
        }
        if expected == Dimension::RATE && may_count_turns(unit) {
            return Err(UnitError::TurnsOrRadians { unit: unit.into() });
        }
        parsed.to_si(number)
    };
    if value.is_finite() { Ok(value) } else { Err(UnitError::NotFinite) }
}

/// Frequency in Hz of text such as `"2.52 Hz"`, with Hz, kHz, MHz, rad/s or rpm. As a [`Dimension::RATE`] a hertz would be
/// a radian per second.
pub(crate) fn parse_hertz(text: &str) -> Option<f64> {
    let (number, unit) = split_number(text)?;
    let hertz = match unit.trim() {
        "Hz" => 1.0,
        "kHz" => 1e3,
        "MHz" => 1e6,
        "rad/s" => 0.5 / PI,
        "rpm" => 1.0 / 60.0,
        _ => return None,
    };
    Some(number * hertz)
}

/// Splits off the decimal number at the start of `text`. Returns `None` without a number or if the rest makes it
/// doubtful, as in `1,5` and `1_000`.
pub(crate) fn split_number(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let digits = |from: usize| {
        let tail = text[from..].bytes();
        from + tail.take_while(u8::is_ascii_digit).count()
    };
    let mut end = digits(usize::from(text.starts_with(['+', '-'])));
    if text[end..].starts_with('.') {
        end = digits(end + 1);
    }
    let mut exponent = text[end..].chars();
    if matches!(exponent.next(), Some('e' | 'E')) {
        let sign = usize::from(matches!(exponent.next(), Some('+' | '-')));
        let after = digits(end + 1 + sign);
        if after > end + 1 + sign {
            end = after;
        }
    }
    let (number, rest) = text.split_at(end);
    if rest.starts_with([',', '_', '.', '\'']) {
        return None;
    }
    Some((number.parse().ok()?, rest))
}

/// Error in a quantity or a unit.
///
/// Its text continues a sentence that names the input: `length = "1.5"` *has no unit, but must be a length such as m*.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum UnitError {
    /// The text does not begin with a decimal number.
    #[error("does not begin with a number such as 1.5 or 2e-3")]
    NotANumber,
    /// The number, or its value in SI, is too large.
    #[error("is too large, but must be finite")]
    NotFinite,
    /// A number without a unit where a dimension is expected.
    #[error("has no unit, but must be {}", wanted(*.expected))]
    NoUnit {
        /// Expected dimension.
        expected: Dimension,
    },
    /// A unit of another dimension.
    #[error("is {}, but must be {}", described(.unit, *.found), wanted(*.expected))]
    WrongDimension {
        /// The unit as written.
        unit: String,
        /// Dimension of the unit.
        found: Dimension,
        /// Expected dimension.
        expected: Dimension,
    },
    /// An unknown unit.
    #[error("has the unknown unit `{}`", visible(&excerpt(.unit)))]
    UnknownUnit {
        /// The word as written.
        unit: String,
        /// The known unit spelt most like it, if one is near.
        nearest: Option<&'static str>,
    },
    /// A rate that may count turns.
    #[error("is in {}, which may count turns or radians", visible(&excerpt(.unit)))]
    TurnsOrRadians {
        /// The unit as written.
        unit: String,
    },
    /// More than one unit may belong below the stroke.
    #[error("is ambiguous: only one unit may follow the only `/`")]
    Ambiguous,
    /// No unit, or signs in between that make no sense.
    #[error("has the malformed unit `{}`", visible(&excerpt(.unit)))]
    Malformed {
        /// The unit as written.
        unit: String,
    },
}

impl UnitError {
    /// Suggests a remedy.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::NoUnit { .. } => Some("a number without quotes is in SI units".into()),
            Self::UnknownUnit { unit, nearest } => {
                if let Some([first, second]) = run_together(unit) {
                    return Some(format!("a blank separates units: `{first} {second}`"));
                }
                let bare = unit.trim_end_matches(|c: char| c.is_ascii_digit());
                match nearest {
                    Some(near) if *near == bare => {
                        let power = &unit[bare.len()..];
                        Some(format!("a power is written `{near}^{power}`"))
                    }
                    Some(near) => Some(format!("did you mean `{near}`?")),
                    None => None,
                }
            }
            Self::TurnsOrRadians { .. } => {
                Some("write rpm for turns a minute, or rad/s, deg/s or 1/s".into())
            }
            Self::Ambiguous => Some("use negative powers, as in `kg m^-1 s^-1`".into()),
            Self::Malformed { .. } => Some("units read like `N m^2`, `kg/m` or `1/s`".into()),
            Self::NotANumber => Some("a value with its unwrite it like \"1.5 m\"".into()),
            Self::NotFinite | Self::WrongDimension { .. } => None,
        }
    }
}

fn wanted(dimension: Dimension) -> String {
    let name = dimension.name().unwrap_or("of another dimension");
    match dimension.si_unit() {
        "" => name.into(),
        unit => format!("{name} such as {unit}"),
    }
}

fn described(unit: &str, dimension: Dimension) -> String {
    dimension.name().map_or_else(|| format!("measured in {}", visible(&excerpt(unit))), Into::into)
}

/// Exponents of mass, length, time and electric current in a unit; an angle is a pure number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dimension {
    mass: i8,
    length: i8,
    time: i8,
    current: i8,
}

impl Dimension {
    /// A pure number or an angle.
    pub const NONE: Self = Self::new(0, 0, 0);
    /// m
    pub const LENGTH: Self = Self::new(0, 1, 0);
    /// m²
    pub const AREA: Self = Self::new(0, 2, 0);
    /// m⁴
    pub const SECOND_MOMENT: Self = Self::new(0, 4, 0);
    /// kg
    pub const MASS: Self = Self::new(1, 0, 0);
    /// kg/m
    pub const MASS_PER_LENGTH: Self = Self::new(1, -1, 0);
    /// kg/m³
    pub const DENSITY: Self = Self::new(1, -3, 0);
    /// kg m²
    pub const ROTARY_INERTIA: Self = Self::new(1, 2, 0);
    /// s
    pub const TIME: Self = Self::new(0, 0, 1);
    /// 1/s, also of an angle
    pub const RATE: Self = Self::new(0, 0, -1);
    /// 1/s², also of an angle
    pub const ANGULAR_ACCELERATION: Self = Self::new(0, 0, -2);
    /// m/s
    pub const VELOCITY: Self = Self::new(0, 1, -1);
    /// m/s²
    pub const ACCELERATION: Self = Self::new(0, 1, -2);
    /// N
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Pa
    pub const PRESSURE: Self = Self::new(1, -1, -2);
    /// N m, also per angle
    pub const TORQUE: Self = Self::new(1, 2, -2);
    /// Mass times length.
    pub const ROTARY_INERTIA_PER_LENGTH: Self = Self::new(1, 1, 0);
    /// N m²
    pub const BENDING_STIFFNESS: Self = Self::new(1, 3, -2);
    /// N m s, also per angle
    pub const VISCOUS_FRICTION: Self = Self::new(1, 2, -1);
    /// Force per velocity.
    pub const SLIDING_FRICTION: Self = Self::new(1, 0, -1);
    /// W
    pub const POWER: Self = Self::new(1, 2, -3);
    /// A
    pub const CURRENT: Self = Self::electric(0, 0, 0, 1);
    /// V
    pub const VOLTAGE: Self = Self::electric(1, 2, -3, -1);
    /// Ω
    pub const RESISTANCE: Self = Self::electric(1, 2, -3, -2);
    /// N m/A, also V s per angle
    pub const TORQUE_CONSTANT: Self = Self::electric(1, 2, -2, -1);

    pub(crate) const fn new(mass: i8, length: i8, time: i8) -> Self {
        Self::electric(mass, length, time, 0)
    }

    pub(crate) const fn electric(mass: i8, length: i8, time: i8, current: i8) -> Self {
        Self { mass, length, time, current }
    }

    /// SI unit as this program writes it; empty for a pure number and for a dimension that this program does not use.
    ///
    /// ```
    /// use flexlink::numeric::Dimension;
    /// assert_eq!(Dimension::BENDING_STIFFNESS.si_unit(), "N m^2");
    /// ```
    pub fn si_unit(&self) -> &'static str {
        self.name_and_unit().map_or("", |(_, unit)| unit)
    }

    /// Quantity of this dimension, with its article; `None` for a dimension that this program does not use.
    pub fn name(&self) -> Option<&'static str> {
        self.name_and_unit().map(|(name, _)| name)
    }

    fn name_and_unit(self) -> Option<(&'static str, &'static str)> {
        Some(match self {
            Self::NONE => ("a pure number", ""),
            Self::LENGTH => ("a length", "m"),
            Self::AREA => ("an area", "m^2"),
            Self::SECOND_MOMENT => ("a second moment of area", "m^4"),
            Self::MASS => ("a mass", "kg"),
            Self::MASS_PER_LENGTH => ("a mass per length", "kg/m"),
            Self::DENSITY => ("a density", "kg/m^3"),
            Self::ROTARY_INERTIA => ("a rotary inertia", "kg m^2"),
            Self::ROTARY_INERTIA_PER_LENGTH => ("a rotary inertia per length", "kg m"),
            Self::TIME => ("a time", "s"),
            Self::RATE => ("a rate", "1/s"),
            Self::ANGULAR_ACCELERATION => ("an angular acceleration", "rad/s^2"),
            Self::VELOCITY => ("a velocity", "m/s"),
            Self::ACCELERATION => ("an acceleration", "m/s^2"),
            Self::FORCE => ("a force", "N"),
            Self::PRESSURE => ("a pressure", "Pa"),
            Self::TORQUE => ("a torque", "N m"),
            Self::BENDING_STIFFNESS => ("a bending stiffness", "N m^2"),
            Self::VISCOUS_FRICTION => ("a viscous friction", "N m s/rad"),
            Self::SLIDING_FRICTION => ("a sliding friction", "N s/m"),
            Self::POWER => ("a power", "W"),
            Self::CURRENT => ("a current", "A"),
            Self::VOLTAGE => ("a voltage", "V"),
            Self::RESISTANCE => ("a resistance", "ohm"),
            Self::TORQUE_CONSTANT => ("a torque constant", "N m/A"),
            _ => return None,
        })
    }

    /// Dimension of `self · otherⁿ`; `None` if an exponent overflows.
    pub(super) fn times(self, other: Self, n: i8) -> Option<Self> {
        let exponent = |own: i8, other: i8| own.checked_add(other.checked_mul(n)?);
        Some(Self {
            mass: exponent(self.mass, other.mass)?,
            length: exponent(self.length, other.length)?,
            time: exponent(self.time, other.time)?,
            current: exponent(self.current, other.current)?,
        })
    }
}

/// A single unit: coefficient · 10^exponent of the SI unit.
#[derive(Clone, Copy, Debug)]
struct KnownUnit {
    pub(super) symbol: &'static str,
    /// A whole number wherever the factor is a finite decimal, so that no digit is lost.
    pub(super) coefficient: f64,
    pub(super) exponent: i32,
    pub(super) dimension: Dimension,
}

const fn unit(
    symbol: &'static str,
    coefficient: f64,
    exponent: i32,
    dimension: Dimension,
) -> KnownUnit {
    KnownUnit { symbol, coefficient, exponent, dimension }
}

/// Every unit this program reads.
const KNOWN: [KnownUnit; 51] = [
    unit("m", 1.0, 0, Dimension::LENGTH),
    unit("mm", 1.0, -3, Dimension::LENGTH),
    unit("cm", 1.0, -2, Dimension::LENGTH),
    unit("km", 1.0, 3, Dimension::LENGTH),
    unit("um", 1.0, -6, Dimension::LENGTH),
    unit("µm", 1.0, -6, Dimension::LENGTH),
    unit("in", 254.0, -4, Dimension::LENGTH),
    unit("ft", 3048.0, -4, Dimension::LENGTH),
    unit("kg", 1.0, 0, Dimension::MASS),
    unit("g", 1.0, -3, Dimension::MASS),
    unit("mg", 1.0, -6, Dimension::MASS),
    unit("t", 1.0, 3, Dimension::MASS),
    unit("lb", 45_359_237.0, -8, Dimension::MASS),
    unit("lbm", 45_359_237.0, -8, Dimension::MASS),
    unit("oz", 28_349_523_125.0, -12, Dimension::MASS),
    // lbf s²/ft
    unit("slug", 44_482_216_152_605.0 / 3048.0, -9, Dimension::MASS),
    unit("s", 1.0, 0, Dimension::TIME),
    unit("ms", 1.0, -3, Dimension::TIME),
    unit("us", 1.0, -6, Dimension::TIME),
    unit("µs", 1.0, -6, Dimension::TIME),
    unit("ns", 1.0, -9, Dimension::TIME),
    unit("min", 60.0, 0, Dimension::TIME),
    unit("h", 3600.0, 0, Dimension::TIME),
    unit(DAY, 86_400.0, 0, Dimension::TIME),
    unit("N", 1.0, 0, Dimension::FORCE),
    unit("mN", 1.0, -3, Dimension::FORCE),
    unit("kN", 1.0, 3, Dimension::FORCE),
    unit("MN", 1.0, 6, Dimension::FORCE),
    unit("dyn", 1.0, -5, Dimension::FORCE),
    unit("kgf", 980_665.0, -5, Dimension::FORCE),
    unit("lbf", 44_482_216_152_605.0, -13, Dimension::FORCE),
    unit("ozf", 44_482_216_152_605.0 / 16.0, -13, Dimension::FORCE),
    unit("Pa", 1.0, 0, Dimension::PRESSURE),
    unit("kPa", 1.0, 3, Dimension::PRESSURE),
    unit("MPa", 1.0, 6, Dimension::PRESSURE),
    unit("GPa", 1.0, 9, Dimension::PRESSURE),
    unit("bar", 1.0, 5, Dimension::PRESSURE),
    // lbf/in² and its thousandfold
    unit("psi", PSI, -5, Dimension::PRESSURE),
    unit("ksi", PSI, -2, Dimension::PRESSURE),
    unit("J", 1.0, 0, Dimension::TORQUE),
    unit("W", 1.0, 0, Dimension::POWER),
    unit("mW", 1.0, -3, Dimension::POWER),
    unit("kW", 1.0, 3, Dimension::POWER),
    unit("Hz", 1.0, 0, Dimension::RATE),
    unit("rad", 1.0, 0, Dimension::NONE),
    unit("mrad", 1.0, -3, Dimension::NONE),
    unit("deg", PI / 180.0, 0, Dimension::NONE),
    unit("rpm", PI / 30.0, 0, Dimension::RATE),
    unit("1", 1.0, 0, Dimension::NONE),
    // The same units with the Greek small mu instead of the micro sign.
    unit("μm", 1.0, -6, Dimension::LENGTH),
    unit("μs", 1.0, -6, Dimension::TIME),
];

/// Electrical units. A heading of a column is not searched for them, as `v` is a velocity there.
const ELECTRICAL: [KnownUnit; 9] = [
    unit("A", 1.0, 0, Dimension::CURRENT),
    unit("mA", 1.0, -3, Dimension::CURRENT),
    unit("V", 1.0, 0, Dimension::VOLTAGE),
    unit("mV", 1.0, -3, Dimension::VOLTAGE),
    unit("kV", 1.0, 3, Dimension::VOLTAGE),
    unit("ohm", 1.0, 0, Dimension::RESISTANCE),
    unit("mohm", 1.0, -3, Dimension::RESISTANCE),
    unit("Ω", 1.0, 0, Dimension::RESISTANCE),
    unit("mΩ", 1.0, -3, Dimension::RESISTANCE),
];

const DAY: &str = "d";

const PSI: f64 = 44_482_216_152_605.0 / (254.0 * 254.0);

/// The unit with this symbol.
fn known(symbol: &str) -> Option<&'static KnownUnit> {
    KNOWN.iter().chain(&ELECTRICAL).find(|unit| unit.symbol == symbol)
}

/// The known symbol spelt most like `word`, if one is near.
pub(super) fn nearest(word: &str) -> Option<&'static str> {
    let likeness = |symbol: &str| {
        // Case and the first letter only decide between equals: `pa` is Pa, `cn` is cm.
        let same_start = word.chars().next() == symbol.chars().next();
        strsim::jaro(&word.to_lowercase(), &symbol.to_lowercase())
            + 0.01 * strsim::jaro(word, symbol)
            + if same_start { 0.01 } else { 0.0 }
    };
    let scores = KNOWN.iter().map(|unit| (unit.symbol, likeness(unit.symbol)));
    let best = scores.reduce(|best, next| if next.1 > best.1 { next } else { best });
    best.filter(|(_, score)| *score > 0.66).map(|(symbol, _)| symbol)
}

/// True if a word is a unit's symbol in any case, with or without a power, such as `rad` or `s2`, or two symbols run
/// together, such as `Nm`. `d` is excluded: it stands for *desired* more often than for days.
pub(crate) fn reads_as_unit(word: &str) -> bool {
    let lower = word.to_lowercase();
    let word = lower.trim_end_matches(|c: char| c.is_ascii_digit());
    let same = |symbol: &str, word: &str| symbol != DAY && symbol.to_lowercase() == word;
    KNOWN.iter().any(|unit| same(unit.symbol, word)) || split(word, same).is_some()
}

/// The two symbols run together in `Nm`, `ozin` or `inlb`: one of a force or mass, one of a length.
fn run_together(word: &str) -> Option<[&'static str; 2]> {
    split(word, |symbol, word| symbol == word)
}

fn split(word: &str, same: impl Fn(&str, &str) -> bool) -> Option<[&'static str; 2]> {
    let symbol = |word: &str, dimensions: &[Dimension]| {
        let is_meant =
            |unit: &&KnownUnit| same(unit.symbol, word) && dimensions.contains(&unit.dimension);
        KNOWN.iter().find(is_meant).map(|unit| unit.symbol)
    };
    let (weight, arm) = ([Dimension::FORCE, Dimension::MASS], [Dimension::LENGTH]);
    let symbols = |(at, _)| {
        let (first, second) = word.split_at(at);
        let pair = |a: &[Dimension], b: &[Dimension]| Some([symbol(first, a)?, symbol(second, b)?]);
        pair(&weight, &arm).or_else(|| pair(&arm, &weight))
    };
    word.char_indices().find_map(symbols)
}

/// A decimal number without its sign.
const NUMBER: &str = r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?";

/// Power of a factor: `^2`, `**-1` or `²`.
const POWER: &str = r"((\^|\*\*)[+-]?[0-9]{1,2}|⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)?";

/// Regular expression (ECMA 262) of a quantity: the pattern `sign`, a number and a product of known units. It checks
/// neither the dimension nor that only one unit follows the stroke.
///
/// It matches all that [`parse_quantity`](super::parse_quantity) reads, except signs outside `sign` and powers of more
/// than two digits.
pub(crate) fn quantity_pattern(sign: &str) -> String {
    let symbols: Vec<&str> = KNOWN.iter().chain(&ELECTRICAL).map(|unit| unit.symbol).collect();
    let factor = format!("({}){POWER}", symbols.join("|"));
    // Contains the units only once, because editors show the whole expression.
    format!(r"^\s*{sign}{NUMBER}\s*(/\s*)?({factor}(\s*[*/·⋅]\s*(?=\S)|\s+|$))+$")
}

/// True for a rate such as `1/min` or `Hz`, which may count a motor's turns; `1/s` counts radians.
pub(crate) fn may_count_turns(unit: &str) -> bool {
    let words = || unit.split(|c: char| !c.is_alphabetic()).filter(|word| !word.is_empty());
    let has_angle = words().any(|word| ["rad", "mrad", "deg", "rpm"].contains(&word));
    !has_angle && words().any(|word| word != "s")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str, expected: Dimension) -> (String, Option<String>) {
        let error = parse_quantity(text, expected).unwrap_err();
        (error.to_string(), error.hint())
    }

    #[test]
    fn decimal_factors_cost_no_digit() {
        let cases = [
            ("150 cm", Dimension::LENGTH, 1.5),
            ("135cm", Dimension::LENGTH, 1.35),
            ("-15e-1 mm", Dimension::LENGTH, -0.0015),
            ("5e4 N cm^2", Dimension::BENDING_STIFFNESS, 5.0),
            ("5e4 N*cm**2", Dimension::BENDING_STIFFNESS, 5.0),
            ("5e4 N·cm²", Dimension::BENDING_STIFFNESS, 5.0),
            ("5e4 N ⋅ cm²", Dimension::BENDING_STIFFNESS, 5.0),
            ("1000 kg cm^2", Dimension::ROTARY_INERTIA, 0.1),
            ("2e7 N/cm^2", Dimension::PRESSURE, 2e11),
            ("2e7 N cm⁻²", Dimension::PRESSURE, 2e11),
            ("0.25e-2 cm^4", Dimension::SECOND_MOMENT, 2.5e-11),
            ("0.008 kg/cm^3", Dimension::DENSITY, 8000.0),
            ("1 cm^2", Dimension::AREA, 1e-4),
            ("0.8 g/mm", Dimension::MASS_PER_LENGTH, 0.8),
            ("0.015 N m s/rad", Dimension::VISCOUS_FRICTION, 0.015),
            ("2 1/s", Dimension::RATE, 2.0),
            ("2 /s", Dimension::RATE, 2.0),
            ("180 deg", Dimension::NONE, std::f64::consts::PI),
            ("0.5", Dimension::NONE, 0.5),
        ];
        for (text, dimension, expected) in cases {
            let found = parse_quantity(text, dimension);
            assert_eq!(found, Ok(expected), "{text}");
        }
    }

    #[test]
    fn products_of_inch_pound_units_are_right_to_round_off() {
        let cases = [
            (
                "28.6 lbf ft^2",
                Dimension::BENDING_STIFFNESS,
                28.6 * 4.448_221_615_260_5 * 0.3048 * 0.3048,
            ),
            ("12 oz in^2", Dimension::ROTARY_INERTIA, 12.0 * 0.028_349_523_125 * 0.0254 * 0.0254),
            ("1e4 ksi", Dimension::PRESSURE, 6.894_757_293_168_361e10),
        ];
        for (text, dimension, expected) in cases {
            let found = parse_quantity(text, dimension).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-15, "{text}");
        }
    }

    #[test]
    fn a_wrong_or_missing_unit_is_refused_with_what_is_meant() {
        let length = |text| refusal(text, Dimension::LENGTH);
        assert_eq!(
            length("1.5"),
            (
                "has no unit, but must be a length such as m".into(),
                Some("a number without quotes is in SI units".into())
            )
        );
        assert_eq!(length("150 kg").0, "is a mass, but must be a length such as m");
        assert_eq!(length("1 kg s").0, "is measured in kg s, but must be a length such as m");
        assert_eq!(
            length("150 cn"),
            ("has the unknown unit `cn`".into(), Some("did you mean `cm`?".into()))
        );
        assert_eq!(length("1 mm2").1.unwrap(), "a power is written `mm^2`");
        assert_eq!(length("1 xyzzy").1, None);
    }

    #[test]
    fn two_units_below_the_stroke_are_ambiguous() {
        for text in ["1 kg/m s", "1 J/kg/K", "1 kg/m*s"] {
            let error = parse_quantity(text, Dimension::DENSITY).unwrap_err();
            assert_eq!(error, UnitError::Ambiguous, "{text}");
        }
    }

    #[test]
    fn what_is_no_finite_decimal_number_is_refused() {
        for text in
            ["", "abc", "nan m", "inf m", "-inf m", "1,5 m", "1_000 m", "e5 m", ". m", "- m"]
        {
            let error = parse_quantity(text, Dimension::LENGTH).unwrap_err();
            assert_eq!(error, UnitError::NotANumber, "{text}");
        }
        for text in ["1e999 m", "1e308 km"] {
            let error = parse_quantity(text, Dimension::LENGTH).unwrap_err();
            assert_eq!(error, UnitError::NotFinite, "{text}");
        }
    }

    #[test]
    fn what_is_no_product_of_units_is_refused() {
        for text in [
            "",
            " ",
            "N m^",
            "N m^x",
            "N * * m",
            "N *",
            "^2",
            "(N m)",
            "m^999",
            "m^99 m^99",
            "1/",
            "/",
            "um^60 m^-59",
            "km^103 m^-102",
            "oz^30 kg^-29",
        ] {
            let error = Unit::parse(text).unwrap_err();
            assert!(matches!(error, UnitError::Malformed { .. }), "{text:?}");
        }
    }

    #[test]
    fn a_rate_that_may_count_turns_is_refused() {
        for unit in ["1/min", "/min", "min^-1", "Hz", "1/h", "1/ms"] {
            let refused = parse_quantity(&format!("3000 {unit}"), Dimension::RATE).unwrap_err();
            assert_eq!(
                refused.to_string(),
                format!("is in {unit}, which may count turns or radians")
            );
            assert!(refused.hint().unwrap().starts_with("write rpm for turns a minute"));
        }
        let rate = |text: &str| parse_quantity(text, Dimension::RATE).unwrap();
        for (text, exact) in [("6 rad/min", 0.1), ("2 s⁻¹", 2.0), ("1 mrad/ms", 1.0)] {
            assert!((rate(text) - exact).abs() < 1e-15, "{text}");
        }
        assert!((rate("30 rpm") - rate("180 deg/s")).abs() < 1e-15);
    }

    #[test]
    fn the_si_unit_of_each_dimension_has_that_dimension_and_factor_one() {
        let range = -4..=4;
        let all = range.clone().flat_map(|mass| {
            let range = range.clone();
            let lengths =
                range.clone().flat_map(move |length| range.clone().map(move |time| (length, time)));
            lengths.map(move |(length, time)| Dimension::new(mass, length, time))
        });
        let named: Vec<Dimension> = all.filter(|d| !d.si_unit().is_empty()).collect();
        assert_eq!(named.len(), 20);
        for dimension in named {
            let unit = Unit::parse(dimension.si_unit()).unwrap();
            assert_eq!(unit.dimension(), dimension);
            assert_eq!(unit.to_si(3.7).to_bits(), 3.7_f64.to_bits());
        }
    }

    /// From the SI brochure and NIST SP 811, appendix B, as decimal numbers.
    const EXPECTED: &str = "
        m 1; mm 0.001; cm 0.01; km 1000; um 0.000001; µm 0.000001; μm 0.000001; in 0.0254;
        ft 0.3048; kg 1; g 0.001; mg 0.000001; t 1000; lb 0.45359237; lbm 0.45359237;
        oz 0.028349523125; slug 14.593902937206364; s 1; ms 0.001; us 0.000001; µs 0.000001;
        μs 0.000001; ns 0.000000001; min 60; h 3600; d 86400; N 1; mN 0.001; kN 1000; MN 1000000; dyn 0.00001;
        kgf 9.80665; lbf 4.4482216152605; ozf 0.27801385095378125; Pa 1; kPa 1000; MPa 1000000;
        GPa 1000000000; bar 100000; psi 6894.757293168361; ksi 6894757.293168361; J 1; W 1; mW 0.001; kW 1000; Hz 1;
        rad 1; mrad 0.001; deg 0.017453292519943295; rpm 0.10471975511965977; 1 1";

    #[test]
    fn every_unit_has_its_published_value() {
        let rows: Vec<_> =
            EXPECTED.split(';').map(|row| row.trim().split_once(' ').unwrap()).collect();
        for (symbol, value) in &rows {
            let expected: f64 = value.parse().unwrap();
            let found = Unit::parse(symbol).unwrap().to_si(1.0);
            assert!((found / expected - 1.0).abs() < 3e-16, "{symbol} = {found:e}");
        }
        assert_eq!(rows.len(), KNOWN.len());
        for unit in KNOWN {
            assert!(rows.iter().any(|(symbol, _)| *symbol == unit.symbol));
        }
    }

    #[test]
    fn a_misspelt_unit_is_near_the_meant_one() {
        for (word, meant) in [
            ("cn", Some("cm")),
            ("pa", Some("Pa")),
            ("lbs", Some("lb")),
            ("metre", Some("m")),
            ("inch", Some("in")),
            ("m2", Some("m")),
            ("Newton", Some("N")),
            ("furlong", None),
        ] {
            assert_eq!(nearest(word), meant, "{word}");
        }
    }

    #[test]
    fn a_torque_without_its_blank_is_taken_apart() {
        for (word, symbols) in [
            ("Nm", Some(["N", "m"])),
            ("mNm", Some(["mN", "m"])),
            ("Nmm", Some(["N", "mm"])),
            ("lbfft", Some(["lbf", "ft"])),
            ("inlb", Some(["in", "lb"])),
            ("lbs", None),
            ("nm", None),
        ] {
            assert_eq!(run_together(word), symbols, "{word}");
        }
    }

    #[test]
    fn symbols_read_as_units_and_other_words_do_not() {
        for word in ["rad", "hz", "S2", "cm", "N", "MPa", "Nm", "ncm", "mNm", "ozin", "inlbf"] {
            assert!(reads_as_unit(word), "{word}");
        }
        for word in ["", "1", "42", "hub", "cmd", "torque", "motor", "sin", "µ", "²", "d"] {
            assert!(!reads_as_unit(word), "{word}");
        }
    }
}
