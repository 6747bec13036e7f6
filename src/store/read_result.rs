//! Results read back: the folder of a run, or the table of a sweep; and a run taken from memory before it
//! is written.

use std::ffi::OsStr;
use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::json::{Head, newer, unreadable};
use super::read_tables::{ONE_RUN, TIME, Table, deflections, is_same_time, read_mesh, read_nodal};
use super::run_tables::{
    DEFLECTIONS, DISPLACEMENTS, HUB_ANGLE, MOMENTS, MOTOR, NODES, NodalFile, PLAYED_HUB,
    RIGID_TORQUE, RunOutputs, SOLVED_HUB, SUMMARY, TIP, TORQUE,
};
use super::summary::{A_RUN, Summary};
use super::sweep::{is_sweep, read_sweep};
use crate::beam::NodalHistories;
use crate::csv::{InputError, InputFile, Place, TableError, quoted, time_format};
use crate::inverse::{NodalTable, Solution};
use crate::link::Link;
use crate::motion::TipMotionHistories;
use crate::numeric::ThinnedGrid;
use crate::result::{StoredNodes, StoredResult, StoredRun, StoredSolution};
use crate::text::is_hidden;

/// Reads a result back: the folder of a run of `solve` or `simulate`, the table of a sweep, or a
/// folder with one such table.
///
/// # Errors
/// [`TableError`] names the file and what is missing in it, damaged, or of another run.
pub fn read_result(path: &Path) -> Result<StoredResult, TableError> {
    if path.join(SUMMARY).exists() {
        return Ok(StoredResult::Run(Box::new(read_run(RunFolder(path))?)));
    }
    let table = if path.is_dir() { only_sweep(path)? } else { path.to_owned() };
    Ok(StoredResult::Sweep(Box::new(read_sweep(&table)?)))
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

/// The folder of one run.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunFolder<'a>(pub(super) &'a Path);

impl RunFolder<'_> {
    /// Reads a file that every run has.
    pub(super) fn file(&self, name: &str) -> Result<InputFile, TableError> {
        if !self.has(name) {
            return Err(self.refuse(name, "nothing", &format!("must be there: {A_RUN}")));
        }
        let path = self.0.join(name);
        // A pipe in a folder, unlike one that a command line names, may have no end.
        if !path.is_file() && !path.is_dir() {
            return Err(self.refuse(name, "a device or a pipe", "must be a file"));
        }
        InputFile::read(&path).map_err(|error| unreadable(&error))
    }

    /// Refuses a folder in which one of the files is missing that its summary names.
    fn check_named(&self, names: &[String]) -> Result<(), TableError> {
        let shown = self.0.display().to_string();
        check_names("files", names, Place { file: &shown, line: None })?;
        match names.iter().find(|name| !self.has(name)) {
            Some(name) => Err(self.refuse(name, "nothing", "must be there: summary.json names it")),
            None => Ok(()),
        }
    }

    fn has(&self, name: &str) -> bool {
        self.0.join(name).exists()
    }

    fn refuse(&self, subject: &str, found: &str, must: &str) -> TableError {
        let shown = self.0.display().to_string();
        Place { file: &shown, line: None }.refuse(subject, found, must)
    }
}

/// Bytes of the longest file name.
const LONGEST_NAME: usize = 255;

/// Refuses names that lead into a folder.
pub(super) fn check_names(subject: &str, names: &[String], place: Place) -> Result<(), TableError> {
    let is_name = |name: &&String| {
        let is_last = Path::new(name).file_name().is_some_and(|own| own == name.as_str());
        is_last && name.len() <= LONGEST_NAME && !name.contains(is_hidden)
    };
    match names.iter().find(|name| !is_name(name)) {
        Some(name) => {
            let must = "must be names, without folders or control characters";
            Err(place.refuse(subject, quoted(name), must))
        }
        None => Ok(()),
    }
}

