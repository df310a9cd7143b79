//! `devices`: what is there, and what each paper finds on it.

use std::convert::Infallible;

use clap::Args;
use serde_json::{Value, json};

use super::failure::Failure;
use super::outcome;
use crate::gpu::physical::BASELINE;
use crate::gpu::{Error, Feature, Instance, PhysicalDevice};
use crate::measure::study::{Study, Visitor};
use crate::papers;

#[derive(Debug, Clone, Args)]
pub struct DevicesArgs {
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Features that each paper needs beyond the baseline.
struct Needs(Vec<(&'static str, &'static [Feature])>);

impl Visitor for Needs {
    type Error = Infallible;

    fn visit<S: Study>(&mut self) -> Result<(), Infallible> {
        self.0.push((S::PAPER, S::NEEDS));
        Ok(())
    }
}

fn needs_of_papers() -> Vec<(&'static str, &'static [Feature])> {
    let mut needs = Needs(Vec::new());
    let Ok(()) = papers::each(&mut needs);
    needs.0
}

pub fn run(arguments: &DevicesArgs) -> Result<(), Failure> {
    let instance = Instance::new(false)?;
    let devices = PhysicalDevice::enumerate(&instance)?;
    if devices.is_empty() {
        return Err(Error::NoDevice { reason: "no driver offers one".into() }.into());
    }
    if arguments.json {
        let document: Vec<Value> = devices.iter().map(json_of).collect();
        outcome::print(&outcome::text(&document)?)
    } else {
        outcome::print(&devices.iter().map(text_of).collect::<String>())
    }
}

fn json_of(device: &PhysicalDevice) -> Value {
    let features: serde_json::Map<String, Value> =
        Feature::ALL.iter().map(|&f| (f.as_str().to_owned(), json!(device.has(f)))).collect();
    let papers: serde_json::Map<String, Value> = needs_of_papers()
        .iter()
        .map(|(name, needs)| {
            let lacks = device.lacks(needs);
            (name.to_string(), json!({"capable": lacks.is_empty(), "needs": names(needs), "lacks": lacks}))
        })
        .collect();
    let limits = &device.limits;
    json!({
        "index": device.index, "name": device.name, "type": device.device_type.as_str(), "uuid": device.uuid_text(),
        "driver": device.driver_name, "driver_version": device.driver_info,
        "api_version": device.api_version_text(),
        "limits": {
            "max_image_dimension_2d": limits.max_image_dimension2_d,
            "max_image_array_layers": limits.max_image_array_layers,
            "max_storage_buffer_bytes": limits.max_storage_buffer_range,
            "max_push_constant_bytes": limits.max_push_constants_size,
            "timestamp_period_ns": limits.timestamp_period,
            "timestamp_bits": device.queue.map(|q| q.1),
        },
        "features": features, "portability_lacks": device.portability_lacks, "papers": papers,
    })
}

fn names(needs: &[Feature]) -> Vec<&'static str> {
    BASELINE.iter().chain(needs).map(|f| f.as_str()).collect()
}

fn text_of(device: &PhysicalDevice) -> String {
    let style = outcome::style();
    let mut lines = vec![
        style.bold(&format!("{}: {}", device.index, device.name)),
        format!("  type     {}", device.device_type.as_str()),
        format!("  uuid     {}", device.uuid_text()),
        format!("  driver   {} {}", device.driver_name, device.driver_info),
        format!("  vulkan   {}", device.api_version_text()),
    ];
    let has: Vec<&str> = Feature::ALL.iter().filter(|&&f| device.has(f)).map(|f| f.as_str()).collect();
    let lacks: Vec<&str> = Feature::ALL.iter().filter(|&&f| !device.has(f)).map(|f| f.as_str()).collect();
    lines.push(format!("  has      {}", has.join(", ")));
    if !lacks.is_empty() {
        lines.push(format!("  lacks    {}", lacks.join(", ")));
    }
    if let Some(subset) = &device.portability_lacks {
        lines.push(format!("  subset   of Vulkan (portability), without {}; no paper uses these", subset.join(", ")));
    }
    for (name, needs) in needs_of_papers() {
        let missing = device.lacks(needs);
        let verdict = if missing.is_empty() {
            style.green("capable")
        } else {
            style.red(&format!("lacks {}", missing.join(", ")))
        };
        lines.push(format!("  {name:8} {verdict} (needs {})", names(needs).join(", ")));
    }
    lines.join("\n") + "\n"
}
