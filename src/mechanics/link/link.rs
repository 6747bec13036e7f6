//! The link and its builder.

use serde::{Deserialize, Serialize};

use super::joint::{Joint, replaced};
use super::parts::{
    Carriage, Damping, Drive, Gravity, Hub, LumpedMass, POSITION_TOLERANCE, ParameterError,
    Payload, not_negative, positive,
};
use super::segment::Segment;

/// Parts of a link before they are checked; unset parts are absent.
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
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
#[must_use]
pub struct LinkParts {
    /// Title for people.
    pub title: String,
    /// Segments from the hub outward, at least one.
    pub segments: Vec<Segment>,
    /// The hub; the default beside a carriage.
    pub hub: Hub,
    /// The carriage in place of a hub.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub carriage: Option<Carriage>,
    /// Stiffness k of the rotational spring between the joint and the root in N m/rad; `None` for a clamped root.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub root_stiffness_n_m_rad: Option<f64>,
    /// Place of the output, whose motion is prescribed, in m from the axis or the carriage; `None` for the tip.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub output_m: Option<f64>,
    /// Lumped masses, in any order.
    pub masses: Vec<LumpedMass>,
    /// The payload.
    pub payload: Payload,
    /// The damping law.
    pub damping: Damping,
    /// Gear and elastic joint between motor and hub.
    pub drive: Option<Drive>,
    /// Gravity in the plane of motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gravity: Option<Gravity>,
}

/// A valid link.
///
/// It is stored as its [`LinkParts`], and checked again when read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "LinkParts", into = "LinkParts")]
pub struct Link {
    parts: LinkParts,
}

impl TryFrom<LinkParts> for Link {
    type Error = ParameterError;

    fn try_from(parts: LinkParts) -> Result<Self, ParameterError> {
        Self::new(parts)
    }
}

impl From<Link> for LinkParts {
    fn from(link: Link) -> Self {
        link.parts
    }
}

impl Link {
    /// Starts a link without segments, mass at its ends or damping.
    pub fn builder() -> LinkParts {
        LinkParts::default()
    }

    /// Checks every range and sorts the lumped masses from the hub outward.
    ///
    /// # Errors
    /// [`ParameterError`] names the first parameter out of its range.
    pub fn new(mut parts: LinkParts) -> Result<Self, ParameterError> {
        if parts.segments.is_empty() {
            let must = "must hold at least one segment";
            return Err(ParameterError::new("segments", "[]", "", must));
        }
        let mut names = std::collections::BTreeSet::new();
        for (index, segment) in parts.segments.iter().enumerate() {
            segment.check(index)?;
            if let Some(name) = segment.name.as_deref().filter(|name| !names.insert(*name)) {
                let parameter = format!("segments.{index}.name");
                let must = "must be unique: an earlier segment has this name";
                return Err(ParameterError::new(parameter, format!("{name:?}"), "", must));
            }
        }
        parts.hub.check()?;
        if let Some(carriage) = &parts.carriage {
            carriage.check()?;
            if parts.hub != Hub::default() {
                let must = "must not be there beside a carriage, which takes the place of the hub";
                return Err(ParameterError::new("hub", "a hub", "", must));
            }
        }
        if let Some(stiffness) = parts.root_stiffness_n_m_rad {
            let key = if parts.carriage.is_some() { "carriage" } else { "hub" };
            positive(&format!("{key}.root_stiffness"), stiffness, "N m/rad")?;
        }
        let link = Self { parts: parts.clone() };
        if let Some(at_m) = parts.output_m {
            link.check_place("output.at", at_m)?;
            let [root_m, tip_m] = [parts.hub.radius_m, link.length_m()];
            if at_m <= root_m + POSITION_TOLERANCE * tip_m {
                let must = format!("must lie beyond the root, at {root_m} m");
                return Err(ParameterError::new("output.at", at_m, "m", must));
            }
            // An output at the tip is the default.
            parts.output_m = (at_m < tip_m * (1.0 - POSITION_TOLERANCE)).then_some(at_m);
        }
        for (index, mass) in parts.masses.iter().enumerate() {
            let path = |key: &str| format!("masses.{index}.{key}");
            link.check_place(&path("at"), mass.at_m)?;
            not_negative(&path("mass"), mass.mass_kg, "kg")?;
            not_negative(&path("inertia"), mass.inertia_kg_m2, "kg m^2")?;
        }
        let Payload { mass_kg, inertia_kg_m2, offset_m } = parts.payload;
        not_negative("payload.mass", mass_kg, "kg")?;
        not_negative("payload.inertia", inertia_kg_m2, "kg m^2")?;
        if !offset_m.is_finite() {
            return Err(ParameterError::new("payload.offset", offset_m, "m", "must be finite"));
        }
        parts.damping.check()?;
        let slides = parts.carriage.is_some();
        parts.drive.as_ref().map_or(Ok(()), |drive| drive.check(slides))?;
        parts.gravity.as_ref().map_or(Ok(()), Gravity::check)?;
        link.check_movable()?;
        parts.masses.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
        Ok(Self { parts })
    }

