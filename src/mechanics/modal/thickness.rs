use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::basis::ModalBasis;
use super::frequencies::real_frequency_zeros;
use super::law::DampingLaw;
use super::shape::{Mode, mode};
use crate::beam::{Element, Mesh};
use crate::link::{CrossSection, Link, Segment, Taper};
use crate::numeric::Scalar as _;

/// Share of a natural frequency or of a torque above which a warning is due. For a frequency it equals 2 % of
/// stiffness, more than the uncertainty of a maker's data of section and material.
pub const NOTICEABLE: f64 = 1e-2;

/// √(E/ρ) in m/s assumed for an unknown section: the value of steel, aluminium and wood.
const USUAL_SPEED_M_S: f64 = 5e3;

/// κ assumed for an unknown section: the value of a thin tube, the smallest of the usual ones.
const LEAST_SHEAR_COEFFICIENT: f64 = 0.5;

/// Estimate of how much neglected shear and rotary inertia would lower natural frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Thickness {
    /// Cross-section of each segment; `None` if unknown.
    sections: Vec<Option<CrossSection>>,
}

/// Natural frequencies that shear and rotary inertia lower by more than 1 %.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "shear and rotary inertia, which the theory leaves out, lower natural frequencies by about {}",
    range(lowest, highest)
)]
pub struct ThickLink {
    /// The lowest such mode.
    pub lowest: LoweredMode,
    /// The highest such mode of those examined.
    pub highest: LoweredMode,
}

/// A mode and the share by which its frequency is lower.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LoweredMode {
    /// Number of the flexible mode, from 1.
    pub number: usize,
    /// Share of the frequency that a thick link lacks.
    pub share: f64,
}

fn range(lowest: &LoweredMode, highest: &LoweredMode) -> String {
    let one = |mode: &LoweredMode| format!("{:.0} % (mode {})", 100.0 * mode.share, mode.number);
    if lowest.number == highest.number {
        one(lowest)
    } else {
        format!("{} to {}", one(lowest), one(highest))
    }
}

impl ThickLink {
    /// Machine-readable name of the kind.
    pub fn kind(&self) -> &'static str {
        "thick_link"
    }

    /// Suggests a remedy to the user.
    pub fn hint(&self) -> &'static str {
        "set theory = \"timoshenko\" to include them; solve reports their effect on the torque"
    }
}

impl Thickness {
    /// Uses the known sections; other segments count as slender.
    pub fn known(link: &Link) -> Self {
        Self { sections: link.segments().iter().map(Segment::slender_section).collect() }
    }

    /// Guesses the unknown sections; `None` if all are known.
    ///
    /// Stiffness and mass give the radius of gyration up to the speed of sound: `EI/m̄ = r² E/ρ`.
    pub fn guessed(link: &Link) -> Option<Self> {
        let segments = link.segments();
        let is_unknown =
            |segment: &Segment| segment.cross_section.is_none() && segment.timoshenko.is_none();
        if !segments.iter().any(is_unknown) {
            return None;
        }
        let section = |segment: &Segment| {
            let guessed = || guess(segment).filter(|_| segment.timoshenko.is_none());
            segment.slender_section().or_else(guessed)
        };
        Some(Self { sections: segments.iter().map(section).collect() })
    }

    /// True if the first `modes` modes cannot be lowered noticeably, by a quick test of the radii alone.
    ///
    /// Mode n bends in n + 1 half waves at most. In a softer piece the half waves are shorter; a factor of four on
    /// their energy allows for it.
    pub fn is_slender(&self, mesh: &Mesh, modes: usize) -> bool {
        let nodes_m = mesh.nodes_m();
        let length_m = nodes_m[nodes_m.len() - 1] - nodes_m[0];
        let wave_number = (modes + 1) as f64 * std::f64::consts::PI / length_m;
        let share = |section: &CrossSection| {
            let Taper { inner, outer } = section.radius_of_gyration_m;
            let thick = inner.max(outer) * wave_number;
            2.0 * thick * thick * (1.0 + section.shear_flexibility())
        };
        self.sections.iter().flatten().all(|section| share(section) < NOTICEABLE)
    }

    /// Modes lowered by more than 1 %, from the link's first natural frequencies.
    pub fn noticeable(&self, mesh: &Mesh, omegas_rad_s: &[f64]) -> Option<ThickLink> {
        if self.sections.iter().all(Option::is_none) {
            return None;
        }
        let shares = omegas_rad_s.iter().map(|omega| self.share(mesh, *omega));
        let modes = (1..).zip(shares).map(|(number, share)| LoweredMode { number, share });
        let modes: Vec<_> = modes.filter(|mode| mode.share > NOTICEABLE).collect();
        Some(ThickLink { lowest: *modes.first()?, highest: *modes.last()? })
    }

    /// Estimated share by which shear and rotary inertia lower a natural frequency.
    ///
    /// It uses the energies of the slender link's mode, of unit mass, and adds them up as Dunkerley does:
    ///
    /// ```text
    /// 1/ω_thick² = (1 + R + S)/ω²,   R = ∫ m̄ r² φ² dx,   S = ω² ∫ Q²/(κGA) dx,   κGA = EI/(r² g)
    /// ```
    ///
    /// with φ the slope, Q the shear force per unit acceleration of the mode and g = E/(κG).
    pub fn share(&self, mesh: &Mesh, omega_rad_s: f64) -> f64 {
        1.0 - (1.0 + self.slowing(mesh, &mode(mesh, omega_rad_s))).sqrt().recip()
    }

