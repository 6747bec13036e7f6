//! Histories over the window that is written, cut out of the answer over one period.

use num_complex::Complex64;

use super::error::InversionError;
use super::periodic_answer::PeriodicAnswer;
use super::spectra::HubSpectra;
use crate::link::{Drive, Link};
use crate::modal::DampingLaw;
use crate::model::Model;
use crate::motion::{TailTerms, TipMotionHistories, TipPeriod, tail_sum};
use crate::numeric::TimeGrid;

/// What the motor does, on its own side of the gear and on the solution's grid.
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
}

/// All histories of a solution but those of the nodes.
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
    /// Those of an answer on `grid`, a part of its period; `tail` is the hub angle's slow tail.
    ///
    /// # Errors
    /// [`InversionError::MotorNotFinite`].
    pub(super) fn of(
        answer: &PeriodicAnswer,
        model: &dyn Model,
        tail: Option<TailTerms>,
        grid: TimeGrid,
    ) -> Result<Self, InversionError> {
        let (period, per_length) = (&answer.period, 1.0 / model.mesh().length_m());
        let whole_tip = &period.histories;
        let root_moment_n_m =
            cut(&period.spectrum.pair.samples(&answer.hub.root_moment_n_m), &grid);
        let tip = TipMotionHistories {
            displacement_m: cut(&whole_tip.displacement_m, &grid),
            velocity_m_s: cut(&whole_tip.velocity_m_s, &grid),
            acceleration_m_s2: cut(&whole_tip.acceleration_m_s2, &grid),
        };
        let hub = HubMotion::of(period, &answer.hub, tail, per_length);
        let (hub_angle_rad, hub_rate_rad_s) = rayon::join(
            || hub.of_period(&answer.excess_rad, &grid, &tip.displacement_m, 0),
            || hub.on(&grid, &tip.velocity_m_s, 1),
        );
        let joint = model.link().joint();
        let mut torque_n_m = cut(&answer.torque_n_m, &grid);
        hub.take_images_off(&grid, 1, joint.friction_n_m_s_rad, &mut torque_n_m);
        let histories = Self {
            rigid_torque_n_m: rigid_torque_n_m(model.link(), model.law(), &tip),
            rigid_hub_angle_rad: tip.displacement_m.iter().map(|v| v * per_length).collect(),
            grid,
            torque_n_m,
            hub_angle_rad,
            hub_rate_rad_s,
            root_moment_n_m,
            tip,
            motor: None,
        };
        let motor = joint.drive.map(|drive| histories.motor(&drive, answer, &hub)).transpose()?;
        Ok(Self { motor, ..histories })
    }

    /// What the motor must do so that the hub receives the torque T.
    ///
    /// The joint's spring twists by T/k; rotor inertia and gear ratio n follow:
    ///
    /// ```text
    /// φ = n (θ + T/k)      motor angle
    /// T_m = T/n + J φ̈      motor torque
    /// ```
    ///
    /// # Errors
    /// [`InversionError::MotorNotFinite`].
    fn motor(
        &self,
        drive: &Drive,
        answer: &PeriodicAnswer,
        hub: &HubMotion<'_>,
    ) -> Result<MotorHistories, InversionError> {
        let Drive { joint_stiffness_n_m_rad, rotor_inertia_kg_m2, gear_ratio } = *drive;
        let spectrum = &answer.period.spectrum;
        let acceleration = hub.on(&self.grid, &self.tip.acceleration_m_s2, 2);
        let hub = [&self.hub_angle_rad, &self.hub_rate_rad_s, &acceleration];
        let [angle_rad, rate_rad_s, acceleration] = [0, 1, 2].map(|order| -> Vec<f64> {
            let torque = spectrum.derivative(&answer.hub.torque_n_m, order);
            let twist = cut(&spectrum.pair.samples(torque), &self.grid);
            let motions = hub[order].iter().zip(twist);
            motions.map(|(hub, t)| gear_ratio * (hub + t / joint_stiffness_n_m_rad)).collect()
        });
        let pairs = self.torque_n_m.iter().zip(&acceleration);
        let torque_n_m: Vec<f64> =
            pairs.map(|(t, a)| t / gear_ratio + rotor_inertia_kg_m2 * a).collect();
        let power_w = torque_n_m.iter().zip(&rate_rad_s).map(|(t, rate)| t * rate).collect();
        let motor = MotorHistories { torque_n_m, angle_rad, rate_rad_s, power_w };
        motor.check()?;
        Ok(motor)
    }
}

