//! `frf`: the frequency response of a link.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;

use flexlink::beam::Mesh;
use flexlink::csv::Digits;
use flexlink::modal::natural_frequencies;
use flexlink::model::{FrequencyResponse, ModelError, changes_on_halves, model_of};
use flexlink::response::{ArmModes, ArmResponses};
use flexlink::result::BandMeshError;
use flexlink::spec::{Described, Specification};
use flexlink::store::{
    ResponseColumns, arm_response, frequency_response_json, link_response, write_frequency_response,
};
use flexlink::text::{given, significant};

use super::arm_pose::ArmInPose;
use crate::options::common::angle_rad;
use crate::options::inputs::{LinkArgs, warn_of_gravity};
use crate::terminal::files::keep_files;
use crate::terminal::{Exit, Failure, StageBar, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink frf link.toml --from 0.1 --to 50 -o frf.csv
  flexlink frf arm.toml --at '30 deg,75 deg' -o frf.csv";

/// Bytes that a row takes besides itself while its fourteen columns are written, as measured.
const ROW_BYTES: usize = 160;

/// Natural frequencies that the default range of frequencies is around.
const DEFAULT_MODES: usize = 5;

/// Bytes that one transfer of an arm takes at one frequency: twice as it is found, and as it is written.
const RESPONSE_BYTES: usize = 64 + 80;

/// Bytes that a run takes besides its rows.
const OWN_BYTES: usize = 16 << 20;

/// Frequency response of a link: torque per tip acceleration, hub angle per tip displacement, tip
/// displacement per torque.
///
/// Writes a CSV with real and imaginary part, magnitude and phase of each, to standard output or a file,
/// and the mesh error of each row: by how much elements of half the length change it, over its magnitude.
/// The largest mesh error is printed, above 1 % as a warning. An automatic mesh is refined until it follows
/// the highest frequency to mesh.tolerance.
///
/// For an arm of several links, about its shape at rest where the links point in the directions of --at: displacement of
/// the tip along x and y, in 1/N, and angle of each joint, in rad/(N m), per torque of each joint. The mesh error
/// is then by how much polynomials of higher order change the displacement and the angles, over their size.
#[derive(Debug, Args)]
#[command(about = "Frequency response of a link", after_help = EXAMPLE)]
pub(crate) struct Frf {
    #[command(flatten)]
    link: LinkArgs,

    /// Of an arm: the directions of all its links, from joint to joint, the inner one first, in rad or with
    /// their unit, as in '30 deg,75 deg'.
    #[arg(long, value_name = "ANGLES", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(value_delimiter = ',')]
    pub(crate) at: Option<Vec<f64>>,

    /// Lowest frequency [default: a tenth of the first natural frequency].
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    from: Option<f64>,

    /// Highest frequency [default: twice the fifth natural frequency].
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    to: Option<f64>,

    /// Number of frequencies.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = crate::options::common::positive)]
    points: usize,

    /// Space the frequencies evenly rather than by a constant factor.
    #[arg(long)]
    linear: bool,

    /// File to write [default: standard output].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Digits: the last one is 10^-N of a column's peak, or `full` for the shortest text that
    /// reads back to the same number.
    #[arg(long, value_name = "N", default_value = "full")]
    digits: Digits,

    /// Write JSON instead of CSV, a list for each column, with all digits.
    #[arg(long, conflicts_with = "digits")]
    json: bool,

    #[command(flatten)]
    warnings: WarningArgs,
}

/// Frequencies whose fourth powers are numbers.
const FREQUENCIES_HZ: RangeInclusive<f64> = 1e-70..=1e70;

impl Frf {
    pub(crate) fn run(self) -> Result<(), Failure> {
        if let Some(output) = &self.output {
            keep_files(output, &[&self.link.link])?;
        }
        let specification = match self.link.described()? {
            Described::Link(own) => own,
            Described::Arm(arm) => {
                let pose = ArmInPose::of(arm, self.at.as_deref())?;
                return self.warnings.refuse(self.tell_arm(&pose)?);
            }
        };
        if self.at.is_some() {
            let message = "--at is for an arm of several links, and the file has one";
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        let bar = StageBar::new();
        bar.at("computing responses");
        let (rows, errors) = self.compute(&specification)?;
        drop(bar);
        self.deliver(link_response(&rows, errors.as_deref()))?;
        let warnings = tell(&rows, errors.as_deref()) + warn_of_gravity(&specification.link);
        self.warnings.refuse(warnings)
    }

    fn deliver(&self, columns: ResponseColumns) -> Result<(), Failure> {
        let output = self.output.as_deref();
        if self.json {
            let text = frequency_response_json(columns);
            return console::deliver(output, text.as_bytes());
        }
        let digits = self.digits;
        console::deliver_by(output, |out| write_frequency_response(out, &columns, digits))
    }

    /// Writes the response of an arm; returns the number of warnings.
    fn tell_arm(&self, pose: &ArmInPose) -> Result<usize, Failure> {
        let bar = StageBar::new();
        bar.at("computing responses");
        let (modes, found) = self.compute_arm(pose)?;
        drop(bar);
        self.deliver(arm_response(&found))?;
        Ok(pose.tell_responses(&modes, &found))
    }

    /// The modes of an arm, and its response.
    pub(crate) fn compute_arm(
        &self,
        pose: &ArmInPose,
    ) -> Result<(ArmModes, ArmResponses), Failure> {
        let modes = pose.modes(DEFAULT_MODES)?;
        let squares = modes.free.modes.iter().map(|mode| mode.square_per_s2);
        let rising: Vec<f64> = squares.filter(|own| *own > 0.0).map(f64::sqrt).collect();
        let (from_hz, to_hz) = self.range_hz(&rising)?;
        let joints = modes.directions_rad.len();
        let bytes = RESPONSE_BYTES * joints * (joints + 2);
        let bytes = self.points.saturating_mul(bytes).saturating_add(OWN_BYTES);
        memory::check("the frequency response", bytes, None, "use fewer --points")?;
        let found = pose.responses(&self.frequencies_hz(from_hz, to_hz))?;
        Ok((modes, found))
    }

    /// The response at each frequency, and its mesh error by halved elements; `None` where damping
    /// allows no halved elements.
    pub(crate) fn compute(
        &self,
        specification: &Specification,
    ) -> Result<(Vec<FrequencyResponse>, Option<Vec<f64>>), Failure> {
        let (link, plan) = (&specification.link, &specification.mesh);
        let mut mesh = Mesh::new(link, plan)?;
        let (from_hz, to_hz) = self.range_hz(&natural_frequencies(&mesh, DEFAULT_MODES))?;
        if plan.is_automatic() {
            mesh = mesh.resolving(to_hz * TAU, plan.tolerance());
        }
        let bytes = self.points.saturating_mul(size_of::<FrequencyResponse>() + ROW_BYTES);
        let bytes = bytes.saturating_add(OWN_BYTES);
        memory::check("the frequency response", bytes, None, "use fewer --points")?;
        let model = model_of(link, mesh, specification.analysis.kept_modes())?;
        let frequencies_hz = self.frequencies_hz(from_hz, to_hz);
        let rows = FrequencyResponse::at_all(&*model, &frequencies_hz);
        match changes_on_halves(&*model, &rows) {
            Ok(changes) => {
                let per_change = model.mesh().error_per_change();
                let errors = changes.iter().map(|change| per_change * change).collect();
                Ok((rows, Some(errors)))
            }
            Err(ModelError::TooManyElements { .. }) => Ok((rows, None)),
            Err(error) => Err(error.into()),
        }
    }

    /// The lowest and the highest frequency: by default those that suit natural frequencies in rad/s.
    fn range_hz(&self, modes: &[f64]) -> Result<(f64, f64), Failure> {
        let hertz = |mode: Option<&f64>| mode.map_or(1.0, |omega| omega / TAU);
        let from_hz = self.from.unwrap_or(0.1 * hertz(modes.first()));
        let to_hz = self.to.unwrap_or(2.0 * hertz(modes.last()));
        let are_possible = [from_hz, to_hz].iter().all(|hertz| FREQUENCIES_HZ.contains(hertz));
        if are_possible && (from_hz < to_hz || self.points == 1) {
            return Ok((from_hz, to_hz));
        }
        let [from, to] = [from_hz, to_hz].map(given);
        let (least, most) = (FREQUENCIES_HZ.start(), FREQUENCIES_HZ.end());
        let must = format!("but must rise within {least:e} … {most:e} Hz");
        let message = format!("--from {from} --to {to} = no range, {must}");
        Err(Failure::new(Exit::Usage, &message, None))
    }

    /// All frequencies, both ends exactly.
    fn frequencies_hz(&self, from_hz: f64, to_hz: f64) -> Vec<f64> {
        let last = self.points.max(2) - 1;
        let frequency_hz = |k| {
            let share = k as f64 / last as f64;
            match k {
                0 => from_hz,
                _ if k == last => to_hz,
                _ if self.linear => from_hz + share * (to_hz - from_hz),
                _ => from_hz * libm::pow(to_hz / from_hz, share),
            }
        };
        (0..self.points).map(frequency_hz).collect()
    }
}

/// Prints the largest mesh error; returns the number of warnings.
fn tell(rows: &[FrequencyResponse], errors: Option<&[f64]>) -> usize {
    let Some(errors) = errors else {
        console::note("the mesh error is not known: modal damping allows no halved elements here");
        return 0;
    };
    let pairs = rows.iter().map(|row| row.frequency_hz).zip(errors.iter().copied());
    let Some(error) = BandMeshError::of_errors(pairs) else { return 0 };
    if let Some(warning) = error.warning {
        console::warning(warning, warning.hint());
        return 1;
    }
    let (worst, at_hz) = (error.worst, significant(error.at_hz, 4));
    let at = format!("{worst:.1e} of the magnitude at the worst, at {at_hz} Hz");
    console::note(&format!("the mesh error is {at} (elements halved)"));
    0
}
