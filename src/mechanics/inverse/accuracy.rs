//! Errors of a solution: the cost of each approximation, for every written quantity; histories of all
//! quantities and their differences.

use serde::Serialize;

use crate::numeric::{Size, extremes, largest, largest_difference};

/// A quantity of a solution over time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Torque at the hub.
    Torque,
    /// Hub angle.
    HubAngle,
    /// Hub rate.
    HubRate,
    /// Hub acceleration.
    HubAcceleration,
    /// Total displacement at the nodes.
    Displacement,
    /// Bending moment at the nodes.
    BendingMoment,
    /// Torque of the motor.
    MotorTorque,
    /// Rate of the motor.
    MotorRate,
}

impl Quantity {
    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Torque => "torque",
            Self::HubAngle => "hub angle",
            Self::HubRate => "hub rate",
            Self::HubAcceleration => "hub acceleration",
            Self::Displacement => "displacement",
            Self::BendingMoment => "bending moment",
            Self::MotorTorque => "motor torque",
            Self::MotorRate => "motor rate",
        }
    }
}

/// Reference of relative errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShareOf {
    /// The largest absolute value.
    Peak,
    /// The largest value less the smallest, for a link with weight.
    Range,
}

impl ShareOf {
    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Peak => "peak",
            Self::Range => "range",
        }
    }
}

/// One value for each quantity of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct PerQuantity<T> {
    /// Torque at the hub.
    pub torque: T,
    /// Hub angle.
    pub hub_angle: T,
    /// Hub rate.
    pub hub_rate: T,
    /// Hub acceleration. `None` without tables.
    pub hub_acceleration: Option<T>,
    /// Total displacement at the nodes. `None` without tables.
    pub displacement: Option<T>,
    /// Bending moment at the nodes, where it is measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bending_moment: Option<T>,
    /// Torque of the motor, where the link has a drive.
    pub motor_torque: Option<T>,
    /// Rate of the motor, where the link has a drive.
    pub motor_rate: Option<T>,
}

impl<T: Copy> PerQuantity<T> {
    /// The present values, the torque first.
    pub fn iter(&self) -> impl Iterator<Item = (Quantity, T)> {
        [
            Some((Quantity::Torque, self.torque)),
            Some((Quantity::HubAngle, self.hub_angle)),
            Some((Quantity::HubRate, self.hub_rate)),
            self.hub_acceleration.map(|value| (Quantity::HubAcceleration, value)),
            self.displacement.map(|value| (Quantity::Displacement, value)),
            self.bending_moment.map(|value| (Quantity::BendingMoment, value)),
            self.motor_torque.map(|value| (Quantity::MotorTorque, value)),
            self.motor_rate.map(|value| (Quantity::MotorRate, value)),
        ]
        .into_iter()
        .flatten()
    }

    /// Combines each value with the same quantity of another solution. A quantity that either lacks becomes `None`.
    pub(crate) fn zip<U: Copy, V>(
        &self,
        other: &PerQuantity<U>,
        join: impl Fn(T, U) -> V,
    ) -> PerQuantity<V> {
        let both = |a: Option<T>, b: Option<U>| a.zip(b).map(|(a, b)| join(a, b));
        PerQuantity {
            torque: join(self.torque, other.torque),
            hub_angle: join(self.hub_angle, other.hub_angle),
            hub_rate: join(self.hub_rate, other.hub_rate),
            hub_acceleration: both(self.hub_acceleration, other.hub_acceleration),
            displacement: both(self.displacement, other.displacement),
            bending_moment: both(self.bending_moment, other.bending_moment),
            motor_torque: both(self.motor_torque, other.motor_torque),
            motor_rate: both(self.motor_rate, other.motor_rate),
        }
    }
}

impl PerQuantity<QuantityErrors> {
    /// One kind of error of every quantity.
    pub fn of_kind(&self, kind: impl Fn(QuantityErrors) -> f64) -> PerQuantity<f64> {
        self.zip(self, |errors, _| kind(errors))
    }

    /// The worst error of a kind and its quantity, if it exceeds a threshold.
    pub(super) fn above(
        &self,
        threshold: f64,
        kind: impl Fn(QuantityErrors) -> f64,
    ) -> Option<(Quantity, f64)> {
        Some(self.of_kind(kind).worst()).filter(|(_, error)| *error > threshold)
    }

    /// Pairs these errors with those of a further kind, where a run measured them.
    pub(super) fn with(
        &self,
        further: Option<PerQuantity<f64>>,
        join: impl Fn(QuantityErrors, f64) -> QuantityErrors,
    ) -> Self {
        further.map_or(*self, |further| self.zip(&further, join))
    }
}

impl PerQuantity<f64> {
    /// The larger of each value and the same quantity of `other`.
    pub(super) fn at_least(&self, others: &Self) -> Self {
        let larger = |own: Option<f64>, other: Option<f64>| {
            own.map(|own| other.map_or(own, |other| own.max(other)))
        };
        Self {
            torque: self.torque.max(others.torque),
            motor_torque: larger(self.motor_torque, others.motor_torque),
            ..*self
        }
    }

    /// The largest value and its quantity; the torque where several are equal. NaN counts as the largest.
    pub fn worst(&self) -> (Quantity, f64) {
        self.iter().fold((Quantity::Torque, self.torque), |worst, found| {
            if found.1 > worst.1 || found.1.is_nan() { found } else { worst }
        })
    }
}

