//! Units and counts of a drive for its set-points.

use crate::numeric::{Dimension, Unit, may_count_turns, split_number};
use crate::text::{plain, significant};

/// Quantity of a set-point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SetPoint {
    /// Angle of a joint in rad, or place of a carriage in m.
    Position,
    /// Rate of a joint in rad/s, or velocity of a carriage in m/s.
    Velocity,
    /// Acceleration of a joint in rad/s², or of a carriage in m/s².
    Acceleration,
    /// Torque at a joint in N m, or force on a carriage in N.
    Effort,
}

impl SetPoint {
    /// All quantities, in the order of their derivatives.
    pub const ALL: [Self; 4] = [Self::Position, Self::Velocity, Self::Acceleration, Self::Effort];

    /// Its name.
    pub fn word(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Effort => "effort",
        }
    }

    /// Its unit in SI, of a joint that turns or one that slides.
    pub fn si_unit(self, slides: bool) -> &'static str {
        match (self, slides) {
            (Self::Position, false) => "rad",
            (Self::Velocity, false) => "rad/s",
            (Self::Acceleration, false) => "rad/s^2",
            (Self::Effort, false) => "N m",
            (Self::Position, true) => "m",
            (Self::Velocity, true) => "m/s",
            (Self::Acceleration, true) => "m/s^2",
            (Self::Effort, true) => "N",
        }
    }

    fn dimension(self, slides: bool) -> Dimension {
        match (self, slides) {
            (Self::Position, false) => Dimension::NONE,
            (Self::Velocity, false) => Dimension::RATE,
            (Self::Acceleration, false) => Dimension::ANGULAR_ACCELERATION,
            (Self::Effort, false) => Dimension::TORQUE,
            (Self::Position, true) => Dimension::LENGTH,
            (Self::Velocity, true) => Dimension::VELOCITY,
            (Self::Acceleration, true) => Dimension::ACCELERATION,
            (Self::Effort, true) => Dimension::FORCE,
        }
    }
}

/// Numbers that a drive takes for a quantity: `number = per_si × quantity + zero`, rounded for counts.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveUnit {
    /// Unit of the numbers; `counts` for whole numbers.
    pub label: String,
    /// Numbers per unit of SI; negative if the drive turns the other way.
    pub per_si: f64,
    /// Number at 0.
    pub zero: f64,
    /// Whether the numbers are whole.
    pub is_count: bool,
}

impl DriveUnit {
    /// The unit in SI.
    pub fn si(set_point: SetPoint, slides: bool) -> Self {
        let label = set_point.si_unit(slides).to_owned();
        Self { label, per_si: 1.0, zero: 0.0, is_count: false }
    }

    /// Number of the drive for a value in SI.
    pub fn number(&self, si: f64) -> f64 {
        let number = si * self.per_si + self.zero;
        if self.is_count { number.round() } else { number }
    }

    /// Value in SI that the drive has after rounding.
    #[must_use]
    pub fn as_held(&self, si: f64) -> f64 {
        if self.is_count { (self.number(si) - self.zero) / self.per_si } else { si }
    }

    /// Description of the numbers of a quantity, with sign and zero of counts.
    pub fn described(&self, set_point: SetPoint, slides: bool) -> String {
        let (word, si) = (set_point.word(), set_point.si_unit(slides));
        if !self.is_count {
            return format!("{word} in {}", self.label);
        }
        let per_si = significant(self.per_si, 9);
        format!("{word} in counts, {per_si} per {si}, {} at 0 {si}", plain(self.zero))
    }
}

/// A unit, or counts, of a quantity: of all joints, or of the joint with a number from 1.
#[derive(Debug, Clone, PartialEq)]
pub struct UnitChoice {
    /// The quantity.
    pub set_point: SetPoint,
    /// Number of the joint from 1; `None`: all.
    pub joint: Option<usize>,
    /// The text that chose it.
    pub text: String,
    scale: Scale,
}

#[derive(Debug, Clone, PartialEq)]
enum Scale {
    /// A unit as written.
    Unit { label: String, unit: Unit },
    /// Counts over a range, whose unit may be that of the quantity; count at 0.
    Counts { counts: f64, range: f64, unit: Option<Unit>, zero: f64 },
}

/// A quantity with the number of a joint, and the text after its equals sign.
fn pair<'a>(text: &'a str, example: &str) -> Result<(SetPoint, Option<usize>, &'a str), String> {
    let (key, value) = text.split_once('=').ok_or_else(|| format!("must read like {example}"))?;
    let key = key.trim();
    let word = key.trim_end_matches(|c: char| c.is_ascii_digit());
    let set_point = SetPoint::ALL.into_iter().find(|own| own.word() == word);
    let set_point = set_point.ok_or(
        "the quantity must be position, velocity, acceleration or effort, or that of a joint: position2",
    )?;
    let joint = match &key[word.len()..] {
        "" => None,
        digits => {
            Some(digits.parse().ok().filter(|joint| *joint > 0).ok_or("joints count from 1")?)
        }
    };
    Ok((set_point, joint, value.trim()))
}

fn unit(text: &str) -> Result<Unit, String> {
    let unit = Unit::parse(text).map_err(|error| match error.hint() {
        Some(hint) => format!("{error}; {hint}"),
        None => error.to_string(),
    })?;
    if unit.dimension() == Dimension::RATE && may_count_turns(text) {
        return Err(format!("{text} may count turns or radians: write rpm, rad/s or deg/s"));
    }
    Ok(unit)
}

