//! The JSON Schema and the reader say the same of link files and arm files, as far as JSON Schema can tell.

#![expect(clippy::unwrap_used, reason = "a test may stop")]

use std::fs;
use std::path::Path;

use flexlink::spec::{SpecError, link_file_schema, read_specification};
use jsonschema::Validator;
use serde_json::Value;

const SEGMENT: &str = "[[segments]]\nlength = 1\nEI = 5\nmass_per_length = 0.8\n";

fn schema() -> Value {
    serde_json::from_str(&link_file_schema()).unwrap()
}

fn validator() -> Validator {
    jsonschema::draft7::new(&schema()).unwrap()
}

/// Whether the schema and the reader accept a file of a link or an arm.
fn verdicts(validator: &Validator, text: &str) -> [bool; 2] {
    let file: Value = toml::from_str(text).unwrap();
    let read = || -> Result<(), SpecError> {
        read_specification("link.toml", text, &[])?;
        Ok(())
    };
    [validator.is_valid(&file), read().is_ok()]
}

/// An arm file with these lines above its links, and in each of them.
fn arm(above: &str, links: &[&str]) -> String {
    let segments = "segments = [{ length = 1, EI = 5, mass_per_length = 0.8 }]";
    let links = links.iter().map(|lines| format!("[[links]]\n{segments}\n{lines}\n"));
    format!("{above}{}", links.collect::<String>())
}

#[test]
fn the_schema_is_one_by_its_own_standard() {
    assert!(jsonschema::meta::is_valid(&schema()));
    assert_eq!(schema()["$schema"], "http://json-schema.org/draft-07/schema#");
}

#[test]
fn every_link_file_and_arm_file_of_this_repository_is_valid() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let files = |folder: &str| {
        let entries = fs::read_dir(root.join(folder)).unwrap().map(|entry| entry.unwrap().path());
        entries.filter(|path| path.is_file()).collect::<Vec<_>>()
    };
    let (links, arms) = (files("specs"), files("specs/arms"));
    assert!(links.len() >= 8 && arms.len() >= 3);
    let paths = [links, arms, files("src/cli/templates")].concat();
    let mut texts: Vec<String> =
        paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let page = include_str!("../../docs/files.md").split_once("```toml\n").unwrap().1;
    texts.push(page.split_once("```").unwrap().0.to_owned());
    let validator = validator();
    for text in texts {
        let file: Value = toml::from_str(&text).unwrap();
        let errors: Vec<String> =
            validator.iter_errors(&file).map(|e| format!("{}: {e}", e.instance_path())).collect();
        assert!(errors.is_empty(), "{text}: {errors:?}");
    }
}

#[test]
fn every_key_has_a_description() {
    fn check(path: &str, schema: &Value, found: &mut usize) {
        for (key, schema) in schema["properties"].as_object().into_iter().flatten() {
            let path = format!("{path}.{key}");
            let description = schema["description"].as_str().unwrap_or_default();
            assert!(description.len() > 4 && !description.starts_with('`'), "{path}");
            *found += 1;
            check(&path, schema, found);
            check(&path, &schema["items"], found);
        }
    }
    let mut found = 0;
    check("", &schema(), &mut found);
    assert!(found >= 60, "only {found} keys");
}

