use serde::Deserialize;

use super::choices::Theory;
use super::damping::damping;
use super::error::Fault;
use super::raw::{RawAnalysis, RawLimits, RawSpecification};
use super::segment::segment;
use super::tree::Node;
use super::value::{AlongAxes, Count, Elements, Si};
use crate::beam::{ElementCount, MeshPlan};
use crate::inverse::Analysis;
use crate::link::{Damping, Drive, Gravity, Hub, Link, LinkParts, LumpedMass, Payload};
use crate::result::{Limits, Remark};

/// The checked content of a link file.
#[derive(Debug, Clone, PartialEq)]
pub struct Specification {
    /// The physical link.
    pub link: Link,
    /// Mesh of the link.
    pub mesh: MeshPlan,
    /// Tolerances, window and modes of the inversion.
    pub analysis: Analysis,
    /// Largest allowed values of link and motor.
    pub limits: Limits,
    /// Possible but unusual values, often a slip of units.
    pub remarks: Vec<Remark>,
}

/// Reads the specification from a tree.
pub(super) fn specification_of(tree: &Node) -> Result<Specification, Fault> {
    convert(RawSpecification::deserialize(tree)?)
}

/// Converts the raw form to the checked one.
fn convert(raw: RawSpecification) -> Result<Specification, Fault> {
    if raw.segments.is_empty() {
        return Err(Fault::new("segments", "must hold at least one [[segments]]"));
    }
    let own_elements: Vec<Option<usize>> =
        raw.segments.iter().map(|segment| segment.elements.map(|count| count.0)).collect();
    let remarks = raw.segments.iter().enumerate().flat_map(|(index, segment)| {
        let at = |key: &str| format!("segments.{index}.{key}");
        let modulus = segment.modulus.and_then(|e| Remark::on_modulus(&at("E"), e.si()));
        let density = segment.density.and_then(|rho| Remark::on_density(&at("density"), rho.si()));
        // A named theory of thick links shows that the link is meant to be thick.
        let theory = segment.theory.or(raw.theory);
        let section = segment.section.as_ref().filter(|_| theory != Some(Theory::Timoshenko));
        let section = section.and_then(|section| {
            let (width, thickness) = (section.width?.si(), section.thickness?.si());
            Remark::on_rectangle(&at("section"), width, thickness)
        });
        modulus.into_iter().chain(density).chain(section)
    });
    let angle = raw.start_angle.and_then(|angle| Remark::on_start_angle(angle.si()));
    let remarks = remarks.chain(angle).collect();
    let theory = raw.theory;
    let gravity = match (raw.gravity, raw.start_angle) {
        (None, Some(_)) => {
            let message = "start_angle needs gravity: without it no direction differs from another";
            return Err(Fault::new("start_angle", message));
        }
        (gravity, start_angle) => gravity.map(|AlongAxes(acceleration_m_s2)| Gravity {
            acceleration_m_s2,
            start_angle_rad: start_angle.map(Si::si),
        }),
    };
    let segments = raw.segments.into_iter().enumerate();
    let link = Link::new(LinkParts {
        title: raw.title.unwrap_or_default(),
        segments: segments
            .map(|(index, raw)| segment(index, raw, theory))
            .collect::<Result<_, _>>()?,
        hub: Hub {
            inertia_kg_m2: raw.hub.inertia.si(),
            radius_m: raw.hub.radius.si(),
            viscous_friction_n_m_s_rad: raw.hub.viscous_friction.si(),
        },
        masses: raw
            .masses
            .iter()
            .map(|mass| LumpedMass {
                at_m: mass.at.si(),
                mass_kg: mass.mass.si(),
                inertia_kg_m2: mass.inertia.si(),
            })
            .collect(),
        payload: Payload {
            mass_kg: raw.payload.mass.si(),
            inertia_kg_m2: raw.payload.inertia.si(),
            offset_m: raw.payload.offset.si(),
        },
        damping: raw.damping.as_ref().map_or(Ok(Damping::None), damping)?,
        drive: raw.drive.map(|drive| Drive {
            joint_stiffness_n_m_rad: drive.joint_stiffness.map_or(f64::INFINITY, |k| k.0.si()),
            rotor_inertia_kg_m2: drive.rotor_inertia.si(),
            gear_ratio: drive.gear_ratio.unwrap_or(1.0),
        }),
        gravity,
    })?;
    let count = raw.mesh.elements.map(|elements| match elements {
        Elements::Word(_) => ElementCount::Auto,
        Elements::Total(count) => ElementCount::Total(count.0),
    });
    let tolerance = raw.mesh.tolerance.unwrap_or(MeshPlan::DEFAULT_TOLERANCE);
    let mesh = MeshPlan::new(&link, &own_elements, count, tolerance)?;
    let analysis = analysis(&raw.analysis)?;
    let limits = limits(&raw.limits).check(link.drive())?;
    Ok(Specification { link, mesh, analysis, limits, remarks })
}

fn analysis(raw: &RawAnalysis) -> Result<Analysis, Fault> {
    let tolerance = raw.tolerance.unwrap_or(Analysis::DEFAULT_TOLERANCE);
    let tip_tolerance = raw.tip_tolerance.unwrap_or(Analysis::DEFAULT_TIP_TOLERANCE);
    let analysis = Analysis::new(tolerance, raw.lead.map(Si::si), raw.lag.map(Si::si))?
        .with_tip_tolerance(tip_tolerance)?;
    let analysis = match raw.second_order {
        Some(order) => analysis.with_second_order(order.into()),
        None => analysis,
    };
    match raw.modes {
        Some(Count(modes)) => Ok(analysis.keeping_modes(modes)?),
        None => Ok(analysis),
    }
}

fn limits(raw: &RawLimits) -> Limits {
    Limits {
        torque_n_m: raw.torque.map(Si::si),
        rms_torque_n_m: raw.rms_torque.map(Si::si),
        hub_rate_rad_s: raw.hub_rate.map(Si::si),
        power_w: raw.power.map(Si::si),
        deflection_m: raw.deflection.map(Si::si),
        bending_moment_n_m: raw.bending_moment.map(Si::si),
        motor_torque_n_m: raw.motor_torque.map(Si::si),
        motor_rms_torque_n_m: raw.motor_rms_torque.map(Si::si),
        motor_rate_rad_s: raw.motor_rate.map(Si::si),
        motor_power_w: raw.motor_power.map(Si::si),
    }
}
