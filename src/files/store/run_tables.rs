//! The tables of a run before they are written: histories of the joints and of the tip, and quantities at nodes; and the
//! writing of its folder: all files or none.

use std::borrow::Cow;
use std::io::{self, Write};
use std::path::Path;

use rayon::prelude::*;

use super::folder::{FolderError, OutputFolder};
use super::names::{
    ANGLE, CHORD, DEFLECTIONS, FORCE, Form, JointFile, MOMENTS, MOTOR, NODES, NodalFile,
    OF_CARRIAGE, PLACES, REPORT, RIGID_TORQUE, RunOutputs, SUMMARY, TIP, TIP_ERROR, TORQUE,
    node_columns, result_files,
};
use super::run_summary::{Findings, PlayedRun};
use super::summary::{RunInputs, Summary};
use crate::beam::Mesh;
use crate::csv::{Column, ColumnGroup, Digits, write_csv, write_nodal};
use crate::inverse::{LinkShape, MotorHistories, NodalTable, Solution, Unwatched, Watch};
use crate::link::{Arm, Link, ParameterError};
use crate::motion::TipMotionHistories;
use crate::numeric::{ThinnedGrid, TimeGrid};
use crate::response::Played;
use crate::result::{FollowedTarget, Metrics};

/// All tables of a run.
pub struct RunTables<'a> {
    pub(super) histories: Vec<Histories<'a>>,
    /// Tables at nodes.
    pub(super) nodal: Vec<NodalColumns<'a>>,
    /// Deflections of a link's nodes. The program computes the tables at nodes from them while writing.
    pub(super) on_request: Option<NodalTable<'a>>,
    pub(super) links: Vec<LinkNodes<'a>>,
    /// The mesh of a single link.
    pub(super) mesh: Option<&'a Mesh>,
}

/// A table over time: each joint's columns in the file's order. A table may lack trailing columns, and a joint
/// without a drive lacks all of them.
pub(super) struct Histories<'a> {
    pub(super) file: &'static JointFile,
    /// Form of its names.
    pub(super) form: Form,
    pub(super) grid: &'a TimeGrid,
    pub(super) joints: Vec<Columns<'a>>,
}

type Columns<'a> = Vec<Cow<'a, [f64]>>;

/// A table at nodes.
pub(super) struct NodalColumns<'a> {
    pub(super) file: &'static NodalFile,
    pub(super) times: ThinnedGrid,
    pub(super) columns: Vec<NodalColumn<'a>>,
}

/// Histories of a quantity at a node of a link of an arm.
type OfNode = for<'a> fn(&'a LinkShape, usize) -> Vec<&'a Vec<f64>>;

/// A quantity of a node at the times of its table.
pub(super) struct NodalColumn<'a> {
    pub(super) link: usize,
    /// Number of the letter among those of the file.
    pub(super) letter: usize,
    pub(super) node: usize,
    pub(super) values: Cow<'a, [f64]>,
}

/// A link and its nodes.
pub(super) struct LinkNodes<'a> {
    pub(super) link: &'a Link,
    /// Its name, or its number from 1 without a name.
    pub(super) name: String,
    /// Distances of the nodes from its joint in m.
    pub(super) nodes_m: &'a [f64],
    /// The name beside each node: for a link the segment that ends there (node 0: begins there), for an arm the link.
    pub(super) names: Vec<String>,
}

/// Histories as columns.
fn columns<const N: usize>(histories: [&Vec<f64>; N]) -> Columns<'_> {
    histories.map(|history| Cow::from(&history[..])).to_vec()
}

fn motor(motor: Option<&MotorHistories>) -> Columns<'_> {
    motor.map_or_else(Vec::new, |motor| {
        let own = [&motor.torque_n_m, &motor.angle_rad, &motor.rate_rad_s, &motor.power_w];
        let electrical = motor.current_a.iter().chain(&motor.voltage_v);
        columns(own).into_iter().chain(electrical.map(|own| Cow::from(&own[..]))).collect()
    })
}

