use std::f64::consts::PI;

use super::parts::{ParameterError, positive};

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
