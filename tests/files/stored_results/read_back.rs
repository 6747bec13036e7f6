//! Runs of solve and simulate.

use flexlink::beam::Mesh;
use flexlink::link::{Damping, Link};
use flexlink::result::{StoredNodes, StoredRun};
use flexlink::spec::read_specification;

use super::{Bench, PAPER, repository};

/// The link of a file with changes, as the program reads it.
fn link_of(file: &str, changes: &[&str]) -> Link {
    let text = std::fs::read_to_string(repository(file)).unwrap();
    let changes: Vec<_> = changes.iter().map(|change| change.parse().unwrap()).collect();
    read_specification(file, &text, &changes).unwrap().link().clone()
}

/// Whether two numbers are one but for round-off.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-15 * a.abs().max(b.abs())
}

#[track_caller]
fn assert_same_link(found: &Link, expected: &Link) {
    assert_eq!(
        (found.title(), found.segments().len()),
        (expected.title(), expected.segments().len())
    );
    for (a, b) in found.segments().iter().zip(expected.segments()) {
        assert_eq!(a.name, b.name);
        let numbers = |s: &flexlink::link::Segment| {
            let (ei, mass) = (s.bending_stiffness_n_m2, s.mass_per_length_kg_m);
            [s.length_m, ei.inner, ei.outer, mass.inner, mass.outer]
        };
        assert!(numbers(a).into_iter().zip(numbers(b)).all(|(a, b)| same(a, b)), "{a:?} {b:?}");
    }
    assert_eq!(found.hub(), expected.hub());
    assert_eq!(found.payload(), expected.payload());
    assert_eq!(found.masses(), expected.masses());
}

/// That the histories of a run are the columns of its tables, every bit.
#[track_caller]
fn assert_histories(bench: &Bench, folder: &str, run: &StoredRun) {
    let column = |file: &str, name: &str| bench.column(&format!("{folder}/{file}"), name);
    assert!(run.times_s == column("torque.csv", "time_s") && run.times_s.len() > 100);
    assert!(run.joints[0].torque_n_m == column("torque.csv", "torque_n_m"));
    assert!(run.joints[0].angle_rad == column("hub_angle.csv", "hub_angle_rad"));
    let arc = run.arc.as_ref().unwrap();
    assert!(arc.tip.displacement_m == column("tip.csv", "tip_displacement_m"));
    assert!(arc.tip.velocity_m_s == column("tip.csv", "tip_velocity_m_s"));
    assert!(arc.tip.acceleration_m_s2 == column("tip.csv", "tip_acceleration_m_s2"));
    let nodes = bench.read(&format!("{folder}/nodes.csv"));
    let places = nodes.lines().skip(1).map(|row| row.split(',').nth(1).unwrap());
    let places: Vec<f64> = places.map(|place| place.parse().unwrap()).collect();
    assert_eq!(places.len(), arc.mesh.nodes_m().len());
    for (place, own) in places.iter().zip(arc.mesh.nodes_m()) {
        assert!((place - own).abs() < 1e-9);
    }
    if let Some(rigid) = &run.joints[0].rigid_torque_n_m {
        assert!(*rigid == column("rigid_torque.csv", "rigid_torque_n_m"));
        let angle = column("hub_angle.csv", "rigid_hub_angle_rad");
        assert!(run.joints[0].rigid_angle_rad == Some(angle));
    }
    assert_eq!(run.joints[0].rigid_torque_n_m.is_some(), run.origin.command == "solve");
}

/// The deflections of a run of one link.
fn deflections(run: &StoredRun) -> StoredNodes {
    run.links[0].deflections_m.clone().unwrap()
}

/// The bending moments of a run of one link.
fn moments(run: &StoredRun) -> StoredNodes {
    run.links[0].moments_n_m.clone().unwrap()
}

/// That a quantity at nodes is the table's.
#[track_caller]
fn assert_nodes(bench: &Bench, table: &str, heading: (&str, &str), found: &StoredNodes) {
    assert!(found.times_s == bench.column(table, "time_s"), "{table}");
    assert_eq!(found.nodes.len(), bench.table(table).len() - 1, "{table}");
    for (node, history) in found.nodes.iter().zip(&found.histories) {
        let name = format!("{}{node}_{}", heading.0, heading.1);
        assert!(*history == bench.column(table, &name), "{table}: {name}");
    }
}

#[track_caller]
fn assert_near(found: &StoredNodes, expected: &StoredNodes) {
    assert_eq!((&found.nodes, &found.times_s), (&expected.nodes, &expected.times_s));
    let pairs = found.histories.iter().flatten().zip(expected.histories.iter().flatten());
    let worst = pairs.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(worst < 2e-9, "{worst:e} m");
}

const LINK: &str = "specs/bayo1987_example1.toml";
const MOTION: &str = "trajectories/sine_0.88s.csv";

/// Links, changes of them, and the damping that the run has then.
const RIGS: [(&str, &str, &[&str]); 7] = [
    ("none", LINK, &["damping={ model = \"none\" }"]),
    ("hysteretic", LINK, &["payload={ mass = 0.05, inertia = 0.001, offset = 0.02 }"]),
    ("modal", LINK, &["damping={ model = \"modal\", ratios = [0.01, 0.02] }", "hub.radius=0.07"]),
    (
        "rayleigh",
        "specs/rome_link.toml",
        &["damping={ model = \"rayleigh\", modes = [1, 3], ratios = [0.01, 0.02] }"],
    ),
    (
        "caughey",
        "specs/gu_petkov.toml",
        &["damping={ model = \"caughey\", ratios = [0.01, 0.02, 0.03, 0.04] }"],
    ),
    (
        "hysteretic",
        "specs/bayo1987_example2.toml",
        &["masses=[{ at = 1.1, mass = 0.03 }, { at = 0.75, mass = 0.05, inertia = 0.001 }]"],
    ),
    ("hysteretic", LINK, &["segments.beam.EI=[9, 3]", "segments.root.name=\"a, b\""]),
];

