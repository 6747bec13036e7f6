//! A piece of the link: stiffness, mass and cross-section.

use serde::{Deserialize, Serialize};

use super::parts::{ParameterError, not_negative, positive};
use super::section::Section;

/// A property that varies linearly along a segment; stored as the list of its values at the inner and the outer end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 2]", into = "[f64; 2]")]
pub struct Taper {
    /// Value at the end towards the hub.
    pub inner: f64,
    /// Value at the end towards the tip.
    pub outer: f64,
}

impl From<[f64; 2]> for Taper {
    fn from([inner, outer]: [f64; 2]) -> Self {
        Self { inner, outer }
    }
}

impl From<Taper> for [f64; 2] {
    fn from(taper: Taper) -> Self {
        [taper.inner, taper.outer]
    }
}

impl Taper {
    /// The same value along the whole segment.
    pub fn constant(value: f64) -> Self {
        Self { inner: value, outer: value }
    }

    /// True if the value is the same along the whole segment.
    pub fn is_constant(&self) -> bool {
        *self == Self::constant(self.inner)
    }

    /// Value at a fraction of the length, 0 at the inner end and 1 at the outer.
    pub fn at(&self, fraction: f64) -> f64 {
        // The sum's last digit would change from element to element.
        if self.is_constant() {
            return self.inner;
        }
        self.inner * (1.0 - fraction) + self.outer * fraction
    }

    /// The property between two fractions of the length.
    #[must_use]
    pub fn between(&self, from: f64, to: f64) -> Self {
        Self { inner: self.at(from), outer: self.at(to) }
    }

    /// Mean value.
    pub fn mean(&self) -> f64 {
        0.5 * (self.inner + self.outer)
    }

    /// Combines the values of two properties at each end.
    pub(crate) fn of_ends(a: Self, b: Self, value: impl Fn(f64, f64) -> f64) -> Self {
        Self { inner: value(a.inner, b.inner), outer: value(a.outer, b.outer) }
    }

    /// Refuses the first end that `check` refuses.
    fn check(
        self,
        check: fn(&str, f64, &str) -> Result<(), ParameterError>,
        parameter: &str,
        unit: &str,
    ) -> Result<(), ParameterError> {
        [self.inner, self.outer].iter().try_for_each(|value| check(parameter, *value, unit))
    }

    /// Both ends multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { inner: self.inner * factor, outer: self.outer * factor }
    }
}

/// Properties of a segment that determine shear and rotary inertia, besides stiffness and mass.
///
/// A segment without [`Timoshenko`] neglects both effects; these numbers give the resulting error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CrossSection {
    /// Radius of gyration r = √(I/A) in the plane of motion in m, above 0 at both ends.
    pub radius_of_gyration_m: Taper,
    /// Shear coefficient κ: the mean shear strain is Q/(κGA); above 0.
    pub shear_coefficient: f64,
}

impl CrossSection {
    /// Poisson's ratio ν assumed for every material; κG varies by 6 % from 0.2 to 0.4.
    pub const POISSON_RATIO: f64 = 0.3;

    /// κ of a section of unknown shape: the value of a rectangle.
    pub const USUAL_SHEAR_COEFFICIENT: f64 = 0.85;

    /// Properties of a section of known shape.
    pub fn of(section: &Section) -> Self {
        let radius_m = (section.second_moment_m4() / section.area_m2()).sqrt();
        Self {
            radius_of_gyration_m: Taper::constant(radius_m),
            shear_coefficient: section.shear_coefficient(Self::POISSON_RATIO),
        }
    }

    /// Properties of a section of known I in m⁴ and A in m².
    pub fn of_moment_and_area(second_moment_m4: Taper, area_m2: Taper) -> Self {
        let radius_m = |i: f64, a: f64| (i / a).sqrt();
        Self {
            radius_of_gyration_m: Taper::of_ends(second_moment_m4, area_m2, radius_m),
            shear_coefficient: Self::USUAL_SHEAR_COEFFICIENT,
        }
    }

    /// E/(κG) = 2(1 + ν)/κ: ratio of the shear compliance to the compliance of a bar in tension.
    pub fn shear_flexibility(&self) -> f64 {
        2.0 * (1.0 + Self::POISSON_RATIO) / self.shear_coefficient
    }

    pub(super) fn check(&self, parameter: &str) -> Result<(), ParameterError> {
        let radius = format!("{parameter}.radius_of_gyration");
        self.radius_of_gyration_m.check(positive, &radius, "m")?;
        positive(&format!("{parameter}.shear_coefficient"), self.shear_coefficient, "")
    }
}

/// Shear and rotary inertia of a segment, by Timoshenko's theory: `v' = ψ + Q/(κGA)` with the rotation ψ of the
/// cross-section (Timoshenko, Phil. Mag. 41, 1921).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Timoshenko {
    /// Shear stiffness `κGA` in N, above 0 at both ends.
    pub shear_stiffness_n: Taper,
    /// Rotary inertia of the cross-section per length, ρI, in kg m, at least 0.
    pub rotary_inertia_per_length_kg_m: Taper,
}

impl Timoshenko {
    /// The values between two fractions of the length.
    #[must_use]
    pub fn between(&self, from: f64, to: f64) -> Self {
        Self {
            shear_stiffness_n: self.shear_stiffness_n.between(from, to),
            rotary_inertia_per_length_kg_m: self.rotary_inertia_per_length_kg_m.between(from, to),
        }
    }

