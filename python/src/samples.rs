//! The samples of a wanted motion in a call, and the problem that they pose.

use pyo3::types::PyString;

use flexlink::cli::options::inputs::{MotionArgs, Wanted};
use flexlink::cli::options::reading::TableName;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::csv::{InputFile, MotionTable, Reading, read_motion_table_as};
use flexlink::link::Arm;
use flexlink::motion::{MotionColumns, PathColumn, PathColumns, Recording};
use flexlink::spec::Specification;

use crate::arrays::{column, dictionary, places};
use crate::keywords::{OF_LINK, OF_TIP, take};
use crate::messages::of_reading;
use crate::prelude::*;

/// Name of samples without a file in messages.
pub(crate) const MOTION: &str = "motion";

/// The samples of a motion in a call: a file, or columns by name with `time` as the first.
pub(crate) enum Samples {
    File(InputFile),
    Arrays(Vec<(String, Vec<f64>)>),
}

impl Samples {
    /// Takes the samples of one link or of an arm out of the keywords; `time` may be the path of a file instead.
    pub(crate) fn take(time: &Any<'_>, keywords: &Keywords<'_>, links: usize) -> Raises<Self> {
        let mut columns = Vec::new();
        for name in names(links) {
            let Some(values) = take(keywords, &name)? else { continue };
            let is_derivative = ["acceleration", "velocity"].contains(&&*name);
            let read = if is_derivative { column } else { places };
            columns.push((name.clone(), read(&name, &values)?));
        }
        match (path_of(time)?, columns.first()) {
            (Some(_), Some((name, _))) => {
                let message = format!("{name} stands beside a file");
                Err(usage(&message, Some("leave one of them out")).into())
            }
            (Some(path), None) => Ok(Self::File(InputFile::read(&path).map_err(Failure::from)?)),
            (None, _) => {
                columns.insert(0, ("time".to_owned(), column("time", time)?));
                Ok(Self::Arrays(columns))
            }
        }
    }

    /// The samples of a column.
    fn array(&self, name: &str) -> Option<Vec<f64>> {
        let Self::Arrays(columns) = self else { return None };
        columns.iter().find(|(own, _)| own == name).map(|(_, values)| values.clone())
    }

    /// The table of the motion of links with these lengths.
    pub(crate) fn table(&self, lengths_m: &[f64], options: &MotionArgs) -> Fails<MotionTable> {
        if let Self::File(InputFile { shown, bytes, .. }) = self {
            return Ok(read_motion_table_as(shown, bytes, lengths_m, &options.format())?);
        }
        refuse_reading(options)?;
        let time_s = self.array("time").unwrap_or_default();
        match lengths_m {
            [length_m] => self.tip(time_s, *length_m),
            _ => self.path(time_s, lengths_m),
        }
    }

    fn tip(&self, time_s: Vec<f64>, length_m: f64) -> Fails<MotionTable> {
        let [acceleration_m_s2, velocity_m_s, displacement_m, angle_rad] =
            OF_LINK.map(|name| self.array(name));
        let columns = MotionColumns { time_s, acceleration_m_s2, velocity_m_s, displacement_m };
        match (angle_rad, self) {
            (Some(_), Self::Arrays(columns)) if columns.len() > 2 => {
                let hint = "an angle stands for the displacement, and has no columns beside it";
                Err(usage(&"angle stands beside another column", Some(hint)))
            }
            (Some(angle), _) => {
                Ok(MotionTable::of_angle(MOTION, columns.time_s, &angle, length_m)?)
            }
            (None, _) => Ok(MotionTable::of_columns(MOTION, columns)?),
        }
    }

    fn path(&self, time_s: Vec<f64>, lengths_m: &[f64]) -> Fails<MotionTable> {
        let column = |name: String| {
            let recording = Recording::default();
            self.array(&name).map(|values| PathColumn { name, values, recording })
        };
        let tip = match OF_TIP.map(|name| column(name.to_owned())) {
            [Some(x), Some(y)] => Some([x, y]),
            [None, None] => None,
            _ => return Err(usage(&"x and y must come together", None)),
        };
        let angles = (1..=lengths_m.len()).map(|link| column(angle(link))).collect();
        let carriage = column("carriage".to_owned());
        let columns = PathColumns { time_s, tip, angles, carriage };
        Ok(MotionTable::of_path(MOTION, columns, lengths_m)?)
    }

    /// The wanted motion of an arm, and remarks on its file.
    pub(crate) fn wanted(&self, arm: &Arm, options: &MotionArgs) -> Fails<(Wanted, Vec<Notice>)> {
        let table = self.table(&arm.lengths_m(), options)?;
        let wanted = options.scale.scaled(&options.motion_in(table, Some(arm))?)?;
        let reading = self.remarks(&wanted.reading);
        Ok((wanted, reading))
    }

    pub(crate) fn remarks(&self, reading: &Reading) -> Vec<Notice> {
        of_reading(self.file().map_or(MOTION, |file| &file.shown), reading)
    }