/// The tables of these files that have a column.
fn tables<'a>(
    grid: &'a TimeGrid,
    form: Form,
    files: impl IntoIterator<Item = (&'static JointFile, Vec<Columns<'a>>)>,
) -> Vec<Histories<'a>> {
    let tables = files.into_iter().map(|(file, joints)| Histories { file, form, grid, joints });
    tables.filter(|table| table.joints.iter().any(|columns| !columns.is_empty())).collect()
}

/// The table of a wanted tip.
fn wanted(target: Option<&FollowedTarget>, form: Form) -> Option<Histories<'_>> {
    let FollowedTarget { grid, wanted_m, error_m, .. } = target?;
    let all = wanted_m.iter().chain([error_m]).map(|history| Cow::from(&history[..]));
    Some(Histories { file: &TIP_ERROR, form, grid, joints: vec![all.collect()] })
}

/// A link on its mesh. The name of an unnamed segment is its number.
fn on_mesh<'a>(link: &'a Link, mesh: &'a Mesh) -> Vec<LinkNodes<'a>> {
    let nodes_m = mesh.nodes_m();
    let name = |node: usize| {
        let index = mesh.element_segments()[node.saturating_sub(1)];
        link.segments()[index].name.clone().unwrap_or_else(|| index.to_string())
    };
    vec![LinkNodes {
        link,
        name: "1".to_owned(),
        names: (0..nodes_m.len()).map(name).collect(),
        nodes_m,
    }]
}

/// The links of an arm with these nodes.
fn of_links<'a>(arm: &'a Arm, nodes_m: impl IntoIterator<Item = &'a [f64]>) -> Vec<LinkNodes<'a>> {
    let links = (1..).zip(arm.links()).zip(nodes_m).map(|((number, own), nodes_m)| LinkNodes {
        link: &own.link,
        name: own.name.clone().unwrap_or_else(|| usize::to_string(&number)),
        nodes_m,
        names: vec![own.name.clone().unwrap_or_default(); nodes_m.len()],
    });
    links.collect()
}

/// The tables at nodes of an arm's links.
fn shape_tables<'a>(solution: &'a Solution, outputs: &RunOutputs) -> Vec<NodalColumns<'a>> {
    let times = outputs.nodal_rows(&solution.grid);
    let nodal: [(_, _, OfNode); 3] = [
        (&PLACES, true, |own, node| own.positions_m[node].iter().collect()),
        (&DEFLECTIONS, outputs.deflections, |own, node| vec![&own.deflections_m[node]]),
        (&MOMENTS, outputs.moments, |own, node| vec![&own.moments_n_m[node]]),
    ];
    let nodal = nodal.into_iter().filter(|(_, is_written, _)| *is_written);
    let nodal = nodal.map(|(file, _, of)| {
        let mut columns = Vec::new();
        for (link, (shape, nodes_m)) in solution.shapes().zip(solution.nodes_m()).enumerate() {
            // A link may have fewer nodes than the list names.
            let is_there = |node: &usize| *node < nodes_m.len();
            for node in outputs.nodes_of(nodes_m).into_iter().filter(is_there) {
                let column = |(letter, values): (usize, &'a Vec<f64>)| NodalColumn {
                    link,
                    letter,
                    node,
                    values: times.taken(values),
                };
                columns.extend(of(shape, node).into_iter().enumerate().map(column));
            }
        }
        NodalColumns { file, times, columns }
    });
    nodal.collect()
}