#[test]
fn what_the_reader_takes_the_schema_takes() {
    let validator = validator();
    let segment = |keys: &str| format!("[[segments]]\nlength = '15 cm'\n{keys}\n");
    let stiffness = "EI = 5\nmass_per_length = 0.8";
    for text in [
        segment(stiffness),
        segment("E = '70 GPa'\nI = ['1 cm^4', 5e-9]\ndensity = 2700\narea = ['1 cm²', '50 mm**2']"),
        segment(
            "E = 7e10\ndensity = 2700\nsection = { shape = 'tube', diameter = 0.02, wall = 0.001 }",
        ),
        segment(
            "EI = 5\ndensity = 2700\nsection = { shape = 'box', width = 1, height = 1, wall = 0.1 }",
        ),
        segment("E = 7e10\nmass_per_length = 0.8\nsection = { shape = 'circle', diameter = 0.01 }"),
        segment(
            "E = 7e10\ndensity = 1\nsection = { shape = 'rectangle', width = 1, thickness = 1 }",
        ),
        format!(
            "theory = 'timoshenko'\n{SEGMENT}shear_stiffness = '4 kN'\nrotary_inertia_per_length = 1e-3"
        ),
        segment(
            "E = 7e10\ndensity = 1\nsection = { shape = 'circle', diameter = 0.01 }\n\
             theory = 'timoshenko'\npoisson_ratio = 0.3",
        ),
        segment(
            "EI = 7\ndensity = 1\nsection = { shape = 'circle', diameter = 0.01 }\n\
             theory = 'timoshenko'\nshear_modulus = '26 GPa'",
        ),
        format!("gravity = [0, '-981 cm/s^2']\nstart_angle = '-90 deg'\n{SEGMENT}"),
        format!("gravity = [0.0, -9.81]\n{SEGMENT}[analysis]\nsecond_order = 'first'"),
        format!("{SEGMENT}[hub]\ninertia = '1000 kg cm^2'\nviscous_friction = '0.015 N·m s/rad'"),
        format!("{SEGMENT}[payload]\nmass = '+50g'\noffset = '-2 cm'"),
        format!("{SEGMENT}[[masses]]\nat = ' .5 m '\nmass = '1e-1 kg'"),
        format!("{SEGMENT}[damping]\nratio = 0.02"),
        format!("{SEGMENT}[damping]\nmodel = 'none'"),
        format!("{SEGMENT}[damping]\nmodel = 'modal'\nratios = [0.02, 0.01]"),
        format!("{SEGMENT}[damping]\nmodel = 'caughey'\nratio = 0.02"),
        format!("{SEGMENT}[damping]\nmodel = 'caughey'\nmodes = [1, 3]\nratios = [0.02, 0.01]"),
        format!("{SEGMENT}[damping]\nmodel = 'rayleigh'\nmodes = [1, 3]\nratios = [0.02, 0.01]"),
        format!("{SEGMENT}[damping]\nmodel = 'rayleigh'\nalpha = '2 /s'"),
        format!("{SEGMENT}[drive]\njoint_stiffness = inf"),
        format!("{SEGMENT}[drive]\njoint_stiffness = '1e3 N m/rad'\ngear_ratio = 50"),
        format!("{SEGMENT}[limits]\nhub_rate = '30 rpm'\npower = '0.02 kN m/s'\ndeflection = 0.1"),
        format!("{SEGMENT}[drive]\n[limits]\nmotor_torque = '20 N cm'\nmotor_rms_torque = 0.1"),
        format!("{SEGMENT}[drive]\n[limits]\nmotor_rate = '3000 rpm'\nmotor_power = '50 W'"),
        format!("{SEGMENT}[mesh]\nelements = 'auto'\ntolerance = 1e-12"),
        format!("{SEGMENT}[mesh]\nelements = 10"),
        format!("{SEGMENT}[analysis]\nlead = '500 ms'\nlag = 0\nmodes = 5\ntolerance = 1e-2"),
        arm("", &[""]),
        arm("gravity = [0, 0]\nstart_angle = 1\n", &["name = 'only'\npayload.mass = 1"]),
        arm("elbow = 'right'\n", &["name = 'a'\ntip = { mass = '50 g' }", "payload.mass = 1"]),
        arm("title = 'three'\nmesh.elements = 8\n", &["", "limits.torque = 1", "hub.radius = 1"]),
        arm(
            "analysis.second_order = 'none'\n",
            &["drive.gear_ratio = 50", "theory = 'euler-bernoulli'"],
        ),
    ] {
        assert_eq!(verdicts(&validator, &text), [true, true], "{text}");
    }
}

