use super::error::ParameterError;
use super::{Damping, Drive, Hub, Link, LinkParts, LumpedMass, Payload, Segment};

/// A link put together from numbers; everything that is not named is left out.
///
/// ```
/// use flexlink::link::{Link, Segment};
/// let link = Link::builder()
///     .segment(Segment::uniform(0.9, 12.0, 1.1))
///     .segment(Segment::uniform(0.6, 5.0, 0.8))
///     .hub_inertia_kg_m2(0.1)
///     .payload_kg(0.25)
///     .damping_ratio(0.02)
///     .build()?;
/// assert_eq!(link.length_m(), 1.5);
/// # Ok::<(), flexlink::link::ParameterError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[must_use]
pub struct LinkBuilder {
    parts: LinkParts,
}

impl Link {
    /// A link without segments, mass at its ends or damping, to be put together.
    pub fn builder() -> LinkBuilder {
        LinkBuilder::default()
    }
}

impl LinkBuilder {
    /// The title that people read.
    pub fn title(mut self, title: &str) -> Self {
        title.clone_into(&mut self.parts.title);
        self
    }

    /// The next segment outward.
    pub fn segment(mut self, segment: Segment) -> Self {
        self.parts.segments.push(segment);
        self
    }

    /// The hub: inertia, radius and friction.
    pub fn hub(mut self, hub: Hub) -> Self {
        self.parts.hub = hub;
        self
    }

    /// Rotary inertia of the hub about the axis in kg m².
    pub fn hub_inertia_kg_m2(mut self, inertia_kg_m2: f64) -> Self {
        self.parts.hub.inertia_kg_m2 = inertia_kg_m2;
        self
    }

    /// A lumped mass on the link.
    pub fn mass(mut self, mass: LumpedMass) -> Self {
        self.parts.masses.push(mass);
        self
    }

    /// What the tip carries: mass, inertia and offset.
    pub fn payload(mut self, payload: Payload) -> Self {
        self.parts.payload = payload;
        self
    }

    /// A point mass at the tip in kg.
    pub fn payload_kg(self, mass_kg: f64) -> Self {
        self.payload(Payload { mass_kg, ..Payload::default() })
    }

    /// The damping law.
    pub fn damping(mut self, damping: Damping) -> Self {
        self.parts.damping = damping;
        self
    }

    /// Material damping of ratio ξ, the paper's law (Bayo 1987, eq 16).
    pub fn damping_ratio(self, ratio: f64) -> Self {
        self.damping(Damping::Hysteretic { ratio })
    }

    /// Gear and elastic joint between motor and hub.
    pub fn drive(mut self, drive: Drive) -> Self {
        self.parts.drive = Some(drive);
        self
    }

    /// The link.
    ///
    /// # Errors
    /// [`ParameterError`] names the first parameter out of its range, by its path in a link file.
    pub fn build(self) -> Result<Link, ParameterError> {
        Link::new(self.parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
        };
        assert_eq!(built.build(), Link::new(parts));
    }

    #[test]
    fn what_cannot_be_is_refused_by_its_path() {
        let refused = |builder: LinkBuilder| builder.build().unwrap_err().to_string();
        assert_eq!(refused(Link::builder()), "segments = [], but must hold at least one segment");
        let flat = Link::builder().segment(Segment::uniform(1.5, 0.0, 0.8));
        assert!(refused(flat).starts_with("segments.0.EI = 0 N m^2, but must "));
    }
}
