//! Damping ratios of one link's modes, with its hub free, with friction, on a spring or clamped. The solver
//! follows each undamped mode while its damping grows from 0 to its full value.

use num_complex::Complex64;

use super::modes::{Equations, HubReaction};
use crate::beam::Mesh;
use crate::link::Link;
use crate::modal::{DampingLaw, ModalBasis, PoseHub, flexible_modes};
use crate::numeric::{Size, magnitude};

/// Modes of the free link in the first sum beyond twice the requested ones, and number of modes that ends the doubling.
const MORE_MODES: usize = 12;
const MOST_MODES: usize = 200;

/// Relative change of a ratio by twice as many modes that ends the summing.
const TOLERANCE: f64 = 1e-7;

/// The viscous damping ratios of the link's first modes with this hub, at their undamped frequencies in rad/s. They
/// belong to the complex modes of
///
/// ```text
/// (s² + c_k s + ω_k²) q_k + p_k (κ + b s) pᵀq = 0
/// ```
///
/// q being the modes of the free link, p their hub angles, κ the spring and b the hub's friction. Hysteretic damping
/// has `c_k = 2ξω_k²/|s|`. NaN for a mode that does not vibrate.
pub fn damping_ratios(
    (link, mesh, law): (&Link, &Mesh, &DampingLaw),
    hub: PoseHub,
    omega_rad_s: &[f64],
) -> Vec<f64> {
    let friction_n_m_s_rad = link.joint().friction();
    let at_hub = match hub {
        // The law already damps the modes of the free link.
        PoseHub::Free if friction_n_m_s_rad == 0.0 => return law.modal_ratios(omega_rad_s),
        PoseHub::Free => (0.0, friction_n_m_s_rad),
        // A clamped hub has no friction.
        PoseHub::Spring(f64::INFINITY) => (f64::INFINITY, 0.0),
        PoseHub::Spring(stiffness) => (stiffness, friction_n_m_s_rad),
    };
    let all = flexible_modes(mesh);
    let mut count = (2 * omega_rad_s.len() + MORE_MODES).min(all);
    let on = |count: usize| {
        let hub = OnHub::new((mesh, law), count, at_hub);
        let ratio = |(k, omega): (usize, &f64)| hub.ratio(k, *omega).unwrap_or(f64::NAN);
        omega_rad_s.iter().enumerate().map(ratio).collect::<Vec<f64>>()
    };
    let mut known = on(count);
    while count < all && count < MOST_MODES {
        count = (2 * count).min(all);
        let finer = on(count);
        let changes = known.iter().zip(&finer).map(|(known, finer)| {
            if known.is_nan() && finer.is_nan() { 0.0 } else { (known - finer).abs() / finer.abs() }
        });
        let change = changes.fold(0.0, Size::larger);
        known = finer;
        if change <= TOLERANCE {
            break;
        }
    }
    known
}

/// The modes of the free link, and the spring and friction at its hub.
struct OnHub {
    /// ω², viscous rates in 1/s, losses 2ξω² in 1/s² and hub angles of the coordinates, the rigid rotation first.
    squares: Vec<f64>,
    rates_per_s: Vec<f64>,
    losses: Vec<f64>,
    hub_angles: Vec<f64>,
    /// Stiffness in N m/rad; infinite for a clamped hub.
    spring_n_m_rad: f64,
    friction_n_m_s_rad: f64,
}

impl OnHub {
    fn new(
        (mesh, law): (&Mesh, &DampingLaw),
        count: usize,
        (spring_n_m_rad, friction_n_m_s_rad): (f64, f64),
    ) -> Self {
        let basis = ModalBasis::lowest(mesh, count);
        let modes = Equations::new(mesh, law, basis, HubReaction::default()).coordinates;
        let squares: Vec<f64> = modes.iter().map(|own| own.square).collect();
        let (rates_per_s, losses) = match law {
            DampingLaw::Hysteretic { ratio } => (
                vec![0.0; modes.len()],
                squares.iter().map(|square| 2.0 * ratio * square).collect(),
            ),
            _ => (modes.iter().map(|own| own.rate_per_s).collect(), vec![0.0; modes.len()]),
        };
        let hub_angles = modes.iter().map(|own| own.hub_angle).collect();
        Self { squares, rates_per_s, losses, hub_angles, spring_n_m_rad, friction_n_m_s_rad }
    }

