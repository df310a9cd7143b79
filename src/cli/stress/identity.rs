//! Everything that fixes the work of a step, as far as it is known before one is taken.

use serde_json::json;

use super::super::failure::Failure;
use super::Ascent;
use super::climber::Children;
use crate::content;
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
        let shaders = options.shaders_sha256()?;
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
            shard: self.shard.map(|shard| [shard.number, shard.count]),
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
