//! An arm: a chain of links in one plane.

use serde::{Deserialize, Serialize};

use super::joint::Joint;
use super::link::Link;
use super::parts::{Carriage, Gravity, ParameterError};

/// Largest number of links: a path names their angles with one digit.
pub(crate) const MOST_LINKS: usize = 9;

/// Side of the first link on which the second one lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Elbow {
    /// The second link turns left of the first: 0 < θ₂ − θ₁ < π.
    Left,
    /// The second link turns right of the first: −π < θ₂ − θ₁ < 0.
    Right,
}

impl Elbow {
    /// Keyword in an arm file.
    pub fn word(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
}

/// One link of an arm.
#[derive(Debug, Clone, PartialEq)]
pub struct ArmLink {
    /// Name of the link, unique within the arm.
    pub name: Option<String>,
    /// The link. Its payload is the load of its tip: on an inner link the body of the next joint.
    pub link: Link,
}

/// A carriage that moves the first joint of an arm along a straight rail.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ArmCarriage {
    /// Mass without the arm, and friction.
    #[serde(flatten)]
    pub carriage: Carriage,
    /// Direction of the rail along x and y. [`Arm::new`] scales it to length 1.
    pub axis: [f64; 2],
}

impl ArmCarriage {
    /// Force of the motor along the rail in N for a rate and an acceleration of the carriage, which exerts this force
    /// along x and y on the arm.
    ///
    /// ```text
    /// F = M (ü − g·e) + b u̇ + R·e
    /// ```
    pub fn force_n(
        &self,
        gravity_m_s2: [f64; 2],
        [rate_m_s, acceleration_m_s2]: [f64; 2],
        on_arm_n: [f64; 2],
    ) -> f64 {
        let Self { carriage, axis } = self;
        let along = |vector: [f64; 2]| axis[0] * vector[0] + axis[1] * vector[1];
        carriage.mass_kg * (acceleration_m_s2 - along(gravity_m_s2))
            + carriage.viscous_friction_n_s_m * rate_m_s
            + along(on_arm_n)
    }

    fn checked(self) -> Result<Self, ParameterError> {
        self.carriage.check()?;
        let [x, y] = self.axis;
        let length = libm::hypot(x, y);
        if length == 0.0 || !length.is_finite() {
            let must = "must be a direction along x and y, not both 0";
            return Err(ParameterError::new("carriage.axis", format!("[{x}, {y}]"), "", must));
        }
        Ok(Self { axis: [x / length, y / length], ..self })
    }
}

/// Parts of an arm before they are checked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ArmParts {
    /// Title for people.
    pub title: String,
    /// The links, the inner one first.
    pub links: Vec<ArmLink>,
    /// Gravity in m/s² along the plane's x and y axes.
    pub gravity_m_s2: [f64; 2],
    /// Side of the elbow; a path of the tip needs it.
    pub elbow: Option<Elbow>,
    /// Carriage of the first joint; without it, the axis of this joint is fixed.
    pub carriage: Option<ArmCarriage>,
}

/// A valid arm of up to nine links; each turns relative to the tip of the one before.
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    parts: ArmParts,
}

impl Arm {
    /// Checks every range of an arm of two links or more. [`Arm::from`] makes an arm of one link.
    ///
    /// # Errors
    /// [`ParameterError`] names the first parameter out of its range.
    pub fn new(mut parts: ArmParts) -> Result<Self, ParameterError> {
        let count = parts.links.len();
        if !(2..=MOST_LINKS).contains(&count) {
            let must = "must be from 2 to 9 links";
            return Err(ParameterError::new("links", format!("{count} links"), "", must));
        }
        Gravity { acceleration_m_s2: parts.gravity_m_s2, start_angle_rad: None }.check()?;
        for (index, ArmLink { name, link }) in parts.links.iter().enumerate() {
            let at = |key: &str| format!("links.{index}.{key}");
            let twin = |other: &ArmLink| name.is_some() && other.name == *name;
            if parts.links[..index].iter().any(twin) {
                let name = name.as_deref().unwrap_or_default();
                let must = "must be unique: an earlier link has this name";
                return Err(ParameterError::new(at("name"), format!("{name:?}"), "", must));
            }
            if link.joint().slides() {
                let must = "must not be there: the joints of an arm turn";
                return Err(ParameterError::new(at("carriage"), "a carriage", "", must));
            }
            if link.root_stiffness_n_m_rad().is_some() {
                let must = "must not be there: the program does not compute it yet for arms";
                let found = "a spring at the root";
                return Err(ParameterError::new(at("hub.root_stiffness"), found, "", must));
            }
            if link.has_station() {
                let must = "must not be there: the path of an arm is that of its tip";
                return Err(ParameterError::new(at("output"), "a station", "", must));
            }
            if link.gravity().is_some() {
                let must = "must be that of the arm";
                return Err(ParameterError::new(at("gravity"), "its own", "", must));
            }
        }
        parts.carriage = parts.carriage.map(ArmCarriage::checked).transpose()?;
        Ok(Self { parts })
    }

    /// Title for people, empty by default.
    pub fn title(&self) -> &str {
        &self.parts.title
    }