impl<'a> RunTables<'a> {
    /// Deflections of a link's nodes, the source of its tables at nodes during writing. `None` for an arm.
    pub fn on_request(&self) -> Option<&NodalTable<'a>> {
        self.on_request.as_ref()
    }

    /// Memory in bytes of the tables that are computed during writing.
    pub fn nodal_bytes(&self) -> usize {
        self.on_request.as_ref().map_or(0, NodalTable::bytes)
    }

    /// The tables of a solution that `outputs` names.
    ///
    /// # Errors
    /// [`ParameterError`] if a node is not one of the mesh.
    pub fn of_solution(
        solution: &'a Solution,
        outputs: &RunOutputs,
    ) -> Result<Self, ParameterError> {
        let Solution { arm, grid, joints, links, tip, .. } = solution;
        let mut files = [(); 5].map(|()| Vec::new());
        for (number, joint) in joints.iter().enumerate().take(links.len()) {
            let mut angles = columns([&joint.angle_rad, &joint.rate_rad_s, &joint.rigid_angle_rad]);
            angles.insert(2, solution.acceleration_rad_s2(number));
            if arm.links()[number].link.joint().slides() {
                angles.push(Cow::from(&links[number].root_moment_n_m[..]));
            }
            let own = [
                columns([&joint.torque_n_m]),
                columns([&joint.rigid_torque_n_m]),
                angles,
                motor(joint.motor.as_ref()),
                joint.force_n.as_ref().map_or_else(Vec::new, |force| columns(force.each_ref())),
            ];
            files.iter_mut().zip(own).for_each(|(joints, own)| joints.push(own));
        }
        let chords = solution.shapes().map(|LinkShape { chord, chord_length_m, .. }| {
            let [angle, rate, acceleration] = chord;
            columns([angle, rate, acceleration, chord_length_m])
        });
        let motions: [fn(&TipMotionHistories) -> &Vec<f64>; 3] =
            [|tip| &tip.displacement_m, |tip| &tip.velocity_m_s, |tip| &tip.acceleration_m_s2];
        let tips = motions.into_iter().flat_map(|of| tip.iter().map(move |tip| Cow::from(of(tip))));
        let files = [&TORQUE, &RIGID_TORQUE, &ANGLE, &MOTOR, &FORCE].into_iter().zip(files);
        let files = files.chain([(&CHORD, chords.collect()), (&TIP, vec![tips.collect()])]);
        let form = Form::of(arm.links().iter().map(|own| &own.link));
        let mut histories = tables(grid, form, files);
        if let Some(own) = joints.get(links.len()) {
            let mut places = columns([&own.angle_rad, &own.rate_rad_s]);
            places.push(solution.acceleration_rad_s2(links.len()));
            let columns = [columns([&own.torque_n_m]), columns([&own.rigid_torque_n_m]), places];
            let files = OF_CARRIAGE.into_iter().zip(columns.map(|own| vec![own]));
            histories.extend(tables(grid, Form::Carriage, files));
        }
        if let [link] = &links[..] {
            return Ok(Self {
                histories,
                nodal: vec![],
                on_request: Some(outputs.deflections(solution)?),
                links: on_mesh(link.link(), link.mesh()),
                mesh: Some(link.mesh()),
            });
        }
        let nodal = shape_tables(solution, outputs);
        let links = of_links(arm, solution.nodes_m());
        Ok(Self { histories, nodal, on_request: None, links, mesh: None })
    }

    /// The tables of a simulation, with a target or without.
    ///
    /// # Errors
    /// [`ParameterError`] if a node is not one of the mesh.
    pub fn of_played(
        PlayedRun { arm, result, .. }: &PlayedRun<'a>,
        outputs: &RunOutputs,
    ) -> Result<Self, ParameterError> {
        let (played, target) = (&result.played, result.target.as_ref());
        let Played { grid, joints, tip, links, .. } = played;
        let torques = joints.iter().map(|joint| columns([&joint.torque_n_m]));
        let mut torques: Vec<_> = torques.collect();
        let angles = joints.iter().map(|joint| {
            columns([&joint.angle_rad, &joint.rate_rad_s, &joint.acceleration_rad_s2])
        });
        let mut angles: Vec<_> = angles.collect();
        // The carriage of an arm is the joint after those of its links.
        let [force, carriage] = [&mut torques, &mut angles].map(|own| own.split_off(links.len()));
        let tip = [
            order_of(tip, |own| &own.displacement_m),
            order_of(tip, |own| &own.velocity_m_s),
            order_of(tip, |own| &own.acceleration_m_s2),
        ]
        .concat();
        let chords = played.bent().map_or(&[][..], |bent| &bent.chords_rad);
        let files = [
            (&TORQUE, torques),
            (&TIP, vec![tip]),
            (&ANGLE, angles),
            (&CHORD, chords.iter().map(|own| columns([own])).collect()),
        ];
        let of_carriage = tables(grid, Form::Carriage, [(&TORQUE, force), (&ANGLE, carriage)]);
        let nodes = links.iter().map(|link| {
            let nodes_m = link.mesh.nodes_m();
            let nodes = outputs.nodes_of(nodes_m).into_iter();
            // An arm's link may have fewer nodes than the list names.
            nodes.filter(|node| arm.alone().is_some() || *node < nodes_m.len()).collect()
        });
        let nodes: Vec<Vec<usize>> = nodes.collect();
        let mut all = Vec::new();
        for (link, places) in played.places_m(&nodes, outputs.every)?.into_iter().enumerate() {
            for (node, place) in nodes[link].iter().zip(places) {
                let column = |(letter, values): (usize, Vec<f64>)| NodalColumn {
                    link,
                    letter,
                    node: *node,
                    values: values.into(),
                };
                all.extend(place.into_iter().enumerate().map(column));
            }
        }
        let times = grid.thinned(outputs.every);
        let form = Form::of(arm.links().iter().map(|own| &own.link));
        let (links, mesh) = match (arm.links(), &links[..]) {
            ([own], [link]) => (on_mesh(&own.link, &link.mesh), Some(&link.mesh)),
            _ => (of_links(arm, links.iter().map(|link| link.mesh.nodes_m())), None),
        };
        Ok(Self {
            histories: tables(grid, form, files)
                .into_iter()
                .chain(of_carriage)
                .chain(wanted(target, form))
                .collect(),
            nodal: vec![NodalColumns { file: &PLACES, times, columns: all }],
            on_request: None,
            links,
            mesh,
        })
    }
}

