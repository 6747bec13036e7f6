//! Complex modes of damped small motions: the solver follows each undamped mode while its damping grows from 0 to its
//! full value.

use num_complex::Complex64;

use crate::numeric::magnitude;

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