    /// Damping ratio of the mode with this number, from 0, and this undamped frequency.
    fn ratio(&self, number: usize, omega_rad_s: f64) -> Option<f64> {
        let alone = |own: usize| {
            let unit = (0..self.squares.len()).map(|k| if k == own { 1.0 } else { 0.0 });
            unit.collect::<Vec<f64>>()
        };
        let apart = |k: usize| self.squares[k] - omega_rad_s * omega_rad_s;
        let x = if self.spring_n_m_rad == 0.0 {
            alone(number + 1)
        } else if let Some(own) = (0..self.squares.len()).find(|k| apart(*k) == 0.0) {
            // A mode of the free link that does not turn the hub.
            alone(own)
        } else {
            (0..self.squares.len()).map(|k| self.hub_angles[k] / apart(k)).collect()
        };
        damping_ratio(self, omega_rad_s, &x)
    }

    /// `pᵀ x`.
    fn hub_angle(&self, x: &[Complex64]) -> Complex64 {
        x.iter().zip(&self.hub_angles).map(|(x, angle)| x * *angle).sum()
    }
}

impl SmallMotions for OnHub {
    fn inertia(&self, x: &[Complex64]) -> Vec<Complex64> {
        x.to_vec()
    }

    fn damping(&self, s_per_s: Complex64, x: &[Complex64]) -> Vec<Complex64> {
        let at_hub = self.hub_angle(x) * self.friction_n_m_s_rad;
        let size = magnitude(s_per_s);
        let of = |k: usize| {
            x[k] * (self.rates_per_s[k] + self.losses[k] / size) + at_hub * self.hub_angles[k]
        };
        (0..x.len()).map(of).collect()
    }

    /// Applies the formula of Sherman and Morrison, as only the hub's spring and friction couple the coordinates.
    fn solved(&self, s_per_s: Complex64, share: f64, y: &[Complex64]) -> Option<Vec<Complex64>> {
        let size = magnitude(s_per_s);
        let receptances = |k: usize| {
            let rate = self.rates_per_s[k] + self.losses[k] / size;
            (s_per_s * s_per_s + s_per_s * (share * rate) + self.squares[k]).inv()
        };
        let receptances: Vec<Complex64> = (0..y.len()).map(receptances).collect();
        let alone: Vec<Complex64> = y.iter().zip(&receptances).map(|(y, own)| y * own).collect();
        let of_hub = self.hub_angles.iter().zip(&receptances);
        let of_hub: Vec<Complex64> = of_hub.map(|(angle, own)| own * *angle).collect();
        let compliance = self.hub_angle(&of_hub);
        let at_hub = s_per_s * (share * self.friction_n_m_s_rad) + self.spring_n_m_rad;
        let torque = self.hub_angle(&alone)
            * if self.spring_n_m_rad.is_infinite() {
                compliance.inv()
            } else {
                at_hub / (at_hub * compliance + 1.0)
            };
        let solution: Vec<_> =
            alone.iter().zip(&of_hub).map(|(alone, hub)| alone - hub * torque).collect();
        product(&solution, &solution).is_finite().then_some(solution)
    }
}

/// Most iterations at one share of the damping, and the relative change of s that ends them.
const MOST_ITERATIONS: usize = 20;
const SETTLED: f64 = 1e-12;

/// Largest difference of a step of s from the tangent, over the step; the solver halves a larger step.
const OFF_TANGENT: f64 = 0.25;

/// Least step of the share of the damping. A mode that needs a smaller step is about to stop vibrating.
const LEAST_STEP: f64 = 1e-5;

/// Largest damping ratio of a vibration; beyond it a motion hardly turns back.
const MOST_RATIO: f64 = 0.999_999;

