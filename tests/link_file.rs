//! The link file: what it says is read, and what it must not say is refused in full sentences.

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::Analysis;
use flexlink::link::{Damping, Hub, LumpedMass, Payload, Taper};
use flexlink::spec::{Override, SpecError, Specification, read_specification};

/// The example of the interface, without the tables that are not supported yet.
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

[mesh]
elements = 10
tolerance = 1e-6

[analysis]
tolerance = 1e-6
lead = 0.5
lag = 0.5
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

/// The error and its hint as the program prints them.
fn shown(error: &SpecError) -> String {
    match error.hint() {
        Some(hint) => format!("{error}\nhint: {hint}"),
        None => error.to_string(),
    }
}

fn refusal(text: &str) -> String {
    shown(&read(text).expect_err(text))
}

/// Refusal of one segment with these keys, which begin in line 2.
fn segment_refusal(keys: &str) -> String {
    refusal(&format!("[[segments]]\n{keys}\n"))
}

fn refusal_with(settings: &[&str]) -> String {
    shown(&read_with(EXAMPLE, settings).expect_err(settings[0]))
}

#[test]
fn the_whole_example_is_read_in_si() {
    let Specification {
        link,
        mesh,
        analysis,
    } = read(EXAMPLE).unwrap();
    assert_eq!(link.title(), "Bayo (1987), example 1: I = 0.25e-2 cm^4");
    let [root, beam] = link.segments() else {
        panic!("{:?}", link.segments());
    };
    assert_eq!(root.name.as_deref(), Some("root"));
    assert_eq!((root.length_m, beam.length_m), (0.15, 1.35));
    assert_eq!(root.bending_stiffness_n_m2, Taper::constant(50.0));
    assert_eq!(beam.bending_stiffness_n_m2, Taper::constant(5.0));
    assert_eq!(beam.mass_per_length_kg_m, Taper::constant(0.8));
    let hub = Hub {
        inertia_kg_m2: 0.1,
        ..Hub::default()
    };
    assert_eq!(*link.hub(), hub);
    let mass = LumpedMass {
        at_m: 0.75,
        mass_kg: 0.05,
        inertia_kg_m2: 0.0,
    };
    assert_eq!(link.masses(), [mass]);
    assert_eq!(*link.payload(), Payload::default());
    assert_eq!(link.damping(), Damping::Hysteretic { ratio: 0.02 });
    let total = Some(ElementCount::Total(10));
    let plan = MeshPlan::new(&link, vec![Some(1), Some(9)], total, 1e-6);
    assert_eq!(mesh, plan.unwrap());
    assert_eq!(analysis, Analysis::new(1e-6, Some(0.5), Some(0.5)).unwrap());
}

#[test]
fn only_segments_are_required() {
    let Specification {
        link,
        mesh,
        analysis,
    } = read(SHORT).unwrap();
    assert_eq!(link.title(), "");
    assert_eq!(*link.hub(), Hub::default());
    assert_eq!(link.damping(), Damping::None);
    assert_eq!(analysis, Analysis::default());
    let plan = MeshPlan::new(&link, vec![None], None, MeshPlan::DEFAULT_TOLERANCE);
    assert_eq!(mesh, plan.unwrap());
}

#[test]
fn stiffness_and_mass_follow_from_material_and_section() {
    let segment = |keys: &str| {
        let specification = read(&format!("[[segments]]\nlength = 1\n{keys}\n")).unwrap();
        let segment = &specification.link.segments()[0];
        (segment.bending_stiffness_n_m2, segment.mass_per_length_kg_m)
    };
    let paper = segment(
        "E = '2e7 N/cm^2'\nI = ['2.5e-2 cm^4', '0.25e-2 cm^4']\ndensity = '0.008 kg/cm^3'\n\
         area = '1 cm^2'",
    );
    let taper = Taper {
        inner: 50.0,
        outer: 5.0,
    };
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
        let (ei, mass) = segment(&format!(
            "E = 7e10\ndensity = 2700\nsection = {{ {shape} }}"
        ));
        assert!(ei.inner > 0.0 && mass.inner > 0.0, "{shape}");
    }
}