impl UnitChoice {
    /// Reads a unit: `position=deg`, or `effort2='N cm'` for the second joint.
    ///
    /// # Errors
    /// The part that is wrong, in words.
    pub fn of_unit(text: &str) -> Result<Self, String> {
        let (set_point, joint, value) = pair(text, "position=deg")?;
        let scale = Scale::Unit { label: value.to_owned(), unit: unit(value)? };
        Ok(Self { set_point, joint, text: text.to_owned(), scale })
    }

    /// Reads counts over a range, and the count at 0: `position=4096/360`, `position='-4096/360 deg+2048'`.
    ///
    /// # Errors
    /// The part that is wrong, in words.
    pub fn of_counts(text: &str) -> Result<Self, String> {
        const EXAMPLE: &str = "'position=4096/360 deg' or 'position=-4096/360 deg+2048'";
        let (set_point, joint, value) = pair(text, EXAMPLE)?;
        let wrong = || format!("must read like {EXAMPLE}");
        let (counts, rest) = split_number(value).ok_or_else(wrong)?;
        let rest = rest.trim_start().strip_prefix('/').ok_or_else(wrong)?;
        let (range, rest) = split_number(rest).ok_or_else(wrong)?;
        // The sign of the zero does not follow the ^ of a power.
        let is_sign = |(at, c): &(usize, char)| {
            matches!(c, '+' | '-')
                && !rest[..*at].ends_with('^')
                && rest[*at..].parse::<f64>().is_ok()
        };
        let at = rest.char_indices().find(is_sign).map_or(rest.len(), |(at, _)| at);
        let zero = if at < rest.len() { rest[at..].parse().map_err(|_| wrong())? } else { 0.0 };
        let named = rest[..at].trim();
        let unit = if named.is_empty() { None } else { Some(unit(named)?) };
        if !(counts / range).is_normal() || !f64::is_finite(zero) {
            return Err("counts and range must be finite numbers other than 0".to_owned());
        }
        let scale = Scale::Counts { counts, range, unit, zero };
        Ok(Self { set_point, joint, text: text.to_owned(), scale })
    }

    /// True for counts over a range without a unit.
    pub(super) fn has_bare_range(&self) -> bool {
        matches!(self.scale, Scale::Counts { unit: None, .. })
    }

    /// True if the choice is for a quantity of the joint with this number from 0, of this kind.
    pub fn is_for(&self, set_point: SetPoint, joint: usize, slides: bool) -> bool {
        let unit = match &self.scale {
            Scale::Unit { unit, .. } => Some(unit),
            Scale::Counts { unit, .. } => unit.as_ref(),
        };
        let fits = unit.is_none_or(|unit| unit.dimension() == set_point.dimension(slides));
        self.set_point == set_point && self.joint.is_none_or(|own| own == joint + 1) && fits
    }

    /// The unit of the drive, chosen after the unit `of` the quantity.
    #[must_use]
    pub fn unit(&self, of: &DriveUnit) -> DriveUnit {
        match &self.scale {
            Scale::Unit { label, unit } => DriveUnit {
                label: label.clone(),
                per_si: unit.to_si(1.0).recip(),
                zero: 0.0,
                is_count: false,
            },
            Scale::Counts { counts, range, unit, zero } => {
                let per_si = match unit {
                    Some(unit) => counts / unit.to_si(*range),
                    None => counts / range * of.per_si,
                };
                DriveUnit { label: "counts".to_owned(), per_si, zero: *zero, is_count: true }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn counts(text: &str, of: &str) -> DriveUnit {
        let of = UnitChoice::of_unit(of).unwrap().unit(&DriveUnit::si(SetPoint::Position, false));
        UnitChoice::of_counts(text).unwrap().unit(&of)
    }

    #[test]
    fn counts_have_the_sign_and_the_zero_of_the_drive() {
        for text in
            ["position=4096/360", "position=4096/360 deg", "position=-4096/-6.283185307179586 rad"]
        {
            let unit = counts(text, "position=deg");
            let numbers = [PI, 0.0008].map(|angle| unit.number(angle).to_string());
            assert_eq!(numbers, ["2048", "1"], "{text}");
            assert!((unit.as_held(0.0008) - 2.0 * PI / 4096.0).abs() < 1e-17);
        }
        let flipped = counts("position2=-4096/360 deg+2048", "position=rad");
        let numbers = [0.0, 0.5 * PI].map(|angle| flipped.number(angle).to_string());
        assert_eq!(numbers, ["2048", "1024"]);
        assert_eq!(
            flipped.described(SetPoint::Position, false),
            "position in counts, -651.898647 per rad, 2048 at 0 rad"
        );
    }

    #[test]
    fn a_choice_is_for_its_joints_alone() {
        let choice = UnitChoice::of_counts("effort2=1000/2.5 N m").unwrap();
        assert!(choice.is_for(SetPoint::Effort, 1, false));
        let others = [(SetPoint::Effort, 0, false), (SetPoint::Effort, 1, true)];
        assert!(others.into_iter().all(|(own, joint, slides)| !choice.is_for(own, joint, slides)));
        assert!(UnitChoice::of_unit("position=mm").unwrap().is_for(SetPoint::Position, 3, true));
        for wrong in ["position", "angle=deg", "position0=deg", "position=", "velocity=1/min"] {
            assert!(UnitChoice::of_unit(wrong).is_err(), "{wrong}");
        }
        for wrong in ["position=4096", "position=0/360", "position=4096/360 deg+x", "position=1/0"]
        {
            assert!(UnitChoice::of_counts(wrong).is_err(), "{wrong}");
        }
    }
}
