//! The inputs and the plan of a sweep: the first line of its unfinished tables and shards, and the record
//! in JSON beside its finished ones.

use serde::{Deserialize, Serialize};

use super::super::json::{
    FORMAT, Fingerprint, Head, as_written, check_format, json, json_line, newer, other_format,
    parsed,
};
use super::super::summary::LinkRecord;
use crate::csv::{Place, TableError, quoted};
use crate::link::Link;
use crate::result::{Limits, Origin};
use crate::sweep::{Shard, SweepPlan, Variation, VariationError};

/// Start of the first line of a shard or an unfinished sweep.
pub(super) const PREFIX: &str = "# flexlink ";

const COMMAND: &str = "sweep";

const VARY: &str = "inputs.vary";

/// Inputs of a sweep: its files, the varied values, each as the program takes it, `payload.mass=0,0.05`, and the
/// other arguments that shape the rows or the files of the cases, in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepInputs {
    /// The link file.
    pub link: Fingerprint,
    /// The trajectory file.
    pub motion: Fingerprint,
    /// The table that plays on every case, if one does: a torque, or the quantity of `--input` in the arguments.
    pub torque: Option<Fingerprint>,
    /// The force on an arm's carriage, or its motion, if it has a file of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<Fingerprint>,
    /// The reference of a feedback, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Fingerprint>,
    /// The reference of an arm's carriage, if it has a file of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub carriage_reference: Option<Fingerprint>,
    /// The varied values.
    pub vary: Vec<String>,
    /// The other arguments.
    pub arguments: Vec<String>,
}

/// A sweep, and the share of its cases in a file.
///
/// The first line of a file with a part of the rows is `# flexlink ` and the record as JSON.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepIdentity {
    record: Box<Record>,
    plan: SweepPlan,
    shard: Shard,
}

/// The content of the JSON file, in the order of its keys.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Record {
    format: u32,
    flexlink: String,
    command: String,
    title: String,
    /// The link of the first case, or the links of its arm.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    links: Vec<LinkRecord>,
    /// The limits of the first case: of each joint, then of an arm's carriage; absent without limits.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    limits: Vec<Limits>,
    inputs: SweepInputs,
    shard: String,
    cases: usize,
    /// The table beside the record; absent in the first line of a table.
    #[serde(skip_serializing_if = "Option::is_none")]
    table: Option<Fingerprint>,
}

impl SweepInputs {
    /// The role and the key of every file.
    fn files(&self) -> [(&'static str, &'static str, Option<&Fingerprint>); 6] {
        let Self { link, motion, torque, force, reference, carriage_reference, .. } = self;
        [
            ("link", "inputs.link.sha256", Some(link)),
            ("motion", "inputs.motion.sha256", Some(motion)),
            ("torque", "inputs.torque.sha256", torque.as_ref()),
            ("force", "inputs.force.sha256", force.as_ref()),
            ("reference", "inputs.reference.sha256", reference.as_ref()),
            ("carriage_reference", "inputs.carriage_reference.sha256", carriage_reference.as_ref()),
        ]
    }
}

impl SweepIdentity {
    /// A share of the sweep of a link with this title; `plan` follows from the `vary` of its inputs.
    pub fn new(title: &str, inputs: SweepInputs, plan: SweepPlan, shard: Shard) -> Self {
        let record = Record {
            format: FORMAT,
            flexlink: env!("CARGO_PKG_VERSION").to_owned(),
            command: COMMAND.to_owned(),
            title: title.to_owned(),
            links: Vec::new(),
            limits: Vec::new(),
            inputs,
            shard: shard.to_string(),
            cases: plan.cases(),
            table: None,
        };
        Self { record: Box::new(record), plan, shard }
    }