/// Errors of one quantity, each over the quantity's peak.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct QuantityErrors {
    /// Discretisation of the link, measured on halved elements.
    pub mesh: f64,
    /// The finite period and the written window.
    pub window: f64,
    /// Change by half the step, where the solver covers every frequency of the samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<f64>,
    /// Change by further iterations, where second-order terms count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iteration: Option<f64>,
    /// Change by a reduction to few modes. `None` where the model keeps all modes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modes: Option<f64>,
    /// Error from uncertain samples. `None` where the samples are exact to the tip's tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<f64>,
    /// Error of the linear model from large deflections, centrifugal stiffening and, for torques and moments, the
    /// thickness. `None` with weight or where second-order terms count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<f64>,
}

/// Histories of all quantities.
pub(super) struct Curves {
    pub(super) torque_n_m: Vec<f64>,
    pub(super) hub_angle_rad: Vec<f64>,
    pub(super) hub_rate_rad_s: Vec<f64>,
    pub(super) hub_acceleration_rad_s2: Vec<f64>,
    /// One for each of some nodes.
    pub(super) displacement_m: Vec<Vec<f64>>,
    pub(super) moment_n_m: Vec<Vec<f64>>,
    /// Torque in N m and rate in rad/s of the motor, where there is a drive.
    pub(super) motor: Option<[Vec<f64>; 2]>,
}

impl Curves {
    fn each(&self) -> PerQuantity<&[Vec<f64>]> {
        let one = std::slice::from_ref::<Vec<f64>>;
        let motor = self.motor.as_ref();
        PerQuantity {
            torque: one(&self.torque_n_m),
            hub_angle: one(&self.hub_angle_rad),
            hub_rate: one(&self.hub_rate_rad_s),
            hub_acceleration: Some(one(&self.hub_acceleration_rad_s2)),
            displacement: Some(&self.displacement_m),
            bending_moment: Some(&self.moment_n_m),
            motor_torque: motor.map(|motor| one(&motor[0])),
            motor_rate: motor.map(|motor| one(&motor[1])),
        }
    }

    /// Largest value of `of` over pairs of histories of the same quantity.
    fn compared(&self, other: &Self, of: impl Fn(&[f64], &[f64]) -> f64) -> PerQuantity<f64> {
        self.each().zip(&other.each(), |own, others| {
            own.iter().zip(others).map(|(a, b)| of(a, b)).fold(0.0, Size::larger)
        })
    }

    /// Largest difference of each quantity.
    pub(super) fn apart(&self, other: &Self) -> PerQuantity<f64> {
        self.compared(other, largest_difference)
    }

    /// Largest difference of each quantity from histories with twice as many samples.
    pub(super) fn apart_from_finer(&self, finer: &Self) -> PerQuantity<f64> {
        self.compared(finer, |own, finer| {
            let pairs = own.iter().zip(finer.iter().step_by(2));
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, Size::larger)
        })
    }

    /// Largest distance of each quantity from rest, over `reaches` samples at its start and its end. One sample cannot
    /// show it, as ringing passes the rest twice a cycle.
    pub(super) fn left_of(&self, rests: &[Self; 2], reaches: [usize; 2]) -> PerQuantity<f64> {
        let farthest = |samples: &[f64], rest: f64| {
            samples.iter().map(|own| (own - rest).abs()).fold(0.0, Size::larger)
        };
        let first = self.compared(&rests[0], |own, rest| farthest(&own[..reaches[0]], rest[0]));
        let last =
            self.compared(&rests[1], |own, rest| farthest(&own[own.len() - reaches[1]..], rest[0]));
        first.zip(&last, Size::larger)
    }

    /// Size of each quantity, the reference of its errors: its range with weight, else its peak; for the hub angle the
    /// largest turn, for displacements the tip's travel.
    pub(super) fn sizes(&self, has_weight: bool, travel_m: f64) -> PerQuantity<f64> {
        let sizes = self.compared(self, |own, _| size(own, has_weight));
        let start = self.hub_angle_rad[0];
        let turn =
            self.hub_angle_rad.iter().map(|angle| (angle - start).abs()).fold(0.0, Size::larger);
        let hub_angle = if has_weight { sizes.hub_angle } else { turn };
        PerQuantity { hub_angle, displacement: Some(travel_m), ..sizes }
    }
}

/// Reference of a quantity's errors: its peak or, for a link with weight, its largest value less its smallest.
pub(crate) fn size(history: &[f64], has_weight: bool) -> f64 {
    if !has_weight {
        return largest(history);
    }
    let [low, high] = extremes(history);
    high - low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_is_the_largest_the_torque_of_equal_ones_and_nan_above_all() {
        let of = |torque, hub_angle, motor: Option<f64>| {
            let errors =
                PerQuantity { torque, hub_angle, motor_torque: motor, ..Default::default() };
            errors.worst().0
        };
        assert_eq!(of(1.0, 2.0, None), Quantity::HubAngle);
        assert_eq!(of(2.0, 2.0, Some(2.0)), Quantity::Torque);
        assert_eq!(of(1.0, 2.0, Some(3.0)), Quantity::MotorTorque);
        assert_eq!(of(f64::NAN, 1.0, None), Quantity::Torque);
        assert_eq!(of(1.0, f64::NAN, Some(9.0)), Quantity::HubAngle);
    }
}
