//! summary.json: the inputs of a run of `solve` or `simulate`, its numbers, and how far to trust them. The same
//! record is written and read back.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::json::{FORMAT, Fingerprint, Head, as_written, check_format, json, newer, parsed};
use crate::csv::{InputFile, Place, TableError, quoted};
use crate::elastica::SecondOrder;
use crate::link::{
    Arm, Carriage, Damping, Drive, Gravity, Hub, Joint, Link, LinkParts, LumpedMass,
    ParameterError, Payload, Segment,
};
use crate::modal::DampingLaw;
use crate::result::{Check, Comparison, Limits, Notice, Origin};
use crate::verify::Verification;

/// Description of a run's folder in messages on missing files.
pub(super) const A_RUN: &str = "the folder of a run of `flexlink solve`, `simulate` or `robust`";

/// Remedy for another file or folder than a result.
pub(super) const RESULTS: &str =
    "name the folder of solve, simulate or robust, or the table of sweep";

/// The option with places in m for nodes; the mesh of a run has nodes there.
pub const STATIONS: &str = "--stations";

/// Numbers of the motion that a page shows, each with its name there.
const MOTION: [(&str, &str); 3] = [
    ("travel_m", "tip_travel_m"),
    ("peak_velocity_m_s", "peak_tip_velocity_m_s"),
    ("peak_acceleration_m_s2", "peak_tip_acceleration_m_s2"),
];

/// A key that only one of the two commands writes, as null if it has no value. Reading treats null like a missing
/// key.
type Nullable<T> = Option<Option<T>>;

/// The content of summary.json, in the order of its keys. Keys of one command alone are optional. Unknown keys become
/// values, so that a later version may have more.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Summary {
    pub(super) format: u32,
    pub(super) flexlink: String,
    pub(super) command: String,
    pub(super) title: String,
    pub(super) inputs: RunInputs,
    /// Default for several links: `arm` holds them.
    #[serde(default, skip_serializing_if = "LinkRecord::is_none")]
    pub(super) link: LinkRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) drive: Nullable<Value>,
    /// Computed values, from `mesh` on: `motion`, `torque`, `analysis`, `results`, `errors`, ….
    #[serde(flatten)]
    pub(super) values: Value,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) measured: Option<Comparison>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) verification: Nullable<Vec<Check>>,
    pub(super) warnings: Vec<Notice>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) remarks: Option<Vec<Notice>>,
    pub(super) files: Vec<String>,
}

/// Inputs of a run: its input files, and its arguments in order, as the program takes them: `--set`,
/// `payload.mass=0`.
///
/// A program with link and motion from numbers has no files, [`RunInputs::of_arguments`]: summary.json does not
/// suffice to repeat its run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunInputs {
    #[serde(skip_serializing_if = "Option::is_none")]
    link: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    motion: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    torque: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hub_angle: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    force: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    carriage: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Nullable<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    measured: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Nullable<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    carriage_reference: Option<Fingerprint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    state: Option<Fingerprint>,
    arguments: Vec<String>,
}

/// The files of a simulation beside the link file.
#[derive(Debug, Clone, Copy)]
pub struct SimulateFiles<'a> {
    /// What is played.
    pub input: &'a InputFile,
    /// The input of an arm's carriage, if it is a separate file.
    pub carriage: Option<&'a InputFile>,
    /// The wanted motion, if there is one.
    pub target: Option<&'a InputFile>,
    /// The recording, if there is one.
    pub measured: Option<&'a InputFile>,
    /// The reference of a feedback, if there is one.
    pub reference: Option<&'a InputFile>,
    /// The reference of an arm's carriage, if it is a separate file.
    pub carriage_reference: Option<&'a InputFile>,
    /// The state at the start, if there is one.
    pub state: Option<&'a InputFile>,
}

impl RunInputs {
    /// The inputs of `solve`.
    pub fn of_solve(link: &InputFile, motion: &InputFile, arguments: Vec<String>) -> Self {
        let [link, motion] = [link, motion].map(|file| Some(Fingerprint::of(file)));
        Self { link, motion, arguments, ..Self::default() }
    }