    /// The identity with the link of the first case, or the links of its arm, and the limits of its joints.
    #[must_use]
    pub fn with_links<'a>(
        mut self,
        links: impl Iterator<Item = &'a Link>,
        limits: &[Limits],
    ) -> Self {
        self.record.links = links.map(LinkRecord::of_parts).collect();
        if limits.iter().any(|own| *own != Limits::default()) {
            self.record.limits = limits.to_vec();
        }
        self
    }

    /// The limits of the first case: of each joint, then of an arm's carriage; empty without limits.
    pub(in crate::files::store) fn limits(&self) -> Vec<Limits> {
        self.record.limits.clone()
    }

    /// The undamaged links of the first case.
    pub(in crate::files::store) fn links(&self) -> Vec<Link> {
        let link = |record: &LinkRecord| record.clone().link(&self.record.title, None).ok();
        self.record.links.iter().filter_map(link).collect()
    }

    /// All cases of the sweep.
    pub fn plan(&self) -> &SweepPlan {
        &self.plan
    }

    /// The share of cases in the complete file.
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// Number of rows of the complete file.
    pub fn rows(&self) -> usize {
        self.shard.len(self.plan.cases())
    }

    /// The same sweep with all its cases.
    #[must_use]
    pub fn whole(&self) -> Self {
        let shard = Shard::default();
        let record = Record { shard: shard.to_string(), ..(*self.record).clone() };
        Self { record: Box::new(record), shard, plan: self.plan.clone() }
    }

    /// The first line of a file with a part of the rows, with its line end.
    pub fn line(&self) -> String {
        format!("{PREFIX}{}\n", json_line(&self.record))
    }

    /// The content of the JSON file beside a table.
    pub(super) fn json(&self, table: Fingerprint) -> String {
        json(&Record { table: Some(table), ..(*self.record).clone() })
    }

    /// Reads the first line of a file.
    pub(super) fn read_line(line: &str, place: Place) -> Result<Self, TableError> {
        let Some(rest) = line.strip_prefix(PREFIX) else {
            let must = "must be that of a shard, `# flexlink {…}`";
            let hint = "a shard is written by flexlink sweep --shard I/N";
            let error = place.refuse("first line", quoted(line), must);
            return Err(error.with_hint(hint.to_owned()));
        };
        match rest.split_once(" sweep ") {
            Some((version, _)) if !rest.starts_with('{') => Err(other_format(None, version, place)),
            _ => Self::read(rest.as_bytes(), place),
        }
    }

    /// Reads a record.
    pub(super) fn read(bytes: &[u8], place: Place) -> Result<Self, TableError> {
        let head: Head = parsed(bytes, place, "must be the record of a sweep, in JSON")?;
        let version = head.flexlink.unwrap_or_default();
        let command = head.command.unwrap_or_default();
        if command != COMMAND {
            return Err(place.refuse("command", quoted(&command), "must be \"sweep\""));
        }
        check_format(head.format, &version, place)?;
        let record: Record =
            parsed(bytes, place, &as_written()).map_err(|error| newer(error, &version))?;
        Self::checked(record, place).map_err(|error| newer(error, &version))
    }

    fn checked(record: Record, place: Place) -> Result<Self, TableError> {
        let shard = record.shard.parse::<Shard>();
        let shard = shard.map_err(|error| place.refuse_whole(&error.to_string()))?;
        let variations: Result<Vec<Variation>, _> =
            record.inputs.vary.iter().map(|text| text.parse()).collect();
        let plan = variations
            .map_err(|error: VariationError| error.to_string())
            .and_then(|variations| SweepPlan::new(variations).map_err(|error| error.to_string()))
            .map_err(|error| place.refuse_whole(&format!("{VARY}: {error}")))?;
        if plan.cases() != record.cases {
            let must = format!("must be {}, as inputs.vary has it", plan.cases());
            return Err(place.refuse("cases", record.cases.to_string(), must));
        }
        Ok(Self { record: Box::new(record), plan, shard })
    }

    /// Refuses a sweep other than `own`, whose file is `of`, and another version.
    pub(super) fn check_same(&self, own: &Self, place: Place, of: &str) -> Result<(), TableError> {
        let pairs = self.keys().into_iter().zip(own.keys());
        let differ = |((key, found), (_, must)): &((&str, String), (&str, String))| {
            if *key == VARY { self.plan != own.plan } else { found != must }
        };
        match pairs.into_iter().find(differ) {
            Some(((key, found), (_, must))) => {
                Err(place.refuse(key, quoted(&found), format!("must be {} as {of}", quoted(&must))))
            }
            None => Ok(()),
        }
    }

    /// Keys whose values decide the rows.
    fn keys(&self) -> Vec<(&'static str, String)> {
        let SweepInputs { vary, arguments, .. } = &self.record.inputs;
        let sha256 = |file: Option<&Fingerprint>| file.map_or("", |own| &own.sha256).to_owned();
        let files = self.record.inputs.files().map(|(_, key, file)| (key, sha256(file)));
        let others = [(VARY, vary.join(" ")), ("inputs.arguments", arguments.join(" "))];
        let version = ("flexlink", self.record.flexlink.clone());
        [version].into_iter().chain(files).chain(others).collect()
    }

    /// The table beside the record.
    pub(super) fn table(&self) -> Option<&Fingerprint> {
        self.record.table.as_ref()
    }

    /// Program, inputs and arguments of the sweep.
    pub(in crate::files::store) fn origin(&self) -> Origin {
        let SweepInputs { vary, arguments, .. } = &self.record.inputs;
        let files = self.record.inputs.files();
        let vary = vary.iter().flat_map(|text| ["--vary".to_owned(), text.clone()]);
        Origin {
            command: self.record.command.clone(),
            version: self.record.flexlink.clone(),
            title: self.record.title.clone(),
            inputs: files
                .into_iter()
                .filter_map(|(role, _, file)| Some(file?.input(role)))
                .collect(),
            arguments: arguments.iter().cloned().chain(vary).collect(),
        }
    }
}

/// Whether a file is the record of a sweep, of whatever version.
pub(super) fn is_record(bytes: &[u8]) -> bool {
    let head: Result<Head, _> = serde_json::from_slice(bytes);
    head.is_ok_and(|head| head.flexlink.is_some() && head.command.as_deref() == Some(COMMAND))
}

