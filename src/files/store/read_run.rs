//! Makes a stored run of a summary and tables: of those in a folder, or of those in memory that a command is about to
//! write.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use serde_json::Value;

use super::json::newer;
use super::names::RunOutputs;
use super::names::{
    ANGLE, DEFLECTIONS, Form, JointFile, MOMENTS, MOTOR, NODES, NodalFile, OF_CARRIAGE, PLACES,
    RIGID, RIGID_TORQUE, ROOT_MOMENT, SUMMARY, TIP, TORQUE,
};
use super::read_tables::{
    RunFolder, TIME, Table, check_window, deflections, read_nodal, read_nodes, times_s,
};
use super::run_tables::RunTables;
use super::summary::{LinkRecord, STATIONS, Summary, numbers_in};
use crate::beam::{Mesh, MeshPlan, NodalHistories};
use crate::csv::{Place, TableError};
use crate::inverse::NodalTable;
use crate::link::{Drive, Link, MotorKnown, POSITION_TOLERANCE};
use crate::motion::{Prescribed, TipMotionHistories};
use crate::result::{
    StoredArc, StoredCarriage, StoredJoint, StoredLink, StoredMotor, StoredNodes, StoredRun,
    StoredTarget,
};

/// Number of the first column of a joint: a torque, or in [`ANGLE`] its angle.
const FIRST: usize = 0;
/// Numbers of the columns with a joint's rate and with its angle in a rigid link, in [`ANGLE`].
const RATE: usize = 1;
const ACCELERATION: usize = 2;
const RIGID_ANGLE: usize = 3;
/// Numbers of the columns with a motor's rate, and with its current and voltage by its constants, in [`MOTOR`].
const MOTOR_RATE: usize = 2;
const MOTOR_CURRENT: usize = 4;
const MOTOR_VOLTAGE: usize = 5;

/// Number of columns of each file of an arm's carriage.
const CARRIAGE_COLUMNS: usize = 3;

/// True for an arm on a carriage.
fn has_carriage(summary: &Summary) -> bool {
    summary.is_of_arm() && summary.values["arm"]["carriage"].is_object()
}

