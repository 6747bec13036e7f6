//! A run and a sweep as read back, and tests of the figures of their bending and their cases.

use std::num::NonZeroUsize;
use std::slice::from_ref;

use super::Figures;
use super::bending::{COLUMNS, Moments, ROWS, deflections, tip_deflection_m, waves};
use super::figure::Stroke;
use super::joint::LIMITED;
use super::motion::exaggeration;
use super::swept::{FINE, sweep_figures};
use super::tip::rigid_tip_m;
use super::view::{View, inside};
use super::words::worded;
use crate::beam::{Mesh, MeshPlan};
use crate::compare::{Cell, Table, TableColumn};
use crate::elastica::SecondOrder;
use crate::inverse::{Analysis, Solution, invert};
use crate::link::{Damping, Hub, Link, LinkParts, LumpedMass, Payload, Segment, Taper};
use crate::motion::{Profile, TipMotion};
use crate::numeric::largest;
use crate::result::{
    JointQuantity, Limits, Metrics, Notice, Origin, StoredArc, StoredInput, StoredJoint,
    StoredLink, StoredNodes, StoredRun, StoredSweep,
};
use crate::store::StoredResult;

/// The paper's first example with a small mass and a payload, and a title full of traps.
pub(super) fn link(viscous_friction_n_m_s_rad: f64) -> Link {
    let segment = |name: &str, length_m, stiffness| Segment {
        name: Some(name.to_owned()),
        length_m,
        bending_stiffness_n_m2: Taper::constant(stiffness),
        mass_per_length_kg_m: Taper::constant(0.8),
        cross_section: None,
        timoshenko: None,
    };
    Link::new(LinkParts {
        title: "</script><script>alert(1)</script> & \"link\"".to_owned(),
        segments: vec![segment("root", 0.15, 50.0), segment("<b>beam", 1.35, 5.0)],
        hub: Hub { inertia_kg_m2: 0.1, viscous_friction_n_m_s_rad, ..Hub::default() },
        carriage: None,
        root_stiffness_n_m_rad: None,
        output_m: None,
        masses: vec![LumpedMass { at_m: 0.75, mass_kg: 0.05, inertia_kg_m2: 0.0 }],
        payload: Payload { mass_kg: 0.05, ..Payload::default() },
        damping: Damping::Hysteretic { ratio: 0.02 },
        drive: None,
        gravity: None,
    })
    .unwrap()
}

/// Solution of [`link`] for a sine of 0.88 s.
pub(super) fn solution() -> Solution {
    let link = link(0.0);
    let plan = MeshPlan::new(&link, &[Some(1), Some(9)], None, 1e-6).unwrap();
    let motion = TipMotion::new(Profile::Sine.sampled(0.5, 0.002, 440, [50, 50])).unwrap();
    invert(&link, &plan, &motion, &Analysis::default()).unwrap()
}