#[test]
fn what_the_schema_refuses_the_reader_refuses() {
    let validator = validator();
    let segment = |keys: &str| format!("[[segments]]\n{keys}\n");
    let whole = "EI = 5\nmass_per_length = 0.8\n";
    for text in [
        String::new(),
        "segments = []".into(),
        "segments = [1]".into(),
        format!("{SEGMENT}[payloads]\nmass = 1"),
        format!("{SEGMENT}title = 5\n[hub]"),
        format!("{SEGMENT}colour = 'red'"),
        format!("gravity = 9.81\n{SEGMENT}"),
        format!("gravity = [9.81]\n{SEGMENT}"),
        format!("gravity = [0, 0, -9.81]\n{SEGMENT}"),
        format!("start_angle = 1\n{SEGMENT}"),
        format!("{SEGMENT}[analysis]\nsecond_order = 'all'"),
        segment(whole),
        segment(&format!("{whole}length = true")),
        segment(&format!("{whole}length = 0")),
        segment(&format!("{whole}length = '-15 cm'")),
        segment(&format!("{whole}length = '15'")),
        segment(&format!("{whole}length = '15 parsec'")),
        segment(&format!("{whole}length = '15 m2'")),
        segment(&format!("{whole}length = '15 m *'")),
        segment(&format!("{whole}length = '1,5 m'")),
        segment(&format!("{whole}length = 'm'")),
        segment(&format!("{whole}length = [1, 2]")),
        segment("length = 1\nmass_per_length = 1"),
        segment("length = 1\nEI = 5"),
        segment("length = 1\nE = 5\nmass_per_length = 1"),
        segment("length = 1\nI = 5\nmass_per_length = 1"),
        segment("length = 1\nEI = 5\nE = 1\nmass_per_length = 1"),
        segment("length = 1\nEI = 5\nI = 1\nmass_per_length = 1"),
        segment("length = 1\nEI = [5, 4, 3]\nmass_per_length = 1"),
        segment("length = 1\nEI = [5, 0]\nmass_per_length = 1"),
        segment("length = 1\nEI = [5, '4 parsec']\nmass_per_length = 1"),
        segment("length = 1\nEI = 5\nmass_per_length = -1"),
        segment("length = 1\nEI = 5\nmass_per_length = 1\narea = 1"),
        segment("length = 1\nEI = 5\ndensity = 1"),
        segment(&format!("length = 1\n{whole}elements = 0")),
        segment(&format!("length = 1\n{whole}elements = 'auto'")),
        segment(&format!("length = 1\n{whole}section = {{ shape = 'circle', diameter = 1 }}")),
        segment(
            "length = 1\nE = 5\nI = 1\nmass_per_length = 1\nsection = { shape = 'circle', diameter = 1 }",
        ),
        segment(
            "length = 1\nE = 5\nmass_per_length = 1\nsection = { shape = 'oval', diameter = 1 }",
        ),
        segment("length = 1\nE = 5\nmass_per_length = 1\nsection = { shape = 'circle' }"),
        segment("length = 1\nE = 5\nmass_per_length = 1\nsection = { diameter = 1 }"),
        segment(
            "length = 1\nE = 5\nmass_per_length = 1\nsection = { shape = 'circle', diameter = 1, wall = 1 }",
        ),
        format!("{SEGMENT}[hub]\nradius = -1"),
        format!("{SEGMENT}[[masses]]\nat = 1"),
        format!("{SEGMENT}[payload]\nmass = -1"),
        format!("{SEGMENT}[damping]"),
        format!("{SEGMENT}[damping]\nratio = 1.5"),
        format!("{SEGMENT}[damping]\nratio = '2 %'"),
        format!("{SEGMENT}[damping]\nratios = [0.02]"),
        format!("{SEGMENT}[damping]\nmodel = 'viscous'\nratio = 0.02"),
        format!("{SEGMENT}[damping]\nmodel = 'hysteretic'"),
        format!("{SEGMENT}[damping]\nmodel = 'none'\nratio = 0.02"),
        format!("{SEGMENT}[damping]\nmodel = 'modal'"),
        format!("{SEGMENT}[damping]\nmodel = 'modal'\nratio = 0.02\nratios = [0.02]"),
        format!("{SEGMENT}[damping]\nmodel = 'modal'\nratios = []"),
        format!("{SEGMENT}[damping]\nmodel = 'modal'\nratios = [0.02, 1]"),
        format!("{SEGMENT}[damping]\nmodel = 'rayleigh'"),
        format!("{SEGMENT}[damping]\nmodel = 'rayleigh'\nmodes = [1, 2]"),
        format!("{SEGMENT}[damping]\nmodel = 'rayleigh'\nmodes = [1]\nratios = [0.02]"),
        format!(
            "{SEGMENT}[damping]\nmodel = 'rayleigh'\nalpha = 1\nmodes = [1, 2]\nratios = [0, 0]"
        ),
        format!("{SEGMENT}[damping]\nmodel = 'caughey'\nmodes = [1]"),
        format!("{SEGMENT}[damping]\nmodel = 'caughey'\nratio = 0.1\nmodes = [1]"),
        format!("{SEGMENT}[drive]\njoint_stiffness = 0"),
        format!("{SEGMENT}[drive]\njoint_stiffness = true"),
        format!("{SEGMENT}[drive]\ngear_ratio = 0"),
        format!("{SEGMENT}[drive]\ngear_ratio = 1e200"),
        format!("{SEGMENT}[drive]\n[limits]\nmotor_power = 0"),
        format!("{SEGMENT}[limits]\ntorque = 0"),
        format!("{SEGMENT}[mesh]\nelements = 'many'"),
        format!("{SEGMENT}[mesh]\nelements = 100001"),
        format!("{SEGMENT}[mesh]\ntolerance = 0.2"),
        format!("{SEGMENT}[analysis]\ntolerance = 0"),
        format!("{SEGMENT}[analysis]\nlead = -1"),
        format!("{SEGMENT}[analysis]\nmodes = 0"),
    ] {
        assert_eq!(verdicts(&validator, &text), [false, false], "{text}");
    }
}

#[test]
fn what_the_schema_refuses_of_an_arm_the_reader_refuses() {
    let validator = validator();
    for text in [
        format!("elbow = 'left'\n{SEGMENT}"),
        format!("{}{SEGMENT}", arm("", &["", ""])),
        "links = []".into(),
        "[[links]]\nname = 'bare'".into(),
        arm("elbow = 'up'\n", &["", ""]),
        arm("elbow = 'left'\n", &[""]),
        arm("hub.inertia = 1\n", &["", ""]),
        arm("payload.mass = 1\n", &["", ""]),
        arm("gravity = [0, 0]\nstart_angle = 1\n", &["", ""]),
        arm("", &[""; 10]),
        arm("", &["colour = 'red'", ""]),
        arm("", &["hub.inertai = 1", ""]),
        arm("", &["hub.inertia = -1", ""]),
        arm("", &["name = 1", ""]),
        arm("", &["payload.mass = 1", ""]),
        arm("", &["", "tip.mass = 1"]),
        arm("", &["tip.mass = -1", ""]),
        arm("", &["gravity = [0, 0]", ""]),
        arm("", &["", "mesh.elements = 8"]),
        arm("", &["", "analysis.tolerance = 1e-3"]),
        arm("", &["title = 'x'", ""]),
    ] {
        assert_eq!(verdicts(&validator, &text), [false, false], "{text}");
    }
}
