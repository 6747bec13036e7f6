//! Tables of a quantity at nodes, read back.

use super::numbers::{Numbers, is_same_time, refuse_column};
use crate::beam::Mesh;
use crate::csv::{InputFile, Place, TableError};
use crate::result::StoredNodes;

/// How the columns of a nodal table are headed: `v7_m`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heading {
    pub(super) letter: &'static str,
    pub(super) unit: &'static str,
}

impl Heading {
    fn name(self, node: usize) -> String {
        format!("{}{node}_{}", self.letter, self.unit)
    }

    /// The node of a column, if it is headed so.
    fn node(self, field: &str) -> Option<usize> {
        let rest = field.strip_prefix(self.letter)?.strip_suffix(self.unit)?.strip_suffix('_')?;
        rest.parse().ok().filter(|node| self.name(*node) == field)
    }
}

/// Reads a table whose times are all or every k-th of `times_s`, those of torque.csv.
pub(super) fn read_nodal(
    file: &InputFile,
    heading: Heading,
    mesh: &Mesh,
    times_s: &[f64],
) -> Result<StoredNodes, TableError> {
    let last = mesh.nodes_m().len() - 1;
    let node_of = |field: &str| heading.node(field).filter(|node| *node <= last);
    let check = |fields: &[&str], place: Place| {
        let must = format!("must be of a node, {} to {}", heading.name(0), heading.name(last));
        if fields.len() < 2 {
            return Err(place.refuse("columns", "the time alone", must));
        }
        let stray = (1..fields.len()).find(|index| node_of(fields[*index]).is_none());
        stray.map_or(Ok(()), |index| Err(refuse_column(fields, index, &must, place)))
    };
    let mut table = Numbers::read(file, check)?;
    table.check_times(times_s, stride(table.times_s(), times_s), "torque.csv")?;
    let columns = table.names.iter().zip(&mut table.columns);
    let mut histories: Vec<(usize, Vec<f64>)> = columns
        .filter_map(|(name, values)| Some((node_of(name)?, std::mem::take(values))))
        .collect();
    histories.sort_by_key(|(node, _)| *node);
    let (nodes, histories) = histories.into_iter().unzip();
    Ok(StoredNodes { nodes, times_s: table.take(super::numbers::TIME), histories })
}

/// Every how many of the times of a run a table has a row.
fn stride(own_s: &[f64], times_s: &[f64]) -> usize {
    match own_s.get(1) {
        Some(second) => times_s
            .iter()
            .skip(1)
            .position(|time| is_same_time(*second, *time, times_s))
            .map_or(1, |k| k + 1),
        None => times_s.len(),
    }
}

/// Deflections `w = v − xθ` of displacements, by the hub angles of the run in rad at `times_s`.
pub(super) fn deflections(
    mut displacements: StoredNodes,
    mesh: &Mesh,
    hub_angle_rad: &[f64],
    times_s: &[f64],
) -> StoredNodes {
    let every = stride(&displacements.times_s, times_s);
    for (node, history) in displacements.nodes.iter().zip(&mut displacements.histories) {
        let x_m = mesh.nodes_m()[*node];
        for (value, angle) in history.iter_mut().zip(hub_angle_rad.iter().step_by(every)) {
            *value -= x_m * angle;
        }
    }
    displacements
}
