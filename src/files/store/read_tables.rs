//! The folder of a run, and its tables read back: histories, quantities at nodes, and the nodes.

use std::collections::BTreeMap;
use std::path::Path;

use super::json::unreadable;
use super::names::{Form, NodalFile, TIP_ERROR, node_columns};
use super::summary::{A_RUN, Summary};
use crate::beam::Mesh;
use crate::csv::{
    InputFile, Place, TableError, check_separator, quoted, read_rows, refuse_missing, time_format,
};
use crate::numeric::{ThinnedGrid, TimeGrid};
use crate::result::{StoredNodes, StoredTarget};
use crate::text::is_hidden;

pub(super) const TIME: &str = "time_s";

/// End of a message on tables of two runs.
pub(super) const ONE_RUN: &str = "a folder holds one run";

/// Largest difference of equal times in steps, more than their rounding.
const TIME_TOLERANCE: f64 = 1e-6;

/// The folder of one run.
#[derive(Debug, Clone, Copy)]
pub(super) struct RunFolder<'a>(pub(super) &'a Path);

impl RunFolder<'_> {
    /// Reads a file that every run has.
    pub(super) fn file(&self, name: &str) -> Result<InputFile, TableError> {
        if !self.has(name) {
            return Err(self.refuse(&format!("{name} is missing: this is not {A_RUN}")));
        }
        let path = self.0.join(name);
        // A pipe in a folder, unlike a pipe on the command line, may be endless.
        if !path.is_file() && !path.is_dir() {
            return Err(self.refuse(&format!("{name} = a device or a pipe, but must be a file")));
        }
        InputFile::read(&path).map_err(|error| unreadable(&error))
    }

    /// Refuses a folder without one of the files in its summary.
    pub(super) fn check_named(&self, names: &[String]) -> Result<(), TableError> {
        let shown = self.0.display().to_string();
        check_names("files", names, Place { file: &shown, line: None })?;
        match names.iter().find(|name| !self.has(name)) {
            Some(name) => {
                Err(self.refuse(&format!("{name} is missing, but summary.json names it")))
            }
            None => Ok(()),
        }
    }

    pub(super) fn has(&self, name: &str) -> bool {
        self.0.join(name).exists()
    }

    /// Reads the wanted tip of a simulation, if `named` has its file.
    pub(super) fn target(
        &self,
        named: &[String],
        form: Form,
    ) -> Result<Option<StoredTarget>, TableError> {
        let file = TIP_ERROR.name(form);
        if !named.iter().any(|name| name == file) {
            return Ok(None);
        }
        let columns = TIP_ERROR.columns(form, &[0]);
        let mut table = Table::of(&self.file(file)?, &columns)?;
        table.check_even()?;
        let mut all: Vec<Vec<f64>> = columns.iter().map(|name| table.take(name)).collect();
        let error_m = all.pop().unwrap_or_default();
        Ok(Some(StoredTarget { times_s: table.take(TIME), wanted_m: all, error_m }))
    }

    fn refuse(&self, message: &str) -> TableError {
        let shown = self.0.display().to_string();
        Place { file: &shown, line: None }.refuse_whole(message)
    }
}

/// Bytes of the longest file name.
const LONGEST_NAME: usize = 255;

/// Refuses names with a path into a folder.
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

/// A table over time from a run: `time_s` first, then numbers in every field.
#[derive(Debug, Clone)]
pub(super) struct Table {
    /// The file, for messages.
    shown: String,
    /// Names of the columns, `time_s` first.
    names: Vec<String>,
    /// One column a name.
    columns: Vec<Vec<f64>>,
    lines: Vec<u64>,
}

