//! Errors of the mesh in frequencies, zeros and transfers of a link.

use thiserror::Error;

use crate::numeric::significant;

/// Relative error above which the user is warned.
const COARSE: f64 = 1e-2;

/// Relative errors of values `found` on a mesh, measured on elements of half the length; NaN if these
/// have no such value.
///
/// Errors fall with the fourth power of the element length: the halves have a sixteenth of the error,
/// and the change is 15/16 of it.
pub fn mesh_errors(found: &[f64], on_halves: &[f64]) -> Vec<f64> {
    let halves = on_halves.iter().copied().chain(std::iter::repeat(f64::NAN));
    found.iter().zip(halves).map(|(found, half)| mesh_error((found / half - 1.0).abs())).collect()
}

/// The relative error that follows from a relative change on halved elements.
pub fn mesh_error(change: f64) -> f64 {
    16.0 / 15.0 * change
}

/// Warning of a mesh that is too coarse for some values.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum CoarseMesh {
    /// Natural frequencies or zeros.
    #[error(
        "from {what} {first} on the mesh is wrong by more than 1 %, at the worst by {worst:.1e} \
         (elements halved)"
    )]
    Numbered {
        /// Name of the values.
        what: &'static str,
        /// Number of the first that is, from 1.
        first: usize,
        /// Largest relative error of all.
        worst: f64,
    },
    /// Transfers over frequency.
    #[error(
        "{}, at the worst by {worst:.1e} at {} Hz (elements halved)",
        match below_hz {
            Some(below_hz) => format!(
                "above {} Hz the mesh is wrong by more than 1 %",
                significant(*below_hz, 4)
            ),
            None => "at all frequencies the mesh is wrong by more than 1 %".into(),
        },
        significant(*at_hz, 4)
    )]
    Band {
        /// Highest frequency in Hz up to which all errors are small; none if the first is not.
        below_hz: Option<f64>,
        /// Largest relative error.
        worst: f64,
        /// Its frequency in Hz.
        at_hz: f64,
    },
}

impl CoarseMesh {
    /// A warning, if one of the `errors` of a numbered list is large.
    pub fn of(what: &'static str, errors: &[f64]) -> Option<Self> {
        let first = 1 + errors.iter().position(|error| *error > COARSE)?;
        let worst = errors.iter().copied().fold(0.0, f64::max);
        Some(Self::Numbered { what, first, worst })
    }

    /// Name of the kind, for machines.
    pub fn kind(&self) -> &'static str {
        "coarse_mesh"
    }

    /// What the user can do about it.
    pub fn hint(&self) -> &'static str {
        "more elements, or mesh.elements = \"auto\""
    }
}

/// The mesh error of transfers over a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BandMeshError {
    /// Largest relative error of a transfer.
    pub worst: f64,
    /// Its frequency in Hz.
    pub at_hz: f64,
    /// Last frequency before the first error above 1 %, if there is one.
    below_hz: Option<f64>,
    is_coarse: bool,
}

impl BandMeshError {
    /// From pairs of a frequency in Hz, ascending, and the relative change there on halved elements; none
    /// without frequencies.
    pub fn of_changes(changes: impl IntoIterator<Item = (f64, f64)>) -> Option<Self> {
        changes.into_iter().fold(None, |known: Option<Self>, (at_hz, change)| {
            let worst = mesh_error(change);
            let own = Self { worst, at_hz, below_hz: None, is_coarse: worst > COARSE };
            let Some(known) = known else {
                return Some(Self { below_hz: (worst <= COARSE).then_some(at_hz), ..own });
            };
            let is_coarse = known.is_coarse || own.is_coarse;
            let below_hz = if is_coarse { known.below_hz } else { Some(at_hz) };
            let larger = if own.worst > known.worst { own } else { known };
            Some(Self { below_hz, is_coarse, ..larger })
        })
    }

    /// A warning, if the error is large.
    pub fn warning(&self) -> Option<CoarseMesh> {
        let Self { worst, at_hz, below_hz, is_coarse } = *self;
        is_coarse.then_some(CoarseMesh::Band { below_hz, worst, at_hz })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_halves_do_not_have_has_no_error() {
        let errors = mesh_errors(&[1.015, 2.0], &[1.0]);
        assert!((errors[0] - 0.016).abs() < 1e-15 && errors[1].is_nan());
        assert_eq!(CoarseMesh::of("mode", &[0.01, f64::NAN]), None);
        let found = CoarseMesh::of("mode", &[1e-3, 0.02, f64::NAN, 0.05, 0.04]).unwrap();
        let expected = "from mode 2 on the mesh is wrong by more than 1 %, at the worst by 5.0e-2 (elements halved)";
        assert_eq!(found.to_string(), expected);
    }

    #[test]
    fn a_band_is_right_up_to_the_last_frequency_before_the_first_that_is_wrong() {
        let told = |changes: &[(f64, f64)]| {
            let error = BandMeshError::of_changes(changes.iter().copied()).unwrap();
            error.warning().map(|warning| warning.to_string())
        };
        assert_eq!(BandMeshError::of_changes([]), None);
        assert_eq!(told(&[(1.0, 1e-3), (2.0, 9e-3)]), None);
        let wrong = "the mesh is wrong by more than 1 %, at the worst by";
        assert_eq!(
            told(&[(1.0, 1e-3), (2.0, 2e-3), (3.0, 0.03), (4.0, 1e-3), (5.0, 0.015)]),
            Some(format!("above 2.000 Hz {wrong} 3.2e-2 at 3.000 Hz (elements halved)"))
        );
        assert_eq!(
            told(&[(1.0, 0.03), (2.0, 1e-3)]),
            Some(format!("at all frequencies {wrong} 3.2e-2 at 1.000 Hz (elements halved)"))
        );
    }
}