    fn check(&self, path: impl Fn(&str) -> String) -> Result<(), ParameterError> {
        self.shear_stiffness_n.check(positive, &path("shear_stiffness"), "N")?;
        let rotary = path("rotary_inertia_per_length");
        self.rotary_inertia_per_length_kg_m.check(not_negative, &rotary, "kg m")
    }
}

/// One piece of the link with uniform or tapered stiffness and mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Segment {
    /// Name that addresses the segment, unique in its link.
    pub name: Option<String>,
    /// Length in m, above 0.
    pub length_m: f64,
    /// Bending stiffness EI in N m², above 0 at both ends.
    pub bending_stiffness_n_m2: Taper,
    /// Mass per length m̄ in kg/m, at least 0.
    pub mass_per_length_kg_m: Taper,
    /// Properties for shear and rotary inertia, if known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cross_section: Option<CrossSection>,
    /// Shear and rotary inertia; `None` for a Bernoulli-Euler segment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub timoshenko: Option<Timoshenko>,
}

impl Segment {
    /// A uniform segment: length in m, bending stiffness EI in N m², mass per length in kg/m.
    /// [`Link::new`](super::Link::new) checks the ranges.
    pub fn uniform(length_m: f64, bending_stiffness_n_m2: f64, mass_per_length_kg_m: f64) -> Self {
        Self {
            name: None,
            length_m,
            bending_stiffness_n_m2: Taper::constant(bending_stiffness_n_m2),
            mass_per_length_kg_m: Taper::constant(mass_per_length_kg_m),
            cross_section: None,
            timoshenko: None,
        }
    }

    /// The cross-section of a segment that neglects shear and rotary inertia.
    pub(crate) fn slender_section(&self) -> Option<CrossSection> {
        self.cross_section.filter(|_| self.timoshenko.is_none())
    }

    pub(super) fn check(&self, index: usize) -> Result<(), ParameterError> {
        let path = |key: &str| format!("segments.{index}.{key}");
        if let Some(name) = &self.name {
            check_name(name, &path("name"))?;
        }
        positive(&path("length"), self.length_m, "m")?;
        self.bending_stiffness_n_m2.check(positive, &path("EI"), "N m^2")?;
        self.mass_per_length_kg_m.check(not_negative, &path("mass_per_length"), "kg/m")?;
        self.cross_section.map_or(Ok(()), |section| section.check(&path("section")))?;
        let Some(timoshenko) = &self.timoshenko else { return Ok(()) };
        let rotary = timoshenko.rotary_inertia_per_length_kg_m;
        let nothing = Taper::constant(0.0);
        if self.mass_per_length_kg_m == nothing && rotary != nothing {
            let must = "must be 0 where mass_per_length is 0";
            let parameter = path("rotary_inertia_per_length");
            return Err(ParameterError::new(
                parameter,
                rotary.inner.max(rotary.outer),
                "kg m",
                must,
            ));
        }
        timoshenko.check(path)
    }
}

/// Refuses a name that looks like a number, a wildcard or a path.
fn check_name(name: &str, parameter: &str) -> Result<(), ParameterError> {
    let number = name.chars().all(|c| c.is_ascii_digit());
    if number || name.contains(['.', '*', '=']) || name.trim() != name {
        let must = "must not be empty or a number, nor hold `.`, `*`, `=` or outer blanks";
        return Err(ParameterError::new(parameter, format!("{name:?}"), "", must));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_piece_of_a_taper_is_the_same_line() {
        let taper = Taper { inner: 8.0, outer: 2.0 };
        let piece = taper.between(0.25, 0.5);
        assert_eq!(piece, Taper { inner: 6.5, outer: 5.0 });
    }

    #[test]
    fn pieces_of_what_is_alike_from_end_to_end_are_equal() {
        let taper = Taper::constant(4.1);
        for k in 0..1000 {
            let at = |k: u32| f64::from(k) / 1000.0;
            assert_eq!(taper.between(at(k), at(k + 1)), taper, "piece {k}");
        }
    }

    #[test]
    fn names_that_collide_with_paths_are_refused() {
        for name in ["", "0", "12", "a.b", "*", "x=1", " a"] {
            assert!(check_name(name, "segments.0.name").is_err(), "{name:?} passed");
        }
        assert!(check_name("beam 2", "segments.0.name").is_ok());
    }

    #[test]
    fn a_rectangle_has_its_thickness_over_root_twelve_however_it_is_given() {
        let section = Section::Rectangle { width_m: 0.02, thickness_m: 0.1 };
        let by_shape = CrossSection::of(&section);
        let r = by_shape.radius_of_gyration_m;
        assert!(r.is_constant() && (r.inner / (0.1 / 12.0_f64.sqrt()) - 1.0).abs() < 1e-15);
        let [i, a] = [section.second_moment_m4(), section.area_m2()].map(Taper::constant);
        let by_numbers = CrossSection::of_moment_and_area(i, a);
        assert_eq!(by_numbers.radius_of_gyration_m, r);
        let flexibility = [by_shape, by_numbers].map(|section| section.shear_flexibility());
        assert!((flexibility[0] - 3.06).abs() < 5e-3 && (flexibility[1] - 3.06).abs() < 5e-3);
    }
}