    /// Refuses a rigid inertia that is not finite and positive: a torque of 0 would move the link, or no torque could.
    fn check_movable(&self) -> Result<(), ParameterError> {
        let inertia = self.rigid_inertia_kg_m2();
        if inertia.is_finite() && inertia > 0.0 {
            return Ok(());
        }
        let (unit, must) = if self.joint().slides() {
            ("kg", "the link with all that it carries must have a finite mass above 0")
        } else {
            (
                "kg m^2",
                "the link with all that it carries must have a finite rotary inertia above 0",
            )
        };
        Err(ParameterError::new("segments", format!("a total of {inertia}"), unit, must))
    }

    /// Title for people, empty by default.
    pub fn title(&self) -> &str {
        &self.parts.title
    }

    /// Segments from the hub outward, at least one.
    pub fn segments(&self) -> &[Segment] {
        &self.parts.segments
    }

    /// The hub.
    pub fn hub(&self) -> &Hub {
        &self.parts.hub
    }

    /// Lumped masses, from the hub outward.
    pub fn masses(&self) -> &[LumpedMass] {
        &self.parts.masses
    }

    /// The payload.
    pub fn payload(&self) -> &Payload {
        &self.parts.payload
    }

    /// The damping law.
    pub fn damping(&self) -> &Damping {
        &self.parts.damping
    }

    /// Gear and elastic joint between motor and hub, if the link has a drive.
    pub fn drive(&self) -> Option<&Drive> {
        self.parts.drive.as_ref()
    }

    /// The link with further inertia and viscous friction of its joint.
    ///
    /// # Errors
    /// [`ParameterError`] for sums that are not finite.
    pub fn with_joint(&self, inertia: f64, friction: f64) -> Result<Self, ParameterError> {
        let mut parts = self.parts.clone();
        if let Some(carriage) = &mut parts.carriage {
            carriage.mass_kg += inertia;
            carriage.viscous_friction_n_s_m += friction;
        } else {
            parts.hub.inertia_kg_m2 += inertia;
            parts.hub.viscous_friction_n_m_s_rad += friction;
        }
        Self::new(parts)
    }

    /// Stiffness in N m/rad between rotor and hub; infinite for a rigid joint or without a drive.
    pub fn joint_stiffness_n_m_rad(&self) -> f64 {
        self.drive().map_or(f64::INFINITY, |drive| drive.joint_stiffness_n_m_rad)
    }

    /// Gravity in the plane of motion, if set.
    pub fn gravity(&self) -> Option<&Gravity> {
        self.parts.gravity.as_ref()
    }

    /// True if gravity acts in the plane of motion.
    pub fn has_weight(&self) -> bool {
        self.gravity().is_some_and(Gravity::acts)
    }