/// The solution as read back from its folder.
pub(super) fn run() -> StoredRun {
    let (link, solution) = (link(0.0), solution());
    let metrics = Metrics::of(&solution);
    let mesh: Mesh = solution.links[0].mesh().clone();
    let all: Vec<usize> = (0..mesh.nodes_m().len()).collect();
    let times = |len: usize| (0..len).map(|k| solution.grid.time_s(k)).collect::<Vec<f64>>();
    let times_s = times(solution.grid.len);
    let readings = vec![
        ("peak_torque_n_m".to_owned(), metrics.hub().peak_torque_n_m.value),
        ("lead_s".to_owned(), metrics.hub().lead_s.unwrap()),
        ("lag_s".to_owned(), metrics.hub().lag_s.unwrap()),
    ];
    StoredRun {
        origin: Origin {
            command: "solve".to_owned(),
            version: "0.1.0".to_owned(),
            title: link.title().to_owned(),
            inputs: vec![StoredInput {
                role: "link".to_owned(),
                name: "<i>link.toml".to_owned(),
                sha256: "0".repeat(64),
            }],
            arguments: vec!["--set".to_owned(), "title=<u>".to_owned()],
        },
        name: String::new(),
        carriage: None,
        joints: vec![StoredJoint {
            torque_n_m: solution.hub().torque_n_m.clone(),
            angle_rad: solution.hub().angle_rad.clone(),
            rate_rad_s: solution.hub().rate_rad_s.clone(),
            acceleration_rad_s2: solution.acceleration_rad_s2(0).into_owned(),
            rigid_torque_n_m: Some(solution.hub().rigid_torque_n_m.clone()),
            rigid_angle_rad: Some(solution.hub().rigid_angle_rad.clone()),
            motor: None,
            readings: readings.clone(),
            errors: vec![],
            limits: Limits::default(),
        }],
        arc: Some(StoredArc {
            second_order: SecondOrder::None,
            kept_modes: None,
            origin_rad: 0.0,
            tip: solution.tip[0].clone(),
            mesh,
        }),
        links: vec![StoredLink {
            name: "1".to_owned(),
            link,
            nodes_m: solution.links[0].mesh().nodes_m().to_vec(),
            positions_m: vec![],
            deflections_m: Some(StoredNodes {
                nodes: all.clone(),
                times_s: times_s.clone(),
                histories: solution
                    .deflections(&all, NonZeroUsize::MIN)
                    .unwrap()
                    .histories()
                    .samples,
            }),
            moments_n_m: None,
        }],
        nodal_times_s: vec![],
        tip_m: [vec![], vec![]],
        moving_s: Some((
            solution.grid.time_s(solution.moving.0),
            solution.grid.time_s(solution.moving.1),
        )),
        target: None,
        prescribed: None,
        gravity_m_s2: [0.0; 2],
        readings,
        checks: vec![],
        remarks: vec![Notice {
            kind: "a kind".to_owned(),
            message: "a density of <b>".to_owned(),
            hint: "another unit".to_owned(),
        }],
        warnings: vec![Notice {
            kind: "a kind".to_owned(),
            message: "<em>bent".to_owned(),
            hint: "less & slower".to_owned(),
        }],
        times_s,
    }
}

impl StoredRun {
    /// The deflections of the nodes of the single link.
    pub(super) fn bent(&mut self) -> &mut StoredNodes {
        self.links[0].deflections_m.as_mut().unwrap()
    }
}

/// The view of one run.
pub(super) fn view(run: &StoredRun) -> View<'_> {
    View::of(from_ref(run))
}

#[test]
fn moments_made_from_displacements_are_those_of_the_solution() {
    let run = run();
    let view = View::of(from_ref(&run));
    let Moments { nodes: found, is_written } = view.moments(0).unwrap();
    assert!(!is_written);
    let exact = solution().moments(&found.nodes, NonZeroUsize::MIN).unwrap().histories().samples;
    let peak = exact[0].iter().fold(0.0_f64, |peak, m| peak.max(m.abs()));
    for (node, (found, exact)) in found.histories.iter().zip(&exact).enumerate() {
        for k in inside(&run.times_s, view.span_s.0, view.span_s.1) {
            let error = (found[k] - exact[k]).abs() / peak;
            assert!(error < 0.02, "node {node}, sample {k}: {error}");
        }
    }
}

#[test]
fn moments_written_are_taken_as_they_are() {
    let mut run = run();
    let mut written = run.bent().clone();
    written.histories[0][7] = 42.0;
    run.links[0].moments_n_m = Some(written.clone());
    let expected = Moments { nodes: written, is_written: true };
    assert_eq!(view(&run).moments(0), Some(expected));
}

#[test]
fn an_estimate_that_misses_the_summary_is_none() {
    let mut run = run();
    assert!(view(&run).moments(0).is_some());
    let exact = largest(&solution().links[0].root_moment_n_m);
    run.readings.push(("peak_root_moment_n_m".to_owned(), exact));
    assert!(view(&run).moments(0).is_some());
    // With three digits the second differences are noise.
    for history in &mut run.bent().histories {
        for w in history {
            *w = (*w * 1e4).round() * 1e-4;
        }
    }
    assert_eq!(view(&run).moments(0), None);
}