/// One history of each axis of a tip.
fn order_of(
    tip: &[TipMotionHistories],
    of: impl Fn(&TipMotionHistories) -> &Vec<f64>,
) -> Columns<'_> {
    tip.iter().map(|axis| Cow::from(&of(axis)[..])).collect()
}

/// Writes the folder of a solution whose link and motion a program has from numbers, with all files that
/// `flexlink solve` writes; [`read_result`](super::read_result) reads it back.
///
/// ```
/// # use flexlink::{beam::MeshPlan, inverse::*, link::*, motion::Profile};
/// use flexlink::store::{StoredResult, read_result, write_solution};
/// # let strip = Segment::uniform(1.5, 5.0, 0.8);
/// # let link = Link::builder().segment(strip).hub_inertia_kg_m2(0.1).damping_ratio(0.02).build()?;
/// # let motion = Profile::Sine.motion(0.5, 0.88, 100)?;
/// let solution = invert(&link, &MeshPlan::automatic(&link), &motion, &Analysis::default())?;
/// # let folder = tempfile::tempdir()?;
/// # let folder = folder.path().join("out");
/// write_solution(&folder, &solution)?;
/// let StoredResult::Runs(runs) = read_result(&folder)? else { unreachable!() };
/// assert_eq!(runs[0].joints[0].torque_n_m.len(), solution.grid.len);
/// assert!(runs[0].origin.inputs.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`FolderError`] names the file that cannot be written.
pub fn write_solution(folder: &Path, solution: &Solution) -> Result<(), FolderError> {
    let (outputs, metrics) = (RunOutputs::default(), Metrics::of(solution));
    let (inputs, findings) = (RunInputs::default(), Findings::default());
    let summary = Summary::of_solution(inputs, solution, &metrics, &findings, &outputs);
    let folder = OutputFolder::stage(folder, &|_| {})?;
    let tables = RunTables::of_solution(solution, &outputs);
    let tables = tables.map_err(|error| folder.refused(PLACES.name(Form::Hub), error))?;
    outputs.write(folder, tables, (&summary, None), &Unwatched)
}

