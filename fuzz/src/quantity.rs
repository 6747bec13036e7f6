use super::text_of;
use super::wording::check_words;
use flexlink::numeric::{Dimension, Unit, UnitError, parse_quantity};

/// Every dimension that a link file or a table measures in.
const DIMENSIONS: [Dimension; 19] = [
    Dimension::NONE,
    Dimension::LENGTH,
    Dimension::AREA,
    Dimension::SECOND_MOMENT,
    Dimension::MASS,
    Dimension::MASS_PER_LENGTH,
    Dimension::DENSITY,
    Dimension::ROTARY_INERTIA,
    Dimension::TIME,
    Dimension::RATE,
    Dimension::ANGULAR_ACCELERATION,
    Dimension::VELOCITY,
    Dimension::ACCELERATION,
    Dimension::FORCE,
    Dimension::PRESSURE,
    Dimension::TORQUE,
    Dimension::BENDING_STIFFNESS,
    Dimension::VISCOUS_FRICTION,
    Dimension::POWER,
];

/// Laws: those of a unit and of a quantity.
///
/// # Panics
/// If one is broken.
pub fn quantity(bytes: &[u8]) {
    check_unit(text_of(bytes));
    check_quantity(text_of(bytes));
}

// Laws: a unit is refused with words, or has a factor that is a number above 0, by which its values
// are multiplied.
fn check_unit(text: &str) {
    let unit = match Unit::parse(text) {
        Err(error) => return check_words("", &error, error.hint().as_deref()),
        Ok(unit) => unit,
    };
    let factor = unit.to_si(1.0);
    assert!(factor.is_normal() && factor > 0.0, "{text:?} is {factor:e}");
    for value in [0.8, 150.0, -5e4] {
        // Two roundings here, two and one there, each of half an epsilon.
        let off = (unit.to_si(value) / (value * factor) - 1.0).abs();
        let is_normal = (value * factor).is_normal();
        assert!(!is_normal || off <= 2.5 * f64::EPSILON, "{value} {text:?} is off by {off:e}");
    }
}

// Laws: a quantity is refused with words, or is finite, of one dimension alone and as large without
// its sign, or with blanks around it.
fn check_quantity(text: &str) {
    let mut accepted = Vec::new();
    for dimension in DIMENSIONS {
        match parse_quantity(text, dimension) {
            Ok(value) => accepted.push((dimension, value)),
            Err(error) => check_words("", &error, error.hint().as_deref()),
        }
    }
    assert!(accepted.len() <= 1, "{text:?} is {accepted:?}");
    let Some(&(dimension, value)) = accepted.first() else { return };
    assert!(value.is_finite(), "{text:?} is {value}");
    let same = |text: &str, value: f64| {
        let found = parse_quantity(text, dimension);
        assert_eq!(found.map(f64::to_bits), Ok(value.to_bits()), "{text:?}");
    };
    same(&format!(" \t{text}\n"), value);
    let plain = text.trim();
    match plain.strip_prefix('-') {
        Some(positive) if !positive.starts_with('+') => same(positive, -value),
        None if !plain.starts_with('+') => same(&format!("-{plain}"), -value),
        _ => {}
    }
    let unit = plain.trim_start_matches(|c: char| "+-.0123456789eE".contains(c));
    let missing = parse_quantity(&plain[..plain.len() - unit.len()], dimension);
    let is_pure = dimension == Dimension::NONE;
    assert!(is_pure || matches!(missing, Err(UnitError::NoUnit { .. })), "{text:?}: {missing:?}");
}