#[test]
fn colours_stand_at_their_time_however_the_rows_are_thinned() {
    let run = run();
    let whole = waves(&view(&run), 0).unwrap().map.unwrap();
    let mut thinned = run.clone();
    let nodes = thinned.bent();
    for values in nodes.histories.iter_mut().chain([&mut nodes.times_s]) {
        *values = values.iter().copied().step_by(4).collect();
    }
    let thinned = waves(&view(&thinned), 0).unwrap().map.unwrap();
    let middle = ROWS / 2;
    for k in 0..COLUMNS {
        let apart = (whole.rows[middle][k] - thinned.rows[middle][k]) / whole.limits().1;
        assert!(apart.abs() < 0.02, "column {k}: {apart}");
    }
}

#[test]
fn the_tip_is_known_without_its_node() {
    let mut run = run();
    let whole = run.bent().clone();
    let nodes = run.bent();
    for list in [0, nodes.nodes.len() - 2] {
        nodes.nodes.remove(list);
        nodes.histories.remove(list);
    }
    let found = view(&run).deflections(0).unwrap();
    assert_eq!(found.nodes, whole.nodes);
    for (found, written) in found.histories.iter().zip(&whole.histories) {
        let apart = found.iter().zip(written).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(apart < 1e-12, "{apart:e}");
    }
    run.bent().nodes.clear();
    run.bent().histories.clear();
    assert_eq!(view(&run).deflections(0), None);
    assert!(waves(&view(&run), 0).is_err());
}

#[test]
fn the_formula_of_the_waves_is_that_of_what_they_draw() {
    let estimated = run();
    let (mut written, mut deflected) = (estimated.clone(), estimated.clone());
    written.links[0].moments_n_m = Some(written.bent().clone());
    let nodes = deflected.bent();
    for k in (0..nodes.nodes.len()).rev().filter(|k| ![0, 5].contains(k)) {
        nodes.nodes.remove(k);
        nodes.histories.remove(k);
    }
    for (run, begins, holds) in [
        (estimated, "m(x, t) = ∫", "second differences"),
        (written, "m(x, t) = EI", "√(|m|"),
        (deflected, "w(x, t)", "√(|w|"),
    ] {
        let figures = Figures::of(&StoredResult::Runs(vec![run])).drawn;
        assert!(figures.iter().all(|figure| !figure.formula.is_empty()));
        let formula = &figures.iter().find(|figure| figure.id == "waves").unwrap().formula;
        assert!(formula.starts_with(begins) && formula.contains(holds), "{formula}");
    }
}

/// A text as a page shows it.
fn shown(text: &str) -> String {
    worded(None, text)
}

/// A sweep with the ratio and the order of the cases after its varied columns.
fn sweep(varied: &[(&str, &[f64])], ratios: &[f64]) -> StoredSweep {
    let named = varied.iter().copied().chain([("torque_ratio", ratios)]);
    let columns = named.map(|(name, values)| {
        let mut column = TableColumn::new(name.to_owned());
        for value in values {
            let cell = if value.is_nan() { Cell::Word("") } else { Cell::Number(*value) };
            column.push(cell);
        }
        column
    });
    let table = Table { columns: columns.collect(), lines: (2..2 + ratios.len() as u64).collect() };
    let si = |name: &str| if name == "payload.mass" { "kg" } else { "" };
    let units = varied.iter().map(|(name, _)| si(name).to_owned());
    StoredSweep {
        name: "sweep.csv".to_owned(),
        origin: None,
        links: vec![],
        limits: vec![],
        units: units.collect(),
        table,
    }
}