impl Table {
    /// Reads a table with exactly these columns beside the time.
    pub(super) fn of(file: &InputFile, columns: &[String]) -> Result<Self, TableError> {
        Self::read(file, |fields, place| {
            for wanted in columns {
                if !fields.contains(&wanted.as_str()) {
                    return Err(refuse_missing(fields, wanted, place));
                }
            }
            let must = || format!("must be one of {TIME}, {}", columns.join(", "));
            let unknown = |field: &&str| *field != TIME && !columns.iter().any(|own| own == field);
            match fields.iter().position(unknown) {
                Some(index) => Err(place.refuse_column(index, fields[index], must())),
                None => Ok(()),
            }
        })
    }

    /// Reads a table whose names, `time_s` first, `check` accepts.
    fn read(
        file: &InputFile,
        check: impl Fn(&[&str], Place) -> Result<(), TableError>,
    ) -> Result<Self, TableError> {
        let whole = Place { file: &file.shown, line: None };
        let at = |line| Place { line: Some(line), ..whole };
        let begin = |line, fields: &[&str]| {
            check_columns(fields, at(line))?;
            check(fields, at(line))?;
            Ok(Self {
                shown: file.shown.clone(),
                names: fields.iter().map(|&field| field.to_owned()).collect(),
                columns: vec![Vec::new(); fields.len()],
                lines: Vec::new(),
            })
        };
        let push = |table: &mut Self, line, fields: &[&str]| table.push(fields, line, at(line));
        let table = read_rows(&file.shown, &file.bytes, begin, push)?;
        table.filter(|table| !table.lines.is_empty()).ok_or_else(|| {
            whole.refuse_whole("the table has no rows, but must have at least one below the names")
        })
    }

    fn push(&mut self, fields: &[&str], line: u64, place: Place) -> Result<(), TableError> {
        place.check_width(fields.len(), self.names.len())?;
        for ((name, field), column) in self.names.iter().zip(fields).zip(&mut self.columns) {
            column.push(read_number(name, field, place)?);
        }
        if let &[.., before, now] = &self.columns[0][..]
            && now <= before
        {
            let must = format!("must be above {before} s of the row before");
            return Err(place.refuse(TIME, format!("{now} s"), must));
        }
        self.lines.push(line);
        Ok(())
    }

    /// The times in s.
    pub(super) fn times_s(&self) -> &[f64] {
        &self.columns[0]
    }

    /// Takes the column of this name; empty if the table does not have it.
    pub(super) fn take(&mut self, name: &str) -> Vec<f64> {
        let place = self.names.iter().position(|own| own == name);
        place.map(|place| std::mem::take(&mut self.columns[place])).unwrap_or_default()
    }

    /// Refuses uneven times, and too few times.
    pub(super) fn check_even(&self) -> Result<(), TableError> {
        let rows = self.lines.len();
        if rows < 2 {
            return Err(self.refuse(None, "rows", &rows.to_string(), "must be two or more"));
        }
        TimeGrid::through(self.times_s()).map(drop).map_err(|error| {
            let place = Place { file: &self.shown, line: Some(self.lines[error.sample]) };
            place.refuse_whole(&error.to_string())
        })
    }

    /// Refuses times other than every `every`-th of `times_s`, the times of the file `of`.
    pub(super) fn check_times(
        &self,
        (of, times_s): (&str, &[f64]),
        every: usize,
    ) -> Result<(), TableError> {
        let (found, expected) = (self.lines.len(), times_s.len().div_ceil(every));
        if found != expected {
            let must = format!("must be {expected}, as {of} has it: {ONE_RUN}");
            return Err(self.refuse(None, "rows", &found.to_string(), &must));
        }
        let pairs = self.times_s().iter().zip(times_s.iter().step_by(every));
        for (row, (found_s, expected_s)) in pairs.enumerate() {
            if !is_same_time(*found_s, *expected_s, times_s) {
                let must = format!("must be {expected_s} s as in {of}: {ONE_RUN}");
                return Err(self.refuse(Some(row), TIME, &format!("{found_s} s"), &must));
            }
        }
        Ok(())
    }

    pub(super) fn refuse(
        &self,
        row: Option<usize>,
        subject: &str,
        found: &str,
        must: &str,
    ) -> TableError {
        let line = row.map(|row| self.lines[row]);
        Place { file: &self.shown, line }.refuse(subject, found, must)
    }
}

