//! The folder of a run of an arm, read back; and a run taken from memory before it is written.

use std::num::NonZeroUsize;

use serde_json::Value;

use super::arm_run::{
    joint_angle, joint_rate, moment, motor_rate, motor_torque, position, rigid_joint_angle,
    rigid_torque, torque,
};
use super::read_tables::{RunFolder, TIME, Table, check_window, read_number, stride, times_s};
use super::run_tables::{
    ARM_NODES, JOINT_ANGLES, MOMENTS, MOTOR, NODES, POSITIONS, RIGID_TORQUES, RunOutputs, TIP,
    TORQUES, WANTED_PLACE,
};
use super::summary::{LinkRecord, STATIONS, Summary, numbers_in};
use crate::csv::{InputFile, Place, TableError, quoted, read_rows};
use crate::inverse::ArmSolution;
use crate::link::{Drive, Link};
use crate::motion::Prescribed;
use crate::result::{
    StoredArm, StoredArmLink, StoredJoint, StoredMotor, StoredNodes, StoredTarget,
};

/// The histories of a run of an arm.
struct Histories {
    times_s: Vec<f64>,
    joints: Vec<JointHistories>,
    links: Vec<StoredArmLink>,
    nodal_times_s: Vec<f64>,
    tip_m: [Vec<f64>; 2],
    target: Option<StoredTarget>,
}

/// Those of one joint: torque, angle, rate, and where they are known torque and angle of the rigid arm, and the motor.
struct JointHistories {
    own: [Vec<f64>; 3],
    rigid: [Option<Vec<f64>>; 2],
    motor: Option<StoredMotor>,
}

/// Reads all that a run of an arm with this summary, which is at `place`, has left.
pub(super) fn read_arm(
    folder: RunFolder,
    summary: &Summary,
    place: Place,
) -> Result<StoredArm, TableError> {
    let links = links_of(summary, place)?;
    let nodes_m = read_nodes(&folder.file(NODES.0)?, &links)?;
    let numbers = 1..=links.len();
    let each = |name: fn(usize) -> String| numbers.clone().map(name).collect::<Vec<String>>();
    let mut torques = Table::holding(&folder.file(TORQUES)?, &each(torque))?;
    torques.check_even()?;
    check_window(&torques, summary)?;
    let times_s = torques.take(TIME);
    let arguments = summary.origin().arguments;
    let has_some_nodes = arguments.iter().any(|own| own == "--nodes" || own == STATIONS);
    let read = |file: &str, columns: &[String]| {
        let is_nodal = [POSITIONS, MOMENTS.file].contains(&file);
        let table = Table::holding(&folder.file(file)?, columns);
        let table = table.map_err(|error| {
            let hint =
                "the page draws all nodes of an arm: solve it without --nodes and --stations";
            if is_nodal && has_some_nodes { error.with_hint(hint.to_owned()) } else { error }
        })?;
        // The tables at nodes may be thinned.
        let every = if is_nodal { stride(table.times_s(), &times_s) } else { 1 };
        table.check_times((TORQUES, &times_s), every)?;
        Ok::<Table, TableError>(table)
    };
    let there = |file: &str, columns: Vec<String>| {
        folder.has(file).then(|| read(file, &columns)).transpose()
    };
    let mut angles = read(JOINT_ANGLES, &[each(joint_angle), each(joint_rate)].concat())?;
    let mut tip = read(TIP.0, &["x_m", "y_m"].map(str::to_owned))?;
    let mut rigid = there(RIGID_TORQUES, each(rigid_torque))?;
    let mut motor = there(MOTOR.0, vec![])?;
    // A column that is not there is empty.
    let some = |column: Vec<f64>| Some(column).filter(|column| column.len() == times_s.len());
    let joints = numbers.clone().map(|number| JointHistories {
        own: [
            torques.take(&torque(number)),
            angles.take(&joint_angle(number)),
            angles.take(&joint_rate(number)),
        ],
        rigid: [
            rigid.as_mut().map(|rigid| rigid.take(&rigid_torque(number))),
            some(angles.take(&rigid_joint_angle(number))),
        ],
        motor: motor.as_mut().and_then(|own| {
            let torque_n_m = some(own.take(&motor_torque(number)))?;
            Some(StoredMotor { torque_n_m, rate_rad_s: some(own.take(&motor_rate(number)))? })
        }),
    });
    let joints = joints.collect();

    let at_nodes = |name: &dyn Fn(usize, usize) -> Vec<String>| -> Vec<String> {
        let links = numbers.clone().zip(&nodes_m);
        links.flat_map(|(k, own)| (0..own.len()).flat_map(move |node| name(k, node))).collect()
    };
    let places = |link, node| vec![position("x", link, node), position("y", link, node)];
    let mut positions = read(POSITIONS, &at_nodes(&places))?;
    let mut moments = there(MOMENTS.file, at_nodes(&|link, node| vec![moment(link, node)]))?;
    let moment_times_s = moments.as_mut().map(|own| own.take(TIME)).unwrap_or_default();
    let mut shape = |(number, ((name, link), nodes_m)): (usize, ((String, Link), Vec<f64>))| {
        let all = 0..nodes_m.len();
        let moments = moments.as_mut().map(|own| StoredNodes {
            nodes: all.clone().collect(),
            times_s: moment_times_s.clone(),
            histories: all.clone().map(|node| own.take(&moment(number, node))).collect(),
        });
        let place = |node| ["x", "y"].map(|axis| positions.take(&position(axis, number, node)));
        let positions_m = all.clone().map(place).collect();
        StoredArmLink { name, link, nodes_m, positions_m, moments_n_m: moments }
    };
    let links = (1..).zip(links.into_iter().zip(nodes_m)).map(&mut shape).collect();
    let nodal_times_s = positions.take(TIME);
    let tip_m = ["x_m", "y_m"].map(|name| tip.take(name));
    let target = folder.target(&summary.files, &WANTED_PLACE)?;
    let histories = Histories { times_s, joints, links, nodal_times_s, tip_m, target };
    Ok(stored(summary, folder.0.display().to_string(), histories))
}