#[test]
fn fields_reach_half_way_to_their_neighbours() {
    let sweep = sweep(
        &[("a", &[1.0, 2.0, 4.0, 1.0, 2.0, 4.0]), ("b", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0])],
        &[0.1, 0.2, 0.3, 0.4, f64::NAN, 0.6],
    );
    let figures = sweep_figures(&sweep);
    assert_eq!((figures.drawn.len(), figures.omitted.len()), (1, 0));
    let figure = &figures.drawn[0];
    let map = figure.map.as_ref().unwrap();
    let place = |share: f64, count: usize| {
        (0..count).find(|k| (*k + 1) as f64 > share * count as f64).unwrap()
    };
    let at = |a: f64, b: f64| {
        let column = place(figure.x.share(a), FINE.0);
        map.rows[place(figure.y.share(b), FINE.1)][column]
    };
    for (a, b, expected) in [(1.0, 0.0, 0.1), (1.4, 0.45, 0.1), (1.6, 0.0, 0.2), (3.1, 0.55, 0.6)] {
        assert!((at(a, b) - expected).abs() < 1e-15, "{a}, {b}: {}", at(a, b));
    }
    assert!(at(2.0, 1.0).is_nan(), "a case without a number");
    assert_eq!(figure.x.places, [1.0, 2.0, 4.0]);
}

#[test]
fn equal_factors_and_decades_have_a_logarithmic_axis_and_keys_their_units() {
    for (name, values, unit, scale) in [
        ("payload.mass", &[0.5, 1.0, 2.0, 4.0, 8.0][..], "kg", "log"),
        ("segments.beam.EI", &[0.1, 3.0, 11.0], "", "log"),
        ("segments.*.EI*", &[1.0, 7.0, 13.0], "", "linear"),
        ("segments.beam.I [cm^4]", &[1.0, 90.0], "cm⁴", "linear"),
        ("hub.inertia", &[0.0, 1.0, 1000.0], "", "linear"),
    ] {
        let axis = &sweep_figures(&sweep(&[(name, values)], &vec![0.5; values.len()])).drawn[0].x;
        assert_eq!((&shown(&axis.unit)[..], axis.spacing_word()), (unit, scale), "{name}");
    }
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let one = sweep(&[("a", &[1.0])], &[0.5]);
    let figures = sweep_figures(&one);
    assert!(figures.drawn.is_empty());
    assert!(figures.omitted[0].contains("two values or more"), "{:?}", figures.omitted);
    let failed = sweep(&[("a", &[1.0, 2.0])], &[f64::NAN, f64::NAN]);
    assert!(sweep_figures(&failed).omitted[0].contains("no case has a number"));
    let many: Vec<f64> = (0..14).map(f64::from).collect();
    let last: Vec<f64> = (0..14).map(|k| f64::from(k % 2)).collect();
    let more: Vec<f64> = (0..14).map(|k| f64::from(k / 2)).collect();
    let crowd = sweep(&[("a", &many), ("b", &more), ("c", &last)], &[0.5; 14]);
    let figures = sweep_figures(&crowd);
    let [dots] = &figures.drawn[0].curves[..] else { panic!("{:?}", figures.drawn[0].curves) };
    assert_eq!((dots.stroke, dots.points.len()), (Stroke::Points(1), 14));
    assert!(figures.drawn[0].caption.contains("more than a figure holds"));
}

#[test]
fn words_part_lines_and_the_value_with_most_numbers_has_the_axis() {
    let mut table = sweep(
        &[("a", &[1.0, 2.0, 3.0, 1.0, 2.0, 3.0]), ("law", &[f64::NAN; 6])],
        &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
    );
    let mut law = TableColumn::new("law".to_owned());
    for word in ["none", "none", "none", "modal", "modal", "modal"] {
        law.push(Cell::Word(word));
    }
    table.table.columns[1] = law;
    let figure = &sweep_figures(&table).drawn[0];
    assert_eq!(shown(&figure.x.name), "a");
    let names: Vec<String> = figure.curves.iter().map(|curve| shown(&curve.name)).collect();
    assert_eq!(names, ["law = none", "law = modal"]);
    assert_eq!(figure.curves[1].points, [(1.0, 0.4), (2.0, 0.5), (3.0, 0.6)]);
}

