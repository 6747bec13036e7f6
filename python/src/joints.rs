//! Histories that several results have by the same names: of joints and their motors, and of the tip.

use flexlink::motion::TipMotionHistories;

use crate::prelude::*;
use crate::properties::Value::{OfJoints, Stored};
use crate::properties::{Named, Properties, slices};

/// A quantity of a joint, or of its motor before gear and transmission.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    Effort,
    Position,
    Rate,
    Acceleration,
    RigidEffort,
    RigidPosition,
    MotorEffort,
    MotorPosition,
    MotorRate,
    MotorAcceleration,
    MotorPower,
    MotorCurrent,
    MotorVoltage,
}

/// A result with histories of joints.
pub(crate) trait Driven: Properties {
    /// A quantity of each joint, the inner one first and a carriage last.
    fn joints(&self, of: Of) -> Vec<Option<&[f64]>>;

    /// The quantity of the joint of each link.
    fn of_links(&self, of: Of) -> Vec<&[f64]> {
        self.joints(of).into_iter().take(self.links()).flatten().collect()
    }

    /// The quantity of the carriage, the joint of one link or the last of an arm.
    fn of_carriage(&self, of: Of) -> Vec<&[f64]> {
        self.joints(of).pop().flatten().into_iter().collect()
    }

    /// The quantity of the motor of each link's joint.
    fn of_motors(&self, of: Of) -> Vec<Option<&[f64]>> {
        self.joints(of).into_iter().take(self.links()).collect()
    }

    /// Properties of all these results.
    const JOINTS: Named<Self> = &[
        ("torque", Stored(|own| own.of_links(Of::Effort))),
        ("force", Stored(|own| own.of_carriage(Of::Effort))),
        ("hub_angle joint_angle", Stored(|own| own.of_links(Of::Position))),
        ("carriage", Stored(|own| own.of_carriage(Of::Position))),
        ("hub_rate joint_rate", Stored(|own| own.of_links(Of::Rate))),
        ("carriage_velocity", Stored(|own| own.of_carriage(Of::Rate))),
    ];

    /// Properties of results that store accelerations.
    const ACCELERATIONS: Named<Self> = &[
        ("hub_acceleration joint_acceleration", Stored(|own| own.of_links(Of::Acceleration))),
        ("carriage_acceleration", Stored(|own| own.of_carriage(Of::Acceleration))),
    ];

    /// Properties of solved runs.
    const SOLVED: Named<Self> = &[
        ("rigid_torque", Stored(|own| own.of_links(Of::RigidEffort))),
        ("rigid_force", Stored(|own| own.of_carriage(Of::RigidEffort))),
        (
            "rigid_hub_angle rigid_joint_angle rigid_carriage",
            Stored(|own| own.of_links(Of::RigidPosition)),
        ),
        ("motor_torque", OfJoints(|own| own.of_motors(Of::MotorEffort))),
        ("motor_rate", OfJoints(|own| own.of_motors(Of::MotorRate))),
        ("motor_current", OfJoints(|own| own.of_motors(Of::MotorCurrent))),
        ("motor_voltage", OfJoints(|own| own.of_motors(Of::MotorVoltage))),
    ];
}

/// A result with histories of the tip and with nodes along its links.
pub(crate) trait Moving: Properties {
    /// Places of the tip in m, of one link along its arc, of an arm x and y; or their derivatives of this order.
    fn tip(&self, order: usize) -> Vec<&[f64]>;

    /// Distances in m of the nodes of each link from its joint.
    fn nodes_m(&self) -> Vec<&[f64]>;

    /// Those of one link.
    fn nodes_of_link(&self, link: usize) -> Fails<&[f64]> {
        self.nodes_m().get(link).copied().ok_or_else(|| no_link(link, self.links()))
    }

    /// Properties of all these results.
    const MOTION: Named<Self> = &[
        ("tip_displacement tip", Stored(|own| own.tip(0))),
        ("tip_velocity", Stored(|own| own.tip(1))),
        ("tip_acceleration", Stored(|own| own.tip(2))),
        ("nodes", Stored(|own| vec![own.nodes_m()[0]])),
    ];
}

/// Places of a tip along its axes, or their derivatives of this order.
pub(crate) fn axes(tip: &[TipMotionHistories], order: usize) -> Vec<&[f64]> {
    slices(tip.iter().map(|axis| match order {
        0 => &axis.displacement_m,
        1 => &axis.velocity_m_s,
        _ => &axis.acceleration_m_s2,
    }))
}

/// Refusal of the number of a link.
pub(crate) fn no_link(link: usize, links: usize) -> Failure {
    usage(&format!("link = {link}, but must be below {links}, the number of links"), None)
}