    /// The joint that moves the link.
    pub fn joint(&self) -> Joint {
        self.parts.carriage.map_or(Joint::Revolute(self.parts.hub), Joint::Prismatic)
    }

    /// Stiffness k of the rotational spring between the joint and the root in N m/rad; `None` for a clamped root.
    pub fn root_stiffness_n_m_rad(&self) -> Option<f64> {
        self.parts.root_stiffness_n_m_rad
    }

    /// Distance L from the axis to the tip in m: hub radius and all segments.
    pub fn length_m(&self) -> f64 {
        let beam: f64 = self.parts.segments.iter().map(|s| s.length_m).sum();
        self.parts.hub.radius_m + beam
    }

    /// Distance in m from the axis, or from the carriage, to the output whose motion is prescribed: the tip, or a
    /// station on the link.
    pub fn output_m(&self) -> f64 {
        self.parts.output_m.unwrap_or_else(|| self.length_m())
    }

    /// True if the output is a station on the link instead of its tip.
    pub fn has_station(&self) -> bool {
        self.parts.output_m.is_some()
    }

    /// Estimate of the tip's deflection over that of the output: both grow with the square of the distance from the root.
    pub(crate) fn tip_per_output(&self) -> f64 {
        let root_m = self.hub().radius_m;
        ((self.length_m() - root_m) / (self.output_m() - root_m)).powi(2)
    }

    /// A text for this link, from the text for a link whose output is the tip.
    pub fn of_output(&self, mut text: String) -> String {
        if self.has_station() {
            text =
                text.replace("(rotary inertia, shear or payload)", "(the link beyond it swings)");
            // Keys such as `tip_tolerance` stay.
            let words = |own: &str| replaced(&replaced(own, "tip", "output"), "Tip", "Output");
            text = text.split("tip_").map(words).collect::<Vec<_>>().join("tip_");
        }
        text
    }

    /// Displacement of the rigid link's output per unit of the joint's position: of the tip, the length L of a link that
    /// turns, 1 of one that slides.
    pub fn rigid_tip(&self) -> f64 {
        self.joint().rigid(self.output_m())[0]
    }

    /// Checks that `at_m`, a distance from the axis in m, lies on the link.
    ///
    /// # Errors
    /// [`ParameterError`] about the parameter `name` if it does not.
    pub fn check_place(&self, name: &str, at_m: f64) -> Result<(), ParameterError> {
        let (root_m, tip_m) = (self.hub().radius_m, self.length_m());
        let slack_m = POSITION_TOLERANCE * tip_m;
        let is_there = (root_m - slack_m..=tip_m + slack_m).contains(&at_m);
        let from = if self.joint().slides() { "carriage" } else { "axis" };
        let must = format!("must lie on the link, from {root_m} m to {tip_m} m from the {from}");
        is_there.then_some(()).ok_or_else(|| ParameterError::new(name, at_m, "m", must))
    }

    /// First moment of mass about the axis in kg m. Times the gravity across the link, it is the holding torque.
    pub fn mass_moment_kg_m(&self) -> f64 {
        let (mut root_m, mut moment) = (self.parts.hub.radius_m, 0.0);
        for segment in &self.parts.segments {
            let (l, m) = (segment.length_m, segment.mass_per_length_kg_m);
            moment += l * (m.mean() * root_m + (m.inner + 2.0 * m.outer) / 6.0 * l);
            root_m += l;
        }
        let masses = self.parts.masses.iter().map(|mass| mass.mass_kg * mass.at_m);
        let Payload { mass_kg, offset_m, .. } = self.parts.payload;
        moment + masses.sum::<f64>() + mass_kg * (root_m + offset_m)
    }

    /// Direction in rad of a link on a carriage with weight, which it keeps. `None` for other links.
    pub fn direction_rad(&self) -> Option<f64> {
        let gravity = self.gravity().filter(|own| own.acts() && self.joint().slides())?;
        gravity.start_angle_rad
    }

