//! Errors of a mesh in modes, zeros and transfers.

use thiserror::Error;

use crate::beam::Mesh;
use crate::text::significant;

/// Relative error above which the user gets a warning.
const COARSE: f64 = 1e-2;

/// Relative errors of values `found` on a mesh, measured on elements of half the length; NaN for values that these
/// lack.
pub fn mesh_errors(mesh: &Mesh, found: &[f64], on_halves: &[f64]) -> Vec<f64> {
    let halves = on_halves.iter().copied().chain(std::iter::repeat(f64::NAN));
    let per_change = mesh.error_per_change();
    let error = |(found, half): (&f64, f64)| per_change * (found / half - 1.0).abs();
    found.iter().zip(halves).map(error).collect()
}

/// How a mesh is refined to measure its error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refined {
    /// By elements of half the length.
    Elements,
    /// By polynomials of higher order.
    Orders,
}

impl Refined {
    /// How, in words.
    pub fn how(self) -> &'static str {
        match self {
            Self::Elements => "elements halved",
            Self::Orders => "orders raised",
        }
    }
}

/// Warning of a mesh that is too coarse for some values.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CoarseMesh {
    /// Natural frequencies or zeros.
    #[error(
        "from {what} {first} on the mesh is wrong by more than 1 %, at the worst by {worst:.1e} ({})",
        by.how()
    )]
    Numbered {
        /// Name of the values.
        what: &'static str,
        /// Number of the first value with a large error, from 1.
        first: usize,
        /// Largest relative error.
        worst: f64,
        /// How it is measured.
        by: Refined,
    },
    /// Transfers over frequency.
    #[error(
        "{}, at the worst by {worst:.1e} at {} Hz ({})",
        match below_hz {
            Some(below_hz) => format!(
                "above {} Hz the mesh is wrong by more than 1 %",
                significant(*below_hz, 4)
            ),
            None => "at all frequencies the mesh is wrong by more than 1 %".into(),
        },
        significant(*at_hz, 4),
        by.how()
    )]
    Band {
        /// Highest frequency in Hz below all large errors; absent if the first error is large.
        below_hz: Option<f64>,
        /// Largest relative error.
        worst: f64,
        /// Its frequency in Hz.
        at_hz: f64,
        /// How it is measured.
        by: Refined,
    },
}

impl CoarseMesh {
    /// A warning, if one of the `errors` of a numbered list is large.
    pub fn of(what: &'static str, errors: &[f64], by: Refined) -> Option<Self> {
        // A mode missing at the lower orders counts as wrong by all of its value.
        let known = |error: &f64| match by {
            Refined::Orders if error.is_nan() => 1.0,
            _ => *error,
        };
        let first = 1 + errors.iter().map(known).position(|error| error > COARSE)?;
        let worst = errors.iter().map(known).fold(0.0, f64::max);
        Some(Self::Numbered { what, first, worst, by })
    }

    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        "coarse_mesh"
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::Numbered { by: Refined::Orders, .. } => "ask for fewer modes: --count",
            Self::Band { by: Refined::Orders, .. } => "a lower --to",
            _ => "use more elements, or mesh.elements = \"auto\"",
        }
    }
}

/// The mesh error of transfers over a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandMeshError {
    /// Largest relative error of a transfer.
    pub worst: f64,
    /// Its frequency in Hz.
    pub at_hz: f64,
    /// How it is measured.
    pub by: Refined,
    /// A warning, if the error is large.
    pub warning: Option<CoarseMesh>,
}

impl BandMeshError {
    /// From pairs of a frequency in Hz, ascending, and the relative error there; none without frequencies.
    pub fn of_errors(errors: impl IntoIterator<Item = (f64, f64)>, by: Refined) -> Option<Self> {
        let errors: Vec<_> = errors.into_iter().collect();
        let larger = |known: (f64, f64), own: (f64, f64)| if own.1 > known.1 { own } else { known };
        let (at_hz, worst) = errors.iter().copied().reduce(larger)?;
        let warning = errors.iter().position(|(_, error)| *error > COARSE).map(|first| {
            let below_hz = first.checked_sub(1).map(|last| errors[last].0);
            CoarseMesh::Band { below_hz, worst, at_hz, by }
        });
        Some(Self { worst, at_hz, by, warning })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{Link, uniform};

    #[test]
    fn what_the_halves_do_not_have_has_no_error() {
        let mesh = Mesh::on(&Link::new(uniform()).unwrap(), 4);
        let errors = mesh_errors(&mesh, &[1.015, 2.0], &[1.0]);
        assert!((errors[0] - 0.016).abs() < 1e-15 && errors[1].is_nan());
        assert_eq!(CoarseMesh::of("mode", &[0.01, f64::NAN], Refined::Elements), None);
        let found =
            CoarseMesh::of("mode", &[1e-3, 0.02, f64::NAN, 0.05, 0.04], Refined::Elements).unwrap();
        let expected = "from mode 2 on the mesh is wrong by more than 1 %, at the worst by 5.0e-2 (elements halved)";
        assert_eq!(found.to_string(), expected);
        let found = CoarseMesh::of("mode", &[1e-3, f64::NAN], Refined::Orders).unwrap();
        let expected = "from mode 2 on the mesh is wrong by more than 1 %, at the worst by 1.0e0 (orders raised)";
        assert_eq!(
            (&found.to_string()[..], found.hint()),
            (expected, "ask for fewer modes: --count")
        );
    }

    #[test]
    fn a_band_is_right_up_to_the_last_frequency_before_the_first_that_is_wrong() {
        let told = |errors: &[(f64, f64)]| {
            let error =
                BandMeshError::of_errors(errors.iter().copied(), Refined::Elements).unwrap();
            error.warning.map(|warning| warning.to_string())
        };
        assert_eq!(BandMeshError::of_errors([], Refined::Elements), None);
        assert_eq!(told(&[(1.0, 1e-3), (2.0, 9e-3)]), None);
        let wrong = "the mesh is wrong by more than 1 %, at the worst by";
        assert_eq!(
            told(&[(1.0, 1e-3), (2.0, 2e-3), (3.0, 0.03), (4.0, 1e-3), (5.0, 0.015)]),
            Some(format!("above 2.000 Hz {wrong} 3.0e-2 at 3.000 Hz (elements halved)"))
        );
        assert_eq!(
            told(&[(1.0, 0.03), (2.0, 1e-3)]),
            Some(format!("at all frequencies {wrong} 3.0e-2 at 1.000 Hz (elements halved)"))
        );
    }
}
