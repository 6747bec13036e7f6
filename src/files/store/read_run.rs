//! A run from its summary and its tables: read from a folder, or taken from memory before writing.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use serde_json::Value;

use super::json::newer;
use super::names::{
    ANGLE, DEFLECTIONS, JointFile, MOMENTS, MOTOR, NODES, NodalFile, PLACES, RIGID_TORQUE, SUMMARY,
    TIP, TORQUE,
};
use super::outputs::RunOutputs;
use super::read_tables::{
    RunFolder, TIME, Table, check_window, deflections, read_nodal, read_nodes, times_s,
};
use super::run_tables::RunTables;
use super::summary::{LinkRecord, STATIONS, Summary, numbers_in};
use crate::beam::{Mesh, MeshPlan, NodalHistories};
use crate::csv::{Place, TableError};
use crate::inverse::NodalTable;
use crate::link::{Drive, Link};
use crate::motion::{Prescribed, TipMotionHistories};
use crate::result::{
    StoredArc, StoredJoint, StoredLink, StoredMotor, StoredNodes, StoredRun, StoredTarget,
};

/// Histories by file and column.
type Histories = BTreeMap<(&'static str, String), Vec<f64>>;

/// Quantities at nodes by file: for each link and each letter of the file.
type Nodal = BTreeMap<&'static str, Vec<Vec<StoredNodes>>>;

/// A run without its summary.
struct Parts {
    /// Name of its folder.
    name: String,
    /// Names of the links, and the links.
    links: Vec<(String, Link)>,
    /// Distances of the nodes of each link from its joint in m.
    nodes_m: Vec<Vec<f64>>,
    /// The mesh of a single link.
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

/// Reads the tables of a run with this summary, which is at `place`.
fn read_parts(folder: RunFolder, summary: &Summary, place: Place) -> Result<Parts, TableError> {
    let links = links_of(summary, place)?;
    let count = links.len();
    let nodes_file = folder.file(NODES)?;
    let nodes_place = Place { file: &nodes_file.shown, line: None };
    let nodes_m = read_nodes(&nodes_file, count)?;
    let mesh = if let [(_, link)] = &links[..] {
        let nodes_m = nodes_m.first().map_or(&[][..], |own| own);
        let plan = MeshPlan::through(link, nodes_m, &summary.stations_m());
        let mesh = plan.and_then(|plan| Mesh::new(link, &plan));
        Some(mesh.map_err(|error| nodes_place.refuse_whole(&error.to_string()))?)
    } else {
        check_nodes(&nodes_m, &links, nodes_place)?;
        None
    };

    let is_solved = summary.is_solved();
    let all: Vec<usize> = (0..count).collect();
    let mut torque = Table::of(&folder.file(TORQUE.name(count))?, &TORQUE.columns(count, &all))?;
    torque.check_even()?;
    check_window(&torque, summary)?;
    let times_s = torque.take(TIME);
    let of = (TORQUE.name(count), &times_s[..]);
    let is_driven = |joint: &usize| count == 1 || links[*joint].1.drive().is_some();
    let driven: Vec<usize> = all.iter().copied().filter(is_driven).collect();
    let mut tables = vec![(&TORQUE, TORQUE.columns(count, &all), torque)];
    for (file, joints, is_there) in [
        (&ANGLE, &all, true),
        (&TIP, &all, true),
        (&RIGID_TORQUE, &all, is_solved),
        (&MOTOR, &driven, is_solved && !driven.is_empty() && folder.has(MOTOR.name(count))),
    ] {
        if is_there {
            let mut columns = file.columns(count, joints);
            columns.retain(|name| is_solved || !name.starts_with("rigid_"));
            let table = Table::of(&folder.file(file.name(count))?, &columns)?;
            table.check_times(of, 1)?;
            tables.push((file, columns, table));
        }
    }
    let histories = tables.into_iter().flat_map(|(file, columns, mut table)| {
        let history = move |name: String| ((file.name(count), name.clone()), table.take(&name));
        columns.into_iter().map(history)
    });
    let histories = histories.collect();
    let nodes: Vec<usize> = nodes_m.iter().map(Vec::len).collect();
    let arguments = &summary.origin().arguments;
    let is_chosen = arguments.iter().any(|own| own == "--nodes" || own == STATIONS);
    let mut nodal = Nodal::new();
    for file in [&DEFLECTIONS, &PLACES, &MOMENTS] {
        let name = file.name(count);
        // Places of an arm replace its deflections.
        let is_read = !(count > 1 && name == DEFLECTIONS.name(count));
        if is_read && (folder.has(name) || (count > 1 && name == PLACES.name(count))) {
            nodal.insert(name, read_nodal(&folder.file(name)?, file, (&nodes, is_chosen), of)?);
        }
    }
    let target = folder.target(&summary.files, count)?;
    let name = folder.0.display().to_string();
    Ok(Parts { name, links, nodes_m, mesh, times_s, histories, nodal, target })
}

/// Names and links in a summary. The name of an unnamed link is its number.
fn links_of(summary: &Summary, place: Place) -> Result<Vec<(String, Link)>, TableError> {
    if !summary.is_of_arm() {
        let link = summary.link().map_err(|error| place.refuse_whole(&format!("link.{error}")))?;
        return Ok(vec![("1".to_owned(), link)]);
    }
    let links = summary.values["arm"]["links"].as_array().filter(|links| links.len() > 1);
    let missing = || place.refuse_whole("arm.links must be a list of two links or more");
    let link = |(k, entry): (usize, &Value)| {
        let name = entry["name"].as_str().map_or_else(|| (k + 1).to_string(), str::to_owned);
        let refused = |error: String| place.refuse_whole(&format!("arm.links.{k}: {error}"));
        let record = serde_json::from_value::<LinkRecord>(entry["link"].clone());
        let drive = serde_json::from_value::<Option<Drive>>(entry["drive"].clone());
        let (record, drive) = record
            .and_then(|record| Ok((record, drive?)))
            .map_err(|error| refused(error.to_string()))?;
        let link = record.link(&name, drive).map_err(|error| refused(error.to_string()))?;
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
    let is_whole = |(own, (_, link)): (&Vec<f64>, &(String, Link))| {
        let length_m = link.length_m();
        let is_at = |x_m: Option<&f64>, end_m: f64| {
            x_m.is_some_and(|x_m| (x_m - end_m).abs() <= 1e-9 * length_m)
        };
        let rises = own.windows(2).all(|pair| pair[0] < pair[1]);
        rises && is_at(own.first(), link.hub().radius_m) && is_at(own.last(), length_m)
    };
    if nodes_m.len() == links.len() && nodes_m.iter().zip(links).all(is_whole) {
        return Ok(());
    }
    let must = "must be the nodes of all links, of each from its hub to its tip";
    Err(place.refuse("rows", "others", must))
}

impl Parts {
    fn take(&mut self, file: &JointFile, joint: usize, column: usize) -> Option<Vec<f64>> {
        let count = self.links.len();
        self.histories.remove(&(file.name(count), file.column(count, joint, column)))
    }

    fn take_nodes(&mut self, file: &NodalFile) -> Vec<Vec<StoredNodes>> {
        self.nodal.remove(file.name(self.links.len())).unwrap_or_default()
    }

    /// Takes the histories of a joint, and its numbers from the summary, which is at `place`.
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
        let (of, [results, errors, limits]) = if is_alone {
            (String::new(), [results, errors, limits])
        } else {
            let of = format!("joints.{k}.");
            (of, [&results["joints"][k], &errors["joints"][k], &limits[k]])
        };
        for key in ["lead_s", "lag_s"].into_iter().filter(|_| summary.is_solved()) {
            let missing = match results {
                Value::Object(numbers) => match numbers.get(key) {
                    Some(value) if value.is_null() || value.is_number() => continue,
                    _ => format!("results.{of}{key}"),
                },
                _ => "results".to_owned(),
            };
            return Err(place.refuse_whole(&format!("{missing} is missing")));
        }
        let motor = self.take(&MOTOR, k, 0).zip(self.take(&MOTOR, k, 2));
        Ok(StoredJoint {
            torque_n_m: self.take(&TORQUE, k, 0).unwrap_or_default(),
            angle_rad: self.take(&ANGLE, k, 0).unwrap_or_default(),
            rate_rad_s: self.take(&ANGLE, k, 1).unwrap_or_default(),
            rigid_torque_n_m: self.take(&RIGID_TORQUE, k, 0),
            rigid_angle_rad: self.take(&ANGLE, k, 3),
            motor: motor.map(|(torque_n_m, rate_rad_s)| StoredMotor { torque_n_m, rate_rad_s }),
            readings: if is_alone { summary.readings() } else { numbers_in(results, "") },
            errors: errors_by_kind(errors),
            limits: Summary::limits(limits),
        })
    }

    /// Takes the motion of a single link along its arc.
    fn arc(&mut self, hub: &StoredJoint, summary: &Summary) -> Option<StoredArc> {
        let mesh = self.mesh.take()?;
        let [displacement_m, velocity_m_s, acceleration_m_s2] =
            [0, 1, 2].map(|column| self.take(&TIP, 0, column).unwrap_or_default());
        let origin_rad = origin_rad(&self.links[0].1, hub, &displacement_m);
        let [written, displacements] =
            [&DEFLECTIONS, &PLACES].map(|file| self.take_nodes(file).into_iter().flatten().next());
        let computed = || {
            let hub = (&hub.angle_rad[..], origin_rad?);
            Some(deflections(displacements?, mesh.nodes_m(), hub, &self.times_s))
        };
        Some(StoredArc {
            second_order: summary.second_order(),
            kept_modes: summary.kept_modes(),
            origin_rad: origin_rad.unwrap_or(0.0),
            tip: TipMotionHistories { displacement_m, velocity_m_s, acceleration_m_s2 },
            deflections_m: written.or_else(computed),
            mesh,
        })
    }

    /// Puts summary and tables of a run together.
    fn stored(mut self, summary: &Summary, place: Place) -> Result<StoredRun, TableError> {
        let values = &summary.values;
        let joints = (0..self.links.len()).map(|k| self.joint(k, summary, place));
        let joints = joints.collect::<Result<Vec<_>, _>>()?;
        let arc = self.arc(&joints[0], summary);
        let moves = |key: &str| summary.number("motion", key, place);
        let moving = || Ok((moves("moves_from_s")?, moves("moves_until_s")?));
        let of_arm = |axis: usize| values["arm"]["gravity_m_s2"][axis].as_f64().unwrap_or(0.0);
        let of_link = self.links[0].1.gravity().map(|gravity| gravity.acceleration_m_s2);
        // The places of an arm, whose tip has two columns for each order.
        let tip_m = [0, 1].map(|axis| self.take(&TIP, 0, axis).unwrap_or_default());
        let places = self.take_nodes(&PLACES);
        let nodal_times_s = places.iter().flatten().next().map(|axis| axis.times_s.clone());
        let mut places = places.into_iter().map(|axes| {
            let [x, y] = <[StoredNodes; 2]>::try_from(axes).ok()?;
            let pairs = x.histories.into_iter().zip(y.histories);
            Some(pairs.map(|(x, y)| [x, y]).collect())
        });
        let mut moments = self.take_nodes(&MOMENTS).into_iter().flatten();
        let links = self.links.into_iter().zip(self.nodes_m);
        let links = links.map(|((name, link), nodes_m)| StoredLink {
            name,
            link,
            nodes_m,
            positions_m: places.next().flatten().unwrap_or_default(),
            moments_n_m: moments.next(),
        });
        Ok(StoredRun {
            origin: summary.origin(),
            name: self.name,
            joints,
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
            moving_s: summary.is_solved().then(moving).transpose()?,
            gravity_m_s2: of_link.unwrap_or_else(|| [0, 1].map(of_arm)),
            readings: summary.readings(),
            checks: summary.verification.iter().flatten().flatten().cloned().collect(),
            warnings: summary.warnings.clone(),
            remarks: summary.remarks.clone().unwrap_or_default(),
            times_s: self.times_s,
        })
    }
}

/// Kind of the error of a tip: the distance from the wanted motion is known at every moment.
const WANTED: &str = "from the wanted motion";

/// Errors of each quantity by kind. A number alone is an error of the tip.
fn errors_by_kind(stored: &Value) -> Vec<(String, Vec<(String, f64)>)> {
    let mut found: Vec<(String, Vec<(String, f64)>)> = Vec::new();
    for (key, value) in stored.as_object().into_iter().flatten() {
        let (quantity, kind) =
            key.strip_suffix("_model").map_or((&key[..], WANTED), |quantity| (quantity, "model"));
        let alone = value.as_f64().map(|error| (kind.to_owned(), error));
        let kinds = numbers_in(value, "").into_iter().chain(alone);
        match found.iter_mut().find(|(own, _)| own == quantity) {
            Some((_, all)) => all.extend(kinds),
            None => found.push((quantity.to_owned(), kinds.collect())),
        }
    }
    found.retain(|(_, kinds)| !kinds.is_empty());
    found
}

/// Direction of the chord in rad where the tip's displacement is 0. Unknown if gravity makes hub angles absolute and
/// the folder does not show the zero of displacements.
fn origin_rad(link: &Link, hub: &StoredJoint, tip_m: &[f64]) -> Option<f64> {
    let Some(gravity) = link.gravity() else { return Some(0.0) };
    let rigid = || {
        let (first_rad, first_m) = (hub.rigid_angle_rad.as_ref()?.first()?, tip_m.first()?);
        Some(first_rad - first_m / link.length_m())
    };
    let given = gravity.start_angle_rad.or_else(rigid);
    if gravity.acts() { given } else { Some(given.unwrap_or(0.0)) }
}

/// Copies of the nodes' histories at one time while the program makes a page.
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
        let count = tables.links.len();
        let mut histories = Histories::new();
        for table in &tables.histories {
            // A page shows only these tables.
            let is_shown = [&TORQUE, &RIGID_TORQUE, &ANGLE, &TIP, &MOTOR]
                .iter()
                .any(|file| file.name(count) == table.file.name(count));
            for (joint, columns) in table.joints.iter().enumerate().filter(|_| is_shown) {
                for (column, values) in columns.iter().enumerate() {
                    let name = table.file.column(count, joint, column);
                    histories.insert((table.file.name(count), name), values.to_vec());
                }
            }
        }
        let mut nodal = Nodal::new();
        let is_shown = |name: &str| name != DEFLECTIONS.name(count);
        for table in tables.nodal.iter().filter(|table| is_shown(table.file.name(count))) {
            let times_s = times_s(&table.times);
            let empty = StoredNodes { nodes: vec![], times_s, histories: vec![] };
            let mut found = vec![vec![empty; table.file.letters(count).len()]; count];
            for column in &table.columns {
                let nodes = &mut found[column.link][column.letter];
                nodes.nodes.push(column.node);
                nodes.histories.push(column.values.to_vec());
            }
            nodal.insert(table.file.name(count), found);
        }
        if let Some(deflections) = &tables.on_request {
            let histories = in_order(deflections.histories());
            nodal.insert(DEFLECTIONS.name(count), vec![vec![histories]]);
            if self.moments {
                let histories = in_order(deflections.moments().histories());
                nodal.insert(MOMENTS.name(count), vec![vec![histories]]);
            }
        }
        let grid = tables.histories.first().map(|table| table.grid.thinned(NonZeroUsize::MIN));
        let links = tables.links.iter().map(|own| (own.name.clone(), own.link.clone()));
        let parts = Parts {
            name: String::new(),
            links: links.collect(),
            nodes_m: tables.links.iter().map(|own| own.nodes_m.to_vec()).collect(),
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
