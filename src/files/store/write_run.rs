//! Writes the folder of a run: all its files or none.

use std::borrow::Cow;
use std::io::{self, Write};

use rayon::prelude::*;

use super::folder::{FolderError, OutputFolder};
use super::names::{
    DEFLECTIONS, MOMENTS, NODES, NodalFile, PLACES, REPORT, SUMMARY, node_columns, result_files,
};
use super::outputs::RunOutputs;
use super::run_tables::{Histories, LinkNodes, NodalColumns, RunTables};
use super::summary::Summary;
use crate::csv::{Column, ColumnGroup, Digits, write_csv, write_nodal};
use crate::inverse::{NodalTable, Watch};

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
        let links = nodes.len();
        let history = |own: &Histories| self.write_history(&folder, own, links);
        let column = |own: &NodalColumns| {
            folder.file(own.file.name(links), |out| {
                let columns = own.columns.iter().map(|column| Column {
                    name: own.file.column(links, column.link, column.letter, column.node),
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
                    histories.par_iter().filter(|own| self.has(own.file.name(links), links));
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
        Histories { file, grid, joints }: &Histories,
        links: usize,
    ) -> Result<(), FolderError> {
        let times = self.rows(grid);
        let columns = (0..).zip(joints).flat_map(|(joint, columns)| {
            let named = (0..).zip(columns);
            named.map(move |(column, values)| (file.column(links, joint, column), values))
        });
        let taken: Vec<(String, Cow<[f64]>)> =
            columns.map(|(name, values)| (name, times.taken(values))).collect();
        let columns = taken.iter().map(|(name, values)| Column { name: name.clone(), values });
        let groups = if file.shares_decimals {
            vec![ColumnGroup { columns: columns.collect() }]
        } else {
            columns.map(|column| ColumnGroup { columns: vec![column] }).collect()
        };
        folder.file(file.name(links), |out| write_csv(out, &times, &groups, self.digits))
    }

    /// Tables of a link's nodes, one after the other, because each may take much memory.
    fn write_on_request(
        &self,
        folder: &OutputFolder,
        deflections: NodalTable,
        watch: &dyn Watch,
    ) -> Result<(), FolderError> {
        let write = |file: &NodalFile, table: &NodalTable| {
            let heading = (file.letters(1)[0], file.unit);
            folder.file(file.name(1), |out| write_nodal(out, table, heading, self.digits, watch))
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
    table.write_record(node_columns(links.len()))?;
    let format = Digits::Full.for_peak(links.iter().filter_map(|link| link.nodes_m.last()).sum());
    for (number, link) in (1..=links.len()).zip(links) {
        for (node, (x_m, name)) in link.nodes_m.iter().zip(&link.names).enumerate() {
            let mut position = Vec::new();
            format.write(&mut position, *x_m);
            let (node, number) = (node.to_string(), number.to_string());
            let fields = [number.as_bytes(), node.as_bytes(), &position, name.as_bytes()];
            table.write_record(&fields[usize::from(links.len() == 1)..])?;
        }
    }
    table.flush()
}
