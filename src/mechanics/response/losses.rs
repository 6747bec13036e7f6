//! Losses of a drive in the equations of motion: friction of the joint and losses of the gear, solved step by step.
//!
//! The motor gives the effort E at the joint, in front of the losses. It turns the rotor, and the gear passes the rest on
//! to the joint as the torque T (see [`Drive::with_losses`]):
//!
//! ```text
//! f(T, x) = S = E − B θ̇ − R θ̈,   B: of the back voltage, R: inertia of the rotor
//! ```
//!
//! The equations contain B and R as friction and inertia of the joint. So the link moves as under the effort E − L, with the
//! loss L = S − T. Within a step of a linear link L is constant, and rate and acceleration depend on it linearly: one
//! equation for one number. Its left side rises with L from negative to positive values, for all drives, because S rises
//! with L by less than L. Bent links have one loss for each joint and each stage of a step. In an iteration of the step rates
//! and accelerations depend linearly on all of them: [`balanced`].

use nalgebra::{DMatrix, DVector};

use super::driving::Cubic;
use crate::link::{Drive, Link};

/// Losses of a drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct Losses {
    drive: Drive,
    /// Rate of the joint by which the losses change their sign.
    pub(super) friction_rate: f64,
    /// Smallest one that a peak rate sets; 0 where the drive has its own.
    least_rate: f64,
    /// Friction B of the back voltage at the joint, if the motor is under a voltage.
    back: f64,
    /// Inertia R of the rotor at the joint, if the rotor turns with it.
    rotor: f64,
    /// Steps for each step of the input.
    pub(super) substeps: usize,
}

/// Number that depends linearly on the loss: value at no loss, and slope.
type Line = [f64; 2];

/// Way in rad, or over the link's length, that a joint held by friction creeps in a play, about.
const CREEP: f64 = 1e-6;

/// Most steps of the bisection for one loss: the digits of a number, and their halves.
const MOST_STEPS: usize = 120;

/// Most rounds for several losses, and their largest change, over the largest loss, that ends the rounds.
const MOST_ROUNDS: usize = 40;
const BALANCED: f64 = 1e-13;

/// Rates or accelerations of joints that depend linearly on all their losses.
pub(super) struct Answers {
    /// Values without losses.
    pub(super) free: DVector<f64>,
    /// Reductions by a unit of each loss, column by column.
    pub(super) per_loss: DMatrix<f64>,
}

/// The losses of several joints. `joints` has the losses and the effort of each, `losses` where to begin.
///
/// Each round solves every loss alone, while the others stay. Newton's method then couples them by their slopes there. Unlike
/// slopes at the last losses, these do not overshoot where the friction is steep.
pub(super) fn balanced(
    joints: &[(Losses, f64)],
    [rates, accelerations]: [&Answers; 2],
    mut losses: DVector<f64>,
) -> DVector<f64> {
    let count = joints.len();
    if count == 0 {
        return losses;
    }
    for _ in 0..MOST_ROUNDS {
        let (mut slopes, mut alone) = (DMatrix::identity(count, count), losses.clone());
        for (i, (own, effort)) in joints.iter().enumerate() {
            let [rate, acceleration] = [rates, accelerations].map(|of| {
                let others: f64 = (0..count).map(|k| of.per_loss[(i, k)] * losses[k]).sum();
                let slope = of.per_loss[(i, i)];
                [of.free[i] - others + slope * losses[i], -slope]
            });
            alone[i] = own.solve(*effort, rate, acceleration);
            let [by_rate, by_acceleration] = own.slopes(*effort, rate, acceleration, alone[i]);
            for k in 0..count {
                let [of_rate, of_acceleration] =
                    [rates, accelerations].map(|of| of.per_loss[(i, k)]);
                slopes[(i, k)] += by_rate * of_rate + by_acceleration * of_acceleration;
            }
            let whole = slopes[(i, i)];
            slopes.row_mut(i).iter_mut().for_each(|slope| *slope /= whole);
        }
        let size = alone.amax().max(losses.amax());
        let mut change = &alone - &losses;
        let is_balanced = change.amax() <= BALANCED * size;
        if !slopes.lu().solve_mut(&mut change) || is_balanced {
            return alone;
        }
        losses += change;
    }
    losses
}