#[test]
fn every_rig_comes_back_as_it_was_solved() {
    let bench = Bench::new();
    for (law, file, changes) in RIGS {
        let set: Vec<&str> = changes.iter().flat_map(|change| ["--set", *change]).collect();
        bench.solve(&[&[file, MOTION], &set[..]].concat());
        let run = bench.run_of("out");
        let expected = link_of(file, changes);
        assert_same_link(&run.links[0].link, &expected);
        let link = &run.links[0].link;
        assert_eq!(link.damping().name(), law);
        match (link.damping(), expected.damping()) {
            // Told by α and β, which are what the law has come to on the mesh.
            (Damping::Rayleigh { alpha_per_s, beta_s }, _) => {
                assert!(*alpha_per_s > 0.0 && *beta_s > 0.0);
            }
            (found, expected) => assert_eq!(found, expected),
        }
        assert_histories(&bench, "out", &run);
        let derived = deflections(&run);
        bench.solve(&[&[file, MOTION], &set[..], &["--deflections", "--moments"]].concat());
        let run = bench.run_of("out");
        let (deflections, moments) = (deflections(&run), moments(&run));
        assert_nodes(&bench, "out/nodal_deflections.csv", ("w", "m"), &deflections);
        assert_nodes(&bench, "out/bending_moments.csv", ("m", "n_m"), &moments);
        assert_near(&derived, &deflections);
    }
}

#[test]
fn nodal_tables_may_be_thinned_in_any_order() {
    let bench = Bench::new();
    for every in [1, 7, 300, 100_000] {
        let thin = format!("{PAPER} --nodes 10,0,5 --every {every} --moments");
        bench.solve(&thin);
        let derived = deflections(&bench.run_of("out"));
        assert_eq!(derived.nodes, [0, 5, 10]);
        bench.solve(&format!("{thin} --deflections"));
        let run = bench.run_of("out");
        let thinned: Vec<f64> = run.times_s.iter().step_by(every).copied().collect();
        assert_eq!(derived.times_s, thinned);
        assert_near(&derived, &deflections(&run));
        assert_nodes(&bench, "out/bending_moments.csv", ("m", "n_m"), &moments(&run));
    }
}

#[test]
fn all_digits_and_an_automatic_mesh_with_few_kept_modes_come_back() {
    let bench = Bench::new();
    bench.write("link.toml", "segments = [{ length = 1.5, EI = 5, mass_per_length = 0.8 }]\n");
    let link = bench.file("link.toml");
    let set = "--set mesh.elements=\"auto\" --set mesh.tolerance=1e-7 --set analysis.modes=4";
    bench.solve(&format!("{link} {MOTION} --digits full {set}"));
    let run = bench.run_of("out");
    let arc = run.arc.as_ref().unwrap();
    assert_eq!(arc.kept_modes, Some(4));
    assert!(arc.mesh.nodes_m().len() > 9);
    assert_histories(&bench, "out", &run);
    bench.solve(PAPER);
    assert_eq!(bench.run_of("out").arc.unwrap().kept_modes, None);
}

#[test]
fn a_simulation_comes_back_with_and_without_feedback_and_target() {
    let bench = Bench::new();
    bench.solve(PAPER);
    let [torque, tip, hub] =
        ["out/torque.csv", "out/tip.csv", "out/hub_angle.csv"].map(|name| bench.file(name));
    let feedback = format!("--feedback 20,2 --reference {hub}");
    for (options, roles) in [
        ("--until 4", "link torque"),
        (&format!("--target {tip} --nodes 3,1"), "link torque target"),
        (&feedback, "link torque reference"),
        (&format!("{feedback} --target {tip} --digits full"), "link torque target reference"),
    ] {
        let play = format!("simulate {LINK} {torque} --set payload.mass=0.05 {options}");
        bench.run(&play, "played");
        let run = bench.run_of("played");
        assert_same_link(&run.links[0].link, &link_of(LINK, &["payload.mass=0.05"]));
        assert_histories(&bench, "played", &run);
        let own: Vec<_> = run.origin.inputs.iter().map(|input| input.role.as_str()).collect();
        assert_eq!(own.join(" "), roles);
        let arc = run.arc.as_ref().unwrap();
        assert_eq!((run.moving_s, &run.links[0].moments_n_m, arc.kept_modes), (None, &None, None));
        assert_eq!(run.origin.arguments[..2], ["--set", "payload.mass=0.05"]);
        // v = xθ + w, the other way round.
        assert_deflected(&bench, &arc.mesh, &run.joints[0].angle_rad, &deflections(&run));
    }
}

#[track_caller]
fn assert_deflected(bench: &Bench, mesh: &Mesh, hub_angle_rad: &[f64], found: &StoredNodes) {
    for (node, history) in found.nodes.iter().zip(&found.histories) {
        let v = bench.column("played/nodal_displacements.csv", &format!("v{node}_m"));
        for ((v, w), angle) in v.iter().zip(history).zip(hub_angle_rad) {
            assert!((w + mesh.nodes_m()[*node] * angle - v).abs() < 1e-14);
        }
    }
}
