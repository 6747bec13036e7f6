use std::fs;
use std::path::Path;

use flexlink::link::{Damping, Link};
use flexlink::spec::read_specification;

fn specs() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("specs");
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    let files = entries.filter(|entry| entry.path().is_file()).map(|entry| {
        let name = entry.file_name().into_string().unwrap();
        (name, fs::read_to_string(entry.path()).unwrap())
    });
    files.collect()
}

fn link(name: &str) -> Link {
    let specs = specs();
    let (_, text) = specs.iter().find(|(file, _)| file == name).unwrap();
    read_specification(name, text, &[]).unwrap().link().clone()
}

#[test]
fn every_published_link_is_read_and_names_its_source() {
    let specs = specs();
    assert_eq!(specs.len(), 13);
    for (name, text) in specs {
        assert!(text.starts_with("# "), "{name} names no source");
        if let Err(error) = read_specification(&name, &text, &[]) {
            panic!("{error}");
        }
    }
}

#[test]
fn the_two_links_of_bayo_differ_in_stiffness_alone() {
    for (name, ei) in [("bayo1987_example1.toml", 5.0), ("bayo1987_example2.toml", 20.0)] {
        let link = link(name);
        let [root, beam] = link.segments() else {
            panic!("{name}");
        };
        assert!((beam.bending_stiffness_n_m2.inner / ei - 1.0).abs() < 1e-15);
        assert!((root.bending_stiffness_n_m2.inner / (10.0 * ei) - 1.0).abs() < 1e-15);
        assert!((link.length_m() - 1.5).abs() < 1e-15);
        assert!((link.rigid_inertia_kg_m2() - 1.0).abs() < 1e-15);
        assert_eq!(*link.damping(), Damping::Hysteretic { ratio: 0.02 });
    }
}

#[test]
fn the_hub_radius_of_gu_and_petkov_adds_to_the_length() {
    assert!((link("gu_petkov.toml").length_m() - 1.04).abs() < 1e-15);
}
