//! How far the work is, as its watcher is told.

use std::num::NonZeroUsize;
use std::sync::Mutex;

use flexlink::beam::{ElementCount, MeshPlan};
use flexlink::inverse::{Analysis, Resources, Stage, Watch, invert, invert_motion};

use flexlink::elastica::SecondOrder;
use flexlink::link::{Arm, ArmLink, ArmParts, Taper};
use flexlink::motion::{ArmPath, Motion, PathColumn, PathColumns, Recording};

use super::{Smooth, link};
use crate::common::plan_of;
use crate::recordings::septic;

/// Every stage that began, its parts, and how many of them are done.
#[derive(Debug, Default)]
struct Notes(Mutex<Vec<(Stage, usize, usize)>>);

impl Watch for Notes {
    fn begin(&self, stage: Stage, parts: usize) {
        self.0.lock().unwrap().push((stage, parts, 0));
    }

    fn advance(&self, parts: usize) {
        self.0.lock().unwrap().last_mut().unwrap().2 += parts;
    }
}

impl Notes {
    /// Elements of every mesh that was solved on, in turn; every stage must be done to its end.
    #[track_caller]
    fn meshes(&self) -> Vec<usize> {
        let notes = self.0.lock().unwrap();
        let of_mesh = |(stage, parts, done): &(Stage, usize, usize)| {
            assert_eq!(parts, done, "{stage:?}");
            match stage {
                Stage::Solve { elements } => *elements,
                other => panic!("{other:?}"),
            }
        };
        notes.iter().map(of_mesh).collect()
    }
}

#[test]
fn every_mesh_is_told_and_solved_to_its_last_frequency_and_watching_changes_nothing() {
    let motion = Smooth::SHORT.motion();
    let link = link(|_| ());
    let plan = MeshPlan::new(&link, &[None], Some(ElementCount::Auto), 1e-6).unwrap();
    let (arm, plans) = (link.clone().into(), std::slice::from_ref(&plan));
    let wanted = Motion::Tip(motion.clone());
    for analysis in [Analysis::default(), Analysis::default().with_moments()] {
        let notes = Notes::default();
        let resources = Resources { watch: &notes, ..Resources::default() };
        let solution = invert_motion(&arm, plans, &wanted, &analysis, &resources).unwrap();
        let meshes = notes.meshes();
        let answers = solution.links[0].mesh().elements().len();
        let doubled: Vec<usize> =
            meshes.iter().copied().take_while(|n| *n <= 2 * answers).collect();
        assert!(doubled.windows(2).all(|pair| pair[1] == 2 * pair[0] || pair[1] == answers));
        assert!(meshes.contains(&answers) && meshes.contains(&(2 * answers)), "{meshes:?}");
        let unwatched = invert(&link, &plan, &motion, &analysis).unwrap();
        assert!(unwatched.hub().torque_n_m == solution.hub().torque_n_m);
    }
}

/// Each refinement is one stage, of both meshes or of the finer one alone; the elements are those of the finer mesh.
#[test]
fn every_mesh_of_a_bent_link_and_of_an_arm_is_told_and_solved_to_its_end() {
    let stiff = link(|parts| parts.segments[0].bending_stiffness_n_m2 = Taper::constant(60.0));
    let plan = MeshPlan::new(&stiff, &[None], Some(ElementCount::Auto), 1e-6).unwrap();
    let full = Analysis::default().with_second_order(SecondOrder::Full);
    let one = (Arm::from(stiff.clone()), Motion::Tip(Smooth::SHORT.motion()));
    let links = vec![ArmLink { name: None, link: stiff }; 2];
    let two = Arm::new(ArmParts { links, ..ArmParts::default() }).unwrap();
    let angle = |by: f64| {
        let at = |k: u32| by * septic(f64::from(k) / 200.0)[0];
        let (name, values) = (String::new(), (0..=200).map(at).collect());
        Some(PathColumn { name, values, recording: Recording::default() })
    };
    let time_s = (0..=200).map(|k| 0.01 * f64::from(k)).collect();
    let columns =
        PathColumns { time_s, tip: None, angles: vec![angle(0.3), angle(0.5)], carriage: None };
    let path = Motion::Path(ArmPath::new(columns, &two.lengths_m()).unwrap());
    for (arm, motion) in [one, (two, path)] {
        let (notes, plans) = (Notes::default(), vec![plan.clone(); arm.links().len()]);
        let resources = Resources { watch: &notes, ..Resources::default() };
        let solution = invert_motion(&arm, &plans, &motion, &full, &resources).unwrap();
        let finest: usize =
            solution.links.iter().map(|link| 2 * link.mesh().elements().len()).sum();
        let meshes = notes.meshes();
        assert!(meshes.contains(&finest), "{meshes:?} without {finest}");
        assert!(meshes.iter().all(|elements| *elements <= finest), "{meshes:?}");
    }
}

#[test]
fn the_nodes_of_a_table_are_solved_for_and_transformed_to_the_last() {
    let motion = Smooth::SHORT.motion();
    let link = link(|_| ());
    let plan = plan_of(&link, 20);
    let solution = invert(&link, &plan, &motion, &Analysis::default()).unwrap();
    let nodes: Vec<usize> = (0..=20).collect();
    let notes = Notes::default();
    solution.displacements(&nodes, NonZeroUsize::MIN).unwrap().peak(&notes, |_, _| true);
    let notes = notes.0.into_inner().unwrap();
    let band = solution.band.frequencies;
    let expected = [(Stage::Solve { elements: 20 }, band, band), (Stage::Transform, 21, 21)];
    assert_eq!(notes, expected);
}
