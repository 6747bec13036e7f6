use super::known::KNOWN;

/// A decimal number without its sign.
const NUMBER: &str = r"([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?";

/// A factor's power: `^2`, `**-1` or `²`.
const POWER: &str = r"((\^|\*\*)[+-]?[0-9]{1,2}|⁻?[⁰¹²³⁴⁵⁶⁷⁸⁹]+)?";

/// Regular expression (ECMA 262) of the text of a quantity: what `sign` matches, a number and a
/// product of known units. Which dimension the product has it cannot tell, nor that only one unit
/// may stand below the stroke.
///
/// It passes all that [`parse_quantity`](super::parse_quantity) reads, but for numbers of a sign
/// that is left out and powers of more than two digits.
pub(crate) fn quantity_pattern(sign: &str) -> String {
    let symbols: Vec<&str> = KNOWN.iter().map(|unit| unit.symbol).collect();
    let factor = format!("({}){POWER}", symbols.join("|"));
    // The units once: editors show the whole expression beside what it refuses.
    format!(r"^\s*{sign}{NUMBER}\s*(/\s*)?({factor}(\s*[*/·⋅]\s*(?=\S)|\s+|$))+$")
}
