//! A piece of the link: stiffness, mass and cross-section, or the dimensions of a section.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::parts::{ParameterError, not_negative, positive};

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

/// A cross-section; area and second moment of area follow from it.
///
/// Width is measured across the plane of motion, thickness and height in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Section {
    /// Solid rectangle.
    Rectangle {
        /// Width across the plane of motion, m.
        width_m: f64,
        /// Thickness in the plane of motion, m.
        thickness_m: f64,
    },
    /// Solid circle.
    Circle {
        /// Diameter, m.
        diameter_m: f64,
    },
    /// Hollow circle.
    Tube {
        /// Outer diameter, m.
        diameter_m: f64,
        /// Wall thickness, m.
        wall_m: f64,
    },
    /// Hollow rectangle.
    Box {
        /// Outer width across the plane of motion, m.
        width_m: f64,
        /// Outer height in the plane of motion, m.
        height_m: f64,
        /// Wall thickness, m.
        wall_m: f64,
    },
}

impl Section {
    /// Area of the cross-section in m².
    pub fn area_m2(&self) -> f64 {
        match *self {
            Self::Rectangle { width_m, thickness_m } => width_m * thickness_m,
            Self::Circle { diameter_m } => PI / 4.0 * diameter_m.powi(2),
            Self::Tube { diameter_m, wall_m } => PI * wall_m * (diameter_m - wall_m),
            Self::Box { width_m, height_m, wall_m } => {
                2.0 * wall_m * (width_m + height_m - 2.0 * wall_m)
            }
        }
    }

    /// Second moment of area about the bending axis in m⁴.
    ///
    /// ```
    /// use flexlink::link::Section;
    /// let strip = Section::Rectangle { width_m: 0.02, thickness_m: 0.001 };
    /// assert!((strip.second_moment_m4() - 0.02 * 1e-9 / 12.0).abs() < 1e-24);
    /// ```
    pub fn second_moment_m4(&self) -> f64 {
        match *self {
            Self::Rectangle { width_m, thickness_m } => rectangle(width_m, thickness_m),
            Self::Circle { diameter_m } => disc(diameter_m),
            Self::Tube { diameter_m, wall_m } => {
                // Factored, so that a thin wall loses no digits.
                let inner_m = diameter_m - 2.0 * wall_m;
                PI / 16.0 * wall_m * (diameter_m - wall_m) * (diameter_m.powi(2) + inner_m.powi(2))
            }
            Self::Box { width_m, height_m, wall_m } => {
                rectangle(width_m, height_m)
                    - rectangle(width_m - 2.0 * wall_m, height_m - 2.0 * wall_m)
            }
        }
    }