    /// The links, the inner one first.
    pub fn links(&self) -> &[ArmLink] {
        &self.parts.links
    }

    /// The joint between ground and the first link.
    pub fn joint(&self) -> Joint {
        self.parts.links[0].link.joint()
    }

    /// The carriage of the first joint of an arm. `None` for one link, whose carriage is its joint.
    pub fn carriage(&self) -> Option<&ArmCarriage> {
        self.parts.carriage.as_ref()
    }

    /// This arm with its carriage held.
    #[must_use]
    pub fn held(&self) -> Self {
        Self { parts: ArmParts { carriage: None, ..self.parts.clone() } }
    }

    /// This arm with the rotors of its motors, and the friction of their back voltages, at the joints; a voltage then acts
    /// as the torque [`Drive::effort_per_volt`](super::Drive::effort_per_volt) per volt.
    ///
    /// # Errors
    /// [`ParameterError`] for a joint without the motor's constants, or with a motor that does not act as inertia and friction
    /// of its joint: behind an elastic joint, on a moving link, or on a carriage with weight.
    pub fn under_voltages(&self) -> Result<Self, ParameterError> {
        let refused = |number: usize, key: &str, found: &str, must: &str| {
            let path = self.pick(String::new(), format!("links.{number}."));
            Err(ParameterError::new(format!("{path}drive.{key}"), found, "", must))
        };
        let must = "must be there: a voltage acts through it";
        let mut parts = self.parts.clone();
        for (number, ArmLink { link, .. }) in parts.links.iter_mut().enumerate() {
            let drive = link.drive().copied().unwrap_or_default();
            let Some(friction) = drive.back_friction() else {
                let is_missing = drive.torque_constant_n_m_a.is_none();
                let key = if is_missing { "torque_constant" } else { "resistance" };
                return refused(number, key, "nothing", must);
            };
            if drive.joint_stiffness_n_m_rad.is_finite() {
                let must = "must be inf: a voltage is played on stiff joints alone";
                return refused(number, "joint_stiffness", "finite", must);
            }
            *link = link.with_joint(0.0, friction)?;
        }
        if self.carriage().is_some() {
            let must = "must not be there: it has no motor for a voltage";
            return Err(ParameterError::new("carriage", "a carriage below an arm", "", must));
        }
        Self { parts }.with_rotors()
    }

    /// The arm with the rotors of its motors at the joints, as if all joints were rigid: the links under efforts of motors.
    ///
    /// # Errors
    /// [`ParameterError`] for a rotor beyond the first joint, and for one on a carriage with weight.
    pub fn with_rotors(&self) -> Result<Self, ParameterError> {
        let mut parts = self.parts.clone();
        for (number, ArmLink { link, .. }) in parts.links.iter_mut().enumerate() {
            let drive = link.drive().copied().unwrap_or_default();
            let refused = |key: &str, found: &str, must: &str| {
                let path = self.pick(String::new(), format!("links.{number}."));
                Err(ParameterError::new(format!("{path}drive.{key}"), found, "", must))
            };
            if drive.rotor_inertia_kg_m2 > 0.0 && number > 0 {
                let must =
                    "must be 0 beyond the first joint, whose rotor alone turns on the ground";
                return refused("rotor_inertia", "above 0", must);
            }
            if drive.rotor_inertia_kg_m2 > 0.0 && link.joint().slides() && link.has_weight() {
                let must =
                    "must be 0 on a carriage with weight: the rotor moves, but does not weigh";
                return refused("rotor_inertia", "above 0", must);
            }
            *link = link.with_joint(drive.rotor_at_joint(), 0.0)?;
        }
        Ok(Self { parts })
    }

    /// All joints with an effort: those of the links, the inner one first, then the carriage of an arm.
    pub fn joints(&self) -> impl Iterator<Item = Joint> {
        let carriage = self.carriage().map(|own| Joint::Prismatic(own.carriage));
        self.links().iter().map(|own| own.link.joint()).chain(carriage)
    }

    /// Name of one of [`Arm::joints`] of several links: `joint 2`, `carriage`.
    pub fn name_of_joint(&self, joint: usize) -> String {
        if joint < self.links().len() { format!("joint {}", joint + 1) } else { "carriage".into() }
    }

    /// The link of an arm of one link.
    pub fn alone(&self) -> Option<&Link> {
        match self.links() {
            [own] => Some(&own.link),
            _ => None,
        }
    }

    /// The first alternative for one link, the second for several.
    pub fn pick<T>(&self, of_link: T, of_arm: T) -> T {
        if self.alone().is_some() { of_link } else { of_arm }
    }

    /// A text in the words of its joint and of the output, from the text for a hub whose output is the tip. The joint is
    /// the first one, or the carriage of an arm in a text on the joint after the last, or on its torque.
    pub fn worded(&self, text: &str) -> String {
        let number = self.links().len() + 1;
        let [beyond, torque] = [format!("joint {number}"), format!("torque{number}")];
        let is_beyond = text.contains(&beyond) || text.contains(&torque);
        let of_carriage = self.carriage().filter(|_| is_beyond);
        of_carriage.map_or_else(
            || self.of_output(self.joint().worded(text)),
            |own| {
                let text = text.replace(&format!("of {beyond}"), "of the carriage");
                let text = text.replace(&beyond, "carriage").replace(&torque, "the force");
                let text =
                    text.replace("the joint stands", "it stands").replace(" at the joint", "");
                Joint::Prismatic(own.carriage).worded(&text)
            },
        )
    }

