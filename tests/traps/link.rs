//! A link as the cases describe it: written to a link file for the program, and cut into pieces
//! for the truth.

use std::fmt::Write;

/// Files, columns and keys of a hub, and those of a carriage in their place.
const OF_CARRIAGE: [(&str, &str); 12] = [
    ("torque.csv", "force.csv"),
    ("torque_n_m", "force_n"),
    ("torque", "force"),
    ("peak_torque_n_m", "peak_force_n"),
    ("hub_angle.csv", "carriage.csv"),
    ("hub_angle_rad", "carriage_m"),
    ("hub_angle", "carriage_travel"),
    ("hub_rate_rad_s", "carriage_velocity_m_s"),
    ("hub_rate", "carriage_speed"),
    ("peak_hub_rate_rad_s", "peak_carriage_speed_m_s"),
    ("hub_acceleration_rad_s2", "carriage_acceleration_m_s2"),
    ("hub_acceleration", "carriage_acceleration"),
];

/// Those of the tip, and those of a station in their place.
const OF_STATION: [(&str, &str); 2] =
    [("tip.csv", "output.csv"), ("tip_displacement_m", "output_displacement_m")];

/// Pieces that a tapered segment is cut into for the coarser of the two truths.
const TAPER_PIECES: usize = 32;

/// A value at the inner and at the outer end of a segment.
pub(crate) type Ends = [f64; 2];

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Segment {
    pub(crate) length_m: f64,
    pub(crate) stiffness_n_m2: Ends,
    pub(crate) mass_kg_m: Ends,
}

/// A body on the link, `at_m` from the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Body {
    pub(crate) at_m: f64,
    pub(crate) mass_kg: f64,
    pub(crate) inertia_kg_m2: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Payload {
    pub(crate) mass_kg: f64,
    pub(crate) inertia_kg_m2: f64,
    pub(crate) offset_m: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    pub(crate) stiffness_n_m: f64,
    pub(crate) rotor_kg_m2: f64,
    pub(crate) gear: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Damping {
    Hysteretic(f64),
    Rayleigh { alpha_per_s: f64, beta_s: f64 },
    RayleighThrough { modes: [usize; 2], ratios: [f64; 2] },
    Modal(Vec<f64>),
    Caughey(Vec<f64>),
}

/// The joint between ground and link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Joint {
    Hub,
    /// Slides across the link: forces in N stand for torques, displacements in m for angles.
    Carriage,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Link {
    pub(crate) joint: Joint,
    pub(crate) segments: Vec<Segment>,
    /// Inertia of the joint: of a hub in kg m², of a carriage in kg.
    pub(crate) hub_kg_m2: f64,
    pub(crate) friction_n_m_s: f64,
    /// Stiffness of a spring between joint and root in N m/rad; infinite without one.
    pub(crate) root_n_m_rad: f64,
    /// Distance of the output from the axis in m; `None` for the tip.
    pub(crate) output_m: Option<f64>,
    pub(crate) radius_m: f64,
    pub(crate) bodies: Vec<Body>,
    pub(crate) payload: Payload,
    pub(crate) damping: Damping,
    pub(crate) drive: Option<Drive>,
}

/// A uniform stretch of the link with the body at its outer end, the payload left out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub(crate) length_m: f64,
    pub(crate) stiffness_n_m2: f64,
    pub(crate) mass_kg_m: f64,
    pub(crate) end_kg: f64,
    pub(crate) end_kg_m2: f64,
}

impl Link {
    /// One uniform segment on a hub, damping 0.02.
    pub(crate) fn uniform(
        length_m: f64,
        stiffness_n_m2: f64,
        mass_kg_m: f64,
        hub_kg_m2: f64,
    ) -> Self {
        Self {
            joint: Joint::Hub,
            root_n_m_rad: f64::INFINITY,
            output_m: None,
            segments: vec![Segment {
                length_m,
                stiffness_n_m2: [stiffness_n_m2; 2],
                mass_kg_m: [mass_kg_m; 2],
            }],
            hub_kg_m2,
            friction_n_m_s: 0.0,
            radius_m: 0.0,
            bodies: Vec::new(),
            payload: Payload::default(),
            damping: Damping::Hysteretic(0.02),
            drive: None,
        }
    }

