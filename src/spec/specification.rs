use super::damping::damping;
use super::error::Fault;
use super::quantity::{Count, Elements, Quantity, Real, Unbounded, optional_si};
use super::raw::{
    RawAnalysis, RawDrive, RawHub, RawLimits, RawMass, RawMesh, RawPayload, RawSpecification,
};
use super::segment::{remarks, segment};
use crate::beam::{ElementCount, MeshPlan};
use crate::inverse::Analysis;
use crate::link::{Damping, Drive, Hub, Link, LinkParts, LumpedMass, Payload};
use crate::numeric::Dimension;
use crate::result::{Limits, Remark};

/// The checked content of a link file.
#[derive(Debug, Clone, PartialEq)]
pub struct Specification {
    /// The physical link.
    pub link: Link,
    /// How the link is meshed.
    pub mesh: MeshPlan,
    /// Tolerances, window and modes of the inversion.
    pub analysis: Analysis,
    /// Largest values that link and motor may reach.
    pub limits: Limits,
    /// Values that are possible but rare, often a slip of units.
    pub remarks: Vec<Remark>,
}

/// Converts the raw form to the checked one.
pub(super) fn convert(raw: RawSpecification) -> Result<Specification, Fault> {
    if raw.segments.is_empty() {
        return Err(Fault::new("segments", "must hold at least one [[segments]]"));
    }
    let own_elements = raw.segments.iter().map(|s| s.elements.map(|count| count.0));
    let own_elements: Vec<Option<usize>> = own_elements.collect();
    let remarks = remarks(&raw.segments)?;
    let segments = raw.segments.into_iter().enumerate();
    let masses = raw.masses.iter().enumerate();
    let link = Link::new(LinkParts {
        title: raw.title.unwrap_or_default(),
        segments: segments.map(|(index, raw)| segment(index, raw)).collect::<Result<_, _>>()?,
        hub: hub(&raw.hub)?,
        masses: masses.map(|(index, raw)| lumped_mass(index, raw)).collect::<Result<_, _>>()?,
        payload: payload(&raw.payload)?,
        damping: raw.damping.as_ref().map_or(Ok(Damping::None), damping)?,
        drive: raw.drive.as_ref().map(drive).transpose()?,
    })?;
    let mesh = mesh(&link, &own_elements, &raw.mesh)?;
    let analysis = analysis(&raw.analysis)?;
    let limits = limits(&raw.limits)?.check(link.drive())?;
    Ok(Specification { link, mesh, analysis, limits, remarks })
}

fn hub(raw: &RawHub) -> Result<Hub, Fault> {
    let friction = &raw.viscous_friction;
    Ok(Hub {
        inertia_kg_m2: raw.inertia.si("hub.inertia", Dimension::ROTARY_INERTIA)?,
        radius_m: raw.radius.si("hub.radius", Dimension::LENGTH)?,
        viscous_friction_n_m_s_rad: friction
            .si("hub.viscous_friction", Dimension::VISCOUS_FRICTION)?,
    })
}

fn lumped_mass(index: usize, raw: &RawMass) -> Result<LumpedMass, Fault> {
    let si = |key: &str, value: &Quantity, dimension| {
        value.si(&format!("masses.{index}.{key}"), dimension)
    };
    Ok(LumpedMass {
        at_m: si("at", &raw.at, Dimension::LENGTH)?,
        mass_kg: si("mass", &raw.mass, Dimension::MASS)?,
        inertia_kg_m2: si("inertia", &raw.inertia, Dimension::ROTARY_INERTIA)?,
    })
}

fn payload(raw: &RawPayload) -> Result<Payload, Fault> {
    let inertia = &raw.inertia;
    Ok(Payload {
        mass_kg: raw.mass.si("payload.mass", Dimension::MASS)?,
        inertia_kg_m2: inertia.si("payload.inertia", Dimension::ROTARY_INERTIA)?,
        offset_m: raw.offset.si("payload.offset", Dimension::LENGTH)?,
    })
}

