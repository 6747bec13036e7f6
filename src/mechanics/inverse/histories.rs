//! Histories over the written window, cut out of the answer over one period.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::accuracy::Curves;
use super::error::InversionError;
use super::periodic_answer::PeriodicAnswer;
use crate::beam::{Checkpoints, NodalQuantity};
use crate::link::{Drive, Link};
use crate::modal::DampingLaw;
use crate::model::Model;
use crate::motion::{TAIL_TERMS, TailTerms, TipMotionHistories, TipPeriod, tail_sum};
use crate::numeric::{TimeGrid, largest};

/// Spacing of the low frequencies that determine the power series of a transfer, over the first zero.
const SPACING: f64 = 0.1;

/// Histories of the motor on its side of the gear, on the solution's grid.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorHistories {
    /// Torque of the motor in N m.
    pub torque_n_m: Vec<f64>,
    /// Angle of the rotor in rad.
    pub angle_rad: Vec<f64>,
    /// Rate of the rotor in rad/s.
    pub rate_rad_s: Vec<f64>,
    /// Mechanical power of the motor in W.
    pub power_w: Vec<f64>,
    /// Current in A, if the drive has its torque constant.
    pub current_a: Option<Vec<f64>>,
    /// Voltage in V, if the drive has its resistance, too.
    pub voltage_v: Option<Vec<f64>>,
    /// Torque in N m without losses, if there are any.
    pub(super) lossless_n_m: Option<Vec<f64>>,
}

impl MotorHistories {
    /// The motor under the torque of a joint that moves at a rate, from angle, rate and acceleration of the rotor.
    ///
    /// ```text
    /// T_m = f(T, x)/n + J φ̈,   i = T_m/k,   u = R i + k φ̇
    /// ```
    ///
    /// f and x are those of [`Drive::with_losses`].
    pub(crate) fn of(
        drive: &Drive,
        [joint_n_m, joint_rate]: [&[f64]; 2],
        [angle_rad, rate_rad_s, acceleration]: [Vec<f64>; 3],
    ) -> Self {
        let lossless_n_m = Self::lossless_n_m(drive, joint_n_m, &acceleration);
        let (torque_n_m, lossless_n_m) = if drive.has_losses() {
            let friction_rate = drive.friction_rate(largest(joint_rate));
            let samples = joint_n_m.iter().zip(joint_rate).zip(&acceleration);
            let lossy = samples.map(|((joint_n_m, rate), acceleration)| {
                let along = Drive::direction(*rate, friction_rate);
                drive.motor_n_m(drive.with_losses(*joint_n_m, along).torque, *acceleration)
            });
            (lossy.collect(), Some(lossless_n_m))
        } else {
            (lossless_n_m, None)
        };
        let power_w = torque_n_m.iter().zip(&rate_rad_s).map(|(t, rate)| t * rate).collect();
        let constant = drive.torque_constant_n_m_a;
        let current_a = constant.map(|k| torque_n_m.iter().map(|t| t / k).collect::<Vec<f64>>());
        let voltage_v = current_a.as_ref().zip(constant).zip(drive.resistance_ohm);
        let voltage_v = voltage_v.map(|((current_a, k), resistance_ohm)| {
            let samples = current_a.iter().zip(&rate_rad_s);
            samples.map(|(i, rate)| resistance_ohm * i + k * rate).collect()
        });
        Self { torque_n_m, angle_rad, rate_rad_s, power_w, current_a, voltage_v, lossless_n_m }
    }

    /// Torque of the motor in N m without losses, from the joint's torque and the rotor's acceleration.
    pub(super) fn lossless_n_m(drive: &Drive, joint_n_m: &[f64], acceleration: &[f64]) -> Vec<f64> {
        joint_n_m.iter().zip(acceleration).map(|(t, a)| drive.motor_n_m(*t, *a)).collect()
    }

    /// True if friction or gear take part of the torque.
    pub fn has_losses(&self) -> bool {
        self.lossless_n_m.is_some()
    }