impl Losses {
    /// Losses of the link's drive, where it has some, for a joint that moves at up to `peak_rate` in a play of `duration_s`.
    /// Under a voltage the equations contain the friction `back` of the back voltage, and the inertia of the rotor.
    pub(super) fn of(
        link: &Link,
        back: Option<f64>,
        (peak_rate, duration_s): (f64, f64),
    ) -> Option<Self> {
        let drive = *link.drive().filter(|drive| drive.has_losses())?;
        let (back, rotor) = back.map_or((0.0, 0.0), |back| (back, drive.rotor_at_joint()));
        let size = if link.joint().slides() { link.length_m() } else { 1.0 };
        let is_set = drive.friction_rate_rad_s.is_some();
        let least_rate = if is_set { 0.0 } else { CREEP * size / duration_s };
        Some(Self { drive, friction_rate: 0.0, least_rate, back, rotor, substeps: 1 }.at(peak_rate))
    }

    /// True if friction holds the joint, which creeps at most.
    pub(super) fn holds(&self) -> bool {
        self.friction_rate <= self.least_rate
    }

    /// The losses for a joint that moves at up to `peak_rate`.
    pub(super) fn at(self, peak_rate: f64) -> Self {
        // A joint that friction holds has no peak rate.
        Self { friction_rate: self.drive.friction_rate(peak_rate).max(self.least_rate), ..self }
    }

    /// The loss L, from the effort in front of rotor and losses, rate and acceleration of the joint.
    pub(super) fn solve(&self, effort: f64, rate: Line, acceleration: Line) -> f64 {
        let Self { drive, friction_rate, back, rotor, .. } = self;
        let geared = |loss: f64| {
            let [rate, acceleration] = [rate, acceleration].map(|own| own[0] + own[1] * loss);
            (effort - back * rate - rotor * acceleration, rate)
        };
        // Torque that would be needed in front of the losses, less the one that there is: falls with the loss.
        let missing = |loss: f64| {
            let (geared, rate) = geared(loss);
            let along = Drive::direction(rate, *friction_rate);
            drive.with_losses(geared - loss, along).torque - geared
        };
        let least = drive.coulomb_friction_n_m + geared(0.0).0.abs();
        let mut reach = least.max(f64::MIN_POSITIVE);
        let (mut low, mut high) = (-reach, reach);
        for _ in 0..MOST_STEPS {
            if missing(low) >= 0.0 && missing(high) <= 0.0 {
                break;
            }
            reach *= 2.0;
            (low, high) = (-reach, reach);
        }
        let (mut at_low, mut at_high) = (missing(low), missing(high));
        // The false position with halved ends (Illinois), and a bisection where it stalls.
        for step in 0..MOST_STEPS {
            if high - low <= 4.0 * f64::EPSILON * low.abs().max(high.abs()) {
                break;
            }
            let straight = (low * at_high - high * at_low) / (at_high - at_low);
            let middle = 0.5 * (low + high);
            let inside = step % 3 != 2 && straight > low && straight < high;
            let loss = if inside { straight } else { middle };
            match missing(loss) {
                0.0 => return loss,
                found if found > 0.0 => (low, at_low, at_high) = (loss, found, 0.5 * at_high),
                found => (high, at_high, at_low) = (loss, found, 0.5 * at_low),
            }
        }
        0.5 * (low + high)
    }

    /// Slopes of the loss by rate and by acceleration of the joint, where it is `loss`.
    fn slopes(&self, effort: f64, rate: Line, acceleration: Line, loss: f64) -> [f64; 2] {
        let Self { drive, friction_rate, back, rotor, .. } = self;
        let [rate, acceleration] = [rate, acceleration].map(|own| own[0] + own[1] * loss);
        let along = Drive::direction(rate, *friction_rate);
        let lossy = drive.with_losses(effort - back * rate - rotor * acceleration - loss, along);
        let per_geared = 1.0 - lossy.per_torque.recip();
        let per_rate = (1.0 - along * along) / friction_rate;
        let by_rate = lossy.per_direction / lossy.per_torque * per_rate - back * per_geared;
        [by_rate, -rotor * per_geared]
    }

    /// Number of steps, a power of two, in which the joint's rate changes by less than half the friction's.
    pub(super) fn steps_for(&self, rates: &[f64]) -> usize {
        let change = rates.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let steps = (2.0 * change / self.friction_rate).clamp(1.0, MOST_SUBSTEPS as f64);
        (steps.ceil() as usize).next_power_of_two()
    }
}

/// Most steps for each step of the input.
pub(super) const MOST_SUBSTEPS: usize = 64;