    /// The inputs of a program without files.
    pub fn of_arguments(arguments: Vec<String>) -> Self {
        Self { arguments, ..Self::default() }
    }

    /// The inputs of `simulate`, which plays a torque or a motion of a hub, or of a carriage that `slides`.
    pub fn of_simulate(
        link: &InputFile,
        files: &SimulateFiles,
        (is_torque, slides): (bool, bool),
        arguments: Vec<String>,
    ) -> Self {
        let SimulateFiles { input, target, measured, reference, state, .. } = *files;
        let link = Some(Fingerprint::of(link));
        let input = Some(Fingerprint::of(input));
        let of = |kind| input.clone().filter(|_| kind == (is_torque, slides));
        let others = [measured, state, files.carriage, files.carriage_reference];
        let [measured, state, own, carriage_reference] =
            others.map(|file| file.map(Fingerprint::of));
        let of_carriage = |of_torque| own.clone().filter(|_| of_torque == is_torque);
        let [target, reference] = [target, reference].map(|file| Some(file.map(Fingerprint::of)));
        Self {
            link,
            torque: of((true, false)),
            hub_angle: of((false, false)),
            force: of((true, true)).or(of_carriage(true)),
            carriage: of((false, true)).or(of_carriage(false)),
            target,
            measured,
            reference,
            carriage_reference,
            state,
            arguments,
            ..Self::default()
        }
    }
}

/// The link in SI with the keys of its file, without title and drive.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct LinkRecord {
    length_m: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rigid_inertia_kg_m2: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rigid_mass_kg: Option<f64>,
    segments: Vec<Segment>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hub: Option<Hub>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    carriage: Option<Carriage>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    root_stiffness_n_m_rad: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    output_m: Option<f64>,
    masses: Vec<LumpedMass>,
    payload: Payload,
    damping: Damping,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gravity: Option<Gravity>,
}

impl Summary {
    /// A summary with the common keys of both commands.
    pub(super) fn of(command: &str, inputs: RunInputs, arm: &Arm, law: &DampingLaw) -> Self {
        Self {
            format: FORMAT,
            flexlink: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.to_owned(),
            title: arm.title().to_owned(),
            inputs,
            link: arm.alone().map(|link| LinkRecord::of(link, law)).unwrap_or_default(),
            ..Self::default()
        }
    }

    /// The summary of a run without a folder.
    #[must_use]
    pub fn without_files(self) -> Self {
        Self { files: Vec::new(), ..self }
    }

    /// Warnings of the run.
    pub fn warnings(&self) -> &[Notice] {
        &self.warnings
    }

    /// Number of the run's files, including this one.
    pub fn file_count(&self) -> usize {
        self.files.len()
    }

    /// The arguments of the run's torque table; empty without one.
    pub(super) fn table_arguments(&self) -> Vec<String> {
        let arguments = self.values["table"]["arguments"].as_array().into_iter().flatten();
        arguments.filter_map(|word| word.as_str().map(str::to_owned)).collect()
    }

    /// The JSON text, indented, with a final line end.
    ///
    /// # Panics
    /// Never: JSON can hold every summary.
    pub fn to_json(&self) -> String {
        json(self)
    }

    pub(super) fn read(file: &InputFile) -> Result<Self, TableError> {
        let whole = Place { file: &file.shown, line: None };
        let head: Head = parsed(&file.bytes, whole, "must be the summary of a run, in JSON")?;
        let Some(version) = head.flexlink else {
            return Err(whole.refuse_whole(&format!("flexlink is missing: this is not {A_RUN}")));
        };
        let command = head.command.unwrap_or_default();
        if !["solve", "simulate"].contains(&command.as_str()) {
            let must = "must be \"solve\" or \"simulate\"";
            return Err(whole.refuse("command", quoted(&command), must));
        }
        check_format(head.format, &version, whole)?;
        parsed(&file.bytes, whole, &as_written()).map_err(|error| newer(error, &version))
    }

