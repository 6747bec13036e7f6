//! `frf`: the frequency response of a link or an arm.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::Args;

use crate::beam::{Mesh, MeshPlan};
use crate::csv::Digits;
use crate::modal::{buckling_share, natural_frequencies};
use crate::model::{
    FrequencyResponse, KeptModes, ModelError, changes_on_halves, model_of, responses_with_weight,
};
use crate::response::{arm_modes, arm_responses};
use crate::result::NO_DIRECTION;
use crate::result::{BandMeshError, Refined};
use crate::spec::Specification;
use crate::store::{
    ResponseColumns, arm_response, frequency_response_json, link_response, write_frequency_response,
};
use crate::text::{given, significant};

use super::modes::falling;
use crate::cli::options::common::{angle_rad, directions, hertz};
use crate::cli::options::inputs::{LinkArgs, refuse_direction, warn_of_gravity};
use crate::cli::terminal::files::keep_files;
use crate::cli::terminal::{Exit, Failure, StageBar, WarningArgs, console, memory};

const EXAMPLE: &str = "\
Example:
  flexlink frf link.toml --from 0.1 --to 50 -o frf.csv
  flexlink frf hanging.toml --at '-90 deg' -o frf.csv
  flexlink frf arm.toml --at '30 deg,75 deg' -o frf.csv";

/// Bytes of a row besides itself while its fourteen columns are written, as measured.
const ROW_BYTES: usize = 160;

/// Number of natural frequencies within the default range of frequencies.
const DEFAULT_MODES: usize = 5;

/// Bytes of one transfer of an arm at one frequency: twice as computed, and once as written.
const RESPONSE_BYTES: usize = 64 + 80;

/// Bytes of a run besides its rows.
const OWN_BYTES: usize = 16 << 20;

/// Frequency response of a link or an arm: torque per tip acceleration, hub angle per tip displacement, tip
/// displacement per torque.
///
/// Writes a CSV with real and imaginary part, magnitude and phase of each, to standard output or a file,
/// and the mesh error of each row: its change by elements of half the length, over its magnitude.
/// The largest mesh error is printed, above 1 % as a warning. An automatic mesh is refined until it follows
/// the highest frequency to mesh.tolerance.
///
/// With --at, the response is that of small motions about the shape at rest in these directions, bent by the weight
/// (modes --at of one link leaves this sag out). Its columns are the displacement of the tip along x and y, in 1/N,
/// and the angle of each joint, in rad/(N m), per torque of each joint. The mesh error is then their change by
/// polynomials of higher order, over their size. All modes count: analysis.modes is refused, and so are shear, alpha
/// and modal damping. An arm of several links needs --at. A link on a carriage keeps its direction: with gravity its
/// response has the weight along it, as in modes, unless modal damping or analysis.modes is set.
#[derive(Debug, Args)]
#[command(about = "Frequency response of a link or an arm", after_help = EXAMPLE)]
pub struct Frf {
    #[command(flatten)]
    link: LinkArgs,

    /// The directions of all links, from joint to joint, the inner one first, in rad or with their unit, as in
    /// '-90 deg' for one link or '30 deg,75 deg' for an arm of two.
    #[arg(long, value_name = "ANGLES", value_parser = angle_rad, allow_hyphen_values = true)]
    #[arg(value_delimiter = ',')]
    at: Option<Vec<f64>>,

    /// Lowest frequency in Hz or with its unit [default: a tenth of the first natural frequency].
    #[arg(long, value_name = "HZ", value_parser = hertz, allow_hyphen_values = true)]
    from: Option<f64>,

    /// Highest frequency in Hz or with its unit [default: twice the fifth natural frequency].
    #[arg(long, value_name = "HZ", value_parser = hertz, allow_hyphen_values = true)]
    to: Option<f64>,

    /// Number of frequencies.
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = crate::cli::options::common::positive)]
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

/// Frequencies whose fourth powers are finite and not 0.
const FREQUENCIES_HZ: RangeInclusive<f64> = 1e-70..=1e70;