/// Whether two times in s are equal, on a grid of these times.
fn is_same_time(a_s: f64, b_s: f64, grid_s: &[f64]) -> bool {
    /// Accuracy of written times: each is within 1e-12 s.
    const ROUNDING_S: f64 = 2.1e-12;
    let step_s = grid_s.get(1).map_or(0.0, |second| second - grid_s[0]);
    (a_s - b_s).abs() <= (TIME_TOLERANCE * step_s).max(ROUNDING_S)
}

/// Refuses duplicate names, and names that do not begin with the time.
fn check_columns(fields: &[&str], place: Place) -> Result<(), TableError> {
    check_separator(fields, place)?;
    if !fields.contains(&TIME) {
        return Err(refuse_missing(fields, TIME, place));
    }
    if fields[0] != TIME {
        return Err(place.refuse_column(0, fields[0], format!("must be {TIME}")));
    }
    for (index, field) in fields.iter().enumerate() {
        if let Some(earlier) = fields[..index].iter().position(|earlier| earlier == field) {
            let must = format!("must not repeat column {}", earlier + 1);
            return Err(place.refuse_column(index, fields[index], must));
        }
    }
    Ok(())
}

/// The finite number in a field of the column of this name.
pub(super) fn read_number(name: &str, field: &str, place: Place) -> Result<f64, TableError> {
    let finite = "must be a finite number";
    if field.is_empty() {
        return Err(place.refuse(name, "an empty field", finite));
    }
    match field.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(place.refuse(name, field, finite)),
        Err(_) => Err(place.refuse(name, quoted(field), "must be a number")),
    }
}

/// Reads a table at nodes: one entry for each link and each letter of the file. `nodes` counts the nodes of each
/// link, and the run may have written only some `chosen` ones. Rows may be thinned: every k-th of `times_s`, the
/// times of the file `of`. The table of a single link may lack nodes, unlike an arm's.
pub(super) fn read_nodal(
    file: &InputFile,
    nodal: &NodalFile,
    (form, nodes, is_chosen): (Form, &[usize], bool),
    (of, times_s): (&str, &[f64]),
) -> Result<Vec<Vec<StoredNodes>>, TableError> {
    let (links, letters) = (nodes.len(), nodal.letters(form).len());
    let column = |link, letter, node| nodal.column(form, link, letter, node);
    let mut places = BTreeMap::new();
    for (link, count) in nodes.iter().enumerate() {
        for (node, letter) in (0..*count).flat_map(|node| (0..letters).map(move |own| (node, own)))
        {
            places.insert(column(link, letter, node), (link, letter, node));
        }
    }
    let check = |fields: &[&str], place: Place| {
        let last = column(links - 1, letters - 1, nodes[links - 1] - 1);
        let must = format!("must be of a node, {} to {last}", column(0, 0, 0));
        if fields.len() < 2 {
            return Err(place.refuse("columns", "the time alone", must));
        }
        let stray = (1..fields.len()).find(|index| !places.contains_key(fields[*index]));
        if let Some(index) = stray {
            return Err(place.refuse_column(index, fields[index], must));
        }
        let mut all: Vec<_> = places.iter().collect();
        all.sort_by_key(|(_, place)| **place);
        let missing = all.into_iter().find(|(name, _)| !fields.contains(&name.as_str()));
        let Some((name, _)) = missing.filter(|_| links > 1) else { return Ok(()) };
        let error = refuse_missing(fields, name, place);
        Err(if is_chosen { error.with_hint(ALL_NODES.to_owned()) } else { error })
    };
    let mut table = Table::read(file, check)?;
    table.check_times((of, times_s), stride(table.times_s(), times_s))?;
    let times_s = table.take(TIME);
    let mut columns: Vec<_> = table
        .names
        .iter()
        .zip(table.columns)
        .filter_map(|(name, values)| Some((*places.get(name)?, values)))
        .collect();
    columns.sort_by_key(|((_, _, node), _)| *node);
    let empty = StoredNodes { nodes: vec![], times_s, histories: vec![] };
    let mut found = vec![vec![empty; letters]; links];
    for ((link, letter, node), values) in columns {
        found[link][letter].nodes.push(node);
        found[link][letter].histories.push(values);
    }
    Ok(found)
}