/// Histories by file and column.
type Histories = BTreeMap<(&'static str, String), Vec<f64>>;

/// Quantities at nodes by file, for each link and each letter of the file's columns.
type Nodal = BTreeMap<&'static str, Vec<Vec<StoredNodes>>>;

/// Links and tables of a run, beside its summary. [`Parts::stored`] moves them into a [`StoredRun`].
struct Parts {
    /// Name of its folder.
    name: String,
    /// Names of the links, and the links.
    links: Vec<(String, Link)>,
    /// Distances of the nodes of each link from its joint in m.
    nodes_m: Vec<Vec<f64>>,
    /// The mesh of a single link; `None` for an arm.
    mesh: Option<Mesh>,
    times_s: Vec<f64>,
    histories: Histories,
    nodal: Nodal,
    target: Option<StoredTarget>,
}

/// Reads all files of a run.
pub(super) fn read_run(folder: RunFolder) -> Result<StoredRun, TableError> {
    let file = folder.file(SUMMARY)?;
    let summary = Summary::read(&file)?;
    let place = Place { file: &file.shown, line: None };
    let read = || {
        folder.check_named(&summary.files)?;
        if summary.origin().arguments.iter().any(|argument| argument == "--golden") {
            let must = "must be a run without it: a golden folder lacks some tables";
            return Err(place.refuse("inputs.arguments", "--golden", must));
        }
        read_parts(folder, &summary, place)?.stored(&summary, place)
    };
    read().map_err(|error| newer(error, &summary.flexlink))
}

/// Reads the tables of a run with this summary, whose file is `place`.
fn read_parts(folder: RunFolder, summary: &Summary, place: Place) -> Result<Parts, TableError> {
    let links = read_links(summary, place)?;
    let form = Form::of(links.iter().map(|(_, link)| link));
    let count = links.len();
    let nodes_file = folder.file(NODES)?;
    let nodes_place = Place { file: &nodes_file.shown, line: None };
    let nodes_m = read_nodes(&nodes_file, form)?;
    let mesh = if let [(_, link)] = &links[..] {
        let nodes_m = nodes_m.first().map_or(&[][..], Vec::as_slice);
        let plan = MeshPlan::through(link, nodes_m, &summary.stations_m());
        let mesh = plan.and_then(|plan| Mesh::new(link, &plan));
        Some(mesh.map_err(|error| nodes_place.refuse_whole(&error.to_string()))?)
    } else {
        check_nodes(&nodes_m, &links, nodes_place)?;
        None
    };

    let is_solved = summary.is_solved();
    let joints: Vec<usize> = (0..count).collect();
    let mut torque = Table::of(&folder.file(TORQUE.name(form))?, &TORQUE.columns(form, &joints))?;
    torque.check_even()?;
    check_window(&torque, summary)?;
    // The times of the torque, to which all other tables must keep.
    let times_s = torque.take(TIME);
    let times = (TORQUE.name(form), &times_s[..]);
    let has_drive = |joint: &usize| count == 1 || links[*joint].1.drive().is_some();
    let driven: Vec<usize> = joints.iter().copied().filter(has_drive).collect();
    let mut tables = vec![(&TORQUE, TORQUE.columns(form, &joints), torque)];
    for (file, joints, is_there) in [
        (&ANGLE, &joints, true),
        (&TIP, &joints, true),
        (&RIGID_TORQUE, &joints, is_solved),
        (&MOTOR, &driven, is_solved && !driven.is_empty() && folder.has(MOTOR.name(form))),
    ] {
        if is_there {
            let mut columns = file.columns(form, joints);
            columns.retain(|name| is_solved || !name.starts_with(RIGID) && name != ROOT_MOMENT);
            let known = |joint: usize| links[joint].1.drive().map(Drive::known);
            for (column, needs) in
                [(MOTOR_CURRENT, MotorKnown::Current), (MOTOR_VOLTAGE, MotorKnown::Voltage)]
            {
                for joint in joints.iter().filter(|joint| known(**joint) < Some(needs)) {
                    columns.retain(|name| *name != MOTOR.column(form, *joint, column));
                }
            }
            let table = Table::of(&folder.file(file.name(form))?, &columns)?;
            table.check_times(times, 1)?;
            tables.push((file, columns, table));
        }
    }
    let mut tables: Vec<_> = tables.into_iter().map(|own| (form, own)).collect();
    if has_carriage(summary) {
        let form = Form::Carriage;
        let is_there =
            |file: &&JointFile| summary.is_solved() || file.name(form) != RIGID_TORQUE.name(form);
        for file in OF_CARRIAGE.into_iter().filter(is_there) {
            let mut columns = file.columns(form, &[0]);
            columns.truncate(CARRIAGE_COLUMNS);
            let table = Table::of(&folder.file(file.name(form))?, &columns)?;
            table.check_times(times, 1)?;
            tables.push((form, (file, columns, table)));
        }
    }
    let histories = tables.into_iter().flat_map(|(form, (file, columns, mut table))| {
        let history = move |name: String| ((file.name(form), name.clone()), table.take(&name));
        columns.into_iter().map(history)
    });
    let histories = histories.collect();
    let counts: Vec<usize> = nodes_m.iter().map(Vec::len).collect();
    let arguments = &summary.origin().arguments;
    let is_chosen = arguments.iter().any(|option| option == "--nodes" || option == STATIONS);
    let mut nodal = Nodal::new();
    for file in [&DEFLECTIONS, &PLACES, &MOMENTS] {
        let name = file.name(form);
        // The page draws the links of an arm at their places.
        if folder.has(name) || (count > 1 && name == PLACES.name(form)) {
            nodal.insert(
                name,
                read_nodal(&folder.file(name)?, file, (form, &counts, is_chosen), times)?,
            );
        }
    }
    let target = folder.target(&summary.files, form)?;
    let name = folder.0.display().to_string();
    Ok(Parts { name, links, nodes_m, mesh, times_s, histories, nodal, target })
}

/// Names and links from a summary. The name of an unnamed link is its number.
fn read_links(summary: &Summary, place: Place) -> Result<Vec<(String, Link)>, TableError> {
    if !summary.is_of_arm() {
        let link = summary.link().map_err(|error| place.refuse_whole(&format!("link.{error}")))?;
        return Ok(vec![("1".to_owned(), link)]);
    }
    let links = summary.values["arm"]["links"].as_array().filter(|links| links.len() > 1);
    let missing = || place.refuse_whole("arm.links must be a list of two links or more");
    let link = |(k, entry): (usize, &Value)| {
        let name = entry["name"].as_str().map_or_else(|| (k + 1).to_string(), str::to_owned);
        let refuse = |error: String| place.refuse_whole(&format!("arm.links.{k}: {error}"));
        let record = serde_json::from_value::<LinkRecord>(entry["link"].clone());
        let drive = serde_json::from_value::<Option<Drive>>(entry["drive"].clone());
        let (record, drive) = record
            .and_then(|record| Ok((record, drive?)))
            .map_err(|error| refuse(error.to_string()))?;
        let link = record.link(&name, drive).map_err(|error| refuse(error.to_string()))?;
        Ok((name, link))
    };
    links.ok_or_else(missing)?.iter().enumerate().map(link).collect()
}

/// Refuses nodes unless they lead along each link of an arm from its hub to its tip.
fn check_nodes(
    nodes_m: &[Vec<f64>],
    links: &[(String, Link)],
    place: Place,
) -> Result<(), TableError> {
    let is_whole = |(nodes_m, (_, link)): (&Vec<f64>, &(String, Link))| {
        let (root_m, tip_m) = (link.hub().radius_m, link.length_m());
        let is_same = |x_m: f64, end_m: f64| (x_m - end_m).abs() <= POSITION_TOLERANCE * tip_m;
        let ends = nodes_m.first().zip(nodes_m.last());
        ends.is_some_and(|(first_m, last_m)| is_same(*first_m, root_m) && is_same(*last_m, tip_m))
            && nodes_m.windows(2).all(|pair| pair[0] < pair[1])
    };
    if nodes_m.len() == links.len() && nodes_m.iter().zip(links).all(is_whole) {
        return Ok(());
    }
    let must = "must be the nodes of all links, of each from its hub to its tip";
    Err(place.refuse("rows", "others", must))
}

impl Parts {
    fn form(&self) -> Form {
        Form::of(self.links.iter().map(|(_, link)| link))
    }

    /// Moves a history out: of a joint, or of the carriage after the last joint, from a column by its number.
    fn take(&mut self, file: &JointFile, joint: usize, column: usize) -> Option<Vec<f64>> {
        let links = self.links.len();
        let (form, joint) = if joint < links { (self.form(), joint) } else { (Form::Carriage, 0) };
        self.histories.remove(&(file.name(form), file.column(form, joint, column)))
    }

    /// Moves the quantities of a table at nodes out, for each link and letter.
    fn take_nodes(&mut self, file: &NodalFile) -> Vec<Vec<StoredNodes>> {
        self.nodal.remove(file.name(self.form())).unwrap_or_default()
    }

    /// Moves the histories of a joint, or of the carriage after the last joint, out, and adds its numbers from the summary, whose file is `place`.
    fn joint(
        &mut self,
        k: usize,
        summary: &Summary,
        place: Place,
    ) -> Result<StoredJoint, TableError> {
        let values = &summary.values;
        let is_alone = self.links.len() == 1;
        // A single link has its numbers in one object, an arm in a list.
        let [results, errors, limits] = ["results", "errors", "limits"].map(|key| &values[key]);
        let (prefix, [results, errors, limits]) = if is_alone {
            (String::new(), [results, errors, limits])
        } else {
            let [results, errors] = [results, errors]
                .map(|own| if k < self.links.len() { &own["joints"][k] } else { &own["carriage"] });
            let prefix =
                if k < self.links.len() { format!("joints.{k}.") } else { "carriage.".into() };
            (prefix, [results, errors, &limits[k]])
        };
        // A solution has both numbers of each joint, null without one.
        for key in ["lead_s", "lag_s"].into_iter().filter(|_| summary.is_solved()) {
            let missing = match results {
                Value::Object(numbers) => match numbers.get(key) {
                    Some(value) if value.is_null() || value.is_number() => continue,
                    _ => format!("results.{prefix}{key}"),
                },
                _ => "results".to_owned(),
            };
            return Err(place.refuse_whole(&format!("{missing} is missing")));
        }
        let motor = self.take(&MOTOR, k, FIRST).zip(self.take(&MOTOR, k, MOTOR_RATE));
        let motor = motor.map(|(torque_n_m, rate_rad_s)| StoredMotor {
            torque_n_m,
            rate_rad_s,
            current_a: self.take(&MOTOR, k, MOTOR_CURRENT),
            voltage_v: self.take(&MOTOR, k, MOTOR_VOLTAGE),
        });
        Ok(StoredJoint {
            torque_n_m: self.take(&TORQUE, k, FIRST).unwrap_or_default(),
            angle_rad: self.take(&ANGLE, k, FIRST).unwrap_or_default(),
            rate_rad_s: self.take(&ANGLE, k, RATE).unwrap_or_default(),
            acceleration_rad_s2: self.take(&ANGLE, k, ACCELERATION).unwrap_or_default(),
            rigid_torque_n_m: self.take(&RIGID_TORQUE, k, FIRST),
            rigid_angle_rad: self.take(&ANGLE, k, RIGID_ANGLE),
            motor,
            readings: if is_alone { summary.readings() } else { numbers_in(results, "") },
            errors: errors_by_kind(errors),
            limits: Summary::limits(limits, place)?,
        })
    }

    /// Moves the motion of a single link along its arc out; `None` for an arm. Unless the run wrote the link's deflections,
    /// they follow from displacements and hub angle.
    fn arc(&mut self, hub: &StoredJoint, summary: &Summary) -> Option<StoredArc> {
        let mesh = self.mesh.take()?;
        let [displacement_m, velocity_m_s, acceleration_m_s2] =
            [0, 1, 2].map(|column| self.take(&TIP, 0, column).unwrap_or_default());
        let origin_rad = origin_rad(&self.links[0].1, hub, &displacement_m);
        let displacements = self.take_nodes(&PLACES).into_iter().flatten().next();
        let name = DEFLECTIONS.name(self.form());
        if let (false, Some(displacements), Some(origin_rad)) =
            (self.nodal.contains_key(name), displacements, origin_rad)
        {
            let hub = (&hub.angle_rad[..], origin_rad);
            let computed = deflections(displacements, &mesh, hub, &self.times_s);
            self.nodal.insert(name, vec![vec![computed]]);
        }
        Some(StoredArc {
            second_order: summary.second_order(),
            kept_modes: summary.kept_modes(),
            origin_rad: origin_rad.unwrap_or(0.0),
            tip: TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 },
            mesh,
        })
    }

    /// The run of these links and tables and of the summary, whose file is `place`.
    fn stored(mut self, summary: &Summary, place: Place) -> Result<StoredRun, TableError> {
        let values = &summary.values;
        let joints = (0..self.links.len()).map(|k| self.joint(k, summary, place));
        let joints = joints.collect::<Result<Vec<_>, _>>()?;
        let carriage = has_carriage(summary).then(|| {
            let joint = self.joint(self.links.len(), summary, place)?;
            let axis = serde_json::from_value(values["arm"]["carriage"]["axis"].clone());
            let axis =
                axis.map_err(|error| place.refuse_whole(&format!("arm.carriage.axis: {error}")))?;
            Ok(StoredCarriage { joint, axis })
        });
        let carriage = carriage.transpose()?;
        let arc = self.arc(&joints[0], summary);
        let time_s = |key: &str| summary.number("motion", key, place);
        let moving_s = || Ok((time_s("moves_from_s")?, time_s("moves_until_s")?));
        // A summary has the gravity of a single link in the link, of an arm beside its links.
        let of_link_m_s2 = self.links[0].1.gravity().map(|gravity| gravity.acceleration_m_s2);
        let of_arm_m_s2 = |axis: usize| values["arm"]["gravity_m_s2"][axis].as_f64().unwrap_or(0.0);
        // x and y of an arm's tip. `arc` has moved the tip of a single link out.
        let tip_m = [0, 1].map(|axis| self.take(&TIP, 0, axis).unwrap_or_default());
        let places = self.take_nodes(&PLACES);
        let nodal_times_s = places.iter().flatten().next().map(|axis| axis.times_s.clone());
        let mut places = places.into_iter().map(|axes| {
            let [x, y] = <[StoredNodes; 2]>::try_from(axes).ok()?;
            let pairs = x.histories.into_iter().zip(y.histories);
            Some(pairs.map(|(x, y)| [x, y]).collect())
        });
        let [mut deflections, mut moments] =
            [&DEFLECTIONS, &MOMENTS].map(|file| self.take_nodes(file).into_iter().flatten());
        let links = self.links.into_iter().zip(self.nodes_m);
        let links = links.map(|((name, link), nodes_m)| StoredLink {
            name,
            link,
            nodes_m,
            positions_m: places.next().flatten().unwrap_or_default(),
            deflections_m: deflections.next(),
            moments_n_m: moments.next(),
        });
        Ok(StoredRun {
            origin: summary.origin(),
            name: self.name,
            joints,
            carriage,
            links: links.collect(),
            arc,
            nodal_times_s: nodal_times_s.unwrap_or_default(),
            tip_m,
            target: self.target,
            prescribed: match values["motion"]["given"].as_str() {
                Some("tip") => Some(Prescribed::Tip),
                Some("angles") => Some(Prescribed::Angles),
                _ => None,
            },
            moving_s: summary.is_solved().then(moving_s).transpose()?,
            gravity_m_s2: of_link_m_s2.unwrap_or_else(|| [0, 1].map(of_arm_m_s2)),
            readings: summary.readings(),
            checks: summary.verification.iter().flatten().flatten().cloned().collect(),
            warnings: summary.warnings.clone(),
            remarks: summary.remarks.clone().unwrap_or_default(),
            times_s: self.times_s,
        })
    }
}