#[test]
fn every_damping_law_is_read() {
    let law = |keys: &str| {
        let specification = read(&format!("{SHORT}[damping]\n{keys}\n")).unwrap();
        specification.link.damping()
    };
    assert_eq!(law("ratio = 0.05"), Damping::Hysteretic { ratio: 0.05 });
    assert_eq!(law("model = 'none'"), Damping::None);
    let rayleigh = |alpha_per_s, beta_s| Damping::Rayleigh {
        alpha_per_s,
        beta_s,
    };
    assert_eq!(
        law("model = 'rayleigh'\nalpha = '0.1 1/s'\nbeta = '2 ms'"),
        rayleigh(0.1, 0.002)
    );
    assert_eq!(
        law("model = 'rayleigh'\nbeta = 0.002"),
        rayleigh(0.0, 0.002)
    );
    assert_eq!(
        law("model = 'rayleigh'\nmodes = [1, 3]\nratios = [0.02, 0.01]"),
        Damping::RayleighThroughModes {
            modes: [1, 3],
            ratios: [0.02, 0.01]
        }
    );
}

#[test]
fn a_slip_of_the_toml_is_refused_in_its_line() {
    for (text, expected) in [
        (
            "[hub]\nradius = 5 cm\n",
            "link.toml:2: string values must be quoted, expected literal string",
        ),
        (
            "title = 'a'\n\ntitle = 'b'\n",
            "link.toml:3: duplicate key `title`",
        ),
        (
            "[hub]\nradius = 0\n[hub]\n",
            "link.toml:3: duplicate key `hub`",
        ),
        (
            "\n[[segments]\nlength = 1\n",
            "link.toml:2: unclosed array table, expected `]`",
        ),
    ] {
        assert_eq!(refusal(text), expected);
    }
}

#[test]
fn a_file_without_segments_is_refused() {
    let must = "must hold at least one [[segments]]";
    assert_eq!(refusal(""), format!("link.toml: {must}"));
    assert_eq!(refusal("\nsegments = []\n"), format!("link.toml:2: {must}"));
    assert_eq!(
        refusal("\n[segments]\nlength = 1\n"),
        "link.toml:2: segments = a table, but must be tables headed [[segments]]"
    );
    assert_eq!(
        refusal(&format!("{SHORT}masses = [0.1, 0.2]\n")),
        "link.toml:2: masses = [0.1, 0.2], but must be tables headed [[masses]]"
    );
}

#[test]
fn an_unknown_key_is_refused_with_the_nearest_known_one() {
    assert_eq!(
        segment_refusal("lenght = 1"),
        "link.toml:2: unknown key `lenght` in segments.0\nhint: did you mean `length`?"
    );
    assert_eq!(
        refusal(&format!("{SHORT}[hub]\ncolour = 'red'\n")),
        "link.toml:3: unknown key `colour` in hub\nhint: known here: inertia, radius and \
         viscous_friction"
    );
    assert_eq!(
        refusal(&format!("{SHORT}[payloads]\nmass = 1\n")),
        "link.toml:2: unknown key `payloads`\nhint: did you mean `payload`?"
    );
    assert_eq!(
        segment_refusal("length = 1\nsection = { shape = 'circle', radius = 1 }"),
        "link.toml:3: unknown key `radius` in segments.0.section\nhint: known here: shape, width, \
         thickness, height, diameter and wall"
    );
}

#[test]
fn tables_that_are_not_supported_yet_say_so() {
    assert_eq!(
        refusal(&format!("{SHORT}[drive]\ngear_ratio = 1\n")),
        "link.toml:2: [drive] is not supported yet"
    );
    assert_eq!(
        refusal(&format!("{SHORT}[limits]\ntorque = 5\n")),
        "link.toml:2: [limits] is not supported yet"
    );
}