/// Hint for a table without all nodes of an arm.
const ALL_NODES: &str =
    "the page draws all nodes of an arm: solve it without --nodes and --stations";

/// Number of times of a run for each row of a table.
pub(super) fn stride(own_s: &[f64], times_s: &[f64]) -> usize {
    match own_s.get(1) {
        Some(second) => times_s
            .iter()
            .skip(1)
            .position(|time| is_same_time(*second, *time, times_s))
            .map_or(1, |k| k + 1),
        None => times_s.len(),
    }
}

/// Deflections `w = v − xθ` of displacements: θ is the hub angle of the run in rad at `times_s`, less `origin_rad`,
/// the angle of zero displacement; of a carriage `w = v − u`.
pub(super) fn deflections(
    mut displacements: StoredNodes,
    mesh: &Mesh,
    (hub_angle_rad, origin_rad): (&[f64], f64),
    times_s: &[f64],
) -> StoredNodes {
    let every = stride(&displacements.times_s, times_s);
    for (node, history) in displacements.nodes.iter().zip(&mut displacements.histories) {
        let rigid = mesh.rigid(*node)[0];
        for (value, angle) in history.iter_mut().zip(hub_angle_rad.iter().step_by(every)) {
            *value -= rigid * (angle - origin_rad);
        }
    }
    displacements
}

/// Reads nodes.csv: for each link the distances of its nodes from its joint in m.
pub(super) fn read_nodes(file: &InputFile, form: Form) -> Result<Vec<Vec<f64>>, TableError> {
    let at = |line| Place { file: &file.shown, line: Some(line) };
    let names = node_columns(form);
    let begin = |line, fields: &[&str]| {
        if fields == names {
            return Ok(Vec::<Vec<f64>>::new());
        }
        let must = format!("must be {}", quoted(&names.join(",")));
        Err(at(line).refuse("columns", quoted(&fields.join(",")), must))
    };
    let push = |nodes_m: &mut Vec<Vec<f64>>, line, fields: &[&str]| {
        at(line).check_width(fields.len(), names.len())?;
        // A single link has no number.
        let numbered = fields.len() - 2;
        let (numbers, x_m) = (&fields[..numbered], fields[numbered]);
        if nodes_m.is_empty() || numbers.get(1) == Some(&"0") {
            nodes_m.push(Vec::new());
        }
        let next = [nodes_m.len(), nodes_m.last().map_or(0, Vec::len)].map(|own| own.to_string());
        let next = &next[next.len() - numbered..];
        for ((name, found), must) in names.iter().zip(numbers).zip(next) {
            if found != must {
                return Err(at(line).refuse(*name, quoted(found), format!("must be {must}")));
            }
        }
        let x_m = read_number("x_m", x_m, at(line))?;
        nodes_m.last_mut().into_iter().for_each(|own| own.push(x_m));
        Ok(())
    };
    Ok(read_rows(&file.shown, &file.bytes, begin, push)?.unwrap_or_default())
}

/// Refuses a torque unless its times are those of the summary.
pub(super) fn check_window(torque: &Table, summary: &Summary) -> Result<(), TableError> {
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

/// Times in s rounded as in tables.
pub(super) fn times_s(grid: &ThinnedGrid) -> Vec<f64> {
    let format = time_format(|k| grid.time_s(k), grid.len());
    let written = |k: usize| {
        let mut text = Vec::new();
        format.write(&mut text, grid.time_s(k));
        std::str::from_utf8(&text).ok().and_then(|text| text.parse().ok())
    };
    (0..grid.len()).map(|k| written(k).unwrap_or(grid.time_s(k))).collect()
}