/// The deflection of a rotated and shifted link from its chord is its bending, and a rigid arm's tip follows from its
/// angles.
#[test]
fn deflections_are_those_from_the_chord_and_the_wanted_place_is_that_of_the_rigid_arm() {
    let nodes_m: Vec<f64> = (0..=8).map(|k| 0.125 * f64::from(k)).collect();
    let bent = |x_m: f64, k: usize| 0.05 * k as f64 * libm::sin(std::f64::consts::PI * x_m);
    let angles = [[0.3, 0.4, 0.5], [1.9, 1.5, 1.1]];
    let rigid = |link: usize| -> Vec<f64> {
        (0..3).map(|k| angles[link][k] - if link == 0 { 0.0 } else { angles[0][k] }).collect()
    };
    let tip = |link: usize, k: usize| -> [f64; 2] {
        let before = angles[..=link].iter();
        [before.clone().map(|a| libm::cos(a[k])).sum(), before.map(|a| libm::sin(a[k])).sum()]
    };
    let place = |link: usize, x_m: f64, k: usize| {
        let (sin, cos, w) = (libm::sin(angles[link][k]), libm::cos(angles[link][k]), bent(x_m, k));
        let from = if link == 0 { [0.0; 2] } else { tip(0, k) };
        [from[0] + x_m * cos - w * sin, from[1] + x_m * sin + w * cos]
    };
    let segment = Segment::uniform(1.0, 5.0, 0.8);
    let links = (0..2_usize).map(|link| StoredLink {
        name: link.to_string(),
        link: Link::builder().segment(segment.clone()).build().unwrap(),
        nodes_m: nodes_m.clone(),
        positions_m: nodes_m
            .iter()
            .map(|x| [0, 1].map(|axis| (0..3).map(|k| place(link, *x, k)[axis]).collect()))
            .collect(),
        deflections_m: None,
        moments_n_m: None,
    });
    let one = run();
    let joints = (0..2)
        .map(|joint| StoredJoint { rigid_angle_rad: Some(rigid(joint)), ..one.joints[0].clone() });
    let times_s = vec![0.0, 1.0, 2.0];
    let arm = StoredRun {
        joints: joints.collect(),
        links: links.collect(),
        nodal_times_s: times_s.clone(),
        times_s,
        tip_m: [0, 1].map(|axis| (0..3).map(|k| tip(1, k)[axis]).collect()),
        arc: None,
        ..one.clone()
    };
    for link in 0..2 {
        let found = deflections(&arm, link);
        for (x_m, history) in nodes_m.iter().zip(&found.histories) {
            for (k, w) in history.iter().enumerate() {
                assert!((w - bent(*x_m, k)).abs() < 1e-14, "link {link} at {x_m} m: {w}");
            }
        }
        for (k, w) in tip_deflection_m(&arm, link).iter().enumerate() {
            let exact = -libm::sin(libm::atan(0.05 * std::f64::consts::PI * k as f64));
            assert!((w - exact).abs() <= 0.01 * exact.abs() + 1e-14, "link {link}, {k}: {w}");
        }
    }
    let wanted = rigid_tip_m(&arm).unwrap();
    let off = (0..3).map(|k| libm::hypot(wanted[0][k] - tip(1, k)[0], wanted[1][k] - tip(1, k)[1]));
    assert!(off.fold(0.0, f64::max) < 1e-14);
}

#[test]
fn a_deflection_is_drawn_as_large_as_it_is_well_seen() {
    for (bending, factor) in [(0.0, 1.0), (0.001, 50.0), (0.008, 10.0), (0.035, 2.0), (0.3, 1.0)] {
        let found = exaggeration(bending);
        assert!((found - factor).abs() < 1e-15, "{bending}: {found}");
    }
}

#[test]
fn every_figure_of_a_limited_history_is_of_a_quantity_with_a_limit() {
    for figure in LIMITED {
        assert!(JointQuantity::of_limit(figure.quantity.1).is_some(), "{}", figure.quantity.1);
    }
}