    /// A text for this arm, from the text for one whose output is the tip.
    pub fn of_output(&self, text: String) -> String {
        self.links()[0].link.of_output(text)
    }

    /// Number of a joint in metrics, limits and remarks, from 0. `None` for one link, whose joint is its hub.
    pub fn number_of(&self, joint: usize) -> Option<usize> {
        self.pick(None, Some(joint))
    }

    /// Gravity in m/s² along the plane's x and y axes.
    pub fn gravity_m_s2(&self) -> [f64; 2] {
        self.parts.gravity_m_s2
    }

    /// True if gravity acts in the plane.
    pub fn has_weight(&self) -> bool {
        self.parts.gravity_m_s2.iter().any(|part| *part != 0.0)
    }

    /// Side of the elbow, if set.
    pub fn elbow(&self) -> Option<Elbow> {
        self.parts.elbow
    }

    /// Name of a link in messages: its name, or its number from 1.
    pub fn name_of(&self, link: usize) -> String {
        match &self.parts.links[link].name {
            Some(name) => format!("link {name}"),
            None => format!("link {}", link + 1),
        }
    }

    /// Weight times length in N m: the size of its moments about the first joint, also where counterweights balance it. On
    /// a carriage the weight in N.
    pub fn weight_moment_n_m(&self) -> f64 {
        let [x, y] = self.gravity_m_s2();
        let masses_kg: f64 = self.links().iter().map(|own| own.link.mass_kg()).sum();
        let [length_m, _] = self.joint().rigid(self.length_m());
        masses_kg * length_m * (x * x + y * y).sqrt()
    }

    /// Inertia of all that each joint moves, with rigid links in these directions in rad and the other joints held: in kg m²
    /// about a hub, in kg on a carriage, which comes last.
    pub fn joint_inertias(&self, directions_rad: &[f64]) -> Vec<f64> {
        let links = || self.links().iter().map(|own| &own.link).zip(directions_rad);
        let mut place_m = [0.0; 2];
        let mut roots_m = Vec::new();
        for (link, direction_rad) in links() {
            roots_m.push(place_m);
            let along = [libm::cos(*direction_rad), libm::sin(*direction_rad)];
            place_m = [0, 1].map(|axis| place_m[axis] + link.rigid_tip() * along[axis]);
        }
        let about = |joint: usize| {
            let outer = links().zip(&roots_m).skip(joint);
            let inertia = |((link, direction_rad), root_m): ((&Link, &f64), &[f64; 2])| {
                let away_m = [0, 1].map(|axis| root_m[axis] - roots_m[joint][axis]);
                let along =
                    away_m[0] * libm::cos(*direction_rad) + away_m[1] * libm::sin(*direction_rad);
                let square_m2 = away_m[0] * away_m[0] + away_m[1] * away_m[1];
                link.rigid_inertia_kg_m2()
                    + link.mass_kg() * square_m2
                    + 2.0 * link.mass_moment_kg_m() * along
            };
            outer.map(inertia).sum()
        };
        let carried = || self.links().iter().map(|own| own.link.mass_kg()).sum::<f64>();
        let carriage = self.carriage().map(|own| own.carriage.mass_kg + carried());
        (0..self.links().len()).map(about).chain(carriage).collect()
    }

    /// Stiffness of each joint between rotor and hub in N m/rad; infinite for a rigid joint.
    pub fn joint_stiffnesses_n_m_rad(&self) -> Vec<f64> {
        self.links().iter().map(|own| own.link.joint_stiffness_n_m_rad()).collect()
    }

    /// Distance in m from the joint of each link to its output, the length of the link unless one link has a station.
    pub fn lengths_m(&self) -> Vec<f64> {
        self.parts.links.iter().map(|own| own.link.output_m()).collect()
    }

    /// Length of the stretched arm in m.
    pub fn length_m(&self) -> f64 {
        self.parts.links.iter().map(|own| own.link.length_m()).sum()
    }
}

/// A link is an arm of one link.
impl From<Link> for Arm {
    fn from(link: Link) -> Self {
        Self {
            parts: ArmParts {
                title: link.title().to_owned(),
                gravity_m_s2: link.gravity().map_or([0.0; 2], |own| own.acceleration_m_s2),
                links: vec![ArmLink { name: None, link }],
                elbow: None,
                carriage: None,
            },
        }
    }
}

impl Link {
    /// Mass in kg of all that turns about the axis, without the hub.
    pub fn mass_kg(&self) -> f64 {
        let segments = self.segments().iter();
        let beam: f64 = segments.map(|s| s.length_m * s.mass_per_length_kg_m.mean()).sum();
        let lumped: f64 = self.masses().iter().map(|mass| mass.mass_kg).sum();
        beam + lumped + self.payload().mass_kg
    }
}