    /// Torque without losses, whose errors follow from the spectra.
    pub(super) fn linear_n_m(&self) -> &Vec<f64> {
        self.lossless_n_m.as_ref().unwrap_or(&self.torque_n_m)
    }

    /// All histories by their names.
    fn named(&self) -> impl Iterator<Item = (&'static str, &Vec<f64>)> {
        [
            ("torque", Some(&self.torque_n_m)),
            ("angle", Some(&self.angle_rad)),
            ("rate", Some(&self.rate_rad_s)),
            ("power", Some(&self.power_w)),
            ("current", self.current_a.as_ref()),
            ("voltage", self.voltage_v.as_ref()),
        ]
        .into_iter()
        .filter_map(|(name, samples)| Some((name, samples?)))
    }
}

/// All histories of a solution except those of the nodes.
pub(super) struct Histories {
    pub(super) grid: TimeGrid,
    pub(super) torque_n_m: Vec<f64>,
    pub(super) rigid_torque_n_m: Vec<f64>,
    pub(super) hub_angle_rad: Vec<f64>,
    pub(super) hub_rate_rad_s: Vec<f64>,
    pub(super) rigid_hub_angle_rad: Vec<f64>,
    pub(super) root_moment_n_m: Vec<f64>,
    pub(super) tip: TipMotionHistories,
    pub(super) motor: Option<MotorHistories>,
}

impl Histories {
    /// Cuts the histories on `grid` out of an answer over one period. `tail` is the slow tail of the hub angle (see
    /// [`SlowTails`]). `start_angle_rad` is the direction of the chord at zero displacement of the tip.
    ///
    /// # Errors
    /// [`InversionError::MotorNotFinite`].
    pub(super) fn of(
        answer: &PeriodicAnswer,
        model: &dyn Model,
        tail: Option<TailTerms>,
        (start_angle_rad, grid): (f64, TimeGrid),
    ) -> Result<Self, InversionError> {
        let (period, per_rigid_tip) = (&answer.period, 1.0 / model.mesh().rigid_tip());
        let whole_tip = &period.histories;
        let root_moment_n_m =
            cut(&period.spectrum.pair.samples(&answer.hub.root_moment_n_m), &grid);
        let tip = TipMotionHistories {
            displacement_m: cut(&whole_tip.displacement_m, &grid),
            velocity_m_s: cut(&whole_tip.velocity_m_s, &grid),
            acceleration_m_s2: cut(&whole_tip.acceleration_m_s2, &grid),
        };
        let hub = HubMotion { period, tail, per_rigid_tip };
        let mut hub_angle_rad = hub.on(&grid, answer.excess(0), &tip.displacement_m, 0);
        let mut rigid_hub_angle_rad: Vec<f64> =
            tip.displacement_m.iter().map(|v| v * per_rigid_tip).collect();
        let joint = model.link().joint();
        // A link that slides keeps its direction.
        let turns = !joint.slides();
        if turns && start_angle_rad != 0.0 {
            for angle in hub_angle_rad.iter_mut().chain(&mut rigid_hub_angle_rad) {
                *angle += start_angle_rad;
            }
        }
        let hub_rate_rad_s = hub.on(&grid, answer.excess(1), &tip.velocity_m_s, 1);
        let mut torque_n_m = cut(&answer.torque_n_m, &grid);
        hub.take_images_off(&grid, 1, joint.friction(), &mut torque_n_m);
        if let Some([friction_n_m, ..]) = hub.friction(joint.friction(), &grid) {
            add(&friction_n_m, &mut torque_n_m);
        }
        let histories = Self {
            rigid_torque_n_m: rigid_torque_n_m(model.link(), model.law(), &tip, |k| {
                if turns { rigid_hub_angle_rad[k] } else { start_angle_rad }
            }),
            rigid_hub_angle_rad,
            grid,
            torque_n_m,
            hub_angle_rad,
            hub_rate_rad_s,
            root_moment_n_m,
            tip,
            motor: None,
        };
        let drive = model.link().drive();
        let motor = drive.map(|drive| histories.motor((drive, joint.friction()), answer, &hub));
        let motor = motor.transpose()?;
        Ok(Self { motor, ..histories })
    }