impl MotorHistories {
    /// Refuses a history that leaves double precision.
    ///
    /// # Errors
    /// [`InversionError::MotorNotFinite`].
    fn check(&self) -> Result<(), InversionError> {
        let histories = [
            ("torque", &self.torque_n_m),
            ("angle", &self.angle_rad),
            ("rate", &self.rate_rad_s),
            ("power", &self.power_w),
        ];
        for (history, samples) in histories {
            if samples.iter().any(|sample| !sample.is_finite()) {
                return Err(InversionError::MotorNotFinite { history });
            }
        }
        Ok(())
    }
}

/// Torque in N m that moves the tip of the same link, were it rigid.
///
/// ```text
/// T_rigid = I_rigid (a + αv)/L + b v/L
/// ```
///
/// α is the mass part of Rayleigh damping and zero otherwise: the torque of the flexible link tends
/// to this one as EI grows.
fn rigid_torque_n_m(link: &Link, law: &DampingLaw, tip: &TipMotionHistories) -> Vec<f64> {
    let inertia = link.rigid_inertia_kg_m2() / link.length_m();
    let friction = link.joint().friction_n_m_s_rad / link.length_m();
    let drag = inertia * law.mass_rate_per_s() + friction;
    let samples = tip.acceleration_m_s2.iter().zip(&tip.velocity_m_s);
    samples.map(|(a, v)| inertia * a + drag * v).collect()
}

/// Deflection of the tip from the hub's tangent line, `v_tip − Lθ`, in m, from the hub angles of the
/// rigid and of the flexible link.
pub(super) fn tip_deflection_m(rigid_rad: &[f64], flexible_rad: &[f64], length_m: f64) -> Vec<f64> {
    let pairs = rigid_rad.iter().zip(flexible_rad);
    pairs.map(|(rigid, flexible)| length_m * (rigid - flexible)).collect()
}

/// The samples of a period that `grid` covers.
pub(super) fn cut(period: &[f64], grid: &TimeGrid) -> Vec<f64> {
    let mut samples = Vec::with_capacity(grid.len);
    for part in parts(period, grid) {
        samples.extend_from_slice(part);
    }
    samples
}

/// What `grid` covers of a period, one after the other.
fn parts<'a, T>(period: &'a [T], grid: &TimeGrid) -> impl Iterator<Item = &'a [T]> {
    let (mut first, mut left) = (grid.in_period(0, period.len()), grid.len);
    std::iter::from_fn(move || {
        let last = period.len().min(first + left);
        let part = &period[first..last];
        (first, left) = (0, left - part.len());
        (!part.is_empty()).then_some(part)
    })
}

/// The hub angle over a period: the tip's motion over the length, and what bending adds.
pub(super) struct HubMotion<'a> {
    period: &'a TipPeriod,
    excess_amplitudes_rad: &'a [Complex64],
    tail: Option<TailTerms>,
    per_length: f64,
}

impl<'a> HubMotion<'a> {
    pub(super) fn of(
        period: &'a TipPeriod,
        hub: &'a HubSpectra,
        tail: Option<TailTerms>,
        per_length: f64,
    ) -> Self {
        Self { period, excess_amplitudes_rad: &hub.excess_angle_rad, tail, per_length }
    }

    /// Its `order`-th derivative on a grid, `tip` being that of the tip there.
    pub(super) fn on(&self, grid: &TimeGrid, tip: &[f64], order: usize) -> Vec<f64> {
        let spectrum = &self.period.spectrum;
        let derivative = spectrum.derivative(self.excess_amplitudes_rad, order);
        self.of_period(&spectrum.pair.samples(derivative), grid, tip, order)
    }

    /// The same, where the derivative of the excess is known over the period.
    fn of_period(&self, excess: &[f64], grid: &TimeGrid, tip: &[f64], order: usize) -> Vec<f64> {
        let mut motion = cut(excess, grid);
        self.take_images_off(grid, order, 1.0, &mut motion);
        for (excess, tip) in motion.iter_mut().zip(tip) {
            *excess += tip * self.per_length;
        }
        motion
    }

    /// Takes what other periods add to the `order`-th derivative, times a factor, off samples of a grid.
    fn take_images_off(&self, grid: &TimeGrid, order: usize, factor: f64, samples: &mut [f64]) {
        let Some(tail) = self.tail.filter(|_| factor != 0.0) else { return };
        let tail = tail.map(|s| factor * s);
        let images = self.period.images().history(order);
        let mut rest = samples;
        for part in parts(images, grid) {
            let (these, others) = rest.split_at_mut(part.len());
            for (sample, terms) in these.iter_mut().zip(part) {
                *sample -= tail_sum(&tail, terms);
            }
            rest = others;
        }
    }
}
