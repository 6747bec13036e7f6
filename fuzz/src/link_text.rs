use std::fmt::Write as _;

use flexlink::link::{Damping, Link, Segment, Taper};
use flexlink::result::{JointQuantity, QUANTITIES};
use flexlink::spec::Specification;

/// A link file in SI that says all that a specification holds, but for its mesh.
///
/// # Panics
/// Never: a string can be written to.
pub fn link_text(specification: &Specification) -> String {
    let (link, limits) = (specification.link(), specification.limits[0]);
    let analysis = specification.analysis;
    let mut file = bodies(link);
    file += &damping(link.damping());
    let mut table = |name: &str, entries: &[(&str, Option<f64>)]| {
        writeln!(file, "[{name}]").expect("a string");
        for (key, value) in entries.iter().filter_map(|(key, value)| Some((key, (*value)?))) {
            writeln!(file, "{key} = {value:?}").expect("a string");
        }
    };
    if let Some(drive) = link.drive() {
        let entries = [
            ("joint_stiffness", drive.joint_stiffness_n_m_rad),
            ("rotor_inertia", drive.rotor_inertia_kg_m2),
            ("gear_ratio", drive.gear_ratio),
        ];
        table("drive", &entries.map(|(key, value)| (key, Some(value))));
    }
    let keys = QUANTITIES.iter().filter_map(JointQuantity::limit_key);
    table("limits", &keys.map(|key| (key, limits.of(key))).collect::<Vec<_>>());
    let times = [
        ("tolerance", Some(analysis.tolerance())),
        ("lead", analysis.lead_s()),
        ("lag", analysis.lag_s()),
    ];
    table("analysis", &times);
    if let Some(modes) = analysis.modes() {
        writeln!(file, "modes = {modes}").expect("a string");
    }
    file
}

/// Title, segments and all that is rigid.
fn bodies(link: &Link) -> String {
    let segments: Vec<String> = link.segments().iter().map(segment).collect();
    let mass = |mass: &flexlink::link::LumpedMass| {
        let (at, mass, inertia) = (mass.at_m, mass.mass_kg, mass.inertia_kg_m2);
        format!("{{ at = {at:?}, mass = {mass:?}, inertia = {inertia:?} }}")
    };
    let masses: Vec<String> = link.masses().iter().map(mass).collect();
    let (hub, payload) = (link.hub(), link.payload());
    format!(
        "title = {}\nsegments = [{}]\nmasses = [{}]\n\
         hub = {{ inertia = {:?}, radius = {:?}, viscous_friction = {:?} }}\n\
         payload = {{ mass = {:?}, inertia = {:?}, offset = {:?} }}\n",
        quoted(link.title()),
        segments.join(", "),
        masses.join(", "),
        hub.inertia_kg_m2,
        hub.radius_m,
        hub.viscous_friction_n_m_s_rad,
        payload.mass_kg,
        payload.inertia_kg_m2,
        payload.offset_m,
    )
}

fn segment(segment: &Segment) -> String {
    let taper = |Taper { inner, outer }: Taper| format!("[{inner:?}, {outer:?}]");
    let name = segment.name.as_deref().map(|name| format!("name = {}, ", quoted(name)));
    format!(
        "{{ {}length = {:?}, EI = {}, mass_per_length = {} }}",
        name.unwrap_or_default(),
        segment.length_m,
        taper(segment.bending_stiffness_n_m2),
        taper(segment.mass_per_length_kg_m),
    )
}

fn damping(damping: &Damping) -> String {
    let keys = match damping {
        Damping::None => String::new(),
        Damping::Hysteretic { ratio } => format!(", ratio = {ratio:?}"),
        Damping::Rayleigh { alpha_per_s, beta_s } => {
            format!(", alpha = {alpha_per_s:?}, beta = {beta_s:?}")
        }
        Damping::RayleighThroughModes { modes, ratios } => {
            format!(", modes = {modes:?}, ratios = {ratios:?}")
        }
        Damping::Modal { ratios } => format!(", ratios = {ratios:?}"),
        Damping::Caughey { modes, ratios } => format!(", modes = {modes:?}, ratios = {ratios:?}"),
    };
    format!("damping = {{ model = \"{}\"{keys} }}\n", damping.name())
}

/// A string of TOML.
fn quoted(text: &str) -> String {
    let escaped = |letter: char| match letter {
        '"' | '\\' => format!("\\{letter}"),
        letter if letter.is_control() => format!("\\u{:04x}", u32::from(letter)),
        letter => letter.to_string(),
    };
    let inner: String = text.chars().map(escaped).collect();
    format!("\"{inner}\"")
}
