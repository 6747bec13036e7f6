//! A link and a motion from numbers, solved into a folder, `out/from_numbers` or the one named, and read
//! back.

#![expect(clippy::print_stdout, reason = "a program that prints its result")]

use std::path::PathBuf;

use flexlink::beam::MeshPlan;
use flexlink::inverse::{Analysis, invert};
use flexlink::link::{Link, Segment};
use flexlink::motion::Profile;
use flexlink::store::{StoredResult, read_result, write_solution};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let strip = Segment::uniform(1.5, 5.0, 0.8);
    let link = Link::builder().segment(strip).hub_inertia_kg_m2(0.1).damping_ratio(0.02).build()?;
    let motion = Profile::Sine.motion(0.5, 0.88, 220)?;
    let solution = invert(&link, &MeshPlan::automatic(&link), &motion, &Analysis::default())?;

    let folder = std::env::args_os().nth(1).map_or("out/from_numbers".into(), PathBuf::from);
    write_solution(&folder, &solution)?;
    if let StoredResult::Runs(runs) = read_result(&folder)? {
        let rows = runs[0].joints[0].torque_n_m.len();
        println!("{rows} rows of torque in {}", folder.display());
    }
    Ok(())
}