    /// The paper's first example: a root of 0.15 m that is ten times stiffer.
    pub(crate) fn paper() -> Self {
        let mut link = Self::uniform(1.35, 5.0, 0.8, 0.1);
        let root = Segment { length_m: 0.15, stiffness_n_m2: [50.0; 2], mass_kg_m: [0.8; 2] };
        link.segments.insert(0, root);
        link
    }

    /// The link of the University of Rome behind its joint spring, as `specs/rome_link.toml`.
    pub(crate) fn rome() -> Self {
        let mut link = Self::uniform(0.7, 2.4507, 2.975, 1.95e-3);
        link.payload.mass_kg = 0.117;
        link.drive = Some(Drive { stiffness_n_m: 1000.0, rotor_kg_m2: 1.0, gear: 1.0 });
        link
    }

    /// A tube of carbon fibre, 1 m, 12 × 1 mm, with a heavy tip.
    pub(crate) fn tube() -> Self {
        let (outer, inner) = (0.012_f64, 0.010_f64);
        let pi = std::f64::consts::PI;
        let stiffness = 90e9 * pi / 64.0 * (outer.powi(4) - inner.powi(4));
        let mass = 1600.0 * pi / 4.0 * (outer.powi(2) - inner.powi(2));
        let mut link = Self::uniform(1.0, stiffness, mass, 0.5);
        link.payload.mass_kg = 1.0;
        link.damping = Damping::Hysteretic(0.01);
        link
    }

    /// Distance from axis to tip.
    pub(crate) fn length_m(&self) -> f64 {
        self.radius_m + self.segments.iter().map(|s| s.length_m).sum::<f64>()
    }

    /// The program's name of a file, column or key of this link, from that of a hub with the tip as output.
    pub(crate) fn named<'a>(&self, name: &'a str) -> &'a str {
        let of_joint = OF_CARRIAGE.iter().filter(|_| self.joint == Joint::Carriage);
        let of_output = OF_STATION.iter().filter(|_| self.output_m.is_some());
        let mut pairs = of_joint.chain(of_output);
        pairs.find(|(of_hub, _)| *of_hub == name).map_or(name, |(_, own)| own)
    }

    /// Distance from the axis to the place whose motion the cases prescribe.
    pub(crate) fn output_m(&self) -> f64 {
        self.output_m.unwrap_or_else(|| self.length_m())
    }

    /// Displacement of the rigid link at the output per unit of the joint.
    pub(crate) fn rigid_output(&self) -> f64 {
        self.joint.rigid(self.output_m())[0]
    }

    pub(crate) fn is_tapered(&self) -> bool {
        self.segments.iter().any(Segment::is_tapered)
    }

    /// Uniform pieces, each tapered segment in `fineness` times [`TAPER_PIECES`] of them.
    pub(crate) fn pieces(&self, fineness: usize) -> Vec<Piece> {
        let mut bodies = self.bodies.clone();
        bodies.sort_by(|a, b| a.at_m.total_cmp(&b.at_m));
        let mut pieces = Vec::new();
        let mut start = self.radius_m;
        for segment in &self.segments {
            let end = start + segment.length_m;
            let inside = bodies.iter().filter(|b| b.at_m > start && b.at_m <= end + 1e-12);
            let mut from = start;
            for body in inside {
                segment.cut([from - start, body.at_m - start], fineness, &mut pieces);
                let last = pieces.last_mut().expect("a piece before every body");
                last.end_kg += body.mass_kg;
                last.end_kg_m2 += body.inertia_kg_m2;
                from = body.at_m;
            }
            segment.cut([from - start, segment.length_m], fineness, &mut pieces);
            start = end;
        }
        pieces
    }

    /// The link file, with its tables `[mesh]`, `[analysis]` and `[limits]`.
    pub(crate) fn toml(&self, tables: &str) -> String {
        let mut text = String::new();
        let mut line = |arguments: std::fmt::Arguments<'_>| {
            writeln!(text, "{arguments}").expect("text takes all");
        };
        for Segment { length_m, stiffness_n_m2: ei, mass_kg_m: m } in &self.segments {
            line(format_args!("[[segments]]\nlength = {length_m:?}\nEI = {ei:?}"));
            line(format_args!("mass_per_length = {m:?}"));
        }
        match self.joint {
            Joint::Hub => {
                line(format_args!("[hub]\ninertia = {:?}", self.hub_kg_m2));
                line(format_args!("radius = {:?}", self.radius_m));
            }
            Joint::Carriage => line(format_args!("[carriage]\nmass = {:?}", self.hub_kg_m2)),
        }
        line(format_args!("viscous_friction = {:?}", self.friction_n_m_s));
        line(format_args!("root_stiffness = {:?}", self.root_n_m_rad));
        if let Some(at_m) = self.output_m {
            line(format_args!("[output]\nat = {at_m:?}"));
        }
        for Body { at_m, mass_kg, inertia_kg_m2 } in &self.bodies {
            line(format_args!("[[masses]]\nat = {at_m:?}\nmass = {mass_kg:?}"));
            line(format_args!("inertia = {inertia_kg_m2:?}"));
        }
        let Payload { mass_kg, inertia_kg_m2, offset_m } = self.payload;
        line(format_args!("[payload]\nmass = {mass_kg:?}\ninertia = {inertia_kg_m2:?}"));
        line(format_args!("offset = {offset_m:?}\n{}", self.damping.toml()));
        if let Some(Drive { stiffness_n_m, rotor_kg_m2, gear }) = self.drive {
            line(format_args!("[drive]\njoint_stiffness = {stiffness_n_m:?}"));
            line(format_args!("rotor_inertia = {rotor_kg_m2:?}\ngear_ratio = {gear:?}"));
            if self.joint == Joint::Carriage {
                line(format_args!("pinion_radius = 1.0"));
            }
        }
        line(format_args!("{tables}"));
        text
    }
}

