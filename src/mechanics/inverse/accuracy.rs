//! Errors of a solution: the cost of each approximation, for every written quantity.

use serde::Serialize;

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