/// The identity of a share of a sweep over `link`, for tests.
#[cfg(test)]
pub(super) fn identity_of(
    link: &str,
    arguments: &[&str],
    vary: &str,
    shard: &str,
) -> SweepIdentity {
    let (shown, name, bytes) = ("x".to_owned(), "x".to_owned(), link.as_bytes().to_vec());
    let file = crate::csv::InputFile { shown, name, bytes };
    let inputs = SweepInputs {
        link: Fingerprint::of(&file),
        motion: Fingerprint::of(&file),
        torque: None,
        force: None,
        reference: None,
        carriage_reference: None,
        vary: vec![vary.to_owned()],
        arguments: arguments.iter().map(|a| (*a).to_owned()).collect(),
    };
    let plan = SweepPlan::new(vec![vary.parse().unwrap()]).unwrap();
    SweepIdentity::new("a link", inputs, plan, shard.parse().unwrap())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLACE: Place = Place { file: "s.csv", line: Some(1) };

    fn identity(link: &str, arguments: &[&str], vary: &str) -> SweepIdentity {
        identity_of(link, arguments, vary, "2/8")
    }

    #[test]
    fn it_reads_back_from_its_own_line_and_from_its_file() {
        let limits = [Limits::new([("torque", 2.5)]).unwrap()];
        let found = identity("link", &["--set", "title=\"a\u{85}b\""], "hub.inertia=1:2:11");
        let found = found.with_links(std::iter::empty(), &limits);
        let line = found.line();
        assert!(!line.trim_end().contains(char::is_control), "{line}");
        assert_eq!(SweepIdentity::read_line(line.trim_end(), PLACE).unwrap(), found);
        assert_eq!((found.rows(), found.shard().number()), (2, 2));
        let table = Fingerprint { name: "s.csv".into(), sha256: "00ff".into() };
        let json = found.json(table);
        assert!(json.contains("\"torque_n_m\": 2.5"), "{json}");
        assert!(is_record(json.as_bytes()) && json.starts_with("{\n  \"format\": 2,\n"), "{json}");
        let read = SweepIdentity::read(json.as_bytes(), PLACE).unwrap();
        assert_eq!(read.table().unwrap().sha256, "00ff");
        assert!(!is_record(b"{\"command\": \"sweep\"}") && !is_record(b"[1]"));
    }

    #[test]
    fn what_is_no_first_line_of_this_format_is_refused_in_words() {
        let refused = |line: &str| {
            let error = SweepIdentity::read_line(line, PLACE).unwrap_err();
            (error.to_string(), error.hint().unwrap_or_default().to_owned())
        };
        let (foreign, _) = refused("time_s,torque_n_m");
        assert!(foreign.starts_with("s.csv:1: first line = \"time_s,torque_n_m\", but must be"));
        let older = refused("# flexlink 0.1.0 sweep 00ff, shard 2/2 of 6 cases");
        let hint = "flexlink 0.1.0 wrote it in an older format: run it again";
        assert_eq!(older, ("s.csv:1: format is missing, but must be 2".into(), hint.into()));
        let line = identity("link", &[], "hub.inertia=1:2:11").line();
        for (from, to, words) in [
            (
                "\"shard\":\"2/8\"",
                "\"shard\":\"9/8\"",
                "s.csv:1: shard = \"9/8\", but must read I/N",
            ),
            ("\"cases\":11", "\"cases\":12", "s.csv:1: cases = 12, but must be 11, as inputs.vary"),
            ("1:2:11", "1:2", "s.csv:1: inputs.vary: range = \"1:2\", but must read"),
            ("\"sweep\"", "\"solve\"", "s.csv:1: command = \"solve\", but must be \"sweep\""),
            ("\"title\"", "\"name\"", "s.csv:1: title is missing"),
        ] {
            let (found, _) = refused(line.trim_end().replace(from, to).as_str());
            assert!(found.starts_with(words), "{found}");
        }
    }

    #[test]
    fn whatever_changes_a_row_makes_another_sweep() {
        let known = identity("link", &["--set", "a=1"], "hub.inertia=1,2");
        let check = |other: &SweepIdentity| other.check_same(&known, PLACE, "in a.csv");
        for (other, key) in [
            (identity("link ", &["--set", "a=1"], "hub.inertia=1,2"), "inputs.link.sha256"),
            (identity("link", &["--set", "a=2"], "hub.inertia=1,2"), "inputs.arguments"),
            (identity("link", &["--set", "a=1"], "hub.inertia=1,3"), "inputs.vary"),
            (identity("link", &["--set", "a=1"], "hub.inertia*=1,2"), "inputs.vary"),
        ] {
            let refusal = check(&other).unwrap_err().to_string();
            assert!(refusal.starts_with(&format!("s.csv:1: {key} = \"")), "{refusal}");
            assert!(refusal.ends_with("\" as in a.csv"), "{refusal}");
        }
        let same = identity("link", &["--set", "a=1"], "hub.inertia=1:2:2");
        assert_eq!(check(&same), Ok(()), "the same rows, written otherwise");
    }
}