    /// Cowper's shear coefficient κ for the Poisson's ratio ν: the mean shear strain over the section is Q/(κGA) (J.
    /// Applied Mechanics 33, 1966, table 1; a box counts as thin-walled).
    pub fn shear_coefficient(&self, poisson_ratio: f64) -> f64 {
        let nu = poisson_ratio;
        match *self {
            Self::Rectangle { .. } => 10.0 * (1.0 + nu) / (12.0 + 11.0 * nu),
            Self::Circle { .. } => 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu),
            Self::Tube { diameter_m, wall_m } => {
                let m = (1.0 - 2.0 * wall_m / diameter_m).powi(2);
                let sum = (1.0 + m).powi(2);
                6.0 * (1.0 + nu) * sum / ((7.0 + 6.0 * nu) * sum + (20.0 + 12.0 * nu) * m)
            }
            Self::Box { width_m, height_m, wall_m } => {
                // Between the middles of the walls, which have one thickness.
                let n = (width_m - wall_m) / (height_m - wall_m);
                let polynomial = |[a, b, c, d]: [f64; 4]| a + n * (b + n * (c + n * d));
                let flanges = 10.0 * n * n * n * (3.0 + nu + 3.0 * n);
                10.0 * (1.0 + nu) * (1.0 + 3.0 * n).powi(2)
                    / (polynomial([12.0, 72.0, 150.0, 90.0])
                        + nu * polynomial([11.0, 66.0, 135.0, 90.0])
                        + flanges)
            }
        }
    }

    /// Checks the dimensions; an error names them below `parameter`.
    ///
    /// # Errors
    /// [`ParameterError`] for a dimension that is not above zero, or a wall thicker than half the section.
    pub fn check(&self, parameter: &str) -> Result<(), ParameterError> {
        let (sizes, wall_m) = match *self {
            Self::Rectangle { width_m, thickness_m } => {
                ([("width", width_m), ("thickness", thickness_m)], None)
            }
            Self::Circle { diameter_m } => ([("diameter", diameter_m); 2], None),
            Self::Tube { diameter_m, wall_m } => ([("diameter", diameter_m); 2], Some(wall_m)),
            Self::Box { width_m, height_m, wall_m } => {
                ([("width", width_m), ("height", height_m)], Some(wall_m))
            }
        };
        let path = |name: &str| format!("{parameter}.{name}");
        sizes.iter().try_for_each(|(name, size_m)| positive(&path(name), *size_m, "m"))?;
        let Some(wall_m) = wall_m else { return Ok(()) };
        positive(&path("wall"), wall_m, "m")?;
        let least_m = sizes[0].1.min(sizes[1].1);
        if 2.0 * wall_m < least_m {
            return Ok(());
        }
        let must = format!("must be below half the outer size {least_m} m");
        Err(ParameterError::new(path("wall"), wall_m, "m", must))
    }
}

fn rectangle(width_m: f64, height_m: f64) -> f64 {
    width_m * height_m.powi(3) / 12.0
}

fn disc(diameter_m: f64) -> f64 {
    PI / 64.0 * diameter_m.powi(4)
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

    #[test]
    fn a_tube_is_the_difference_of_two_discs() {
        let tube = Section::Tube { diameter_m: 0.03, wall_m: 0.002 };
        let difference = disc(0.03) - disc(0.026);
        assert!((tube.second_moment_m4() / difference - 1.0).abs() < 1e-13);
        let area = PI / 4.0 * (0.03_f64.powi(2) - 0.026_f64.powi(2));
        assert!((tube.area_m2() / area - 1.0).abs() < 1e-13);
    }

    /// Cowper (1966), table 2: ν = 0.3 gives 0.850, 0.886, 0.531 and 0.436.
    #[test]
    fn shear_coefficients_are_those_of_cowpers_table() {
        let thin = 1e-7;
        for (section, expected) in [
            (Section::Rectangle { width_m: 0.02, thickness_m: 0.3 }, 0.850),
            (Section::Circle { diameter_m: 0.02 }, 0.886),
            (Section::Tube { diameter_m: 0.02, wall_m: 0.02 * thin }, 0.531),
            (Section::Box { width_m: 0.1, height_m: 0.1, wall_m: 0.1 * thin }, 0.436),
        ] {
            let found = section.shear_coefficient(0.3);
            assert!((found - expected).abs() < 5e-4, "{section:?}: {found} is not {expected}");
        }
        // A tube without a hole is a circle.
        let solid = Section::Tube { diameter_m: 0.02, wall_m: 0.01 - 1e-12 };
        let circle = Section::Circle { diameter_m: 0.02 };
        let difference = solid.shear_coefficient(0.3) - circle.shear_coefficient(0.3);
        assert!(difference.abs() < 1e-9);
    }

    #[test]
    fn a_box_with_walls_that_meet_is_refused() {
        let closed = Section::Box { width_m: 0.04, height_m: 0.02, wall_m: 0.01 };
        let error = closed.check("segments.0.section").unwrap_err();
        assert_eq!(
            error.to_string(),
            "segments.0.section.wall = 0.01 m, but must be below half the outer size 0.02 m"
        );
        let open = Section::Box { width_m: 0.04, height_m: 0.02, wall_m: 0.001 };
        let area = 0.04 * 0.02 - 0.038 * 0.018;
        assert!((open.area_m2() / area - 1.0).abs() < 1e-13);
    }
}