    /// R + S, the growth of 1/ω² of a mode; for the rigid rotation, at ω = 0, the share of the inertia about the hub.
    fn slowing(&self, mesh: &Mesh, mode: &Mode) -> f64 {
        let Mode { omega_rad_s, shape } = mode;
        let forces = shape.shear_forces(mesh);
        let (mut rotary, mut shear) = (0.0, 0.0);
        for (k, element) in mesh.elements().iter().enumerate().skip(mesh.springs()) {
            let segment = mesh.element_segments()[k];
            let Some(section) = self.sections.get(segment).copied().flatten() else { continue };
            let square_m2 = section.radius_of_gyration_m.mean().powi(2);
            let Element { length_m, bending_stiffness_n_m2, mass_per_length_kg_m, .. } = element;
            let (inner, outer) = (shape.total(mesh, k), shape.total(mesh, k + 1));
            // Slope of the cubic in the middle.
            let middle = 1.5 * (outer[0] - inner[0]) / length_m - 0.25 * (inner[1] + outer[1]);
            let slopes = (inner[1].powi(2) + 4.0 * middle.powi(2) + outer[1].powi(2)) / 6.0;
            rotary += length_m * mass_per_length_kg_m.mean() * square_m2 * slopes;
            let [from, to] = forces[k];
            let compliance =
                square_m2 * section.shear_flexibility() / bending_stiffness_n_m2.mean();
            shear += length_m * compliance * (from * from + from * to + to * to) / 3.0;
        }
        let square = omega_rad_s * omega_rad_s;
        rotary + square * shear
    }

    /// Estimate of R + S for a zero at a real frequency, from the energies of the link's motion under a torque at the
    /// hub. The hub's energy is excluded, because a zero does not depend on the hub's inertia. A zero is no eigenvalue
    /// of a symmetric problem: its exact derivative needs a second motion, under a force on the tip.
    fn slowing_of_zero(&self, mesh: &Mesh, zero_rad_s: f64) -> f64 {
        let motion = mode(mesh, zero_rad_s);
        let hub = mesh.joint().inertia() * motion.shape.hub_angle.powi(2);
        self.slowing(mesh, &motion) / (1.0 - hub)
    }

    /// Estimated share by which shear and rotary inertia change a torque: root mean square over root mean square.
    ///
    /// The transfer from the tip is a product over modes and zeros; the rigid rotation is mode 0:
    ///
    /// ```text
    /// T/a_tip = I/L · Π (1 − λ/ω_k²) / Π (1 − λ/ω_z²) / Π (1 + λ/z²)
    /// Δ(T/a_tip) / (T/a_tip) ≈ R₀ − Σ_k (R + S)_k ω²/(ω_k² − λ) + Σ_z (R + S)_z ω²/(ω_z² − λ)
    /// ```
    ///
    /// with ω² for λ in the numerators: only damping makes them differ. Zeros at real frequencies `ω_z`, where no
    /// torque moves the tip, come from rotary inertia: the torque peaks there. The other zeros, z, change little. Far
    /// below the first mode only the section's inertia about the hub remains, R₀ = ∫ m̄r² dx / I.
    ///
    /// `omegas_rad_s` are the natural frequencies of the first modes; the torque has an amplitude at each of the
    /// frequencies `of_torque_rad_s`.
    pub fn torque_change(
        &self,
        mesh: &Mesh,
        law: &DampingLaw,
        omegas_rad_s: &[f64],
        (of_torque_rad_s, torque): (&[f64], &[Complex64]),
    ) -> f64 {
        let rigid = Mode { omega_rad_s: 0.0, shape: ModalBasis::rigid(mesh) };
        let inertia = self.slowing(mesh, &rigid);
        let of_mode =
            |(k, omega): (usize, &f64)| (k + 1, *omega, self.slowing(mesh, &mode(mesh, *omega)));
        let mut factors: Vec<_> = omegas_rad_s.iter().enumerate().map(of_mode).collect();
        let limit_rad_s = of_torque_rad_s.last().copied().unwrap_or(0.0);
        for zero in real_frequency_zeros(mesh, limit_rad_s) {
            // Damped like the mode above it.
            let number = 1 + omegas_rad_s.iter().filter(|mode| **mode < zero).count();
            factors.push((number, zero, -self.slowing_of_zero(mesh, zero)));
        }
        let change = |omega: f64| {
            let of_factor = |(number, place_rad_s, slowing): &(usize, f64, f64)| {
                let denominator = law.modal_denominator(*number, *place_rad_s, omega);
                denominator.reciprocal() * -*slowing
            };
            inertia + factors.iter().map(of_factor).sum::<Complex64>() * (omega * omega)
        };
        let (mut changed, mut whole) = (0.0, 0.0);
        for (omega, amplitude) in of_torque_rad_s.iter().zip(torque) {
            let power = amplitude.norm_sqr();
            let share = change(*omega).norm_sqr();
            // Without damping the torque is 0 at a natural frequency and infinite at a zero.
            changed += if share.is_finite() { share * power } else { 0.0 };
            whole += power;
        }
        (changed / whole).sqrt()
    }
}

/// Section of a segment if its material is usual; `None` for a segment without mass.
fn guess(segment: &Segment) -> Option<CrossSection> {
    let (stiffness, mass) = (segment.bending_stiffness_n_m2, segment.mass_per_length_kg_m);
    // A very large stiffness stands for a rigid piece: no section is as long as its segment.
    let radius_m = |ei: f64, m: f64| ((ei / m).sqrt() / USUAL_SPEED_M_S).min(segment.length_m);
    (mass.inner > 0.0 && mass.outer > 0.0).then(|| CrossSection {
        radius_of_gyration_m: Taper::of_ends(stiffness, mass, radius_m),
        shear_coefficient: LEAST_SHEAR_COEFFICIENT,
    })
}
