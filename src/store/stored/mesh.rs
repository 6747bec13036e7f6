//! nodes.csv read back: the mesh of a run.

use super::numbers::read_number;
use crate::beam::{Mesh, MeshPlan};
use crate::csv::{InputFile, Place, TableError, quoted, read_rows};
use crate::link::Link;

const COLUMNS: [&str; 3] = ["node", "x_m", "segment"];

/// The mesh of `link` whose nodes the file lists.
pub(super) fn read_mesh(file: &InputFile, link: &Link) -> Result<Mesh, TableError> {
    let whole = Place { file: &file.shown, line: None };
    let at = |line| Place { line: Some(line), ..whole };
    let begin = |line, fields: &[&str]| {
        if fields == COLUMNS {
            return Ok(Vec::new());
        }
        let must = format!("must be {}", quoted(&COLUMNS.join(",")));
        Err(at(line).refuse("columns", quoted(&fields.join(",")), must))
    };
    let push = |nodes_m: &mut Vec<f64>, line, fields: &[&str]| {
        let &[node, x_m, _] = fields else {
            let must = "must be 3, as many as there are columns";
            return Err(at(line).refuse("fields", fields.len().to_string(), must));
        };
        let number = nodes_m.len().to_string();
        if node != number {
            return Err(at(line).refuse("node", quoted(node), format!("must be {number}")));
        }
        nodes_m.push(read_number("x_m", x_m, at(line))?);
        Ok(())
    };
    let nodes_m = read_rows(&file.shown, &file.bytes, begin, push)?.unwrap_or_default();
    let plan = MeshPlan::through(link, &nodes_m);
    let plan = plan.map_err(|error| whole.refuse_whole(error.to_string()))?;
    Ok(Mesh::new(link, &plan))
}
