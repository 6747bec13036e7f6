//! Modes and damping matrices of an assembled link.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// Natural frequencies ω in rad/s, ascending, the rigid rotation first, and mass-normalised shapes
/// Φ, one a column: `Φᵀ M Φ = 1`.
pub(crate) fn modes(mass: &Mat<f64>, stiffness: &Mat<f64>) -> (Vec<f64>, Mat<f64>) {
    // M = L Lᵀ, then the symmetric L⁻¹ K L⁻ᵀ.
    let size = mass.nrows();
    let factor = mass.llt(Side::Lower).expect("a positive mass matrix").L().to_owned();
    let inverse = factor.partial_piv_lu().solve(Mat::<f64>::identity(size, size));
    let symmetric = &inverse * stiffness * inverse.transpose();
    let eigen = symmetric.self_adjoint_eigen(Side::Lower).expect("finite matrices");
    let squares = eigen.S().column_vector();
    let frequencies = (0..size).map(|k| if k == 0 { 0.0 } else { squares[k].sqrt() });
    (frequencies.collect(), inverse.transpose() * eigen.U())
}

/// `C = M Φ diag(2ζω) Φᵀ M`, which gives each flexible mode its own ratio ζ and leaves the rigid one
/// free (Bayo 1987, eq 12); `ratio` of the number of a mode, from 1, and its ω in rad/s.
pub(crate) fn modal(
    mass: &Mat<f64>,
    stiffness: &Mat<f64>,
    ratio: impl Fn(usize, f64) -> f64,
) -> Mat<f64> {
    let (frequencies, shapes) = modes(mass, stiffness);
    let rate =
        |k: usize| if k == 0 { 0.0 } else { 2.0 * ratio(k, frequencies[k]) * frequencies[k] };
    let momenta = mass * shapes;
    let size = mass.nrows();
    let damped = Mat::from_fn(size, size, |row, k| momenta[(row, k)] * rate(k));
    damped * momenta.transpose()
}
