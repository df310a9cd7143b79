//! The result record and everything written from it.
//!
//! [`Record`] is the one document a measurement leaves behind; the writers turn it (or plain data) into a console
//! table, JSON, CSV, a Chrome trace and SVG plots. Nothing here knows Vulkan, and nothing here measures: the writers
//! return text, and [`crate::file`] puts it on the disk.
//!
//! ```text
//! Record --> console (String)     json (String, and back)     csv (String)
//! TraceRun --> trace (String)   plot::LineChart, plot::BarChart --> SVG (String)
//! Tables (of experiments without runs) --> json (String, and back)
//! Records, Tables, pictures, plots --> html::page (String)
//! any text --> file::write (temporary file, renamed)
//! ```

pub mod alternative;
pub(crate) mod bounded;
pub mod console;
pub mod csv;
pub mod environment;
#[cfg(test)]
pub(crate) mod example;
pub mod html;
pub mod json;
mod limits;
mod pass;
pub mod plot;
pub mod profile;
pub mod record;
pub mod stress;
pub mod table;
pub mod tables;
pub mod text;
pub mod trace;

pub use record::{Record, Run, SCHEMA, Summary};