impl Joint {
    /// Displacement in m and slope of the rigid link at a place per unit of the joint.
    pub(crate) fn rigid(self, x_m: f64) -> [f64; 2] {
        match self {
            Self::Hub => [x_m, 1.0],
            Self::Carriage => [1.0, 0.0],
        }
    }
}

impl Segment {
    fn is_tapered(&self) -> bool {
        let tapers = |[inner, outer]: Ends| (outer / inner - 1.0).abs() > 1e-12;
        tapers(self.stiffness_n_m2) || tapers(self.mass_kg_m)
    }

    /// Pieces of the part between two places, midpoint values.
    fn cut(&self, [from, to]: Ends, fineness: usize, pieces: &mut Vec<Piece>) {
        if to - from < 1e-12 {
            return;
        }
        let count = if self.is_tapered() { TAPER_PIECES * fineness } else { 1 };
        let length_m = (to - from) / count as f64;
        for k in 0..count {
            let middle = (from + (k as f64 + 0.5) * length_m) / self.length_m;
            let at = |[inner, outer]: Ends| inner + (outer - inner) * middle;
            pieces.push(Piece {
                length_m,
                stiffness_n_m2: at(self.stiffness_n_m2),
                mass_kg_m: at(self.mass_kg_m),
                end_kg: 0.0,
                end_kg_m2: 0.0,
            });
        }
    }
}

impl Damping {
    fn toml(&self) -> String {
        match self {
            Self::Hysteretic(ratio) => {
                format!("[damping]\nmodel = \"hysteretic\"\nratio = {ratio:?}")
            }
            Self::Rayleigh { alpha_per_s, beta_s } => {
                format!(
                    "[damping]\nmodel = \"rayleigh\"\nalpha = {alpha_per_s:?}\nbeta = {beta_s:?}"
                )
            }
            Self::RayleighThrough { modes, ratios } => {
                format!("[damping]\nmodel = \"rayleigh\"\nmodes = {modes:?}\nratios = {ratios:?}")
            }
            Self::Modal(ratios) => format!("[damping]\nmodel = \"modal\"\nratios = {ratios:?}"),
            Self::Caughey(ratios) => format!("[damping]\nmodel = \"caughey\"\nratios = {ratios:?}"),
        }
    }
}
