//! The samples of a wanted motion in a call, and the problem that they pose.

use pyo3::types::PyString;

use flexlink::cli::options::common::refuse_for_arms;
use flexlink::cli::problem::Problem;
use flexlink::cli::solve::run::SolveOptions;
use flexlink::csv::{self, InputFile, MotionTable, PathTable, read_motion_table_as};
use flexlink::link::Arm;
use flexlink::motion::{
    MotionColumns, MotionError, MotionScale, PathColumn, PathColumns, Recording, TipMotion,
};
use flexlink::spec::ArmSpecification;

use crate::arrays::{column, dictionary, places};
use crate::keywords::{OF_LINK, OF_TIP, take};
use crate::messages::of_reading;
use crate::prelude::*;

/// Name of samples without a file in messages.
const MOTION: &str = "motion";

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

    /// The table of the tip of a link of this length.
    pub(crate) fn table(&self, length_m: f64, options: &SolveOptions) -> Fails<MotionTable> {
        if let Self::File(InputFile { shown, bytes, .. }) = self {
            let format = options.resample.format(&options.read);
            return Ok(read_motion_table_as(shown, bytes, length_m, &format)?);
        }
        refuse_reading(options)?;
        let time_s = self.array("time").unwrap_or_default();
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

    /// The table of the path of an arm of this many links.
    fn path(&self, links: usize, options: &SolveOptions) -> Fails<PathTable> {
        if let Self::File(file) = self {
            return options.resample.path_of(file, &options.read);
        }
        refuse_reading(options)?;
        let column = |name: &str| {
            let (name, recording) = (name.to_owned(), Recording::default());
            self.array(&name).map(|values| PathColumn { name, values, recording })
        };
        let tip = match OF_TIP.map(column) {
            [Some(x), Some(y)] => Some([x, y]),
            [None, None] => None,
            _ => return Err(usage(&"x and y must come together", None)),
        };
        let time_s = self.array("time").unwrap_or_default();
        let angles = (1..=links).map(|link| column(&angle(link))).collect();
        let table = PathTable::of_columns(MOTION, PathColumns { time_s, tip, angles })?;
        options.resample.path_in(table)
    }

    /// The wanted motion of an arm, and remarks on its file.
    pub(crate) fn wanted(&self, arm: &Arm, options: &SolveOptions) -> Reading {
        let SolveOptions { resample, scale, .. } = options;
        if let [own] = arm.links() {
            let table = self.table(own.link.length_m(), options)?;
            let reading = self.remarks(table.reading());
            let motion = scale.scaled(resample.motion_in(table, &own.link)?)?;
            return Ok((Wanted::Tip(Box::new(motion)), reading));
        }
        refuse_for_arms([resample.of_one_link(), scale.of_one_link()].concat())?;
        let table = self.path(arm.links().len(), options)?;
        Ok((Wanted::Path(Box::new(scale.scaled_path(&table)?)), self.remarks(table.reading())))
    }

    pub(crate) fn remarks(&self, reading: &csv::Reading) -> Vec<Notice> {
        self.file().map_or_else(Vec::new, |file| of_reading(&file.shown, reading))
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
    match links {
        1 => OF_LINK.map(str::to_owned).to_vec(),
        _ => OF_TIP.map(str::to_owned).into_iter().chain((1..=links).map(angle)).collect(),
    }
}

/// Name of the direction of a link, counted from 1.
fn angle(link: usize) -> String {
    format!("angle{link}")
}

/// The motion of one link's tip, or the path of an arm.
#[derive(Clone)]
pub(crate) enum Wanted {
    Tip(Box<TipMotion>),
    Path(Box<PathTable>),
}

/// The wanted motion of a link or an arm, and remarks on its file.
pub(crate) type Reading = Fails<(Wanted, Vec<Notice>)>;

impl Wanted {
    pub(crate) fn scaled(&self, scale: MotionScale) -> Result<Self, MotionError> {
        Ok(match self {
            Self::Tip(motion) => Self::Tip(Box::new(motion.scaled(scale)?)),
            Self::Path(path) => Self::Path(Box::new(path.slowed(scale.duration)?)),
        })
    }

    /// The motion as a problem of a link or an arm from a file.
    pub(crate) fn problem(self, file: &InputFile, arm: ArmSpecification) -> Fails<Problem> {
        match self {
            Self::Tip(motion) => Ok(Problem::of_link(MOTION, arm, *motion)),
            Self::Path(path) => Problem::of_arm(file, arm, *path),
        }
    }
}

/// Refuses options for reading files if the samples are arrays in SI.
fn refuse_reading(options: &SolveOptions) -> Fails<()> {
    let refused = |option: &str, hint| {
        let option = option.split('=').next().unwrap_or_default();
        Err(usage(&format!("{option} is for files, and the motion is arrays"), Some(hint)))
    };
    if options.resample.format(&options.read).drop_outliers {
        let hint = "the refusal of a bad sample gives its number and what its neighbours lead to";
        return refused("drop_outliers", hint);
    }
    let arguments = options.read.arguments();
    arguments.first().map_or(Ok(()), |option| refused(option, "arrays are in SI; multiply them"))
}

/// The path in a text or a path-like object.
pub(crate) fn path_of(value: &Any<'_>) -> PyResult<Option<PathBuf>> {
    let is_path = value.is_instance_of::<PyString>() || value.hasattr("__fspath__")?;
    is_path.then(|| value.extract()).transpose()
}

/// Gives a specification nodes at the stations of the options; of one link, an analysis for all tables.
pub(crate) fn meshed(
    mut specification: ArmSpecification,
    options: &SolveOptions,
) -> Fails<ArmSpecification> {
    let ArmSpecification { arm, meshes, analysis, .. } = &mut specification;
    match arm.links() {
        [own] => {
            meshes[0] = options.nodes.mesh(&own.link, meshes[0].clone())?;
            *analysis = options.analysis(analysis);
        }
        _ => options.nodes.meshes(arm, meshes)?,
    }
    Ok(specification)
}
