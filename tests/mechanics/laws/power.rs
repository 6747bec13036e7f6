//! Where the power goes.

use flexlink::beam::{Gain, Mesh, condense, tip_transfer};
use nalgebra::{Matrix2, Vector2};
use num_complex::Complex64;
use proptest::prelude::*;

use super::links::{any_excitation, any_parts, mesh};

/// `Σ d^H K_d d` over all elements for a hub angle, twice the strain energy of an undamped link with
/// these deformations, and the motion of the tip.
///
/// ```text
/// u_0 = (x_0, 1)ᵀ θ,  d = G u_i,  u_j = R u_i + d
/// ```
fn strain(mesh: &Mesh, lambda: Complex64, theta: Complex64) -> (f64, Complex64) {
    let mut gains = Vec::new();
    condense(mesh, lambda, |_, step| gains.push(step.gain()));
    let mut u = Vector2::new(theta * mesh.nodes_m()[0], theta);
    let mut sum = 0.0;
    for (element, gain) in mesh.relative_elements().iter().zip(gains.iter().rev()) {
        let Gain { vv, vp, pv, pp } = *gain;
        let d = Matrix2::new(vv, vp, pv, pp) * u;
        sum += (d.adjoint() * element.k_d.map(Complex64::from) * d)[0].re;
        u = Vector2::new(u[0] + u[1] * element.length_m, u[1]) + d;
    }
    (sum, u[0])
}

proptest! {
    /// Re(T (iωθ)*) = 2ξω Σ d^H K_d d: K* = K(1 + 2iξ) turns strain into heat, nothing else does.
    #[test]
    fn the_torque_feeds_what_hysteresis_dissipates(
        parts in any_parts(),
        excitation in any_excitation(),
        elements in 7_usize..40,
    ) {
        let mesh = mesh(&parts, elements);
        let (lambda, omega) = (excitation.lambda(&mesh), excitation.omega_rad_s(&mesh));
        // v_tip = 1 m.
        let transfer = tip_transfer(&mesh, lambda);
        let torque = -transfer.inertia_kg_m * omega * omega;
        let rate = Complex64::I * omega * transfer.angle_rad_m;
        let (strain, tip) = strain(&mesh, lambda, transfer.angle_rad_m);
        let fed = (torque * rate.conj()).re;
        let dissipated = 2.0 * excitation.xi * omega * strain;
        prop_assert!((tip - 1.0).norm() < 1e-9, "the tip moves by {} m", tip);
        prop_assert!(dissipated > 0.0);
        let off = (fed - dissipated).abs() / (torque * rate).norm();
        prop_assert!(off < 1e-10, "{} W is not {} W: {:e}", fed, dissipated, off);
    }
}