    /// Gravity in m/s² outward along a link on a carriage with weight. `None` for other links.
    pub fn outward_m_s2(&self) -> Option<f64> {
        let (direction_rad, gravity) = self.direction_rad().zip(self.gravity())?;
        Some(gravity.along_m_s2(direction_rad))
    }

    /// Position of the joint of an unbent link where the displacement of its tip is 0: the start angle of a hub in rad, 0 on
    /// a carriage. `None` for a hub without a start angle.
    pub fn origin_rad(&self) -> Option<f64> {
        if self.joint().slides() {
            return Some(0.0);
        }
        self.gravity().and_then(|gravity| gravity.start_angle_rad)
    }

    /// Effort of the joint that holds the weight of the rigid link in a direction: the torque of a hub in N m; on a
    /// carriage the force in N, which holds the carriage, too.
    pub fn holding_effort(&self, direction_rad: f64) -> f64 {
        let moment = if self.joint().slides() {
            self.rigid_inertia_kg_m2()
        } else {
            self.mass_moment_kg_m()
        };
        self.gravity().map_or(0.0, |gravity| moment * gravity.across_m_s2(direction_rad))
    }

    /// Inertia of the rigid link with its joint: about the axis of a hub in kg m², on a carriage the mass in kg.
    ///
    /// ```text
    /// I_rigid = I_H + ∫ m̄ x² dx + Σ (m x² + J) + m_t (L + c)² + J_t
    /// ```
    pub fn rigid_inertia_kg_m2(&self) -> f64 {
        if let Some(carriage) = &self.parts.carriage {
            return carriage.mass_kg + self.mass_kg();
        }
        let Hub { inertia_kg_m2: mut inertia, radius_m: mut root_m, .. } = self.parts.hub;
        for segment in &self.parts.segments {
            let (l, m) = (segment.length_m, segment.mass_per_length_kg_m);
            // ∫₀ˡ m̄(s) (x + s)² ds with m̄ linear in s, one term for each power of s.
            inertia += l
                * (m.mean() * root_m * root_m
                    + (m.inner + 2.0 * m.outer) / 3.0 * root_m * l
                    + (m.inner + 3.0 * m.outer) / 12.0 * l * l);
            let rotary = segment.timoshenko.map(|own| own.rotary_inertia_per_length_kg_m.mean());
            inertia += l * rotary.unwrap_or(0.0);
            root_m += l;
        }
        for mass in &self.parts.masses {
            inertia += mass.mass_kg * mass.at_m.powi(2) + mass.inertia_kg_m2;
        }
        let Payload { mass_kg, inertia_kg_m2, offset_m } = self.parts.payload;
        inertia + mass_kg * (root_m + offset_m).powi(2) + inertia_kg_m2
    }
}

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

    /// A carriage in place of the hub.
    pub fn carriage(mut self, carriage: Carriage) -> Self {
        self.carriage = Some(carriage);
        self
    }

    /// A rotational spring between the joint and the root, its stiffness in N m/rad.
    pub fn root_stiffness_n_m_rad(mut self, stiffness_n_m_rad: f64) -> Self {
        self.root_stiffness_n_m_rad = Some(stiffness_n_m_rad);
        self
    }

    /// The output, whose motion is prescribed, at this distance in m from the axis or the carriage.
    pub fn output_m(mut self, at_m: f64) -> Self {
        self.output_m = Some(at_m);
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

/// Link of many unit tests: Bayo's link without its stiff root, undamped, with rigid inertia 1 kg m².
#[cfg(test)]
pub(crate) fn uniform() -> LinkParts {
    Link::builder().segment(uniform_segment()).hub_inertia_kg_m2(0.1)
}

/// The only segment of this link.
#[cfg(test)]
pub(crate) fn uniform_segment() -> Segment {
    Segment::uniform(1.5, 5.0, 0.8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::{CrossSection, Section, Taper};

    fn parts() -> LinkParts {
        let segment = |name: &str, length_m| Segment {
            name: Some(name.into()),
            ..Segment::uniform(length_m, 5.0, 0.8)
        };
        LinkParts { segments: vec![segment("root", 0.5), segment("beam", 1.0)], ..uniform() }
    }

    fn refusal(change: impl FnOnce(&mut LinkParts)) -> String {
        let mut parts = parts();
        change(&mut parts);
        Link::new(parts).unwrap_err().to_string()
    }

    #[test]
    fn rigid_inertia_of_a_tapered_link_matches_the_integral() {
        let mut parts = parts();
        parts.hub.radius_m = 0.2;
        parts.segments[1].mass_per_length_kg_m = Taper { inner: 0.9, outer: 0.3 };
        parts.masses.push(LumpedMass { at_m: 0.7, mass_kg: 0.1, inertia_kg_m2: 0.01 });
        parts.payload = Payload { mass_kg: 0.2, inertia_kg_m2: 0.03, offset_m: 0.1 };
        let link = Link::new(parts).unwrap();
        // Midpoint rule, fine enough for nine digits.
        let n = 90_000;
        let integral: f64 = (0..n)
            .map(|k| {
                let s = 1.5 * (f64::from(k) + 0.5) / f64::from(n);
                let m = if s < 0.5 { 0.8 } else { 0.9 - 0.6 * (s - 0.5) };
                m * (0.2 + s).powi(2) * 1.5 / f64::from(n)
            })
            .sum();
        let expected = 0.1 + integral + 0.1 * 0.49 + 0.01 + 0.2 * 1.8_f64.powi(2) + 0.03;
        assert!((link.rigid_inertia_kg_m2() / expected - 1.0).abs() < 1e-9);
    }

    #[test]
    fn every_range_is_refused_with_name_value_and_unit() {
        let cases = [
            (refusal(|p| p.segments.clear()), "segments = [], but must hold at least one segment"),
            (
                refusal(|p| p.segments[1].length_m = 0.0),
                "segments.1.length = 0 m, but must be finite and above 0",
            ),
            (
                refusal(|p| p.segments[0].bending_stiffness_n_m2.outer = -1.0),
                "segments.0.EI = -1 N m^2, but must be finite and above 0",
            ),
            (
                refusal(|p| p.segments[0].mass_per_length_kg_m.inner = f64::INFINITY),
                "segments.0.mass_per_length = inf kg/m, but must be finite and at least 0",
            ),
            (
                refusal(|p| p.segments[1].name = Some("root".into())),
                "segments.1.name = \"root\", but must be unique: an earlier segment has this name",
            ),
            (
                refusal(|p| p.hub.radius_m = f64::NAN),
                "hub.radius = NaN m, but must be finite and at least 0",
            ),
            (
                refusal(|p| {
                    p.masses.push(LumpedMass { at_m: 1.6, mass_kg: 1.0, inertia_kg_m2: 0.0 });
                }),
                "masses.0.at = 1.6 m, but must lie on the link, from 0 m to 1.5 m from the axis",
            ),
            (
                refusal(|p| p.payload.mass_kg = -1.0),
                "payload.mass = -1 kg, but must be finite and at least 0",
            ),
            (
                refusal(|p| {
                    p.hub.inertia_kg_m2 = 0.0;
                    p.segments.iter_mut().for_each(|s| {
                        s.mass_per_length_kg_m = Taper::constant(0.0);
                    });
                }),
                "segments = a total of 0 kg m^2, but the link with all that it carries must have a finite rotary \
                 inertia above 0",
            ),
        ];
        for (found, expected) in cases {
            assert_eq!(found, expected);
        }
    }

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
            carriage: None,
            root_stiffness_n_m_rad: None,
            output_m: None,
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
                ..Drive::DIRECT
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
