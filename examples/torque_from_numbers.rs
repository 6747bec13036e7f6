//! The hub torque of a steel strip whose tip moves half a metre in 0.88 s, as CSV.

#![expect(clippy::print_stdout, clippy::print_stderr, reason = "a program that prints its result")]

use flexlink::beam::MeshPlan;
use flexlink::inverse::{Analysis, invert};
use flexlink::link::{Link, Segment};
use flexlink::motion::Profile;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let strip = Segment::uniform(1.5, 5.0, 0.8);
    let link = Link::builder().segment(strip).hub_inertia_kg_m2(0.1).damping_ratio(0.02).build()?;
    let motion = Profile::Sine.motion(0.5, 0.88, 220)?;
    let solution = invert(&link, &MeshPlan::automatic(&link), &motion, &Analysis::default())?;

    solution.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    println!("time_s,torque_N_m");
    for (k, torque_n_m) in solution.hub().torque_n_m.iter().enumerate() {
        println!("{:.3},{torque_n_m:.6}", solution.grid.time_s(k));
    }
    Ok(())
}
