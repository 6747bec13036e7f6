//! Results read back: the folder of a run, or the table of a sweep; and a run taken from memory before it
//! is written.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::json::{Head, newer, unreadable};
use super::read_arm::read_arm;
use super::read_tables::{
    RunFolder, TIME, Table, check_window, deflections, read_mesh, read_nodal, times_s,
};
use super::run_tables::{
    DEFLECTIONS, DISPLACEMENTS, HUB_ANGLE, MOMENTS, MOTOR, NODES, NodalFile, PLAYED_HUB,
    RIGID_TORQUE, RunOutputs, SOLVED_HUB, SUMMARY, TIP, TORQUE, WANTED,
};
use super::summary::{A_RUN, Summary};
use super::sweep::{is_sweep, read_sweep};
use crate::beam::NodalHistories;
use crate::csv::{InputError, InputFile, Place, TableError};
use crate::inverse::{NodalTable, Solution};
use crate::link::Link;
use crate::motion::TipMotionHistories;
use crate::result::{StoredArm, StoredMotor, StoredNodes, StoredResult, StoredRun, StoredSolution};

/// Reads a result back: the folder of a run of `solve` or `simulate`, the table of a sweep, or a
/// folder with one such table.
///
/// # Errors
/// [`TableError`] names the file and what is missing in it, damaged, or of another run.
pub fn read_result(path: &Path) -> Result<StoredResult, TableError> {
    if path.join(SUMMARY).exists() {
        return read_run(RunFolder(path));
    }
    let table = if path.is_dir() { only_sweep(path)? } else { path.to_owned() };
    Ok(StoredResult::Sweep(Box::new(read_sweep(&table)?)))
}

/// Lengths in m by which links of the same arm may differ.
const SAME_M: f64 = 1e-9;

/// Reads several results back: one of any kind, or runs of an arm that a page shows beside the first.
///
/// # Errors
/// Those of [`read_result`]; several results that are not all runs of arms of as many links.
pub fn read_results(first: &Path, others: &[PathBuf]) -> Result<StoredResult, TableError> {
    let mut result = read_result(first)?;
    for path in others {
        let shown = path.display().to_string();
        let place = Place { file: &shown, line: None };
        let StoredResult::Arms(arms) = &mut result else {
            let must = "must be left out: only runs of arms stand side by side";
            return Err(place.refuse("BESIDE", "a result beside that of one link", must));
        };
        let links = arms[0].links.len();
        let is_same = |other: &StoredArm| {
            let lengths = arms[0].links.iter().zip(&other.links);
            let mut apart_m = lengths.map(|(a, b)| (a.link.length_m() - b.link.length_m()).abs());
            other.links.len() == links && apart_m.all(|apart_m| apart_m <= SAME_M)
        };
        match read_result(path)? {
            StoredResult::Arms(more) if is_same(&more[0]) => arms.extend(more),
            _ => {
                let must = format!(
                    "must be a run of an arm of {links} links as long as those of the first"
                );
                return Err(place.refuse("result", "another", must));
            }
        }
    }
    if let StoredResult::Arms(arms) = &mut result {
        shorten_names(arms);
    }
    Ok(result)
}

/// Leaves of the names of folders the last part, if that tells them apart.
fn shorten_names(arms: &mut [StoredArm]) {
    let last = |arm: &StoredArm| Some(Path::new(&arm.name).file_name()?.to_string_lossy().into());
    let Some(names) = arms.iter().map(last).collect::<Option<Vec<String>>>() else { return };
    if names.iter().collect::<BTreeSet<_>>().len() == names.len() {
        arms.iter_mut().zip(names).for_each(|(arm, name)| arm.name = name);
    }
}

/// The one table of a sweep in a folder.
fn only_sweep(folder: &Path) -> Result<PathBuf, TableError> {
    let shown = folder.display().to_string();
    let entries = fs::read_dir(folder);
    let entries = entries.map_err(|cause| unreadable(&InputError::new(shown.clone(), cause)))?;
    let is_table = |path: &PathBuf| {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
            && is_sweep(path)
    };
    let mut sweeps: Vec<PathBuf> =
        entries.filter_map(Result::ok).map(|entry| entry.path()).filter(is_table).collect();
    sweeps.sort();
    let place = Place { file: &shown, line: None };
    match &sweeps[..] {
        [] => {
            let hint = "the table of a sweep will do, too";
            let error = place.refuse(SUMMARY, "nothing", format!("must be there: {A_RUN}"));
            Err(error.with_hint(hint.to_owned()))
        }
        [only] => Ok(only.clone()),
        several => {
            let names = several.iter().filter_map(|path| path.file_name());
            let names: Vec<_> = names.map(OsStr::to_string_lossy).collect();
            let error = place.refuse("tables of sweeps", names.join(", "), "must be one");
            Err(error.with_hint("give the file of one of them".to_owned()))
        }
    }
}