#[test]
fn a_value_of_the_wrong_kind_is_refused_with_what_it_must_be() {
    for (lines, expected) in [
        ("title = 5", "link.toml:2: title = 5, but must be a string"),
        (
            "hub = [0.1, 0, 0]",
            "link.toml:2: hub = [0.1, 0, 0], but must be a table",
        ),
        (
            "[hub]\ninertia = true",
            "link.toml:3: hub.inertia = true, but must be a number in SI or a string with its unit",
        ),
        (
            "[hub]\ninertia = 1979-05-27",
            "link.toml:3: hub.inertia = 1979-05-27, but must be a number in SI or a string with \
             its unit",
        ),
        (
            "[hub]\ninertia = nan",
            "link.toml:3: hub.inertia = NaN, but must be finite",
        ),
        (
            "[hub]\n\ninertia = -inf",
            "link.toml:4: hub.inertia = -inf, but must be finite",
        ),
        (
            "[hub]\ninertia = 1e999",
            "link.toml:3: hub.inertia = inf, but must be finite",
        ),
        (
            "[damping]\nratio = '2 %'",
            "link.toml:3: damping.ratio = \"2 %\", but must be a number",
        ),
        (
            "[mesh]\nelements = 10.0",
            "link.toml:3: mesh.elements = 10.0, but must be a whole number from 1 to 100000, or \
             \"auto\"",
        ),
        (
            "[mesh]\nelements = 'many'",
            "link.toml:3: mesh.elements = \"many\", but must be a whole number from 1 to 100000, \
             or \"auto\"",
        ),
        (
            "[mesh]\ntolerance = 0.2",
            "link.toml:3: mesh.tolerance = 0.2, but must lie in [1e-12, 1e-1]",
        ),
        (
            "[analysis]\ntolerance = 0",
            "link.toml:3: analysis.tolerance = 0, but must lie in [1e-12, 1e-2]",
        ),
        (
            "[analysis]\nlead = '-1 s'",
            "link.toml:3: analysis.lead = -1 s, but must be finite and at least 0",
        ),
        (
            "[[masses]]\nmass = 1",
            "link.toml:2: masses.0.at is missing",
        ),
        (
            "[[masses]]\nat = 2\nmass = 1",
            "link.toml:3: masses.0.at = 2 m, but must lie on the link, from 0 m to 1.5 m from \
             the axis",
        ),
    ] {
        assert_eq!(refusal(&format!("{SHORT}{lines}\n")), expected);
    }
    for (keys, expected) in [
        ("EI = 5", "link.toml:1: segments.0.length is missing"),
        (
            "length = 1\nEI = [5, 4, 3]",
            "link.toml:3: segments.0.EI = [5, 4, 3], but must be a number in SI, a string with \
             its unit, or two of them [inner, outer]",
        ),
        (
            "length = 1\nEI = [\n 5,\n false]",
            "link.toml:5: segments.0.EI.1 = false, but must be a number in SI or a string with \
             its unit",
        ),
        (
            "length = 1\nE = [1, 2]",
            "link.toml:3: segments.0.E = [1, 2], but must be a number in SI or a string with its \
             unit",
        ),
        (
            "length = 1\nelements = 0",
            "link.toml:3: segments.0.elements = 0, but must be a whole number from 1 to 100000",
        ),
        (
            "length = 1\nelements = 'auto'",
            "link.toml:3: segments.0.elements = \"auto\", but must be a whole number from 1 to \
             100000",
        ),
        (
            "length = 1\nsection = 'circle'",
            "link.toml:3: segments.0.section = \"circle\", but must be a table such as { shape = \
             \"circle\", diameter = 0.01 }",
        ),
    ] {
        assert_eq!(segment_refusal(keys), expected);
    }
}

#[test]
fn a_value_with_a_wrong_unit_is_refused_with_the_right_one() {
    for (length, expected) in [
        (
            "1.5",
            "link.toml:2: segments.0.length = \"1.5\" has no unit, but must be a length such as \
             m\nhint: a number without quotes is in SI units",
        ),
        (
            "150 kg",
            "link.toml:2: segments.0.length = \"150 kg\" is a mass, but must be a length such as \
             m\nhint: a length is wanted, such as \"1 m\"",
        ),
        (
            "150 cn",
            "link.toml:2: segments.0.length = \"150 cn\" has the unknown unit `cn`\nhint: did you \
             mean `cm`?",
        ),
        (
            "1,5 m",
            "link.toml:2: segments.0.length = \"1,5 m\" does not begin with a decimal number\n\
             hint: a length is wanted, such as \"1 m\"",
        ),
        (
            "1 m/kg s",
            "link.toml:2: segments.0.length = \"1 m/kg s\" is ambiguous: only one unit may follow \
             the only `/`\nhint: use negative powers, as in `kg m^-1 s^-1`",
        ),
    ] {
        assert_eq!(segment_refusal(&format!("length = '{length}'")), expected);
    }
}