/// A frequency response for writing.
pub struct Responses {
    pub columns: ResponseColumns,
    /// Unknown if modal damping allows no halved elements; always known in a pose.
    pub error: Option<BandMeshError>,
    /// True if the links leave the pose with free joints.
    falls: bool,
    /// Remedy for a weight that does not count.
    weightless: Option<&'static str>,
}

impl Frf {
    pub(crate) fn run(self) -> Result<(), Failure> {
        if let Some(output) = &self.output {
            keep_files(output, &[&self.link.link])?;
        }
        let (_, specification) = self.link.load()?;
        let bar = StageBar::new();
        bar.at("computing responses");
        let Responses { columns, error, falls, weightless } = self.compute(&specification)?;
        drop(bar);
        let output = self.output.as_deref();
        if self.json {
            console::deliver(output, frequency_response_json(columns).as_bytes())?;
        } else {
            let digits = self.digits;
            console::deliver_by(output, |out| write_frequency_response(out, &columns, digits))?;
        }
        self.warnings.refuse(self.tell(&specification, error, (falls, weightless)))
    }

    /// The response of a link without gravity, of a link on a carriage with its weight, or of a link or an arm in a pose.
    pub fn compute(&self, specification: &Specification) -> Result<Responses, Failure> {
        if self.at.is_some() {
            refuse_direction(&specification.arm)?;
        }
        match specification.arm.alone().filter(|_| self.at.is_none()) {
            Some(_) => self.compute_level(specification),
            None => self.compute_in_pose(specification),
        }
    }

    fn compute_in_pose(&self, specification: &Specification) -> Result<Responses, Failure> {
        let Specification { arm, meshes, .. } = specification;
        let joints = arm.links().len();
        if specification.analysis.kept_modes() != KeptModes::All {
            let message = "analysis.modes is set, but the response in a pose has all modes";
            return Err(Failure::new(Exit::InputRefused, &message, Some("leave it out")));
        }
        let directions_rad = directions(self.at.as_deref(), joints)?;
        let tolerance = MeshPlan::smallest_tolerance(meshes);
        let free = arm_modes(arm, &directions_rad, DEFAULT_MODES, tolerance)?.free;
        let squares = free.modes.iter().map(|mode| mode.square_per_s2);
        let rising: Vec<f64> = squares.filter(|square| *square > 0.0).map(f64::sqrt).collect();
        let row_bytes = RESPONSE_BYTES * joints * (joints + 2);
        let (frequencies_hz, _) = self.frequencies_hz(&rising, row_bytes)?;
        let found = arm_responses(&arm.held(), &directions_rad, &frequencies_hz, tolerance)?;
        let errors = frequencies_hz.iter().copied().zip(found.errors.iter().copied());
        Ok(Responses {
            columns: arm_response(&found),
            error: BandMeshError::of_errors(errors, Refined::Orders),
            falls: free.falls(),
            weightless: None,
        })
    }

    fn compute_level(&self, specification: &Specification) -> Result<Responses, Failure> {
        let (link, plan) = (specification.link(), specification.mesh());
        let mut mesh = Mesh::new(link, plan)?;
        let natural_rad_s = natural_frequencies(&mesh, DEFAULT_MODES);
        let row_bytes = size_of::<FrequencyResponse>() + ROW_BYTES;
        let (frequencies_hz, to_hz) = self.frequencies_hz(&natural_rad_s, row_bytes)?;
        if plan.is_automatic() {
            mesh = mesh.resolving(to_hz * TAU, plan.tolerance());
        }
        let model = model_of(link, mesh, specification.analysis.kept_modes())?;
        let has_all = specification.analysis.kept_modes() == KeptModes::All;
        let weighed = Some(model.on_mesh()).filter(|_| has_all);
        let weighed = weighed.and_then(|link| responses_with_weight(link, &frequencies_hz));
        let weightless = match &weighed {
            Some(_) => None,
            None if link.direction_rad().is_none() => Some(NO_DIRECTION),
            None if !has_all => Some("leave analysis.modes out: the weight then counts"),
            None if model.law().is_modal() => {
                Some("use hysteretic or rayleigh damping, or modes, which has the weight")
            }
            None => Some("lower --to, or use fewer elements: above 256 the weight does not count"),
        };
        let (rows, changes) = if let Some(weighed) = weighed {
            weighed
        } else {
            let rows = FrequencyResponse::at_all(&*model, &frequencies_hz);
            match changes_on_halves(&*model, &rows) {
                Ok(changes) => (rows, Some(changes)),
                Err(ModelError::TooManyElements { .. }) => (rows, None),
                Err(error) => return Err(error.into()),
            }
        };
        let per_change = model.mesh().error_per_change();
        let errors = changes.map(|changes| -> Vec<f64> {
            changes.iter().map(|change| per_change * change).collect()
        });
        let known = frequencies_hz.iter().copied().zip(errors.iter().flatten().copied());
        let outward_m_s2 = link.outward_m_s2().filter(|_| weightless.is_none());
        let share = outward_m_s2.map(|own| buckling_share(model.mesh(), own));
        Ok(Responses {
            error: BandMeshError::of_errors(known, Refined::Elements),
            columns: link_response(link, &rows, errors.as_deref()),
            falls: share.is_some_and(|share| share >= 1.0),
            weightless,
        })
    }