/// Whether a folder has the summary of a run, of any version.
pub fn is_run(folder: &Path) -> bool {
    let file = InputFile::read(&folder.join(SUMMARY));
    let head = file.ok().and_then(|file| serde_json::from_slice::<Head>(&file.bytes).ok());
    head.is_some_and(|head| head.flexlink.is_some())
}

/// Reads all that a run has left.
fn read_run(folder: RunFolder) -> Result<StoredResult, TableError> {
    let file = folder.file(SUMMARY)?;
    let summary = Summary::read(&file)?;
    let place = Place { file: &file.shown, line: None };
    let read = || {
        folder.check_named(&summary.files)?;
        if summary.origin().arguments.iter().any(|argument| argument == "--golden") {
            let must = "must be a run without it: a golden folder has not all tables";
            return Err(place.refuse("inputs.arguments", "--golden", must));
        }
        if summary.is_of_arm() {
            return Ok(StoredResult::Arms(vec![read_arm(folder, &summary, place)?]));
        }
        Ok(StoredResult::Run(Box::new(read_files(folder, &summary, place)?)))
    };
    read().map_err(|error| newer(error, &summary.flexlink))
}

/// Reads the tables of a run with this summary, which is at `place`.
fn read_files(folder: RunFolder, summary: &Summary, place: Place) -> Result<StoredRun, TableError> {
    let link = summary.link().map_err(|error| place.refuse_whole(&format!("link.{error}")))?;
    let mesh = read_mesh(&folder.file(NODES.0)?, &link, &summary.stations_m())?;

    let mut torque = Table::of(&folder.file(TORQUE.0)?, &TORQUE.1)?;
    torque.check_even()?;
    check_window(&torque, summary)?;
    let times_s = torque.take(TIME);
    let read = |file: &str, columns: &[&str]| {
        let table = Table::of(&folder.file(file)?, columns)?;
        table.check_times((TORQUE.0, &times_s), 1)?;
        Ok::<Table, TableError>(table)
    };
    let is_solved = summary.command == "solve";
    let mut hub = read(HUB_ANGLE, if is_solved { &SOLVED_HUB } else { &PLAYED_HUB })?;
    let mut tip = read(TIP.0, &TIP.1)?;
    let solved = || {
        let mut rigid = read(RIGID_TORQUE.0, &RIGID_TORQUE.1)?;
        let motor = folder.has(MOTOR.0).then(|| read(MOTOR.0, &MOTOR.1)).transpose()?;
        let (moving_s, lead_s, lag_s) = timing(summary, place)?;
        Ok(StoredSolution {
            rigid_torque_n_m: rigid.take(RIGID_TORQUE.1[0]),
            rigid_hub_angle_rad: hub.take(SOLVED_HUB[3]),
            motor: motor.map(|mut motor| StoredMotor {
                torque_n_m: motor.take(MOTOR.1[0]),
                rate_rad_s: motor.take(MOTOR.1[2]),
            }),
            moving_s,
            lead_s,
            lag_s,
        })
    };
    let solved = is_solved.then(solved).transpose()?;
    let [hub_angle_rad, hub_rate_rad_s] = [0, 1].map(|column| hub.take(SOLVED_HUB[column]));
    let nodal = |table: NodalFile| {
        let read = || read_nodal(&folder.file(table.file)?, table, &mesh, &times_s);
        folder.has(table.file).then(read).transpose()
    };
    let (written, displacements) = (nodal(DEFLECTIONS)?, nodal(DISPLACEMENTS)?);
    let [displacement_m, velocity_m_s, acceleration_m_s2] = TIP.1.map(|name| tip.take(name));
    let origin_rad = origin_rad(&link, solved.as_ref(), &displacement_m);
    let computed = || {
        let hub = (&hub_angle_rad[..], origin_rad?);
        displacements.map(|nodes| deflections(nodes, &mesh, hub, &times_s))
    };
    let deflections_m = written.or_else(computed);
    let moments_n_m = nodal(MOMENTS)?;
    Ok(StoredRun {
        origin: summary.origin(),
        link,
        mesh,
        second_order: summary.second_order(),
        kept_modes: summary.kept_modes(),
        times_s,
        torque_n_m: torque.take(TORQUE.1[0]),
        hub_angle_rad,
        hub_rate_rad_s,
        origin_rad: origin_rad.unwrap_or(0.0),
        tip: TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 },
        solved,
        target: folder.target(&summary.files, &WANTED)?,
        deflections_m,
        moments_n_m,
        readings: summary.readings(),
        limits: Summary::limits(&summary.values["limits"]),
        checks: summary.verification.iter().flatten().flatten().cloned().collect(),
        warnings: summary.warnings.clone(),
        remarks: summary.remarks.clone().unwrap_or_default(),
    })
}

