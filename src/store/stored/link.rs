//! The link of a summary, checked as one that is read from a link file.

use super::super::link_record::{DampingRecord, DriveRecord, LinkRecord, SegmentRecord};
use crate::link::{
    Damping, Drive, Hub, Link, LinkParts, LumpedMass, ParameterError, Payload, Segment, Taper,
};

impl LinkRecord {
    /// The link itself. One with Rayleigh damping through two modes has come by α and β.
    ///
    /// # Errors
    /// [`ParameterError`] names the first parameter out of its range.
    pub(super) fn into_link(
        self,
        title: String,
        drive: Option<DriveRecord>,
    ) -> Result<Link, ParameterError> {
        let mass = |mass: super::super::link_record::MassRecord| LumpedMass {
            at_m: mass.at_m,
            mass_kg: mass.mass_kg,
            inertia_kg_m2: mass.inertia_kg_m2,
        };
        let length_m = self.length_m;
        let link = Link::new(LinkParts {
            title,
            segments: self.segments.into_iter().map(SegmentRecord::into_segment).collect(),
            hub: Hub {
                inertia_kg_m2: self.hub.inertia_kg_m2,
                radius_m: self.hub.radius_m,
                viscous_friction_n_m_s_rad: self.hub.viscous_friction_n_m_s_rad,
            },
            masses: self.masses.into_iter().map(mass).collect(),
            payload: Payload {
                mass_kg: self.payload.mass_kg,
                inertia_kg_m2: self.payload.inertia_kg_m2,
                offset_m: self.payload.offset_m,
            },
            damping: self.damping.into_damping(),
            drive: drive.map(DriveRecord::into_drive),
        })?;
        if (length_m - link.length_m()).abs() <= 1e-9 * link.length_m() {
            return Ok(link);
        }
        let must = format!("must be {} m, the sum of hub radius and segments", link.length_m());
        Err(ParameterError::new("length_m", length_m, "m", must))
    }
}

impl SegmentRecord {
    fn into_segment(self) -> Segment {
        let taper = |[inner, outer]: [f64; 2]| Taper { inner, outer };
        Segment {
            name: self.name,
            length_m: self.length_m,
            bending_stiffness_n_m2: taper(self.bending_stiffness_n_m2),
            mass_per_length_kg_m: taper(self.mass_per_length_kg_m),
            cross_section: None,
        }
    }
}

impl DriveRecord {
    fn into_drive(self) -> Drive {
        Drive {
            joint_stiffness_n_m_rad: self.joint_stiffness_n_m_rad.unwrap_or(f64::INFINITY),
            rotor_inertia_kg_m2: self.rotor_inertia_kg_m2,
            gear_ratio: self.gear_ratio,
        }
    }
}

impl DampingRecord {
    fn into_damping(self) -> Damping {
        match self {
            Self::None => Damping::None,
            Self::Hysteretic { ratio } => Damping::Hysteretic { ratio },
            Self::Rayleigh { alpha_per_s, beta_s } => Damping::Rayleigh { alpha_per_s, beta_s },
            Self::Modal { ratios } => Damping::Modal { ratios },
            Self::Caughey { modes, ratios } => Damping::Caughey { modes, ratios },
        }
    }
}
