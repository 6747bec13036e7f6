//! The travel of the tip, and the path of an arm's tip.

use std::fmt::Display;

use clap::{Args, ValueEnum};

use crate::cli::options::common::{angle_rad, metres};
use crate::cli::terminal::{Exit, Failure, console};
use crate::csv::{TableFormat, read_motion_table_as};
use crate::inverse::{InversionError, SolutionWarning, check_reach};
use crate::motion::{ArmPath, Curve};
use crate::spec::Specification;
use crate::text::plain;

const PATHS: &str = "Paths of arms";

/// Travel of the tip.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Travel {
    /// Along its arc, in m.
    Length(f64),
    /// Along the arc of a link that turns by this angle in rad.
    Angle(f64),
    /// To a place in the plane, x and y in m.
    Place(Place),
}

/// A travel, or a place.
fn stop(text: &str) -> Result<Travel, String> {
    if text.contains(',') { place(text).map(Travel::Place) } else { travel(text) }
}

pub(super) fn travel(text: &str) -> Result<Travel, String> {
    let length = metres(text).map(Travel::Length);
    let travel = length.or_else(|_| angle_rad(text).map(Travel::Angle));
    travel.map_err(|_| "must be a length, 0.5 or '65.8 cm', or an angle, '90 deg'".to_owned())
}

impl Travel {
    fn place(&self) -> Result<Place, Failure> {
        if let Self::Place(place) = self {
            return Ok(*place);
        }
        let message = "--via = a travel, but must be a place, x and y, with --path";
        Err(Failure::new(Exit::Usage, &message, Some("write it like --via 0.5,0.2")))
    }
}

/// Where the tip of an arm goes.
#[derive(Debug, Args)]
pub struct PathArgs {
    /// Make the path of an arm's tip in its plane instead, a CSV of time, x and y: along a line or an arc.
    #[arg(long, help_heading = PATHS, value_name = "CURVE", value_enum, requires = "from")]
    #[arg(conflicts_with = "distance")]
    path: Option<Kind>,

    /// Start of the path, in m or with units: '0.9,-0.5' or '0.9 m,-500 mm'.
    #[arg(long, help_heading = PATHS, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    #[arg(requires = "path")]
    from: Option<Place>,

    /// End of a line.
    #[arg(long, help_heading = PATHS, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    #[arg(requires = "path", required_if_eq("path", "line"))]
    to: Option<Place>,

    /// Intermediate stop, repeatable, in order: for a link the travel of the tip from its start, as --distance; for a
    /// line of --path a place, '0.5,0.2', where the tip stops unless --corner rounds it.
    #[arg(long, value_name = "STOP", value_parser = stop, allow_hyphen_values = true)]
    via: Vec<Travel>,

    /// Round the corners at --via, from this length before each to as much after it, in m or with its unit:
    /// with continuous curvature, and without a stop.
    #[arg(long, help_heading = PATHS, value_name = "LENGTH", value_parser = metres, allow_hyphen_values = true)]
    #[arg(requires = "via")]
    corner: Option<f64>,

    /// Centre of an arc.
    #[arg(long, help_heading = PATHS, value_name = "X,Y", value_parser = place, allow_hyphen_values = true)]
    #[arg(requires = "path", required_if_eq("path", "arc"))]
    center: Option<Place>,

    /// Angle of an arc in rad or with its unit, counterclockwise, clockwise below 0; it may exceed a turn.
    #[arg(long, help_heading = PATHS, value_name = "ANGLE", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(requires = "path", required_if_eq("path", "arc"))]
    angle: Option<f64>,

    /// Constant directions of the links from the third on, in rad or with units: '30 deg' or '30 deg,-1'.
    #[arg(long, help_heading = PATHS, value_name = "ANGLES", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(value_delimiter = ',', requires = "path")]
    angles: Vec<f64>,

    /// Move the carriage of the arm along, between two places on its rail in m or with units, '0.2,1', or from 0 to one, as
    /// the column carriage: at each time it has made the same share of its way as the tip.
    #[arg(long, help_heading = PATHS, value_name = "FROM,TO", value_parser = carriage, allow_hyphen_values = true)]
    #[arg(requires = "path")]
    carriage: Option<Place>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    Line,
    Arc,
}

/// x and y in m.
type Place = [f64; 2];

fn place(text: &str) -> Result<Place, String> {
    let must = || "must be x and y with a comma between them: 0.9,-0.5".to_owned();
    let (x, y) = text.split_once(',').ok_or_else(must)?;
    if y.contains(',') {
        return Err(must());
    }
    Ok([metres(x)?, metres(y)?])
}

/// Places of a carriage at both ends.
fn carriage(text: &str) -> Result<Place, String> {
    match text.split(',').collect::<Vec<_>>()[..] {
        [to] => Ok([0.0, metres(to)?]),
        [from, to] => Ok([metres(from)?, metres(to)?]),
        _ => Err("must be one place, or FROM,TO: 0,0.8".to_owned()),
    }
}

