use crate::link::Link;
use crate::modal::DampingLaw;
use crate::motion::TipMotionHistories;

/// Torque in N m that moves the tip of the same link, were it rigid.
///
/// ```text
/// T_rigid = I_rigid (a + αv)/L + b v/L
/// ```
///
/// α is the mass part of Rayleigh damping and zero otherwise: the torque of the flexible link tends
/// to this one as EI grows.
pub(super) fn rigid_torque_n_m(
    link: &Link,
    law: &DampingLaw,
    tip: &TipMotionHistories,
) -> Vec<f64> {
    let inertia = link.rigid_inertia_kg_m2() / link.length_m();
    let friction = link.joint().friction_n_m_s_rad / link.length_m();
    let drag = inertia * law.mass_rate_per_s() + friction;
    let samples = tip.acceleration_m_s2.iter().zip(&tip.velocity_m_s);
    samples.map(|(a, v)| inertia * a + drag * v).collect()
}
