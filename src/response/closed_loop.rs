//! Hysteretic damping of a link whose hub feedback holds.
//!
//! The damping ratio ξ belongs to the strain of the link, so its viscous matrix depends on the modes that vibrate:
//! those of the free hub without feedback, those of the held hub under stiff feedback. Between them the matrix is
//!
//! ```text
//! D = (1 − w) D_free + w D_held,    w = |Z|²/(|Z|² + (I ω₁²)²),    Z = k + iω₁ d
//! ```
//!
//! with the gains k and d, the inertia I about the axis and the first frequency ω₁ of the free hub. Neither matrix
//! damps a rotation of the unbent link.

use super::modes::{Equations, HubReaction, held_modes};
use crate::modal::DampingLaw;

/// Part w of the held hub's damping under these gains.
pub(super) fn held_share(reaction: HubReaction, inertia_kg_m2: f64, omega_rad_s: f64) -> f64 {
    let rate_n_m_s_rad = reaction.damping_n_m_s_rad - reaction.friction_n_m_s_rad;
    let stiffness = reaction.stiffness_n_m_rad / inertia_kg_m2 / omega_rad_s.powi(2);
    let rate = rate_n_m_s_rad / inertia_kg_m2 / omega_rad_s;
    let square = stiffness * stiffness + rate * rate;
    if square.is_finite() { square / (1.0 + square) } else { 1.0 }
}

/// Damps the modes of the loop where feedback holds the hub of a hysteretic link; leaves other equations as they are.
pub(super) fn in_loop(mut free: Equations, law: &DampingLaw) -> Equations {
    let DampingLaw::Hysteretic { ratio } = *law else { return free };
    let [rigid, first, ..] = &free.coordinates[..] else { return free };
    let share = held_share(free.reaction, rigid.hub_angle.powi(-2), first.square.sqrt());
    if ratio == 0.0 || share == 0.0 {
        return free;
    }
    let Some(modes) = held_modes(&free) else { return free };
    let count = free.coordinates.len();
    let mut damping = vec![0.0; count * count];
    for (k, coordinate) in free.coordinates.iter().enumerate() {
        damping[k * count + k] = (1.0 - share) * coordinate.rate_per_s;
    }
    for (omega_rad_s, mode) in modes {
        // The coordinate of the held mode: the rotation with the hub bends nothing.
        let follows = mode[0] / rigid.hub_angle;
        let pairs = mode.iter().zip(&free.coordinates);
        let mut bends: Vec<f64> = pairs.map(|(x, free)| x - follows * free.hub_angle).collect();
        bends[0] = 0.0;
        let rate_per_s = share * 2.0 * ratio * omega_rad_s;
        for (own, row) in bends.iter().zip(damping.chunks_exact_mut(count)) {
            row.iter_mut()
                .zip(&bends)
                .for_each(|(entry, other)| *entry += rate_per_s * own * other);
        }
    }
    free.damping = Some(damping);
    free
}
