//! Builder of a link.

use super::damping::Damping;
use super::link::{Link, LinkParts};
use super::parts::{Drive, Gravity, Hub, LumpedMass, ParameterError, Payload};
use super::segment::Segment;

impl LinkParts {
    /// Title for people.
    pub fn title(mut self, title: &str) -> Self {
        title.clone_into(&mut self.title);
        self
    }

    /// Adds the next segment outward.
    pub fn segment(mut self, segment: Segment) -> Self {
        self.segments.push(segment);
        self
    }

    /// The hub: inertia, radius and friction.
    pub fn hub(mut self, hub: Hub) -> Self {
        self.hub = hub;
        self
    }

    /// Rotary inertia of the hub about the axis in kg m².
    pub fn hub_inertia_kg_m2(mut self, inertia_kg_m2: f64) -> Self {
        self.hub.inertia_kg_m2 = inertia_kg_m2;
        self
    }

    /// Adds a lumped mass.
    pub fn mass(mut self, mass: LumpedMass) -> Self {
        self.masses.push(mass);
        self
    }

    /// Payload of the tip: mass, inertia and offset.
    pub fn payload(mut self, payload: Payload) -> Self {
        self.payload = payload;
        self
    }

    /// A point mass at the tip in kg.
    pub fn payload_kg(self, mass_kg: f64) -> Self {
        self.payload(Payload { mass_kg, ..Payload::default() })
    }

    /// The damping law.
    pub fn damping(mut self, damping: Damping) -> Self {
        self.damping = damping;
        self
    }

    /// Material damping of ratio ξ, the paper's law (Bayo 1987, eq 16).
    pub fn damping_ratio(self, ratio: f64) -> Self {
        self.damping(Damping::Hysteretic { ratio })
    }

    /// Gear and elastic joint between motor and hub.
    pub fn drive(mut self, drive: Drive) -> Self {
        self.drive = Some(drive);
        self
    }

    /// Gravity along the plane's x and y axes in m/s², and the direction in rad of the chord, from the axis to the tip,
    /// at tip displacement 0.
    pub fn gravity(mut self, acceleration_m_s2: [f64; 2], start_angle_rad: f64) -> Self {
        let start_angle_rad = Some(start_angle_rad);
        self.gravity = Some(Gravity { acceleration_m_s2, start_angle_rad });
        self
    }

    /// Checks the parts and builds the link.
    ///
    /// # Errors
    /// [`ParameterError`] names the first parameter out of its range, by its path in a link file.
    pub fn build(self) -> Result<Link, ParameterError> {
        Link::new(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{CrossSection, Section, Taper};

    #[test]
    fn a_link_is_what_was_named_and_nothing_else() {
        let built = Link::builder()
            .title("strip")
            .segment(Segment::uniform(1.5, 5.0, 0.8))
            .hub_inertia_kg_m2(0.1)
            .payload_kg(0.25)
            .damping_ratio(0.02);
        let parts = LinkParts {
            title: "strip".into(),
            segments: vec![Segment::uniform(1.5, 5.0, 0.8)],
            hub: Hub { inertia_kg_m2: 0.1, ..Hub::default() },
            masses: vec![],
            payload: Payload { mass_kg: 0.25, ..Payload::default() },
            damping: Damping::Hysteretic { ratio: 0.02 },
            drive: None,
            gravity: None,
        };
        assert_eq!(built.build(), Link::new(parts));
    }

    #[test]
    fn the_moment_of_mass_is_the_change_of_inertia_about_an_axis_that_moves_away() {
        let at = |radius_m: f64| {
            let taper = Taper { inner: 0.9, outer: 0.3 };
            Link::builder()
                .hub(Hub { radius_m: 0.2 + radius_m, ..Hub::default() })
                .segment(Segment::uniform(0.5, 5.0, 0.8))
                .segment(Segment { mass_per_length_kg_m: taper, ..Segment::uniform(1.0, 5.0, 0.8) })
                .mass(LumpedMass { at_m: 0.7 + radius_m, mass_kg: 0.1, inertia_kg_m2: 0.01 })
                .payload(Payload { mass_kg: 0.2, inertia_kg_m2: 0.03, offset_m: 0.1 })
                .build()
                .unwrap()
        };
        // I(r) = I + 2 S r + m r²: the difference over a central step is 2 S.
        let [before, after] = [at(-0.1), at(0.1)].map(|link| link.rigid_inertia_kg_m2());
        let moment = at(0.0).mass_moment_kg_m();
        assert!(((after - before) / 0.4 / moment - 1.0).abs() < 1e-12, "{moment}");
    }

    #[test]
    fn what_cannot_be_is_refused_by_its_path() {
        let refused = |builder: LinkParts| builder.build().unwrap_err().to_string();
        assert_eq!(refused(Link::builder()), "segments = [], but must hold at least one segment");
        let flat = Link::builder().segment(Segment::uniform(1.5, 0.0, 0.8));
        assert!(refused(flat).starts_with("segments.0.EI = 0 N m^2, but must "));
    }

    #[test]
    fn a_stored_link_is_read_back_whole_and_refused_where_it_is_invalid() {
        let strip = Section::Rectangle { width_m: 0.02, thickness_m: 0.001 };
        let segment = Segment {
            name: Some("beam".into()),
            cross_section: Some(CrossSection::of(&strip)),
            ..Segment::uniform(1.5, 5.0, 0.8)
        };
        let link = Link::builder()
            .title("strip")
            .segment(segment)
            .hub(Hub { inertia_kg_m2: 0.1, radius_m: 0.05, viscous_friction_n_m_s_rad: 0.2 })
            .mass(LumpedMass { at_m: 0.7, mass_kg: 0.1, inertia_kg_m2: 1e-3 })
            .payload(Payload { mass_kg: 0.2, inertia_kg_m2: 1e-3, offset_m: 0.02 })
            .damping(Damping::RayleighThroughModes { modes: [1, 3], ratios: [0.01, 0.02] })
            .drive(Drive {
                joint_stiffness_n_m_rad: f64::INFINITY,
                rotor_inertia_kg_m2: 1e-4,
                gear_ratio: 80.0,
            })
            .gravity([0.0, -9.81], 0.5)
            .build()
            .unwrap();
        let text = serde_json::to_string(&link).unwrap();
        assert_eq!(serde_json::from_str::<Link>(&text).unwrap(), link);
        let refusal = |from: &str, to: &str| {
            assert!(text.contains(from), "{text}");
            serde_json::from_str::<Link>(&text.replace(from, to)).unwrap_err().to_string()
        };
        let flat = refusal("\"length_m\":1.5", "\"length_m\":0.0");
        assert_eq!(flat, "segments.0.length = 0 m, but must be finite and above 0");
        assert!(refusal("\"payload\"", "\"load\"").starts_with("unknown field `load`"));
    }
}