    /// The places of a run's option [`STATIONS`].
    pub(super) fn stations_m(&self) -> Vec<f64> {
        let mut arguments = self.inputs.arguments.iter();
        let list = arguments.find(|own| *own == STATIONS).and_then(|_| arguments.next());
        list.map(|list| list.split(',').filter_map(|at| at.parse().ok()).collect())
            .unwrap_or_default()
    }

    pub(super) fn origin(&self) -> Origin {
        let RunInputs { link, motion, torque, hub_angle, force, carriage, target, .. } =
            &self.inputs;
        let RunInputs { measured, reference, carriage_reference, state, arguments, .. } =
            &self.inputs;
        let files = [
            ("link", link.as_ref()),
            ("motion", motion.as_ref()),
            ("torque", torque.as_ref()),
            ("hub_angle", hub_angle.as_ref()),
            ("force", force.as_ref()),
            ("carriage", carriage.as_ref()),
            ("target", target.as_ref().and_then(Option::as_ref)),
            ("measured", measured.as_ref()),
            ("reference", reference.as_ref().and_then(Option::as_ref)),
            ("carriage_reference", carriage_reference.as_ref()),
            ("state", state.as_ref()),
        ];
        Origin {
            command: self.command.clone(),
            version: self.flexlink.clone(),
            title: self.title.clone(),
            inputs: files.into_iter().filter_map(|(role, file)| Some(file?.input(role))).collect(),
            arguments: arguments.clone(),
        }
    }

    /// The link, with the ranges of its parameters checked.
    pub(super) fn link(&self) -> Result<Link, ParameterError> {
        let drive = self.drive.clone().flatten().map(serde_json::from_value).transpose();
        let unreadable = |error: serde_json::Error| {
            ParameterError::new(
                "drive",
                error.to_string(),
                "",
                "must be a drive as solve writes it",
            )
        };
        self.link.clone().link(&self.title, drive.map_err(unreadable)?)
    }

    /// True for a solution, false for a simulation.
    pub(super) fn is_solved(&self) -> bool {
        self.command == "solve"
    }

    /// True for an arm of several links.
    pub(super) fn is_of_arm(&self) -> bool {
        !self.values["arm"].is_null()
    }

    /// First and last time in s of the histories.
    pub(super) fn window_s(&self) -> Option<(f64, f64)> {
        let number = |of: &str, key: &str| self.values[of][key].as_f64();
        let solved = number("analysis", "window_start_s").zip(number("analysis", "window_end_s"));
        let played = |input| number(input, "start_s").zip(number(input, "simulated_until_s"));
        let played =
            || ["torque", "hub_angle", "force", "carriage", "voltage"].into_iter().find_map(played);
        solved.or_else(played)
    }

    /// The number `key` of the object `of`; a summary without it is refused at `place`.
    pub(super) fn number(&self, of: &str, key: &str, place: Place) -> Result<f64, TableError> {
        let object = &self.values[of];
        let missing = if object.is_object() { format!("{of}.{key}") } else { of.to_owned() };
        object[key].as_f64().ok_or_else(|| place.refuse_whole(&format!("{missing} is missing")))
    }

    /// Limits of the record; no limits without an entry.
    pub(super) fn limits(stored: &Value, place: Place) -> Result<Limits, TableError> {
        let limits = Option::<Limits>::deserialize(stored);
        let limits = limits.map_err(|error| place.refuse_whole(&format!("limits: {error}")))?;
        Ok(limits.unwrap_or_default())
    }

    /// Terms of second order in a run of one link.
    pub(super) fn second_order(&self) -> SecondOrder {
        if self.values["elastica"].is_object() {
            return SecondOrder::Full;
        }
        serde_json::from_value(self.values["second_order"]["order"].clone()).unwrap_or_default()
    }

    /// Number of modes that a solution keeps; `None` for all.
    pub(super) fn kept_modes(&self) -> Option<usize> {
        self.values["analysis"]["modes"].as_u64()?.try_into().ok()
    }