/// Names and links of the arm in a summary.
fn links_of(summary: &Summary, place: Place) -> Result<Vec<(String, Link)>, TableError> {
    let links = summary.values["arm"]["links"].as_array().filter(|links| links.len() > 1);
    let missing = || place.refuse("arm.links", "nothing", "must be a list of two links or more");
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

/// Distances of the nodes of each link from its joint in m.
fn read_nodes(file: &InputFile, links: &[(String, Link)]) -> Result<Vec<Vec<f64>>, TableError> {
    let whole = Place { file: &file.shown, line: None };
    let at = |line| Place { line: Some(line), ..whole };
    let begin = |line, fields: &[&str]| {
        if fields == ARM_NODES {
            return Ok(Vec::<Vec<f64>>::new());
        }
        let must = format!("must be {}", quoted(&ARM_NODES.join(",")));
        Err(at(line).refuse("columns", quoted(&fields.join(",")), must))
    };
    let push = |nodes_m: &mut Vec<Vec<f64>>, line, fields: &[&str]| {
        at(line).check_width(fields.len(), ARM_NODES.len())?;
        if fields[1] == "0" {
            nodes_m.push(Vec::new());
        }
        let link = nodes_m.len().to_string();
        let node = nodes_m.last().map_or(0, Vec::len).to_string();
        for (name, found, must) in [("link", fields[0], link), ("node", fields[1], node)] {
            if found != must {
                return Err(at(line).refuse(name, quoted(found), format!("must be {must}")));
            }
        }
        let x_m = read_number(ARM_NODES[2], fields[2], at(line))?;
        nodes_m.last_mut().into_iter().for_each(|own| own.push(x_m));
        Ok(())
    };
    let nodes_m = read_rows(&file.shown, &file.bytes, begin, push)?.unwrap_or_default();
    let is_whole = |(own, (_, link)): (&Vec<f64>, &(String, Link))| {
        let length_m = link.length_m();
        let is_at = |x_m: Option<&f64>, end_m: f64| {
            x_m.is_some_and(|x_m| (x_m - end_m).abs() <= 1e-9 * length_m)
        };
        let rises = own.windows(2).all(|pair| pair[0] < pair[1]);
        rises && is_at(own.first(), link.hub().radius_m) && is_at(own.last(), length_m)
    };
    if nodes_m.len() != links.len() || !nodes_m.iter().zip(links).all(is_whole) {
        let must = "must be the nodes of all links, of each from its hub to its tip";
        return Err(whole.refuse("rows", "others", must));
    }
    Ok(nodes_m)
}

/// A run as its summary and its histories tell it.
fn stored(summary: &Summary, name: String, histories: Histories) -> StoredArm {
    let values = &summary.values;
    let Histories { times_s, joints, links, nodal_times_s, tip_m, target } = histories;
    let joint = |(k, histories): (usize, JointHistories)| {
        let errors = values["errors"]["joints"][k].as_object().into_iter().flatten();
        let errors = errors.map(|(quantity, kinds)| (quantity.clone(), numbers_in(kinds, "")));
        let [torque_n_m, angle_rad, rate_rad_s] = histories.own;
        let [rigid_torque_n_m, rigid_angle_rad] = histories.rigid;
        StoredJoint {
            torque_n_m,
            angle_rad,
            rate_rad_s,
            rigid_torque_n_m,
            rigid_angle_rad,
            motor: histories.motor,
            readings: numbers_in(&values["results"]["joints"][k], ""),
            errors: errors.filter(|(_, kinds)| !kinds.is_empty()).collect(),
            limits: Summary::limits(&values["limits"][k]),
        }
    };
    let moves = |key: &str| values["motion"][key].as_f64();
    let prescribed = match values["motion"]["given"].as_str() {
        Some("tip") => Some(Prescribed::Tip),
        Some("angles") => Some(Prescribed::Angles),
        _ => None,
    };
    let gravity = |axis: usize| values["arm"]["gravity_m_s2"][axis].as_f64().unwrap_or(0.0);
    StoredArm {
        origin: summary.origin(),
        name,
        times_s,
        joints: joints.into_iter().enumerate().map(joint).collect(),
        links,
        nodal_times_s,
        tip_m,
        target,
        prescribed,
        moving_s: moves("moves_from_s").zip(moves("moves_until_s")),
        gravity_m_s2: [gravity(0), gravity(1)],
        readings: summary.readings(),
        checks: summary.verification.iter().flatten().flatten().cloned().collect(),
        warnings: summary.warnings.clone(),
        remarks: summary.remarks.clone().unwrap_or_default(),
    }
}

impl RunOutputs {
    /// The run as reading back its files gives it, but with all digits.
    pub fn stored_arm(&self, solution: &ArmSolution, summary: &Summary) -> StoredArm {
        let nodal_times_s = times_s(&solution.grid.thinned(self.every));
        let few = |values: &Vec<f64>| -> Vec<f64> {
            values.iter().step_by(self.every.get()).copied().collect()
        };
        let joints = solution.joints.iter().map(|joint| JointHistories {
            own: [joint.torque_n_m.clone(), joint.angle[0].clone(), joint.angle[1].clone()],
            rigid: [Some(joint.rigid_torque_n_m.clone()), Some(joint.rigid_angle_rad.clone())],
            motor: joint.motor.as_ref().map(StoredMotor::from),
        });
        let links = solution.arm.links().iter().zip(&solution.links).enumerate();
        let links = links.map(|(k, (own, shape))| StoredArmLink {
            name: own.name.clone().unwrap_or_else(|| (k + 1).to_string()),
            link: own.link.clone(),
            nodes_m: shape.nodes_m.clone(),
            positions_m: shape.positions_m.iter().map(|place| place.each_ref().map(few)).collect(),
            moments_n_m: self.moments.then(|| StoredNodes {
                nodes: (0..shape.nodes_m.len()).collect(),
                times_s: nodal_times_s.clone(),
                histories: shape.moments_n_m.iter().map(few).collect(),
            }),
        });
        let histories = Histories {
            times_s: times_s(&solution.grid.thinned(NonZeroUsize::MIN)),
            joints: joints.collect(),
            links: links.collect(),
            nodal_times_s: nodal_times_s.clone(),
            tip_m: solution.tip.each_ref().map(|axis| axis[0].clone()),
            target: None,
        };
        stored(summary, String::new(), histories)
    }
}
