use super::error::{ParameterError, positive};
use super::{Section, Taper};

/// What shear and rotary inertia of a segment depend on, beside its stiffness and its mass.
///
/// The model leaves both out; with these numbers it says how much that matters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossSection {
    /// Radius of gyration r = √(I/A) in the plane of motion in m, above 0 at both ends.
    pub radius_of_gyration_m: Taper,
    /// Shear coefficient κ: the mean shear strain is Q/(κGA); above 0.
    pub shear_coefficient: f64,
}

impl CrossSection {
    /// Poisson's ratio ν that is assumed of every material; κG varies by 6 % from 0.2 to 0.4.
    pub const POISSON_RATIO: f64 = 0.3;

    /// κ of a section of unknown shape: that of a rectangle.
    pub const USUAL_SHEAR_COEFFICIENT: f64 = 0.85;

    /// That of a section of known shape.
    pub fn of(section: &Section) -> Self {
        let radius_m = (section.second_moment_m4() / section.area_m2()).sqrt();
        Self {
            radius_of_gyration_m: Taper::constant(radius_m),
            shear_coefficient: section.shear_coefficient(Self::POISSON_RATIO),
        }
    }

    /// That of a section of which I in m⁴ and A in m² are known.
    pub fn of_moment_and_area(second_moment_m4: Taper, area_m2: Taper) -> Self {
        let radius_m = |i: f64, a: f64| (i / a).sqrt();
        Self {
            radius_of_gyration_m: Taper {
                inner: radius_m(second_moment_m4.inner, area_m2.inner),
                outer: radius_m(second_moment_m4.outer, area_m2.outer),
            },
            shear_coefficient: Self::USUAL_SHEAR_COEFFICIENT,
        }
    }

    /// E/(κG) = 2(1 + ν)/κ: shear compliance over that of a bar pulled at its end.
    pub fn shear_flexibility(&self) -> f64 {
        2.0 * (1.0 + Self::POISSON_RATIO) / self.shear_coefficient
    }

    pub(super) fn check(&self, parameter: &str) -> Result<(), ParameterError> {
        let Taper { inner, outer } = self.radius_of_gyration_m;
        let radius = format!("{parameter}.radius_of_gyration");
        [inner, outer].iter().try_for_each(|&r| positive(&radius, r, "m"))?;
        positive(&format!("{parameter}.shear_coefficient"), self.shear_coefficient, "")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