impl RunOutputs {
    /// Writes the files of a run, and its `page` if there is one, into `folder`: all or none. `watch` receives the
    /// progress of nodal tables on request.
    ///
    /// # Errors
    /// [`FolderError`] names the file that cannot be written.
    pub fn write(
        &self,
        folder: OutputFolder,
        tables: RunTables,
        (summary, page): (&Summary, Option<&str>),
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        let RunTables { histories, nodal, on_request, links: nodes, .. } = tables;
        let form = Form::of(nodes.iter().map(|own| own.link));
        let history = |own: &Histories| self.write_history(&folder, own);
        let column = |own: &NodalColumns| {
            folder.file(own.file.name(form), |out| {
                let columns = own.columns.iter().map(|column| Column {
                    name: own.file.column(form, column.link, column.letter, column.node),
                    values: &column.values,
                });
                let group = ColumnGroup { columns: columns.collect() };
                write_csv(out, &own.times, &[group], self.digits)
            })
        };
        // The nodal tables take longest; idle threads write the others.
        let (requested, others) = rayon::join(
            || on_request.map_or(Ok(()), |table| self.write_on_request(&folder, table, watch)),
            || {
                let written =
                    histories.par_iter().filter(|own| self.has(own.file.name(own.form), own.form));
                // Collects all results first, so that of two errors the first file's is always returned.
                let written: Vec<_> =
                    written.map(history).chain(nodal.par_iter().map(column)).collect();
                written.into_iter().collect::<Result<(), FolderError>>()
            },
        );
        others.and(requested)?;
        if let Some(page) = page {
            folder.file(REPORT, |out| out.write_all(page.as_bytes()))?;
        }
        folder.file(NODES, |out| write_nodes(out, &nodes))?;
        folder.file(SUMMARY, |out| out.write_all(summary.to_json().as_bytes()))?;
        folder.commit(SUMMARY, &result_files())
    }

    fn write_history(
        &self,
        folder: &OutputFolder,
        Histories { file, form, grid, joints }: &Histories,
    ) -> Result<(), FolderError> {
        let form = *form;
        let times = self.rows(grid);
        let columns = (0..).zip(joints).flat_map(|(joint, columns)| {
            let named = (0..).zip(columns);
            named.map(move |(column, values)| (file.column(form, joint, column), values))
        });
        let taken: Vec<(String, Cow<[f64]>)> =
            columns.map(|(name, values)| (name, times.taken(values))).collect();
        let columns = taken.iter().map(|(name, values)| Column { name: name.clone(), values });
        let groups = if file.shares_decimals {
            vec![ColumnGroup { columns: columns.collect() }]
        } else {
            columns.map(|column| ColumnGroup { columns: vec![column] }).collect()
        };
        folder.file(file.name(form), |out| write_csv(out, &times, &groups, self.digits))
    }

    /// Tables of a link's nodes, one after the other, because each may take much memory.
    fn write_on_request(
        &self,
        folder: &OutputFolder,
        deflections: NodalTable,
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        let write = |file: &NodalFile, table: &NodalTable| {
            let heading = (file.letters(Form::Hub)[0], file.unit);
            folder.file(file.name(Form::Hub), |out| {
                write_nodal(out, table, heading, self.digits, watch)
            })
        };
        if self.deflections {
            write(&DEFLECTIONS, &deflections)?;
        }
        let moments = self.moments.then(|| deflections.moments());
        write(&PLACES, &deflections.with_rotation())?;
        moments.map_or(Ok(()), |moments| write(&MOMENTS, &moments))
    }
}

/// `nodes.csv`: every node of every link. Positions have all digits, because a run from a folder has its mesh from
/// them.
fn write_nodes(out: &mut (dyn Write + Send), links: &[LinkNodes]) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    let columns = node_columns(Form::of(links.iter().map(|own| own.link)));
    table.write_record(columns)?;
    let format = Digits::Full.for_peak(links.iter().filter_map(|link| link.nodes_m.last()).sum());
    for (number, link) in (1..=links.len()).zip(links) {
        for (node, (x_m, name)) in link.nodes_m.iter().zip(&link.names).enumerate() {
            let mut position = Vec::new();
            format.write(&mut position, *x_m);
            let (node, number) = (node.to_string(), number.to_string());
            let fields = [number.as_bytes(), node.as_bytes(), &position, name.as_bytes()];
            table.write_record(&fields[fields.len() - columns.len()..])?;
        }
    }
    table.flush()
}