    /// Copies of these histories as curves, with the hub's acceleration in rad/s²: displacement of the tip, moment at the
    /// root.
    pub(super) fn curves(&self, hub_acceleration_rad_s2: Vec<f64>) -> Curves {
        let motor = self.motor.as_ref();
        Curves {
            torque_n_m: self.torque_n_m.clone(),
            hub_angle_rad: self.hub_angle_rad.clone(),
            hub_rate_rad_s: self.hub_rate_rad_s.clone(),
            hub_acceleration_rad_s2,
            displacement_m: vec![self.tip.displacement_m.clone()],
            moment_n_m: vec![self.root_moment_n_m.clone()],
            motor: motor.map(|motor| [motor.linear_n_m().clone(), motor.rate_rad_s.clone()]),
        }
    }

    /// Motion and torque of the motor for the torque T at the hub.
    ///
    /// The torque twists the joint's spring by T/k. The gear multiplies angles by n, and the rotor's inertia J needs a
    /// further torque:
    ///
    /// ```text
    /// φ = n (θ + T/k)      motor angle
    /// T_m = T/n + J φ̈      motor torque
    /// ```
    ///
    /// [`MotorHistories::of`] adds the losses.
    ///
    /// # Errors
    /// [`InversionError::MotorNotFinite`].
    fn motor(
        &self,
        (drive, friction_n_m_s_rad): (&Drive, f64),
        answer: &PeriodicAnswer,
        hub: &HubMotion<'_>,
    ) -> Result<MotorHistories, InversionError> {
        let Drive { joint_stiffness_n_m_rad, gear_ratio, .. } = *drive;
        let friction = hub.friction(friction_n_m_s_rad, &self.grid);
        let hub_acceleration = hub.on(&self.grid, answer.excess(2), &self.tip.acceleration_m_s2, 2);
        let hub_motions = [&self.hub_angle_rad, &self.hub_rate_rad_s, &hub_acceleration];
        let [angle_rad, rate_rad_s, acceleration] = [0, 1, 2].map(|order| -> Vec<f64> {
            let mut torque = match order {
                0 => cut(&answer.torque_n_m, &self.grid),
                _ => cut(&answer.derivative(&answer.hub.torque_n_m, order), &self.grid),
            };
            // The friction's torque contains the images of the hub's rate. Those of its second derivative are
            // negligible.
            if order < 2 {
                hub.take_images_off(&self.grid, order + 1, friction_n_m_s_rad, &mut torque);
            }
            if let Some(friction) = &friction {
                add(&friction[order], &mut torque);
            }
            let motions = hub_motions[order].iter().zip(torque);
            motions.map(|(hub, t)| gear_ratio * (hub + t / joint_stiffness_n_m_rad)).collect()
        });
        let joint = [&self.torque_n_m[..], &self.hub_rate_rad_s];
        let motor = MotorHistories::of(drive, joint, [angle_rad, rate_rad_s, acceleration]);
        let lost = |(_, samples): &(_, &Vec<f64>)| samples.iter().any(|sample| !sample.is_finite());
        let lost = motor.named().find(lost).map(|(history, _)| history);
        lost.map_or(Ok(motor), |history| Err(InversionError::MotorNotFinite { history }))
    }
}

/// Torque in N m that the same link would need if it were rigid.
///
/// ```text
/// T_rigid = I_rigid (a + αv)/L + b v/L + g(θ) ∫ x dm
/// ```
///
/// g(θ) is gravity across the link. α is the mass part of Rayleigh damping and zero otherwise. The torque of the
/// flexible link tends to this one as EI grows.
fn rigid_torque_n_m(
    link: &Link,
    law: &DampingLaw,
    tip: &TipMotionHistories,
    direction_rad: impl Fn(usize) -> f64,
) -> Vec<f64> {
    let inertia = link.rigid_inertia_kg_m2() / link.rigid_tip();
    let friction = link.joint().friction() / link.rigid_tip();
    let drag = inertia * law.mass_rate_per_s() + friction;
    let samples = tip.acceleration_m_s2.iter().zip(&tip.velocity_m_s);
    let moving = samples.map(|(a, v)| inertia * a + drag * v);
    if link.gravity().is_none() {
        return moving.collect();
    }
    moving.enumerate().map(|(k, moving)| moving + link.holding_effort(direction_rad(k))).collect()
}

/// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m. The hub angle of the rigid link is `v_tip/L`,
/// that of the flexible link θ.
pub(super) fn tip_deflection_m(
    rigid_rad: &[f64],
    flexible_rad: &[f64],
    rigid_tip: f64,
) -> Vec<f64> {
    let pairs = rigid_rad.iter().zip(flexible_rad);
    pairs.map(|(rigid, flexible)| rigid_tip * (rigid - flexible)).collect()
}

/// The samples of a period within `grid`.
pub(super) fn cut(period: &[f64], grid: &TimeGrid) -> Vec<f64> {
    let mut samples = Vec::with_capacity(grid.len);
    for part in parts(period, grid) {
        samples.extend_from_slice(part);
    }
    samples
}

fn add(more: &[f64], samples: &mut [f64]) {
    for (sample, more) in samples.iter_mut().zip(more) {
        *sample += more;
    }
}

/// Slices of a period that make up `grid`, in order: at the period's end the grid continues at its start.
fn parts<'a, T>(period: &'a [T], grid: &TimeGrid) -> impl Iterator<Item = &'a [T]> {
    let (mut first, mut left) = (grid.in_period(0, period.len()), grid.len);
    std::iter::from_fn(move || {
        let last = period.len().min(first + left);
        let part = &period[first..last];
        (first, left) = (0, left - part.len());
        (!part.is_empty()).then_some(part)
    })
}

/// Hub angle over a period: the angle of the rigid link, `v_tip/L`, plus the excess by bending.
pub(super) struct HubMotion<'a> {
    pub(super) period: &'a TipPeriod,
    /// Slow tail of the hub angle, with hysteretic damping.
    pub(super) tail: Option<TailTerms>,
    /// Position of the joint per displacement of the rigid link's tip.
    pub(super) per_rigid_tip: f64,
}

impl HubMotion<'_> {
    /// Computes the `order`-th time derivative of the hub angle on a grid, from the same derivative of the excess over
    /// the whole period and of the tip's displacement on the grid.
    pub(super) fn on(
        &self,
        grid: &TimeGrid,
        excess: &[f64],
        tip: &[f64],
        order: usize,
    ) -> Vec<f64> {
        let mut motion = cut(excess, grid);
        self.take_images_off(grid, order, 1.0, &mut motion);
        for (excess, tip) in motion.iter_mut().zip(tip) {
            *excess += tip * self.per_rigid_tip;
        }
        motion
    }

    /// Friction torque in N m of the rigid link, which turns at the rate v/L, and its first two time derivatives, on a
    /// grid. `None` for a periodic velocity, because the torque's spectrum then contains this friction.
    fn friction(&self, friction_n_m_s_rad: f64, grid: &TimeGrid) -> Option<[Vec<f64>; 3]> {
        let (tip, spectrum) = (&self.period.histories, &self.period.spectrum);
        spectrum.mean_m_s2?;
        let jerk = spectrum.pair.samples(spectrum.derivative(&spectrum.acceleration_m_s2, 1));
        let factor = friction_n_m_s_rad * self.per_rigid_tip;
        let taken = [&tip.velocity_m_s, &tip.acceleration_m_s2, &jerk];
        Some(taken.map(|of_tip| cut(of_tip, grid).iter().map(|value| factor * value).collect()))
    }

    /// Subtracts the images from samples on a grid: the slow tails that all other periods add to the `order`-th
    /// derivative of the hub angle, times a factor.
    fn take_images_off(&self, grid: &TimeGrid, order: usize, factor: f64, samples: &mut [f64]) {
        let Some(tail) = self.tail.filter(|_| factor != 0.0) else { return };
        let tail = tail.map(|s| factor * s);
        let images = parts(self.period.images().history(order), grid).flatten();
        for (sample, terms) in samples.iter_mut().zip(images) {
            *sample -= tail_sum(&tail, terms);
        }
    }
}

