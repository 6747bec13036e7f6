//! The torques of the rigid arm, by recursive Newton-Euler.

use crate::elastica::AngleHistories;
use crate::link::Arm;

/// Mass moments of a rigid link.
struct RigidLink {
    length_m: f64,
    mass_kg: f64,
    /// First moment about its joint in kg m.
    moment_kg_m: f64,
    /// Rotary inertia about its joint in kg m², hub included.
    inertia_kg_m2: f64,
    friction_n_m_s_rad: f64,
}

/// Torques in N m of the joints of an arm of rigid links with these directions.
///
/// ```text
/// a₁ = −g,   aᵢ₊₁ = aᵢ + Lᵢ c,   c = −θ̇ᵢ² e + θ̈ᵢ n
/// Fᵢ = mᵢ aᵢ + Sᵢ c + Fᵢ₊₁,   Tᵢ = Iᵢ θ̈ᵢ + (Sᵢ aᵢ + Lᵢ Fᵢ₊₁)·n + Tᵢ₊₁
/// ```
///
/// Friction comes last: like the torque it acts between two links.
pub(super) fn rigid_torques_n_m(arm: &Arm, chords: &[AngleHistories]) -> Vec<Vec<f64>> {
    let links: Vec<RigidLink> = arm
        .links()
        .iter()
        .map(|own| RigidLink {
            length_m: own.link.length_m(),
            mass_kg: own.link.mass_kg(),
            moment_kg_m: own.link.mass_moment_kg_m(),
            inertia_kg_m2: own.link.rigid_inertia_kg_m2(),
            friction_n_m_s_rad: own.link.joint().friction_n_m_s_rad,
        })
        .collect();
    let samples = chords[0][0].len();
    let mut torques_n_m = vec![Vec::with_capacity(samples); links.len()];
    let mut axes = Vec::with_capacity(links.len());
    for k in 0..samples {
        let mut axis = arm.gravity_m_s2().map(|part| -part);
        axes.clear();
        for (link, chord) in links.iter().zip(chords) {
            let [angle, rate, turning] = [0, 1, 2].map(|part| chord[part][k]);
            let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
            let per_m =
                [-rate * rate * cosine - turning * sine, -rate * rate * sine + turning * cosine];
            axes.push((axis, per_m, [-sine, cosine], turning));
            axis = [0, 1].map(|part| axis[part] + link.length_m * per_m[part]);
        }
        let (mut force_n, mut torque_n_m) = ([0.0; 2], 0.0);
        for (number, link) in links.iter().enumerate().rev() {
            let (axis, per_m, across, turning) = axes[number];
            let onto = |vector: [f64; 2]| vector[0] * across[0] + vector[1] * across[1];
            torque_n_m += link.inertia_kg_m2 * turning
                + link.moment_kg_m * onto(axis)
                + link.length_m * onto(force_n);
            force_n = [0, 1].map(|part| {
                force_n[part] + link.mass_kg * axis[part] + link.moment_kg_m * per_m[part]
            });
            let before = number.checked_sub(1).map_or(0.0, |before| chords[before][1][k]);
            let friction_n_m = link.friction_n_m_s_rad * (chords[number][1][k] - before);
            torques_n_m[number].push(torque_n_m + friction_n_m);
        }
    }
    torques_n_m
}
