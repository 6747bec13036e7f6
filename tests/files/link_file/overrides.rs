use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::link::Link;
use flexlink::spec::Override;

use super::{EXAMPLE, SHORT, read_with};

fn link(settings: &[&str]) -> Link {
    read_with(EXAMPLE, settings).unwrap().link().clone()
}

/// Inner stiffness of each segment.
fn stiffness(settings: &[&str]) -> Vec<f64> {
    let segments = link(settings).segments().to_vec();
    segments.iter().map(|s| s.bending_stiffness_n_m2.inner).collect()
}

#[test]
fn a_segment_is_named_numbered_or_one_of_all() {
    assert_eq!(stiffness(&["segments.beam.EI=20"]), [50.0, 20.0]);
    assert_eq!(stiffness(&["segments.0.EI*=2"]), [100.0, 5.0]);
    assert_eq!(stiffness(&["segments.*.EI*=4"]), [200.0, 20.0]);
    assert_eq!(stiffness(&["segments.*.EI = 2e4 N cm^2"]), [2.0, 2.0]);
}

#[test]
fn several_apply_in_their_order() {
    let settings = ["segments.beam.EI=20", "segments.*.EI*=0.5", "segments.0.EI=7"];
    assert_eq!(stiffness(&settings), [7.0, 10.0]);
}

#[test]
fn a_value_needs_no_quotes_and_an_absent_table_is_added() {
    for set in ["payload.mass=\"50 g\"", "payload.mass=50 g", "payload.mass=0.05"] {
        assert!((link(&[set]).payload().mass_kg - 0.05).abs() < 1e-17, "{set}");
    }
    let short = read_with(SHORT, &["hub.inertia=0.2", "damping.ratio=0.02"]).unwrap();
    assert!((short.link().hub().inertia_kg_m2 - 0.2).abs() < 1e-17);
    let auto = read_with(SHORT, &["mesh.elements=auto"]).unwrap();
    let plan = MeshPlan::new(auto.link(), &[None], Some(ElementCount::Auto), 1e-6);
    assert_eq!(*auto.mesh(), plan.unwrap());
}

#[test]
fn a_factor_multiplies_numbers_quantities_and_both_ends_of_a_taper() {
    assert_eq!(link(&["masses.0.mass=0.1"]).masses()[0].mass_kg, 0.1);
    assert_eq!(link(&["masses.*.mass*=2"]).masses()[0].mass_kg, 0.1);
    assert_eq!(link(&["hub.inertia*=2"]).hub().inertia_kg_m2, 0.2);
    let taper = "[[segments]]\nlength = 1\nEI = ['5e4 N cm^2', 4]\nmass_per_length = 0.8\n";
    let tapered = read_with(taper, &["segments.0.EI*=1.5"]).unwrap().link().clone();
    let ei = tapered.segments()[0].bending_stiffness_n_m2;
    assert_eq!((ei.inner, ei.outer), (7.5, 6.0));
    let twice = ["segments.*.elements*=2", "mesh.elements*=2"];
    let finer = read_with(EXAMPLE, &twice).unwrap();
    let total = Some(ElementCount::Total(20));
    let plan = MeshPlan::new(finer.link(), &[Some(2), Some(18)], total, 1e-6);
    assert_eq!(*finer.mesh(), plan.unwrap());
}

#[test]
fn a_product_is_changed_where_the_file_gives_its_factors_instead() {
    let material = "[[segments]]\nlength = 1\nE = 2e11\nI = 2.5e-11\ndensity = 8e3\narea = 1e-4\n";
    let settings = ["segments.*.EI*=4", "segments.0.mass_per_length*=0.5"];
    let changed = read_with(material, &settings).unwrap();
    let segment = &changed.link().segments()[0];
    assert!((segment.bending_stiffness_n_m2.inner - 20.0).abs() < 1e-12);
    assert!((segment.mass_per_length_kg_m.outer - 0.4).abs() < 1e-14);
    let replaced = read_with(material, &["segments.*.EI=20", "segments.0.mass_per_length=0.5"]);
    let replaced = &replaced.unwrap().link().segments()[0].clone();
    assert_eq!(replaced.bending_stiffness_n_m2.inner.to_bits(), 20.0_f64.to_bits());
    assert_eq!(replaced.mass_per_length_kg_m.inner.to_bits(), 0.5_f64.to_bits());
}

#[test]
fn a_path_of_ten_thousand_steps_is_refused() {
    for deep in [format!("{}=1", vec!["a"; 10_868].join(".")), vec!["a"; 100_000].join(".") + "*=2"]
    {
        let error = deep.parse::<Override>().unwrap_err().to_string();
        assert!(error.ends_with("steps, but must have at most 16"));
    }
}

#[test]
fn a_product_takes_the_place_of_a_section_that_serves_nothing_else() {
    let section = "section = { shape = 'circle', diameter = 0.01 }\n";
    let with = |rest: &str| format!("[[segments]]\nlength = 1\n{section}{rest}");
    let changed = |rest: &str, settings: &[&str]| {
        let read = read_with(&with(rest), settings).map(|read| read.link().segments()[0].clone());
        read.map(|s| (s.bending_stiffness_n_m2.inner, s.mass_per_length_kg_m.inner))
    };
    let area_m2 = 0.25 * std::f64::consts::PI * 1e-4;
    let material = "E = 2e11\ndensity = 7800\n";
    // The section is needed for the mass, or for the stiffness, or no more.
    let (ei, mass) = changed(material, &["segments.0.EI=20"]).unwrap();
    assert_eq!(ei.to_bits(), 20.0_f64.to_bits());
    assert!((mass / (7800.0 * area_m2) - 1.0).abs() < 1e-14);
    let (ei, mass) = changed(material, &["segments.0.mass_per_length=0.5"]).unwrap();
    assert!((ei / (2e11 * area_m2 * 0.01 * 0.01 / 16.0) - 1.0).abs() < 1e-14);
    assert_eq!(mass.to_bits(), 0.5_f64.to_bits());
    for (rest, settings) in [
        ("E = 2e11\nmass_per_length = 0.5\n", &["segments.0.EI=20"][..]),
        ("EI = 20\ndensity = 7800\n", &["segments.0.mass_per_length=0.5"]),
        (material, &["segments.0.EI=20", "segments.0.mass_per_length=0.5"]),
    ] {
        assert_eq!(changed(rest, settings), Ok((20.0, 0.5)), "{rest}");
    }
}

#[test]
fn elements_that_are_set_take_the_place_of_those_of_the_segments() {
    for (set, count) in
        [("mesh.elements=40", ElementCount::Total(40)), ("mesh.elements=auto", ElementCount::Auto)]
    {
        let read = read_with(EXAMPLE, &[set]).unwrap();
        let plan = MeshPlan::new(read.link(), &[None, None], Some(count), 1e-6).unwrap();
        assert_eq!(*read.mesh(), plan, "{set}");
    }
    // In their order: a later one for a segment holds beside it.
    let read = read_with(EXAMPLE, &["mesh.elements=40", "segments.root.elements=3"]).unwrap();
    let total = Some(ElementCount::Total(40));
    let plan = MeshPlan::new(read.link(), &[Some(3), None], total, 1e-6).unwrap();
    assert_eq!(*read.mesh(), plan);
}
