use serde::{Deserialize, Serialize};

use crate::link::{Damping, Drive, Link, Taper};
use crate::modal::DampingLaw;

/// The link in SI, keyed as in its file, for summary.json.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LinkRecord {
    pub(super) length_m: f64,
    pub(super) rigid_inertia_kg_m2: f64,
    pub(super) segments: Vec<SegmentRecord>,
    pub(super) hub: HubRecord,
    pub(super) masses: Vec<MassRecord>,
    pub(super) payload: PayloadRecord,
    pub(super) damping: DampingRecord,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SegmentRecord {
    pub(super) name: Option<String>,
    pub(super) length_m: f64,
    /// At the inner and the outer end.
    pub(super) bending_stiffness_n_m2: [f64; 2],
    pub(super) mass_per_length_kg_m: [f64; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct HubRecord {
    pub(super) inertia_kg_m2: f64,
    pub(super) radius_m: f64,
    pub(super) viscous_friction_n_m_s_rad: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct MassRecord {
    pub(super) at_m: f64,
    pub(super) mass_kg: f64,
    pub(super) inertia_kg_m2: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct PayloadRecord {
    pub(super) mass_kg: f64,
    pub(super) inertia_kg_m2: f64,
    pub(super) offset_m: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "model", rename_all = "lowercase")]
pub(super) enum DampingRecord {
    None,
    Hysteretic { ratio: f64 },
    Rayleigh { alpha_per_s: f64, beta_s: f64 },
    Modal { ratios: Vec<f64> },
    Caughey { modes: Vec<usize>, ratios: Vec<f64> },
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct DriveRecord {
    /// Nothing for a stiff joint: JSON has no infinity.
    pub(super) joint_stiffness_n_m_rad: Option<f64>,
    pub(super) rotor_inertia_kg_m2: f64,
    pub(super) gear_ratio: f64,
}

impl LinkRecord {
    pub(super) fn new(link: &Link, law: &DampingLaw) -> Self {
        let ends = |taper: Taper| [taper.inner, taper.outer];
        let segment = |segment: &crate::link::Segment| SegmentRecord {
            name: segment.name.clone(),
            length_m: segment.length_m,
            bending_stiffness_n_m2: ends(segment.bending_stiffness_n_m2),
            mass_per_length_kg_m: ends(segment.mass_per_length_kg_m),
        };
        let mass = |mass: &crate::link::LumpedMass| MassRecord {
            at_m: mass.at_m,
            mass_kg: mass.mass_kg,
            inertia_kg_m2: mass.inertia_kg_m2,
        };
        let (hub, payload) = (link.hub(), link.payload());
        Self {
            length_m: link.length_m(),
            rigid_inertia_kg_m2: link.rigid_inertia_kg_m2(),
            segments: link.segments().iter().map(segment).collect(),
            hub: HubRecord {
                inertia_kg_m2: hub.inertia_kg_m2,
                radius_m: hub.radius_m,
                viscous_friction_n_m_s_rad: hub.viscous_friction_n_m_s_rad,
            },
            masses: link.masses().iter().map(mass).collect(),
            payload: PayloadRecord {
                mass_kg: payload.mass_kg,
                inertia_kg_m2: payload.inertia_kg_m2,
                offset_m: payload.offset_m,
            },
            damping: DampingRecord::of(link.damping(), law),
        }
    }
}

impl DriveRecord {
    pub(super) fn of(drive: &Drive) -> Self {
        let stiffness = drive.joint_stiffness_n_m_rad;
        Self {
            joint_stiffness_n_m_rad: Some(stiffness).filter(|k| k.is_finite()),
            rotor_inertia_kg_m2: drive.rotor_inertia_kg_m2,
            gear_ratio: drive.gear_ratio,
        }
    }
}

impl DampingRecord {
    /// The numbers of the law, or what the link gives where these are no numbers for people.
    fn of(damping: &Damping, law: &DampingLaw) -> Self {
        match (damping, law) {
            (Damping::Caughey { modes, ratios }, _) => {
                Self::Caughey { modes: modes.clone(), ratios: ratios.clone() }
            }
            (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
                Self::Rayleigh { alpha_per_s: *alpha_per_s, beta_s: *beta_s }
            }
            (Damping::Modal { ratios }, _) => Self::Modal { ratios: ratios.clone() },
            (Damping::Hysteretic { ratio }, _) => Self::Hysteretic { ratio: *ratio },
            _ => Self::None,
        }
    }
}