/// The equations `(s² M + s C + K) x = 0` of small motions, all symmetric. Hysteretic damping, a loss independent of
/// the frequency, enters C as the viscous damping `G/|s|` with equal work per cycle.
pub(super) trait SmallMotions {
    /// `M x`.
    fn inertia(&self, x: &[Complex64]) -> Vec<Complex64>;

    /// `C x` at s.
    fn damping(&self, s_per_s: Complex64, x: &[Complex64]) -> Vec<Complex64>;

    /// `(s² M + s t C + K)⁻¹ y` for a share t of the damping. `None` for a singular matrix.
    fn solved(&self, s_per_s: Complex64, share: f64, y: &[Complex64]) -> Option<Vec<Complex64>>;
}

/// A complex mode with a share of the damping.
#[derive(Clone)]
struct Followed {
    s_per_s: Complex64,
    x: Vec<Complex64>,
}

/// The damping ratio `−Re s/|s|` of the mode with this undamped frequency and shape, under all damping. `None` where it
/// does not vibrate.
pub(super) fn damping_ratio(
    motions: &impl SmallMotions,
    omega_rad_s: f64,
    x: &[f64],
) -> Option<f64> {
    let x = x.iter().map(|x| Complex64::from(*x)).collect();
    let start = Followed { s_per_s: Complex64::new(0.0, omega_rad_s), x };
    let mut known = start.settled(motions, 0.0)?;
    let (mut share, mut step) = (0.0_f64, 1.0);
    while share < 1.0 {
        let next = (share + step).min(1.0);
        let tangent = known.tangent(motions, share) * (next - share);
        let begun = Followed { s_per_s: known.s_per_s + tangent, x: known.x.clone() };
        let is_followed = |found: &Followed| {
            let moved = found.s_per_s - known.s_per_s;
            let room = OFF_TANGENT * magnitude(moved) + SETTLED * magnitude(known.s_per_s);
            magnitude(moved - tangent) <= room
        };
        match begun.settled(motions, next).filter(is_followed) {
            Some(found) => {
                (known, share) = (found, next);
                step *= 2.0;
            }
            None => step *= 0.5,
        }
        if step < LEAST_STEP {
            return None;
        }
    }
    // Subtracts from 0, so that an undamped mode has 0 and not −0.
    let ratio = 0.0 - known.s_per_s.re / magnitude(known.s_per_s);
    (ratio < MOST_RATIO).then_some(ratio)
}

impl Followed {
    /// `d/ds (s² M + s t C + K) x`.
    fn slope(&self, motions: &impl SmallMotions, share: f64) -> Vec<Complex64> {
        let damped = motions.damping(self.s_per_s, &self.x);
        let parts = motions.inertia(&self.x).into_iter().zip(damped);
        parts.map(|(inertia, damped)| self.s_per_s * 2.0 * inertia + damped * share).collect()
    }

    /// ds/dt, t being the share of the damping.
    fn tangent(&self, motions: &impl SmallMotions, share: f64) -> Complex64 {
        let damped = product(&self.x, &motions.damping(self.s_per_s, &self.x));
        -self.s_per_s * damped / product(&self.x, &self.slope(motions, share))
    }

    /// The mode at this share, by inverse iteration with Rayleigh's quotient of symmetric matrices:
    ///
    /// ```text
    /// (s² M + s t C + K) u = p,    p = d/ds (s² M + s t C + K) x,    s ← s − pᵀx/pᵀu,    x ← u
    /// ```
    fn settled(mut self, motions: &impl SmallMotions, share: f64) -> Option<Self> {
        for _ in 0..MOST_ITERATIONS {
            let slope = self.slope(motions, share);
            // No inverse exists exactly at the mode.
            let Some(next) = motions.solved(self.s_per_s, share, &slope) else { return Some(self) };
            let change = product(&slope, &self.x) / product(&slope, &next);
            if !change.is_finite() {
                return Some(self);
            }
            self.s_per_s -= change;
            self.x = next.into_iter().map(|u| u * change).collect();
            if magnitude(change) <= SETTLED * magnitude(self.s_per_s) {
                return Some(self);
            }
        }
        None
    }
}

/// `xᵀ y` without conjugation.
pub(super) fn product(x: &[Complex64], y: &[Complex64]) -> Complex64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
