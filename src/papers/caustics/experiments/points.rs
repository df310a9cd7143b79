//! Tables without times: the rows of one mesh and count of planes after the other, under a progress bar. What is done is kept.

use serde_json::Value;

use super::super::named_mesh::NamedMesh;
use super::super::setup::{Scene, Setup};
use super::Context;
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::report::plot::PlotError;
use crate::scene::MeshSource;

/// One mesh with one count of planes.
pub struct Point<'a> {
    /// The receiver, with its name in tables.
    pub mesh: &'a NamedMesh,
    /// Reference planes of the receiver.
    pub planes: u32,
    /// The user's set-up with that mesh and count.
    pub setup: &'a Setup,
    /// Its input, loaded and placed.
    pub scene: &'a Scene,
}

/// The rows of a point.
pub type RowsOf = fn(&mut Machine, Point<'_>) -> Result<Vec<Vec<Value>>, Error>;

/// Fills an empty table and publishes it with its plot.
///
/// # Errors
/// Errors before the first row; what comes later ends the table, which is published first. One that the user ends is whole.
pub fn publish(
    context: &Context<'_>,
    machine: &mut Machine,
    meshes: &[MeshSource],
    mut table: ResultTable,
    rows_of: RowsOf,
    plot: impl FnOnce(&ResultTable) -> Result<String, PlotError>,
) -> Result<(), Error> {
    let (named, counts) = (NamedMesh::all(meshes), context.options.counts());
    let total = (named.len() * counts.len()) as u64;
    let mut ended = Ok(());
    context.console.watch(&format!("caustics {}", context.name), &mut |watch| {
        let mut done = 0;
        ended = named.iter().try_for_each(|mesh| {
            let mut setup = Setup { meshes: vec![mesh.source.clone()], ..context.setup.clone() };
            let scene = setup.load()?;
            counts.iter().try_for_each(|&planes| {
                watch.check()?;
                setup.parameters.planes = planes;
                setup.parameters.validate()?;
                table.rows.extend(rows_of(machine, Point { mesh, planes, setup: &setup, scene: &scene })?);
                context.keep_table(&table)?;
                done += 1;
                (watch.progress)(done, total);
                Ok(())
            })
        });
    });
    if table.rows.is_empty() {
        return ended.and(Err(Error::Interrupted));
    }
    context.publish_plotted(machine, &table, plot(&table))?;
    ended.or_else(Error::unless_interrupted)
}