/// Kind of an error that is stored as one number, without a kind: the tip's distance from the wanted motion.
const WANTED: &str = "from the wanted motion";

/// Errors of each quantity by kind. Most quantities have an object of kinds. The errors of a solution's tip are two
/// numbers: `tip`, from the wanted motion, and `tip_model`, of the kind `model`.
fn errors_by_kind(stored: &Value) -> Vec<(String, Vec<(String, f64)>)> {
    let mut errors: Vec<(String, Vec<(String, f64)>)> = Vec::new();
    for (key, value) in stored.as_object().into_iter().flatten() {
        let (quantity, kind) =
            key.strip_suffix("_model").map_or((&key[..], WANTED), |quantity| (quantity, "model"));
        let number = value.as_f64().map(|error| (kind.to_owned(), error));
        let kinds = numbers_in(value, "").into_iter().chain(number);
        match errors.iter_mut().find(|(name, _)| name == quantity) {
            Some((_, all)) => all.extend(kinds),
            None => errors.push((quantity.to_owned(), kinds.collect())),
        }
    }
    errors.retain(|(_, kinds)| !kinds.is_empty());
    errors
}

/// Direction of the chord in rad where the tip's displacement is 0. Without gravity it is 0. With gravity it is the
/// link's start angle, or follows from the first hub angle of the rigid link and the first displacement of the tip.
/// Where the folder shows neither, it is 0 if gravity does not act. If it acts, hub angles are absolute: `None`.
fn origin_rad(link: &Link, hub: &StoredJoint, tip_m: &[f64]) -> Option<f64> {
    let Some(gravity) = link.gravity() else { return Some(0.0) };
    let of_rigid = || {
        let (first_rad, first_m) = (hub.rigid_angle_rad.as_ref()?.first()?, tip_m.first()?);
        Some(first_rad - first_m / link.rigid_tip())
    };
    let start_rad = gravity.start_angle_rad.or_else(of_rigid);
    if gravity.acts() { start_rad } else { Some(start_rad.unwrap_or(0.0)) }
}