/// Reads all that a run has left.
fn read_run(folder: RunFolder) -> Result<StoredRun, TableError> {
    let file = folder.file(SUMMARY)?;
    let summary = Summary::read(&file)?;
    let run = read_files(folder, &summary, Place { file: &file.shown, line: None });
    run.map_err(|error| newer(error, &summary.flexlink))
}

/// Reads the tables of a run with this summary, which is at `place`.
fn read_files(folder: RunFolder, summary: &Summary, place: Place) -> Result<StoredRun, TableError> {
    folder.check_named(&summary.files)?;
    if summary.is_of_arm() {
        let must = "must be absent: results of one link are read here, no arm's";
        return Err(place.refuse("arm", "given", must));
    }
    let link = summary.link().map_err(|error| place.refuse_whole(format!("link.{error}")))?;
    let mesh = read_mesh(&folder.file(NODES.0)?, &link)?;

    let mut torque = Table::of(&folder.file(TORQUE.0)?, &TORQUE.1)?;
    torque.check_even()?;
    check_window(&torque, summary)?;
    let times_s = torque.take(TIME);
    let read = |file: &str, columns: &[&str]| {
        let table = Table::of(&folder.file(file)?, columns)?;
        table.check_times(&times_s, 1)?;
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
            motor_torque_n_m: motor.map(|mut motor| motor.take(MOTOR.1[0])),
            moving_s,
            lead_s,
            lag_s,
        })
    };
    let solved = is_solved.then(solved).transpose()?;
    let hub_angle_rad = hub.take(SOLVED_HUB[0]);
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
        kept_modes: summary.kept_modes(),
        times_s,
        torque_n_m: torque.take(TORQUE.1[0]),
        hub_angle_rad,
        origin_rad: origin_rad.unwrap_or(0.0),
        tip: TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 },
        solved,
        deflections_m,
        moments_n_m,
        readings: summary.readings(),
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

/// Refuses a torque over other times than those of the summary.
fn check_window(torque: &Table, summary: &Summary) -> Result<(), TableError> {
    let Some((start_s, end_s)) = summary.window_s() else { return Ok(()) };
    let times_s = torque.times_s();
    let last = times_s.len() - 1;
    for (row, expected_s) in [(0, start_s), (last, end_s)] {
        if !is_same_time(times_s[row], expected_s, times_s) {
            let must = format!("must be {expected_s} s as in summary.json: {ONE_RUN}");
            let found = format!("{} s", times_s[row]);
            return Err(torque.refuse(Some(row), TIME, &found, &must));
        }
    }
    Ok(())
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
            motor_torque_n_m: solution.motor.as_ref().map(|motor| motor.torque_n_m.clone()),
            moving_s,
            lead_s,
            lag_s,
        };
        let origin_rad = origin_rad(solution.link(), Some(&solved), &solution.tip.displacement_m);
        Ok(StoredResult::Run(Box::new(StoredRun {
            origin: summary.origin(),
            link: solution.link().clone(),
            mesh: solution.mesh().clone(),
            kept_modes: summary.kept_modes(),
            times_s: times_s(&solution.grid.thinned(NonZeroUsize::MIN)),
            torque_n_m: solution.torque_n_m.clone(),
            origin_rad: origin_rad.unwrap_or(0.0),
            hub_angle_rad: solution.hub_angle_rad.clone(),
            tip: solution.tip.clone(),
            solved: Some(solved),
            deflections_m: Some(in_order(deflections.histories())),
            moments_n_m: self.moments.then(|| in_order(deflections.moments().histories())),
            readings: summary.readings(),
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

/// Times in s rounded as in tables.
fn times_s(grid: &ThinnedGrid) -> Vec<f64> {
    let format = time_format(|k| grid.time_s(k), grid.len());
    let written = |k: usize| {
        let mut text = Vec::new();
        format.write(&mut text, grid.time_s(k));
        std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok())
    };
    (0..grid.len()).map(|k| written(k).unwrap_or(grid.time_s(k))).collect()
}