impl PathArgs {
    pub(super) fn is_given(&self) -> bool {
        self.path.is_some()
    }

    /// True if the tip stops before the end.
    pub(super) fn stops(&self) -> bool {
        !self.via.is_empty() && (self.corner.is_none() || self.path.is_none())
    }

    /// The first option that needs the missing --path.
    pub(super) fn without_path(&self) -> Option<&'static str> {
        let given = [
            (self.from.is_some(), "--from"),
            (self.to.is_some(), "--to"),
            (self.corner.is_some(), "--corner"),
            (self.center.is_some(), "--center"),
            (self.angle.is_some(), "--angle"),
            (!self.angles.is_empty(), "--angles"),
            (self.carriage.is_some(), "--carriage"),
        ];
        let first = given.into_iter().find(|(is_given, _)| *is_given);
        first.filter(|_| self.path.is_none()).map(|(_, option)| option)
    }

    /// Stops of a link's tip.
    pub(super) fn travels(&self) -> impl Iterator<Item = Travel> {
        self.via.iter().copied()
    }

    /// The curve of the options; `None` without --path.
    pub(crate) fn curve(&self) -> Result<Option<Curve>, Failure> {
        // The parser has checked that the options of a curve are complete.
        let (Some(kind), Some(from_m)) = (self.path, self.from) else { return Ok(None) };
        let given = |option: &'static str, is_given: bool| is_given.then_some(option);
        let others = match kind {
            Kind::Line => [
                given("--center", self.center.is_some()),
                given("--angle", self.angle.is_some()),
                None,
            ],
            Kind::Arc => [
                given("--to", self.to.is_some()),
                given("--via", !self.via.is_empty()),
                given("--corner", self.corner.is_some()),
            ],
        };
        if let Some(option) = others.into_iter().flatten().next() {
            let (own, other) = match kind {
                Kind::Line => ("line", "arc"),
                Kind::Arc => ("arc", "line"),
            };
            let message = format!("{option} belongs to --path {other}, not to --path {own}");
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        let curve = match kind {
            Kind::Arc => {
                Curve::arc(from_m, self.center.unwrap_or(from_m), self.angle.unwrap_or_default())
            }
            Kind::Line => {
                let via = self.via.iter().map(Travel::place).collect::<Result<Vec<_>, _>>()?;
                let points: Vec<Place> =
                    [from_m].iter().chain(&via).chain(&self.to).copied().collect();
                match self.corner {
                    Some(reach_m) => Curve::rounded(&points, reach_m),
                    None => Curve::through(&points),
                }
            }
        };
        let curve = curve.map(|curve| Some(curve.with_carriage(self.carriage)));
        curve.map_err(|error| refused(&error, error.hint()))
    }

    /// Constant directions in rad of the links from the third on.
    pub(super) fn outer_rad(&self) -> &[f64] {
        &self.angles
    }
}

/// Refuses the curve or its times.
pub(super) fn refused(error: &dyn Display, hint: Option<&str>) -> Failure {
    Failure::new(Exit::Usage, &format!("--path: {error}"), hint)
}

/// Refuses a written path that `solve` would not begin to solve, and names its row. Prints the warning of an elbow
/// that is nearly stretched or folded, and returns the number of warnings.
pub(super) fn reached(written: &[u8], arm: &Specification) -> Result<usize, Failure> {
    let (lengths_m, format) = (arm.arm.lengths_m(), TableFormat::default());
    let table = read_motion_table_as("--path", written, &lengths_m, &format)?;
    let columns = table.path_columns().cloned().unwrap_or_default();
    let time_s = columns.time_s.clone();
    let refused = |sample: Option<usize>, error: &dyn Display, hint: Option<&str>| {
        let place = sample.map_or(String::new(), |sample| {
            format!("row {}, at {} s: ", sample + 1, plain(time_s[sample]))
        });
        Failure::new(Exit::InputRefused, &format!("--path: {place}{error}"), hint)
    };
    let path = ArmPath::new(columns, &lengths_m)
        .map_err(|error| refused(error.sample(), &error, error.hint()))?;
    let warning = check_reach(&arm.arm, &path).map_err(|error| {
        let is_far = path.has_carriage()
            && matches!(
                error,
                InversionError::OutOfReach { .. } | InversionError::Stretched { .. }
            );
        let of_carriage = if is_far { ", or other places of --carriage" } else { "" };
        let hint = error.hint().map(|hint| format!("{hint}{of_carriage}"));
        refused(error.sample(), &error, hint.as_deref())
    })?;
    console::warnings(warning.map(SolutionWarning::from));
    Ok(usize::from(warning.is_some()))
}