    /// Frequencies in Hz with both ends exact, and the upper end. The default range follows from the natural frequencies.
    /// Refuses rows of this size if they do not fit into the memory.
    fn frequencies_hz(
        &self,
        natural_rad_s: &[f64],
        row_bytes: usize,
    ) -> Result<(Vec<f64>, f64), Failure> {
        let hertz = |mode: Option<&f64>| mode.map_or(1.0, |omega| omega / TAU);
        let from_hz = self.from.unwrap_or(0.1 * hertz(natural_rad_s.first()));
        let to_hz = self.to.unwrap_or(2.0 * hertz(natural_rad_s.last()));
        let are_possible = [from_hz, to_hz].iter().all(|hertz| FREQUENCIES_HZ.contains(hertz));
        if !are_possible || (from_hz >= to_hz && self.points != 1) {
            let [from, to] = [from_hz, to_hz].map(given);
            let (least, most) = (FREQUENCIES_HZ.start(), FREQUENCIES_HZ.end());
            let must = format!("must rise within {least:e} … {most:e} Hz");
            let message = format!("--from {from} --to {to}: the frequencies {must}");
            return Err(Failure::new(Exit::Usage, &message, None));
        }
        let bytes = self.points.saturating_mul(row_bytes).saturating_add(OWN_BYTES);
        memory::check("the frequency response", bytes, None, "use fewer --points")?;
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
        Ok(((0..self.points).map(frequency_hz).collect(), to_hz))
    }

    /// Prints the mesh error and a warning of a fall; returns the number of warnings.
    fn tell(
        &self,
        Specification { arm, remarks, .. }: &Specification,
        error: Option<BandMeshError>,
        (falls, weightless): (bool, Option<&str>),
    ) -> usize {
        let mut warnings = 0;
        // Without --at the remarks of a link file are those of `modes` and `solve`.
        if self.at.is_some() {
            console::remarks(remarks);
        }
        match error {
            None => {
                let has_weight = weightless.is_none() && arm.has_weight();
                console::note(if has_weight {
                    "the mesh error is not known: halved elements are more than 256, the most with weight"
                } else {
                    "the mesh error is not known: modal damping allows no halved elements here"
                });
            }
            Some(BandMeshError { warning: Some(warning), .. }) => {
                console::warning(warning, warning.hint());
                warnings += 1;
            }
            Some(BandMeshError { worst, at_hz, by, .. }) => {
                let (at_hz, how) = (significant(at_hz, 4), by.how());
                let at = format!("{worst:.1e} of the magnitude at the worst, at {at_hz} Hz");
                console::note(&format!("the mesh error is {at} ({how})"));
            }
        }
        if falls {
            let words = format!("{}: it responds so only under control", falling(arm, "free"));
            let hint = match arm.links() {
                [_] if arm.joint().slides() => "modes prints how fast the straight link falls",
                [_] => {
                    "modes --at prints how fast the straight link falls; here its sag counts, too"
                }
                _ => "modes --at prints how fast it falls",
            };
            console::warning(words, hint);
        }
        let level = weightless.map(|remedy| warn_of_gravity(&arm.links()[0].link, remedy));
        warnings + usize::from(falls) + level.unwrap_or_default()
    }
}