/// The part number `part` of `parts` equal parts of a cubic over a step.
pub(super) fn part_of([a, b, c, d]: Cubic, part: usize, parts: usize) -> Cubic {
    let (h, s) = ((parts as f64).recip(), part as f64 / parts as f64);
    [
        a + s * (b + s * (c + s * d)),
        h * (b + s * (2.0 * c + 3.0 * s * d)),
        h * h * (c + 3.0 * s * d),
        h * h * h * d,
    ]
}

/// Mean of a cubic over its step.
pub(super) fn mean([a, b, c, d]: Cubic) -> f64 {
    a + b / 2.0 + c / 3.0 + d / 4.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_cubic_are_the_cubic() {
        let cubic = [1.0, -2.0, 3.0, -4.0];
        let at = |[a, b, c, d]: Cubic, s: f64| a + s * (b + s * (c + s * d));
        for part in 0..4 {
            let own = part_of(cubic, part, 4);
            for s in [0.0, 0.3, 1.0] {
                assert!((at(own, s) - at(cubic, (part as f64 + s) / 4.0)).abs() < 1e-15);
            }
        }
        let means: f64 = (0..4).map(|part| mean(part_of(cubic, part, 4))).sum();
        assert!((means / 4.0 - mean(cubic)).abs() < 1e-15);
    }

    /// Losses of joints that move each other all balance their gears, however steep their friction.
    #[test]
    fn losses_of_several_joints_balance_together() {
        let drive = Drive { efficiency: 0.6, coulomb_friction_n_m: 0.4, ..Drive::DIRECT };
        let inverse_masses = DMatrix::from_row_slice(2, 2, &[3.0, -4.0, -4.0, 8.0]);
        for friction_rate in [0.1, 1e-3, 1e-7] {
            let own = Losses {
                drive,
                friction_rate,
                least_rate: 0.0,
                back: 0.1,
                rotor: 0.05,
                substeps: 1,
            };
            for efforts in [[5.0, 1.0], [-0.3, 0.2], [0.0, 0.0], [0.5, -2.0]] {
                for at_rest in [[0.0, 0.0], [0.03, -0.02], [-2.0, 1e-5]] {
                    let efforts_of = DVector::from_row_slice(&efforts);
                    let free = &inverse_masses * efforts_of;
                    let rates = Answers {
                        free: DVector::from_row_slice(&at_rest) + 0.01 * &free,
                        per_loss: 0.01 * &inverse_masses,
                    };
                    let accelerations = Answers { free, per_loss: inverse_masses.clone() };
                    let joints = efforts.map(|effort| (own, effort));
                    let found = balanced(&joints, [&rates, &accelerations], DVector::zeros(2));
                    let moving = |of: &Answers| &of.free - &of.per_loss * &found;
                    let [v, a] = [&rates, &accelerations].map(moving);
                    for (k, effort) in efforts.into_iter().enumerate() {
                        let geared = effort - 0.1 * v[k] - 0.05 * a[k];
                        let along = libm::tanh(v[k] / friction_rate);
                        let off = drive.with_losses(geared - found[k], along).torque - geared;
                        // Round-off of a rate over the friction's.
                        assert!(off.abs() < 1e-12 + 1e-15 / friction_rate, "{efforts:?}: {off}");
                    }
                }
            }
        }
    }

    /// The loss balances the torque in front of the gear, whatever the motion does, and at a joint at rest too.
    #[test]
    fn the_loss_balances_the_gear() {
        let drive = Drive { efficiency: 0.6, coulomb_friction_n_m: 0.4, ..Drive::DIRECT };
        let own = Losses {
            drive,
            friction_rate: 0.1,
            least_rate: 0.0,
            back: 0.3,
            rotor: 0.05,
            substeps: 1,
        };
        for effort in [-5.0, -0.3, 0.0, 0.2, 3.0] {
            for at_rest in [-2.0, -0.01, 0.0, 0.03, 1.0] {
                let (rate, acceleration) = ([at_rest, -0.01], [3.0 - at_rest, -8.0]);
                let loss = own.solve(effort, rate, acceleration);
                let [v, a] = [rate, acceleration].map(|line| line[0] + line[1] * loss);
                let geared = effort - 0.3 * v - 0.05 * a;
                let along = libm::tanh(v / 0.1);
                let needed = drive.with_losses(geared - loss, along).torque;
                assert!((needed - geared).abs() < 1e-12, "{effort} {at_rest}: {needed} {geared}");
            }
        }
    }
}
