//! The link file: what it says is read, and what it must not say is refused in full sentences.

#![expect(
    clippy::float_cmp,
    clippy::unwrap_used,
    reason = "decimal units cost no digit, and a test may fail where it stands"
)]

mod damping;
mod overrides;
mod refusals;
mod specs;

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::Analysis;
use flexlink::link::{Damping, Drive, Hub, LumpedMass, Payload, Taper};
use flexlink::result::Limits;
use flexlink::spec::{Override, SpecError, Specification, read_specification};

/// The example of the interface.
const EXAMPLE: &str = r#"title = "Bayo (1987), example 1: I = 0.25e-2 cm^4"

[[segments]]                 # from the hub outward
name = "root"
length = "15 cm"
EI = "5e5 N cm^2"
mass_per_length = 0.8
elements = 1

[[segments]]
name = "beam"
length = "135 cm"
EI = "5e4 N cm^2"
mass_per_length = 0.8
elements = 9

[hub]
inertia = "1000 kg cm^2"
radius = 0.0
viscous_friction = 0.0

[[masses]]
at = 0.75
mass = 0.05
inertia = 0.0

[payload]
mass = 0.0
inertia = 0.0
offset = 0.0

[damping]
model = "hysteretic"
ratio = 0.02

[drive]
joint_stiffness = inf
rotor_inertia = 0.0
gear_ratio = 1.0

[limits]
torque = 5.0
hub_rate = 6.0
deflection = 0.1
bending_moment = 20.0
motor_torque = 0.5
motor_rms_torque = "20 N cm"
motor_rate = "3000 rpm"
motor_power = "100 W"

[mesh]
elements = 10
tolerance = 1e-6

[analysis]
tolerance = 1e-6
lead = 0.5
lag = 0.5
modes = 5
"#;

/// A whole link in one line, so that tests add their own lines below it.
const SHORT: &str = "segments = [{ length = 1.5, EI = 5, mass_per_length = 0.8 }]\n";

fn read(text: &str) -> Result<Specification, SpecError> {
    read_specification("link.toml", text, &[])
}

fn read_with(text: &str, settings: &[&str]) -> Result<Specification, SpecError> {
    let overrides: Result<Vec<Override>, _> = settings.iter().map(|set| set.parse()).collect();
    read_specification("link.toml", text, &overrides?)
}

#[test]
fn the_whole_example_is_read_in_si() {
    let own = read(EXAMPLE).unwrap();
    let (link, mesh, analysis, limits) = (own.link(), own.mesh(), own.analysis, own.limits[0]);
    assert_eq!(link.title(), "Bayo (1987), example 1: I = 0.25e-2 cm^4");
    let [root, beam] = link.segments() else {
        panic!("{:?}", link.segments());
    };
    assert_eq!(root.name.as_deref(), Some("root"));
    assert_eq!((root.length_m, beam.length_m), (0.15, 1.35));
    assert_eq!(root.bending_stiffness_n_m2, Taper::constant(50.0));
    assert_eq!(beam.bending_stiffness_n_m2, Taper::constant(5.0));
    assert_eq!(beam.mass_per_length_kg_m, Taper::constant(0.8));
    let hub = Hub { inertia_kg_m2: 0.1, ..Hub::default() };
    assert_eq!(*link.hub(), hub);
    let mass = LumpedMass { at_m: 0.75, mass_kg: 0.05, inertia_kg_m2: 0.0 };
    assert_eq!(link.masses(), [mass]);
    assert_eq!(*link.payload(), Payload::default());
    assert_eq!(*link.damping(), Damping::Hysteretic { ratio: 0.02 });
    let stiff_joint = Drive {
        joint_stiffness_n_m_rad: f64::INFINITY,
        rotor_inertia_kg_m2: 0.0,
        gear_ratio: 1.0,
        ..Drive::DIRECT
    };
    assert_eq!(link.drive(), Some(&stiff_joint));
    assert_eq!((limits.of("torque"), limits.of("hub_rate")), (Some(5.0), Some(6.0)));
    assert_eq!((limits.of("deflection"), limits.of("bending_moment")), (Some(0.1), Some(20.0)));
    assert_eq!((limits.of("power"), limits.of("rms_torque")), (None, None));
    assert_eq!((limits.of("motor_torque"), limits.of("motor_rms_torque")), (Some(0.5), Some(0.2)));
    let rate = limits.of("motor_rate").unwrap();
    assert!((rate - 100.0 * std::f64::consts::PI).abs() < 1e-12, "{rate}");
    assert_eq!(limits.of("motor_power"), Some(100.0));
    let total = Some(ElementCount::Total(10));
    let plan = MeshPlan::new(link, &[Some(1), Some(9)], total, 1e-6);
    assert_eq!(*mesh, plan.unwrap());
    let window = Analysis::new(1e-6, Some(0.5), Some(0.5));
    assert_eq!(analysis, window.unwrap().keeping_modes(5).unwrap());
}

#[test]
fn only_segments_are_required() {
    let own = read(SHORT).unwrap();
    let (link, mesh, analysis, limits) = (own.link(), own.mesh(), own.analysis, own.limits[0]);
    assert_eq!((link.drive(), limits), (None, Limits::default()));
    assert_eq!(link.title(), "");
    assert_eq!(*link.hub(), Hub::default());
    assert_eq!(*link.damping(), Damping::None);
    assert_eq!(analysis, Analysis::default());
    let plan = MeshPlan::new(link, &[None], None, MeshPlan::DEFAULT_TOLERANCE);
    assert_eq!(*mesh, plan.unwrap());
}

#[test]
fn stiffness_and_mass_follow_from_material_and_section() {
    let segment = |keys: &str| {
        let specification = read(&format!("[[segments]]\nlength = 1\n{keys}\n")).unwrap();
        let segment = &specification.link().segments()[0];
        (segment.bending_stiffness_n_m2, segment.mass_per_length_kg_m)
    };
    let paper = segment(
        "E = '2e7 N/cm^2'\nI = ['2.5e-2 cm^4', '0.25e-2 cm^4']\ndensity = '0.008 kg/cm^3'\n\
         area = '1 cm^2'",
    );
    let taper = Taper { inner: 50.0, outer: 5.0 };
    assert_eq!(paper, (taper, Taper::constant(0.8)));
    let strip = segment(
        "E = '70 GPa'\ndensity = 2700\nsection = { shape = 'rectangle', width = '20 mm', \
         thickness = '1 mm' }",
    );
    assert!((strip.0.inner / (70e9 * 0.02 * 1e-9 / 12.0) - 1.0).abs() < 1e-14);
    assert!((strip.1.outer / 0.054 - 1.0).abs() < 1e-14);
    let mixed =
        segment("EI = [5, 4]\ndensity = 1000\nsection = { shape = 'circle', diameter = 2 }");
    assert_eq!((mixed.0.inner, mixed.0.outer), (5.0, 4.0));
    assert!((mixed.1.inner / (1000.0 * std::f64::consts::PI) - 1.0).abs() < 1e-14);
    for shape in [
        "shape = 'tube', diameter = '30 mm', wall = '2 mm'",
        "shape = 'box', width = '30 mm', height = '20 mm', wall = '2 mm'",
    ] {
        let (ei, mass) = segment(&format!("E = 7e10\ndensity = 2700\nsection = {{ {shape} }}"));
        assert!(ei.inner > 0.0 && mass.inner > 0.0, "{shape}");
    }
}