/// Slow tails of hysteretic damping, from transfers at low frequencies.
///
/// The factor κ = 1 + 2iξ sgn ω of the stiffness jumps at ω = 0. Before and after the motion the torque decays as t⁻⁴,
/// but deflections and hub angle only as t⁻². This slow tail has a closed form. κ times a transfer H from the tip's
/// acceleration is a power series in ω², whose coefficients determine the response h to an impulse at long times s:
///
/// ```text
/// H(ω) = (g₀ + g₁ ω² + g₂ ω⁴ + …)/κ,   ω > 0,
/// h(s) → Σ_m S_m/s^{2m+1},   S_m = −(−1)^m (2m)!/π · Im(g_m/κ),   |s| → ∞,
/// ```
///
/// A Fourier series repeats the motion in every period. [`Images`](crate::motion::Images) hold the tails of all other
/// periods; the histories subtract them.
pub(super) struct SlowTails {
    /// Evenly spaced low frequencies from zero on, in rad/s.
    omegas_rad_s: [f64; TAIL_TERMS + 1],
    /// 1/κ for ω > 0.
    compliance: Complex64,
}

impl SlowTails {
    /// `None` for a law without a slow tail.
    pub(super) fn of(model: &dyn Model, first_zero_per_s: Option<f64>) -> Option<Self> {
        let law = model.law();
        let is_hysteretic = matches!(law, DampingLaw::Hysteretic { ratio } if *ratio > 0.0);
        let spacing = SPACING * first_zero_per_s.filter(|_| is_hysteretic)?;
        let omegas_rad_s = std::array::from_fn(|k| spacing * k as f64);
        Some(Self { omegas_rad_s, compliance: law.stiffness_factor(0.0).inv() })
    }

    /// `S_m` of the hub angle's excess over the rigid link's.
    pub(super) fn hub_tail(&self, model: &dyn Model) -> TailTerms {
        let tips = model.tip_transfers(&self.omegas_rad_s);
        let lags: Vec<Complex64> = tips.iter().map(|tip| tip.deflection_s2).collect();
        self.tail(&lags).map(|s| s / model.mesh().rigid_tip())
    }

    /// `S_m` of the deflection at these nodes.
    pub(super) fn nodal_tails(&self, model: &dyn Model, nodes: &[usize]) -> Vec<TailTerms> {
        let mut rows = vec![[Complex64::ZERO; TAIL_TERMS + 1]; nodes.len()];
        let mut columns: Vec<_> = rows.iter_mut().map(<[_; _]>::as_mut_slice).collect();
        let quantity = NodalQuantity::Deflection;
        let checkpoints = &mut Checkpoints::of(model.mesh(), []);
        model.nodal_transfers(&self.omegas_rad_s, nodes, quantity, &mut columns, checkpoints);
        rows.iter().map(|row| self.tail(row).map(|s| -s)).collect()
    }

    /// `S_m` from the values of `κH`.
    fn tail(&self, values: &[Complex64]) -> TailTerms {
        // Newton's divided differences in ω² determine the polynomial through the values. The second loop turns them
        // into the coefficients of its powers.
        let squares = self.omegas_rad_s.map(|omega| omega * omega);
        let mut differences = values.to_vec();
        for level in 1..differences.len() {
            for k in (level..differences.len()).rev() {
                let rise = differences[k] - differences[k - 1];
                differences[k] = rise / (squares[k] - squares[k - level]);
            }
        }
        let mut powers = vec![Complex64::ZERO; differences.len()];
        for k in (0..differences.len()).rev() {
            for j in (1..powers.len()).rev() {
                powers[j] = powers[j - 1] - powers[j] * squares[k];
            }
            powers[0] = differences[k] - powers[0] * squares[k];
        }
        let mut factor = -1.0 / PI;
        std::array::from_fn(|m| {
            let tail = factor * (powers[m] * self.compliance).im;
            factor *= -(((2 * m + 1) * (2 * m + 2)) as f64);
            tail
        })
    }
}
