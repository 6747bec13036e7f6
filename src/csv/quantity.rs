use crate::numeric::Dimension;

/// What a column of a table that is read holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    Acceleration,
    Velocity,
    Displacement,
    /// Displacement over the link's length.
    Angle,
    Torque,
    HubAngle,
    HubRate,
}

/// How the column of a quantity is headed.
struct Description {
    word: &'static str,
    /// This program's own ending of the name, which tells the SI unit.
    suffix: &'static str,
    dimension: Dimension,
    /// The SI unit, and another that is much used.
    units: [&'static str; 2],
}

impl Quantity {
    fn description(self) -> Description {
        let of = |word, suffix, dimension, units| Description { word, suffix, dimension, units };
        match self {
            Self::Time => of("time", "_s", Dimension::TIME, ["s", "ms"]),
            Self::Acceleration => {
                of("acceleration", "_m_s2", Dimension::ACCELERATION, ["m/s^2", "cm/s^2"])
            }
            Self::Velocity => of("velocity", "_m_s", Dimension::VELOCITY, ["m/s", "cm/s"]),
            Self::Displacement => of("displacement", "_m", Dimension::LENGTH, ["m", "cm"]),
            Self::Angle => of("angle", "_rad", Dimension::NONE, ["rad", "deg"]),
            Self::Torque => of("torque", "_n_m", Dimension::TORQUE, ["N m", "N cm"]),
            Self::HubAngle => of("hub_angle", "_rad", Dimension::NONE, ["rad", "deg"]),
            Self::HubRate => of("hub_rate", "_rad_s", Dimension::RATE, ["rad/s", "deg/s"]),
        }
    }

    /// The name, without prefix and unit.
    pub(super) fn word(self) -> &'static str {
        self.description().word
    }

    pub(super) fn dimension(self) -> Dimension {
        self.description().dimension
    }

    /// The SI unit, and another that is much used.
    pub(super) fn units(self) -> [&'static str; 2] {
        self.description().units
    }

    /// Whether a name ends with this program's own suffix.
    pub(super) fn is_suffixed(self, name: &str) -> bool {
        name.to_lowercase().ends_with(self.description().suffix)
    }
}

/// The columns that one kind of table may hold.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vocabulary {
    pub(super) quantities: &'static [Quantity],
    /// May stand before any name, and changes nothing.
    prefix: &'static str,
    /// A row of names.
    pub(super) example: &'static str,
    /// What to do about two columns of one quantity, where that is not plain.
    pub(super) choice: Option<&'static str>,
}

/// The tip's motion.
pub(super) const TRAJECTORY: Vocabulary = Vocabulary {
    quantities: &[
        Quantity::Time,
        Quantity::Acceleration,
        Quantity::Velocity,
        Quantity::Displacement,
        Quantity::Angle,
    ],
    prefix: "tip_",
    example: "time,acceleration",
    choice: None,
};

/// A torque at the hub.
pub(super) const TORQUE: Vocabulary = Vocabulary {
    quantities: &[Quantity::Time, Quantity::Torque],
    prefix: "hub_",
    example: "time,torque",
    choice: Some("rename one of them; among torques --column chooses"),
};

/// The hub's motion.
pub(super) const HUB_MOTION: Vocabulary = Vocabulary {
    quantities: &[Quantity::Time, Quantity::HubAngle, Quantity::HubRate],
    prefix: "",
    example: "time,hub_angle",
    choice: Some("rename one of them"),
};

impl Vocabulary {
    /// A name in small letters, without the prefix.
    pub(super) fn plain(&self, name: &str) -> String {
        let lower = name.to_lowercase();
        lower.strip_prefix(self.prefix).map_or_else(|| lower.clone(), str::to_owned)
    }

    /// The quantity of a name, and whether the name tells its unit.
    pub(super) fn quantity(&self, name: &str) -> Option<(Quantity, bool)> {
        let plain = self.plain(name);
        self.quantities.iter().find_map(|quantity| {
            let Description { word, suffix, .. } = quantity.description();
            let ending = plain.strip_prefix(word)?;
            (ending.is_empty() || ending == suffix).then_some((*quantity, ending == suffix))
        })
    }
}