/// Direction of the chord in rad where the tip's displacement is 0; none where gravity makes hub angles absolute and
/// nothing says from where displacements count.
fn origin_rad(link: &Link, solved: Option<&StoredSolution>, tip_m: &[f64]) -> Option<f64> {
    let Some(gravity) = link.gravity() else { return Some(0.0) };
    let rigid = || {
        let (first_rad, first_m) = (solved?.rigid_hub_angle_rad.first()?, tip_m.first()?);
        Some(first_rad - first_m / link.length_m())
    };
    let given = gravity.start_angle_rad.or_else(rigid);
    if gravity.acts() { given } else { Some(given.unwrap_or(0.0)) }
}

/// From a summary of `solve`, in s: start and end of the tip's motion, lead and lag of the torque.
fn timing(summary: &Summary, place: Place) -> Result<Timing, TableError> {
    let number = |of: &str, key: &str| {
        let object = &summary.values[of];
        let missing = if object.is_object() { format!("{of}.{key}") } else { of.to_owned() };
        object[key].as_f64().ok_or_else(|| place.refuse(missing, "nothing", "must be there"))
    };
    let moving_s = (number("motion", "moves_from_s")?, number("motion", "moves_until_s")?);
    let timed = |key: &str| match summary.values["results"].get(key) {
        Some(Value::Null) => Ok(None),
        _ => number("results", key).map(Some),
    };
    Ok((moving_s, timed("lead_s")?, timed("lag_s")?))
}

/// Times in s between which the tip moves; lead and lag in s, none of a periodic motion.
type Timing = ((f64, f64), Option<f64>, Option<f64>);

/// Copies of the nodes' histories that making a page holds at a time.
const COPIES: usize = 4;

impl RunOutputs {
    /// Approximate memory in bytes that making a page of the run takes.
    pub fn page_bytes(&self, deflections: &NodalTable) -> usize {
        size_of::<f64>() * COPIES * deflections.nodes().len() * deflections.grid().len()
    }

    /// The run as reading back its files gives it, but with all digits.
    ///
    /// # Errors
    /// [`TableError`] for a summary that is not one of `solve`.
    pub fn stored(
        &self,
        (solution, deflections): (&Solution, &NodalTable),
        summary: &Summary,
    ) -> Result<StoredResult, TableError> {
        let (moving_s, lead_s, lag_s) = timing(summary, Place { file: SUMMARY, line: None })?;
        let solved = StoredSolution {
            rigid_torque_n_m: solution.rigid_torque_n_m.clone(),
            rigid_hub_angle_rad: solution.rigid_hub_angle_rad.clone(),
            motor: solution.motor.as_ref().map(StoredMotor::from),
            moving_s,
            lead_s,
            lag_s,
        };
        let origin_rad = origin_rad(solution.link(), Some(&solved), &solution.tip.displacement_m);
        Ok(StoredResult::Run(Box::new(StoredRun {
            origin: summary.origin(),
            link: solution.link().clone(),
            mesh: solution.mesh().clone(),
            second_order: summary.second_order(),
            kept_modes: summary.kept_modes(),
            times_s: times_s(&solution.grid.thinned(NonZeroUsize::MIN)),
            torque_n_m: solution.torque_n_m.clone(),
            origin_rad: origin_rad.unwrap_or(0.0),
            hub_angle_rad: solution.hub_angle_rad.clone(),
            hub_rate_rad_s: solution.hub_rate_rad_s.clone(),
            tip: solution.tip.clone(),
            solved: Some(solved),
            target: None,
            deflections_m: Some(in_order(deflections.histories())),
            moments_n_m: self.moments.then(|| in_order(deflections.moments().histories())),
            readings: summary.readings(),
            limits: Summary::limits(&summary.values["limits"]),
            checks: summary.verification.iter().flatten().flatten().cloned().collect(),
            warnings: summary.warnings.clone(),
            remarks: summary.remarks.clone().unwrap_or_default(),
        })))
    }
}

/// Histories with the nodes ascending, as a table is read.
fn in_order(histories: NodalHistories) -> StoredNodes {
    let NodalHistories { nodes, grid, samples } = histories;
    let mut pairs: Vec<(usize, Vec<f64>)> = nodes.into_iter().zip(samples).collect();
    pairs.sort_by_key(|(node, _)| *node);
    let (nodes, histories) = pairs.into_iter().unzip();
    StoredNodes { nodes, times_s: times_s(&grid), histories }
}