/// Number of copies of the nodes' histories that exist at one time while the program makes a page.
const COPIES: usize = 4;

impl RunOutputs {
    /// Approximate memory in bytes for a page of the run.
    pub fn page_bytes(&self, deflections: &NodalTable) -> usize {
        size_of::<f64>() * COPIES * deflections.nodes().len() * deflections.grid().len()
    }

    /// The run of these tables as its files would yield it, but with all digits.
    ///
    /// # Errors
    /// [`TableError`] for a summary of another command than `solve`.
    pub fn stored(&self, tables: &RunTables, summary: &Summary) -> Result<StoredRun, TableError> {
        let form = Form::of(tables.links.iter().map(|own| own.link));
        let count = tables.links.len();
        let mut histories = Histories::new();
        for table in &tables.histories {
            let form = table.form;
            // A page reads no other tables over time.
            let is_shown = [&TORQUE, &RIGID_TORQUE, &ANGLE, &TIP, &MOTOR]
                .iter()
                .any(|file| file.name(form) == table.file.name(form));
            for (joint, columns) in table.joints.iter().enumerate().filter(|_| is_shown) {
                for (column, values) in columns.iter().enumerate() {
                    let name = table.file.column(form, joint, column);
                    histories.insert((table.file.name(form), name), values.to_vec());
                }
            }
        }
        let mut nodal = Nodal::new();
        for table in &tables.nodal {
            let times_s = times_s(&table.times);
            let empty = StoredNodes { nodes: vec![], times_s, histories: vec![] };
            let mut links = vec![vec![empty; table.file.letters(form).len()]; count];
            for column in &table.columns {
                let quantity = &mut links[column.link][column.letter];
                quantity.nodes.push(column.node);
                quantity.histories.push(column.values.to_vec());
            }
            nodal.insert(table.file.name(form), links);
        }
        if let Some(deflections) = &tables.on_request {
            nodal.insert(DEFLECTIONS.name(form), vec![vec![in_order(deflections.histories())]]);
            if self.moments {
                let moments = in_order(deflections.moments().histories());
                nodal.insert(MOMENTS.name(form), vec![vec![moments]]);
            }
        }
        let grid = tables.histories.first().map(|table| table.grid.thinned(NonZeroUsize::MIN));
        let links = tables.links.iter().map(|entry| (entry.name.clone(), entry.link.clone()));
        let parts = Parts {
            name: String::new(),
            links: links.collect(),
            nodes_m: tables.links.iter().map(|entry| entry.nodes_m.to_vec()).collect(),
            mesh: tables.mesh.cloned(),
            times_s: grid.map_or_else(Vec::new, |grid| times_s(&grid)),
            histories,
            nodal,
            target: None,
        };
        parts.stored(summary, Place { file: SUMMARY, line: None })
    }
}

/// Histories with the nodes in ascending order, as in a table.
fn in_order(histories: NodalHistories) -> StoredNodes {
    let NodalHistories { nodes, grid, samples } = histories;
    let mut pairs: Vec<(usize, Vec<f64>)> = nodes.into_iter().zip(samples).collect();
    pairs.sort_by_key(|(node, _)| *node);
    let (nodes, histories) = pairs.into_iter().unzip();
    StoredNodes { nodes, times_s: times_s(&grid), histories }
}
