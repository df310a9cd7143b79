//! Heat transfer (chapter 9): the same flow with its radiation and without, at the end of so many frames.

use serde_json::{Value, json};

use super::super::setup::Setup;
use super::flow;
use crate::measure::Error;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;

/// Behind the first, columns of the table of [`flow`].
const COLUMNS: [&str; 7] = ["emissivity", "time s", "mean K", "greatest K", "skin K", "front m", "thickness m"];

/// Only a fluid that radiates cools.
///
/// # Errors
/// [`Error::Input`] for one that does not.
pub fn check(setup: &Setup) -> Result<(), Error> {
    flow::check(setup)?;
    if setup.parameters.flow.heat.emissivity > 0.0 {
        return Ok(());
    }
    Err(Error::Input("`emissivity` 0: nothing radiates that could be set beside it; give one above 0".to_owned()))
}

/// Two rows.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Parameter`], [`Error::Input`].
pub fn table(machine: &mut Machine, setup: &Setup, frames: u32) -> Result<ResultTable, Error> {
    let mut row = |emissivity: f32| -> Result<Vec<Value>, Error> {
        let mut setup = setup.clone();
        setup.parameters.flow.heat.emissivity = emissivity;
        let flow = flow::table(machine, &setup, frames)?;
        let last = flow.rows.last().cloned().unwrap_or_default();
        let at = |name: &str| flow.columns.iter().position(|column| *column == name);
        let observed = COLUMNS[1..].iter().map(|name| at(name).and_then(|at| last.get(at).cloned()));
        Ok([json!(emissivity)].into_iter().chain(observed.map(Option::unwrap_or_default)).collect())
    };
    Ok(ResultTable {
        title: "Cooling: a flow that radiates beside one that keeps its heat",
        columns: &COLUMNS,
        rows: vec![row(setup.parameters.flow.heat.emissivity)?, row(0.0)?],
    })
}