    pub(crate) fn file(&self) -> Option<&InputFile> {
        if let Self::File(file) = self { Some(file) } else { None }
    }

    /// The arguments for `unpickled`.
    pub(crate) fn pickled<'py>(&self, py: Python<'py>) -> PyResult<Pickled<'py>> {
        Ok(match self {
            Self::File(InputFile { shown, name, bytes }) => {
                (Some((shown.clone(), name.clone(), bytes.clone())), PyDict::new(py))
            }
            Self::Arrays(columns) => (None, dictionary(py, columns.iter().cloned())?),
        })
    }

    pub(crate) fn unpickled((file, columns): Pickled<'_>) -> PyResult<Self> {
        let columns = columns.iter().map(|(name, values)| {
            let name: String = name.extract()?;
            Ok((name.clone(), column(&name, &values)?))
        });
        Ok(match file {
            Some((shown, name, bytes)) => Self::File(InputFile { shown, name, bytes }),
            None => Self::Arrays(columns.collect::<PyResult<_>>()?),
        })
    }
}

/// A motion in a pickle: the shown path, the name and the bytes of its file, or its columns.
pub(crate) type Pickled<'py> = (Option<(String, String, Vec<u8>)>, Bound<'py, PyDict>);

/// Names of the columns of a motion of this many links.
fn names(links: usize) -> Vec<String> {
    if links == 1 {
        return OF_LINK.map(str::to_owned).to_vec();
    }
    let names = OF_TIP.map(str::to_owned).into_iter().chain((1..=links).map(angle));
    names.chain(["carriage".to_owned()]).collect()
}

/// Name of the direction of a link, counted from 1.
fn angle(link: usize) -> String {
    format!("angle{link}")
}

/// Refuses options for reading files if the samples are arrays in SI.
fn refuse_reading(options: &MotionArgs) -> Fails<()> {
    let refused = |option: &str, hint| {
        Err(usage(&format!("{option} is for files, and the motion is arrays"), Some(hint)))
    };
    if options.format().drop_outliers {
        let hint = "the refusal of a bad sample gives its number and what its neighbours lead to";
        return refused("drop_outliers", hint);
    }
    let given = options.read.options_of(TableName::Motion, TableName::Motion);
    let of_file = given.into_iter().find(|option| *option != "--resample");
    of_file.map_or(Ok(()), |option| refused(option, "arrays are in SI; multiply them"))
}

/// A table in a call: its file, or a file of the columns in a dictionary, with their names. True for a file.
pub(crate) fn table_of(name: &str, value: &Any<'_>) -> Raises<(InputFile, bool)> {
    if let Some(path) = path_of(value)? {
        return Ok((InputFile::read(&path).map_err(Failure::from)?, true));
    }
    let Ok(columns) = value.cast::<PyDict>() else {
        let must = "must be the path of a file, or a dictionary of its columns";
        return Err(
            PyTypeError::new_err(format!("{name} = {}, but {must}", value.get_type())).into()
        );
    };
    let mut texts = Vec::new();
    for (key, values) in columns {
        let key: String = key.extract()?;
        let numbers = column(&format!("{name}: {key}"), &values)?;
        texts.push((key, numbers));
    }
    let rows = texts.first().map_or(0, |(_, numbers)| numbers.len());
    if let Some((key, numbers)) = texts.iter().find(|(_, numbers)| numbers.len() != rows) {
        let (found, first) = (numbers.len(), &texts[0].0);
        let message = format!("{name}: {key} has {found} rows, but must have {rows}, as {first}");
        return Err(usage(&message, None).into());
    }
    let headings: Vec<&str> = texts.iter().map(|(key, _)| key.as_str()).collect();
    let row = |k: usize| texts.iter().map(|(_, own)| format!("{:?}", own[k])).collect::<Vec<_>>();
    let lines = [headings.join(",")].into_iter().chain((0..rows).map(|k| row(k).join(",")));
    let bytes = lines.collect::<Vec<_>>().join("\n").into_bytes();
    Ok((InputFile { shown: name.to_owned(), name: name.to_owned(), bytes }, false))
}

/// The path in a text or a path-like object.
pub(crate) fn path_of(value: &Any<'_>) -> PyResult<Option<PathBuf>> {
    let is_path = value.is_instance_of::<PyString>() || value.hasattr("__fspath__")?;
    is_path.then(|| value.extract()).transpose()
}

/// Gives a specification nodes at the stations of the options; of one link, an analysis for all tables.
pub(crate) fn meshed(
    mut specification: Specification,
    options: &SolveOptions,
) -> Fails<Specification> {
    let Specification { arm, meshes, analysis, .. } = &mut specification;
    options.nodes.meshes(arm, meshes)?;
    if arm.links().len() == 1 {
        *analysis = options.analysis(analysis);
    }
    Ok(specification)
}
