//! Dimensions, and the units that this program reads.

use std::f64::consts::PI;

/// Exponents of mass, length and time in a unit; an angle is a pure number.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dimension {
    mass: i8,
    length: i8,
    time: i8,
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
    /// W
    pub const POWER: Self = Self::new(1, 2, -3);

    pub(crate) const fn new(mass: i8, length: i8, time: i8) -> Self {
        Self { mass, length, time }
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
            Self::POWER => ("a power", "W"),
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
        })
    }
}

/// A single unit: coefficient · 10^exponent of the SI unit.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownUnit {
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
pub(super) const KNOWN: [KnownUnit; 51] = [
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

const DAY: &str = "d";

const PSI: f64 = 44_482_216_152_605.0 / (254.0 * 254.0);

/// The unit with this symbol.
pub(super) fn known(symbol: &str) -> Option<&'static KnownUnit> {
    KNOWN.iter().find(|unit| unit.symbol == symbol)
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
pub(super) fn run_together(word: &str) -> Option<[&'static str; 2]> {
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
    let symbols: Vec<&str> = KNOWN.iter().map(|unit| unit.symbol).collect();
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
    use super::super::{Unit, parse_quantity};
    use super::*;

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
        assert_eq!(named.len(), 19);
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
