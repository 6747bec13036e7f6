//! Damping matrices of an assembled link.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

/// `C = M Φ diag(2ζω) Φᵀ M`, which gives each flexible mode its own ratio ζ and leaves the rigid one
/// free (Bayo 1987, eq 12); `ratio` of the number of a mode, from 1, and its ω in rad/s.
pub(crate) fn modal(
    mass: &Mat<f64>,
    stiffness: &Mat<f64>,
    ratio: impl Fn(usize, f64) -> f64,
) -> Mat<f64> {
    // M = L Lᵀ, then the symmetric L⁻¹ K L⁻ᵀ.
    let factor = mass.llt(Side::Lower).expect("a positive mass matrix").L().to_owned();
    let inverse = factor.partial_piv_lu().solve(Mat::<f64>::identity(mass.nrows(), mass.nrows()));
    let symmetric = &inverse * stiffness * inverse.transpose();
    let eigen = symmetric.self_adjoint_eigen(Side::Lower).expect("finite matrices");
    let (squares, vectors) = (eigen.S().column_vector(), eigen.U());
    // Ascending: the rigid rotation comes first.
    let rate = |k: usize| {
        let omega = squares[k].max(0.0).sqrt();
        if k == 0 { 0.0 } else { 2.0 * ratio(k, omega) * omega }
    };
    let damped = Mat::from_fn(mass.nrows(), mass.nrows(), |row, k| vectors[(row, k)] * rate(k));
    let shared = damped * vectors.transpose();
    &factor * shared * factor.transpose()
}
