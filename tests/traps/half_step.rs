//! What half the step changes, as a run claims it, against a run at an eighth of the step.

use super::case::{Case, Mesh};
use super::link::Link;
use super::motion::{Column, Motion, Profile};
use super::run::{Nodes, Outcome, Written, solved};

/// The finer run has this part of the step.
const PART: usize = 8;

/// A claim is at least this share of the change that the finer run tells, and at most so many times it.
const AT_LEAST: f64 = 0.5;
const AT_MOST: f64 = 30.0;

fn written(case: &Case, part: usize) -> (Box<Written>, i64) {
    let samples = case.motion.finer(part).samples();
    match solved(case, &samples, &Nodes::Root) {
        Outcome::Written(written) => {
            let first = written.first_row(samples.step_s);
            (written, first)
        }
        Outcome::Refused(_, message) => panic!("{}: {message}", case.name),
    }
}

/// Largest change of a column from one run to the finer one over the column's peak there.
fn change(runs: &[(Box<Written>, i64); 2], table: &str, column: &str) -> f64 {
    let [(coarse, first), (fine, fine_first)] = runs;
    let [coarse, fine] = [coarse, fine].map(|run| run.table(table).column(column).to_vec());
    let peak = fine.iter().fold(0.0_f64, |m, x| m.max((x - fine[0]).abs()));
    let pairs = coarse.iter().enumerate().filter_map(|(k, value)| {
        let row = (k as i64 + first) * PART as i64 - fine_first;
        Some((value - fine.get(usize::try_from(row).ok()?)?).abs())
    });
    pairs.fold(0.0, f64::max) / peak
}

/// Claims of the step error that do not hold.
fn wrong(case: &Case) -> Vec<String> {
    let runs = [written(case, 1), written(case, PART)];
    let columns = [
        ("torque", "torque.csv", "torque_n_m"),
        ("hub_angle", "hub_angle.csv", "hub_angle_rad"),
        ("motor_torque", "motor.csv", "motor_torque_n_m"),
    ];
    let judged = columns.into_iter().filter_map(|(quantity, table, column)| {
        let claimed = runs[0].0.number(&format!("/errors/{quantity}/step"))?;
        let found = change(&runs, table, column);
        let holds = (AT_LEAST * found..=AT_MOST * found).contains(&claimed);
        (!holds).then(|| format!("{quantity}: {claimed:.2e} claimed, {found:.2e} found"))
    });
    judged.collect()
}

/// Every frequency of the samples of a motion of so many steps.
fn whole(name: &str, link: Link, motion: Motion) -> Case {
    Case::new(name, link, motion, Mesh::Elements(20)).with(|c| c.tip_tolerance = Some(0.0))
}

#[test]
fn the_claimed_change_by_half_the_step_is_that_of_a_run_at_an_eighth_of_it() {
    let sine = Motion::new(Profile::Sine, 0.5, 0.88, 0.02);
    let jerk = Motion::new(Profile::MinJerk, 0.3, 1.0, 0.01);
    let septic = Motion::new(Profile::Septic, 0.3, 1.0, 0.02);
    let shown = Motion { column: Column::Displacement, ..septic };
    for case in [
        whole("sine of 44 steps", Link::paper(), sine),
        whole("min-jerk of 100 steps", Link::paper(), jerk),
        whole("septic of 50 steps", Link::paper(), septic),
        whole("displacements of 50 steps, rome", Link::rome(), shown),
    ] {
        assert_eq!(wrong(&case), [""; 0], "{}", case.name);
    }
}

/// A spline through the samples stands for the finer motion. Of a smooth motion it is off by more than
/// the samples are: 2.4e-4 of the torque claimed, 2.4e-7 found. The motor's T̈ of a kink falls slower
/// than half of it a halving: 1.0e-3 claimed, 2.7e-3 found.
#[test]
fn known_claims_of_the_step_are_still_wrong() {
    let gaussian = Motion::new(Profile::Gaussian, 0.5, 1.5, 0.05);
    let smooth = wrong(&whole("gaussian of 30 steps", Link::paper(), gaussian));
    assert_eq!(smooth.len(), 2, "{smooth:?}");
    let septic = Motion::new(Profile::Septic, 0.3, 1.0, 0.02);
    let kink = wrong(&whole("septic of 50 steps, rome", Link::rome(), septic));
    assert!(kink.len() == 1 && kink[0].starts_with("motor_torque"), "{kink:?}");
}
