//! Everything that fixes the work of a step, as far as it is known before one is taken.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::super::failure::Failure;
use super::Ascent;
use super::climber::Children;
use crate::content;
use crate::measure::Error;
use crate::measure::bench::inputs;
use crate::measure::stress::Axis;
use crate::measure::study::Study;
use crate::report::environment;
use crate::report::stress::{AxisName, SCHEMA, Settings, StressRecord};

impl<S: Study> Ascent<'_, S> {
    /// The record without a series.
    pub(super) fn template(&self, children: &Children<'_>) -> Result<StressRecord, Failure> {
        let environment = children.environment()?;
        let options = self.machine.resolve(0);
        let shaders = options.shader_dir.as_deref().map(folder_sha256).transpose()?;
        let parameters = S::parameters();
        let settings = Settings {
            parameters: parameters.iter().map(|p| (p.name.to_owned(), p.text(&self.setup))).collect(),
            preset: self.setup.identity().preset,
            inputs: inputs(&self.setup)?,
            warmup: self.schedule.warmup,
            frames: self.schedule.frames,
            repeat: self.schedule.repeat,
            shader_compiler: options.compiler.to_string(),
            shaders,
            validation: options.validate,
        };
        let axis = name(&self.axis);
        let across = self.across.as_ref().map(name);
        let (device, host, build) = (&environment.device, &environment.host, &environment.build);
        let fixed = json!([
            S::PAPER,
            axis,
            across,
            settings,
            device,
            host,
            build.executable_sha256,
            build.git_commit,
            environment.layers
        ]);
        Ok(StressRecord {
            schema: SCHEMA.to_owned(),
            identity: content::sha256(fixed.to_string().as_bytes()),
            environment,
            command: environment::command(),
            paper: S::PAPER.to_owned(),
            axis,
            across,
            factor: self.limits.factor,
            settings,
            series: Vec::new(),
        })
    }
}

fn name<S: Study>(axis: &Axis<S>) -> AxisName {
    AxisName {
        name: axis.name.to_owned(),
        help: axis.help.to_owned(),
        unit: axis.unit.to_owned(),
        amount_unit: axis.amount_unit().to_owned(),
    }
}

/// SHA-256 of the names and contents of all files below a folder.
fn folder_sha256(folder: &Path) -> Result<String, Error> {
    let failed = |e: std::io::Error| Error::Input(format!("reading the shaders under {}: {e}", folder.display()));
    let mut files = files_below(folder).map_err(failed)?;
    files.sort();
    let digests = files.iter().map(|path| {
        let name = path.strip_prefix(folder).unwrap_or(path).display().to_string();
        Ok(format!("{name}\0{}\n", content::file_sha256(path).map_err(failed)?))
    });
    Ok(content::sha256(digests.collect::<Result<String, Error>>()?.as_bytes()))
}

fn files_below(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            files.extend(files_below(&entry.path())?);
        } else {
            files.push(entry.path());
        }
    }
    Ok(files)
}
