//! The joint that a motor drives: its unit motion, inertia and friction.

use super::parts::{Carriage, Hub};

/// Parts of names of a hub, and those of a carriage in their place; longer ones stand first.
const NAMES: [(&str, &str); 14] = [
    ("hub_acceleration_rad_s2", "carriage_acceleration_m_s2"),
    ("hub_acceleration", "carriage_acceleration"),
    ("gear_ratio", "gear_ratio_rad_m"),
    ("hub_angle_rad", "carriage_travel_m"),
    ("hub_rate_rad_s", "carriage_speed_m_s"),
    ("friction_rate_rad_s", "friction_rate_m_s"),
    ("friction_n_m", "friction_n"),
    ("torque_n_m", "force_n"),
    ("stiffness_n_m_rad", "stiffness_n_m"),
    ("damping_n_m_s_rad", "damping_n_s_m"),
    ("torque", "force"),
    ("hub_angle", "carriage_travel"),
    ("hub_rate", "carriage_speed"),
    ("hub", "carriage"),
];

/// Words and units of a hub in texts, and those of a carriage in their place; longer ones stand first.
const WORDS: [(&str, &str); 24] = [
    ("the motion, or write the motion as angles", "the motion"),
    ("T/a_tip of the paper's dense H", "F/a_tip by assembled matrices"),
    ("T/a_tip", "F/a_tip"),
    ("large deflections and centrifugal stiffening", "large deflections"),
    ("N m s/rad", "N s/m"),
    ("N m/rad", "N/m"),
    ("N m", "N"),
    ("rad/s²", "m/s²"),
    ("rad/s", "m/s"),
    ("rad", "m"),
    ("hub's peak angle", "carriage's travel"),
    ("hub_angle.csv", "carriage.csv"),
    ("hub_acceleration", "carriage_acceleration"),
    ("hub_angle", "carriage_travel"),
    ("hub.inertia", "carriage.mass"),
    ("hub angle", "carriage travel"),
    ("hub rate", "carriage speed"),
    ("hub_rate", "carriage_speed"),
    ("hub accel.", "accel."),
    ("hub", "carriage"),
    ("torques", "forces"),
    ("torque", "force"),
    ("turns", "moves"),
    ("turn", "travel"),
];

/// The joint between ground and link.
///
/// A hub turns: its position is an angle in rad, its effort a torque in N m. A carriage slides across the link: its
/// position is a displacement in m, its effort a force in N. Histories, transfers and modes have the names and units of a
/// hub; of a carriage they hold its position and effort in these units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint {
    /// A hub, which turns.
    Revolute(Hub),
    /// A carriage, which slides.
    Prismatic(Carriage),
}

impl Joint {
    /// A carriage, for its words and names alone.
    pub(crate) const CARRIAGE: Self =
        Self::Prismatic(Carriage { mass_kg: 0.0, viscous_friction_n_s_m: 0.0 });

    /// Inertia of the joint alone: `I_H` of a hub in kg m², M of a carriage in kg.
    pub fn inertia(&self) -> f64 {
        match self {
            Self::Revolute(hub) => hub.inertia_kg_m2,
            Self::Prismatic(carriage) => carriage.mass_kg,
        }
    }

    /// Viscous friction: b of a hub in N m s/rad, of a carriage in N s/m.
    pub fn friction(&self) -> f64 {
        match self {
            Self::Revolute(hub) => hub.viscous_friction_n_m_s_rad,
            Self::Prismatic(carriage) => carriage.viscous_friction_n_s_m,
        }
    }

    /// Distance in m from the axis, or from the carriage, to the root of the link.
    pub fn radius_m(&self) -> f64 {
        match self {
            Self::Revolute(hub) => hub.radius_m,
            Self::Prismatic(_) => 0.0,
        }
    }

    /// Displacement in m and slope of the rigid link at `x_m` per unit of the joint's position.
    #[inline]
    pub fn rigid(&self, x_m: f64) -> [f64; 2] {
        match self {
            Self::Revolute(_) => [x_m, 1.0],
            Self::Prismatic(_) => [1.0, 0.0],
        }
    }

    /// Position of the joint from the motion (v, φ) of the root.
    pub fn position<S>(&self, [v, phi]: [S; 2]) -> S {
        match self {
            Self::Revolute(_) => phi,
            Self::Prismatic(_) => v,
        }
    }

    /// The name of a number, column or key for this joint, from its name for a hub. Names of motors and moments stay.
    pub fn named(&self, name: &str) -> String {
        let of_motor = ["motor", "moment", "torque_constant"].iter().any(|own| name.contains(own));
        let stays = !self.slides() || of_motor;
        let pairs = NAMES.iter().filter(|_| !stays);
        pairs.fold(name.to_owned(), |name, (of_hub, own)| name.replace(of_hub, own))
    }

    /// A text for this joint, from the text for a hub. Replaces whole words. Texts on a limit of the motor or of a moment stay.
    pub fn worded(&self, text: &str) -> String {
        let stays =
            ["motor_", "motor torque", "bending_moment"].iter().any(|own| text.contains(own));
        let pairs = WORDS.iter().filter(|_| self.slides() && !stays);
        pairs.fold(text.to_owned(), |text, (of_hub, own)| replaced(&text, of_hub, own))
    }

    /// True if the joint slides.
    pub fn slides(&self) -> bool {
        matches!(self, Self::Prismatic(_))
    }
}

/// Replaces a phrase where it stands between signs that are no letters, digits or exponents.
pub(super) fn replaced(text: &str, phrase: &str, by: &str) -> String {
    let is_of_word = |sign: char| sign.is_alphanumeric() || sign == '²' || sign == '/';
    let mut whole = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(phrase) {
        let (before, after) = (&rest[..at], &rest[at + phrase.len()..]);
        let begins = !before.ends_with(is_of_word);
        let ends = phrase.ends_with('.') || !after.starts_with(is_of_word);
        whole += before;
        whole += if begins && ends { by } else { phrase };
        rest = after;
    }
    whole + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_hub_become_those_of_a_carriage() {
        let carriage = Joint::CARRIAGE;
        for (of_hub, own) in [
            ("the torque returns to 2 N m", "the force returns to 2 N"),
            ("EI = 5 N m², 3 rad/s of 4 rad", "EI = 5 N m², 3 m/s of 4 m"),
            ("hub turns by up to 0.5 rad", "carriage moves by up to 0.5 m"),
            ("3 N m s/rad at the hub's radius", "3 N s/m at the carriage's radius"),
        ] {
            assert_eq!(carriage.worded(of_hub), own);
            assert_eq!(Joint::Revolute(Hub::default()).worded(of_hub), of_hub);
        }
        for (of_hub, own) in [
            ("peak_rigid_torque_n_m", "peak_rigid_force_n"),
            ("peak_hub_rate_rad_s", "peak_carriage_speed_m_s"),
            ("peak_motor_torque_n_m", "peak_motor_torque_n_m"),
            ("peak_root_moment_n_m", "peak_root_moment_n_m"),
        ] {
            assert_eq!(carriage.named(of_hub), own);
        }
    }
}