fn drive(raw: &RawDrive) -> Result<Drive, Fault> {
    let stiffness = raw.joint_stiffness.as_ref().map(|Unbounded(value)| value);
    let stiffness = optional_si("drive.joint_stiffness", stiffness, Dimension::TORQUE)?;
    Ok(Drive {
        joint_stiffness_n_m_rad: stiffness.unwrap_or(f64::INFINITY),
        rotor_inertia_kg_m2: raw
            .rotor_inertia
            .si("drive.rotor_inertia", Dimension::ROTARY_INERTIA)?,
        gear_ratio: raw.gear_ratio.map_or(1.0, |Real(ratio)| ratio),
    })
}

fn limits(raw: &RawLimits) -> Result<Limits, Fault> {
    let si = |key: &str, value: &Option<Quantity>, dimension| {
        optional_si(&format!("limits.{key}"), value.as_ref(), dimension)
    };
    Ok(Limits {
        torque_n_m: si("torque", &raw.torque, Dimension::TORQUE)?,
        rms_torque_n_m: si("rms_torque", &raw.rms_torque, Dimension::TORQUE)?,
        hub_rate_rad_s: si("hub_rate", &raw.hub_rate, Dimension::RATE)?,
        power_w: si("power", &raw.power, Dimension::POWER)?,
        deflection_m: si("deflection", &raw.deflection, Dimension::LENGTH)?,
        bending_moment_n_m: si("bending_moment", &raw.bending_moment, Dimension::TORQUE)?,
        motor_torque_n_m: si("motor_torque", &raw.motor_torque, Dimension::TORQUE)?,
        motor_rms_torque_n_m: si("motor_rms_torque", &raw.motor_rms_torque, Dimension::TORQUE)?,
        motor_rate_rad_s: si("motor_rate", &raw.motor_rate, Dimension::RATE)?,
        motor_power_w: si("motor_power", &raw.motor_power, Dimension::POWER)?,
    })
}

fn mesh(link: &Link, own: &[Option<usize>], raw: &RawMesh) -> Result<MeshPlan, Fault> {
    let tolerance = raw.tolerance.map_or(MeshPlan::DEFAULT_TOLERANCE, |t| t.0);
    let count = raw.elements.map(|elements| match elements {
        Elements::Auto => ElementCount::Auto,
        Elements::Total(count) => ElementCount::Total(count.0),
    });
    Ok(MeshPlan::new(link, own, count, tolerance)?)
}

fn analysis(raw: &RawAnalysis) -> Result<Analysis, Fault> {
    let Real(tolerance) = raw.tolerance.unwrap_or(Real(Analysis::DEFAULT_TOLERANCE));
    let lead_s = optional_si("analysis.lead", raw.lead.as_ref(), Dimension::TIME)?;
    let lag_s = optional_si("analysis.lag", raw.lag.as_ref(), Dimension::TIME)?;
    let Real(tip) = raw.tip_tolerance.unwrap_or(Real(Analysis::DEFAULT_TIP_TOLERANCE));
    let analysis = Analysis::new(tolerance, lead_s, lag_s)?.with_tip_tolerance(tip)?;
    match raw.modes {
        Some(Count(modes)) => Ok(analysis.keeping_modes(modes)?),
        None => Ok(analysis),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use super::super::tree::Node;
    use serde::Deserialize;

    #[test]
    fn a_mesh_tolerance_has_its_range() {
        let refused = |tolerance: &str| {
            let segment = "{ length = 1, EI = 1, mass_per_length = 1 }";
            let text = format!("segments = [{segment}]\nmesh.tolerance = {tolerance}");
            let tree = Node::document(&text).unwrap();
            convert(RawSpecification::deserialize(&tree).unwrap()).is_err()
        };
        assert!(!refused("1e-12") && !refused("0.1"));
        assert!(refused("0.9e-12") && refused("0.11"));
    }
}