    /// All numbers by name: results, motion of the tip, residual and tip error, errors, comparison with a recording.
    pub(super) fn readings(&self) -> Vec<(String, f64)> {
        let of = |key: &str, prefix: &str| numbers_in(&self.values[key], prefix);
        let errors = of("errors", "").into_iter().map(|(name, error)| (name + "_error", error));
        let motion = MOTION.iter().filter_map(|(key, name)| {
            Some(((*name).to_owned(), self.values["motion"][*key].as_f64()?))
        });
        let numbers = [
            of("results", ""),
            motion.collect(),
            of("second_order", "second_order_"),
            of("residual", "residual_"),
            of("tip_error", "tip_error_"),
        ];
        let measured = self.measured.iter().flat_map(Comparison::readings);
        numbers.into_iter().flatten().chain(errors).chain(measured).collect()
    }
}

/// All numbers of an object, their names behind a prefix. Numbers of an inner object have both names, `torque_mesh`.
pub(super) fn numbers_in(object: &Value, prefix: &str) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for (name, value) in object.as_object().into_iter().flatten() {
        let name = format!("{prefix}{name}");
        found.extend(numbers_in(value, &format!("{name}_")));
        found.extend(value.as_f64().map(|number| (name, number)));
    }
    found
}

impl LinkRecord {
    /// The link, with the ranges of its parameters checked.
    pub(super) fn link(self, title: &str, drive: Option<Drive>) -> Result<Link, ParameterError> {
        let length_m = self.length_m;
        let hub = match (self.hub, &self.carriage) {
            (None, None) => {
                return Err(ParameterError::new(
                    "hub",
                    "nothing",
                    "",
                    "must be there, or a carriage",
                ));
            }
            (hub, _) => hub.unwrap_or_default(),
        };
        let link = Link::new(LinkParts {
            title: title.to_owned(),
            segments: self.segments,
            hub,
            carriage: self.carriage,
            root_stiffness_n_m_rad: self.root_stiffness_n_m_rad,
            output_m: self.output_m,
            masses: self.masses,
            payload: self.payload,
            damping: self.damping,
            drive,
            gravity: self.gravity,
        })?;
        if (length_m - link.length_m()).abs() <= 1e-9 * link.length_m() {
            return Ok(link);
        }
        let must = format!("must be {} m, the sum of hub radius and segments", link.length_m());
        Err(ParameterError::new("length_m", length_m, "m", must))
    }

    /// True without a link.
    fn is_none(&self) -> bool {
        self.segments.is_empty()
    }

    fn of(link: &Link, law: &DampingLaw) -> Self {
        let damping = match (link.damping(), law) {
            (damping @ Damping::Caughey { .. }, _) => damping.clone(),
            (_, DampingLaw::Rayleigh { alpha_per_s, beta_s }) => {
                Damping::Rayleigh { alpha_per_s: *alpha_per_s, beta_s: *beta_s }
            }
            (damping @ (Damping::Modal { .. } | Damping::Hysteretic { .. }), _) => damping.clone(),
            _ => Damping::None,
        };
        Self { damping, ..Self::of_parts(link) }
    }

    /// The record with the damping of the link file.
    pub(super) fn of_parts(link: &Link) -> Self {
        let without_section =
            |segment: &Segment| Segment { cross_section: None, ..segment.clone() };
        let (hub, carriage) = match link.joint() {
            Joint::Revolute(hub) => (Some(hub), None),
            Joint::Prismatic(carriage) => (None, Some(carriage)),
        };
        let inertia = link.rigid_inertia_kg_m2();
        Self {
            length_m: link.length_m(),
            rigid_inertia_kg_m2: hub.map(|_| inertia),
            rigid_mass_kg: carriage.map(|_| inertia),
            segments: link.segments().iter().map(without_section).collect(),
            hub,
            carriage,
            root_stiffness_n_m_rad: link.root_stiffness_n_m_rad(),
            output_m: link.has_station().then(|| link.output_m()),
            masses: link.masses().to_vec(),
            payload: *link.payload(),
            damping: link.damping().clone(),
            gravity: link.gravity().copied(),
        }
    }
}

/// The JSON text of a verification: a list of its checks.
pub fn verification_json(verification: &Verification) -> String {
    json(&verification.checks)
}
