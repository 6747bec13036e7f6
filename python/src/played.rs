//! The table that a sweep plays on every case: a file, a dictionary, or another result.

use std::fs;

use flexlink::cli::options::common::option;
use flexlink::cli::options::play::Driven;
use flexlink::cli::options::reading::ReadArgs;
use flexlink::cli::sweep::cases::TorqueArgs;
use flexlink::csv::Joints;
use flexlink::link::Arm;
use flexlink::store::TemporaryFolder;

use crate::arrays::gains;
use crate::keywords::{OF_LINK, OF_TIP, parsed, take, take_arguments};
use crate::prelude::*;
use crate::samples::{path_of, table_of};
use crate::simulation::Simulation;
use crate::solution::Solution;

/// A table and its play.
pub(crate) struct Table {
    pub(crate) args: TorqueArgs,
    pub(crate) driven: Driven,
    /// The options of the play without files, for a record.
    pub(crate) arguments: Vec<String>,
}

/// Takes the keywords of a play on an arm; `None` without `torque`.
pub(crate) fn take_table(
    keywords: &Keywords<'_>,
    (arm, kind): (&Arm, Joints),
) -> Raises<Option<Table>> {
    let (torque, reference) = (take(keywords, "torque")?, take(keywords, "reference")?);
    let input = take(keywords, "input")?.map(|value| value.str()).transpose()?;
    // Keywords of Python have `_` for `-`.
    let input = input.map(|word| word.to_string().replace('_', "-"));
    let gains = take(keywords, "feedback")?.map(|value| gains(&value)).transpose()?;
    let gains = gains.map(|pairs| {
        let pairs = pairs.iter().map(|(kp, kd)| format!("{kp},{kd}"));
        option("--feedback", pairs.collect::<Vec<_>>().join(","))
    });
    let is_motion = input.as_ref().is_some_and(|word| ["hub-angle", "carriage"].contains(&&**word));
    let arguments = [
        input.map_or_else(Vec::new, |word| option("--input", word)),
        gains.unwrap_or_default(),
        take_arguments(keywords, &["column", "hold", "linear"])?,
    ];
    let arguments = arguments.concat();
    let Some(torque) = torque else {
        let first = arguments.first().map(|word| word.trim_start_matches('-'));
        return match first.or(reference.as_ref().map(|_| "reference")) {
            None => Ok(None),
            Some(name) => {
                Err(usage(&format!("{name} without torque, the table to play"), None).into())
            }
        };
    };
    let folder = TemporaryFolder::new().map_err(Failure::from)?;
    let mut words = arguments.clone();
    let mut files = Vec::new();
    for (name, value, is_motion) in
        [("torque", Some(torque), is_motion), ("reference", reference, true)]
    {
        let Some(value) = value else { continue };
        let path = file(name, &value, (folder.path(), is_motion, kind))?;
        words.extend(option(&format!("--{name}"), path.display()));
        files.push((path, name));
    }
    let args: TorqueArgs = parsed(&words, &[&OF_LINK[..], &OF_TIP].concat(), &[])?;
    let driven = args.read(arm, &ReadArgs::default()).map_err(|failure| {
        let named =
            |text: String, (path, name): &(PathBuf, &str)| match path_of_folder(path, &folder) {
                Some(path) => text.replace(&path, name),
                None => text,
            };
        Failure { message: files.iter().fold(failure.message, named), ..failure }
    })?;
    Ok(driven.map(|driven| Table { args, driven, arguments }))
}

/// A path of the folder in messages; None for a file of the user.
fn path_of_folder(path: &Path, folder: &TemporaryFolder) -> Option<String> {
    path.starts_with(folder.path()).then(|| path.display().to_string())
}

/// The file of a table of a call. Other values than paths become files in a folder: of efforts, or of the motion of the
/// joints.
fn file(
    name: &str,
    value: &Any<'_>,
    (folder, is_motion, kind): (&Path, bool, Joints),
) -> Raises<PathBuf> {
    if let Some(path) = path_of(value)? {
        return Ok(path);
    }
    let path = folder.join(format!("{name}.csv"));
    let run = folder.join(name);
    let in_run = match (is_motion, kind) {
        (false, Joints { links: 1, slides: false }) => "torque.csv",
        (false, Joints { links: 1, slides: true }) => "force.csv",
        (false, _) => "torques.csv",
        (true, Joints { links: 1, slides: false }) => "hub_angle.csv",
        (true, Joints { links: 1, slides: true }) => "carriage.csv",
        (true, _) => "joint_angles.csv",
    };
    let digits = ["--digits=full".to_owned(), "--nodes=0".to_owned()];
    if let Ok(solution) = value.cast::<Solution>() {
        let solution = solution.get();
        value.py().detach(|| solution.write_into(&run, digits.to_vec()))?;
        return Ok(run.join(in_run));
    }
    if let Ok(simulation) = value.cast::<Simulation>() {
        let simulation = simulation.get();
        value.py().detach(|| simulation.write_into(&run, &digits))?;
        return Ok(run.join(in_run));
    }
    // A table for a controller, and the next one of a repeated motion.
    if value.get_type().module()?.to_cow()? == "flexlink" && value.hasattr("write")? {
        let digits = [("digits", "full")].into_py_dict(value.py())?;
        value.call_method("write", (&path,), Some(&digits))?;
        return Ok(path);
    }
    let (table, _) = table_of(name, value)?;
    let refused = |cause| Failure::new(Exit::CannotWrite, &format!("{name}: {cause}"), None);
    fs::write(&path, table.bytes).map_err(refused)?;
    Ok(path)
}
