//! The link on a hub that moves as prescribed.
//!
//! The link is rigidly fixed to the hub: the motor side of a link file's `[drive]` is no part of it, and
//! `hub.inertia` must include the rotor reflected through the gear, N² J.

use super::modes::{Coordinate, Equations, PrescribedHub};
use crate::modal::{DampingLaw, Shape};
use crate::numeric::SymmetricEigen;

/// The equations of the free link with the hub's motion in place of the motor's torque: the coordinates are
/// the hub angle and the modes of the link held at its hub.
///
/// A held mode x is a sum of free modes whose hub angle vanishes. The flexible ones are independent; the
/// rigid rotation follows from them, `x₀ = −Σ p_k x_k/p₀`. So the held frequencies ω are those of
///
/// ```text
/// (1 + p pᵀ/p₀²) x = diag(ω_k²) x/ω²
/// ```
///
/// solved in `y = ω_k x_k` for 1/ω², as exact for low modes as the free ones are. With X the held modes,
/// mass-normalised, and h = x₀/p₀ their product with the rotation by a unit angle,
///
/// ```text
/// η̈ + D η̇ + diag(ω²) η = −h (θ̈ + α θ̇),    D = Xᵀ diag(c) X
/// T = (θ̈ + α θ̇)/p₀² + hᵀ(η̈ + α η̇) + b θ̇
/// ```
///
/// T is the rate of the whole link's angular momentum, and what friction and drag take. Where the ratio of
/// hysteretic damping ξ stands for a viscous one, it is that of the modes that vibrate: D = 2ξω.
///
/// None where the numbers are not finite.
pub(super) fn held(free: &Equations, law: &DampingLaw) -> Option<Equations> {
    let [rigid, flexible @ ..] = &free.coordinates[..] else { return None };
    let count = flexible.len();
    let scaled = |mode: &Coordinate| mode.hub_angle / rigid.hub_angle / mode.square.sqrt();
    let mut matrix = vec![0.0; count * count];
    for (i, own) in flexible.iter().enumerate() {
        for (j, other) in flexible.iter().enumerate().take(i + 1) {
            matrix[i * count + j] = scaled(own) * scaled(other);
        }
        matrix[i * count + i] += own.square.recip();
    }
    let eigen = SymmetricEigen::new(count, matrix)?;
    let mut coordinates = vec![Coordinate {
        square: 0.0,
        rate_per_s: 0.0,
        drive: 1.0,
        hub_angle: 1.0,
        tip: rigid.tip / rigid.hub_angle,
    }];
    let mut shapes = vec![free.shapes[0].clone().scaled(rigid.hub_angle.recip())];
    let mut modes: Vec<Vec<f64>> = Vec::with_capacity(count);
    for (number, k) in (0..count).rev().enumerate() {
        let omega_rad_s = eigen.values[k].sqrt().recip();
        let own = eigen.vector(k).iter().zip(flexible);
        let own: Vec<f64> = own.map(|(y, mode)| omega_rad_s * y / mode.square.sqrt()).collect();
        let turned: f64 = own.iter().zip(flexible).map(|(x, mode)| x * mode.hub_angle).sum();
        let mode: Vec<f64> = std::iter::once(-turned / rigid.hub_angle).chain(own).collect();
        coordinates.push(Coordinate {
            square: omega_rad_s * omega_rad_s,
            rate_per_s: 2.0 * law.modal_ratio(number + 1, omega_rad_s) * omega_rad_s,
            drive: -mode[0] / rigid.hub_angle,
            hub_angle: 0.0,
            tip: mode.iter().zip(&free.coordinates).map(|(x, free)| x * free.tip).sum(),
        });
        shapes.push(Shape { hub_angle: 0.0, ..Shape::sum(&mode, &free.shapes) });
        modes.push(mode);
    }
    let drag_per_s = law.mass_rate_per_s();
    let damping = (law.is_modal() || drag_per_s != 0.0).then(|| {
        let size = count + 1;
        let mut damping = vec![0.0; size * size];
        for (i, own) in modes.iter().enumerate() {
            let row = &mut damping[(i + 1) * size..][..size];
            row[0] = -drag_per_s * coordinates[i + 1].drive;
            for (j, other) in modes.iter().enumerate() {
                let rates = free.coordinates.iter().map(|mode| mode.rate_per_s);
                let terms = own.iter().zip(other).zip(rates).map(|((a, b), rate)| rate * a * b);
                row[j + 1] = terms.sum();
            }
        }
        damping
    });
    let prescribed = PrescribedHub { inertia_kg_m2: rigid.hub_angle.powi(-2), drag_per_s };
    let reaction = free.reaction.of_friction();
    Some(Equations { coordinates, shapes, reaction, damping, prescribed: Some(prescribed) })
}
