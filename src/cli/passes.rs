//! `passes`: the pass table of a variant, as one recorded frame shows it.

use serde_json::{Value, json};

use super::failure::Failure;
use super::options::MachineArgs;
use super::outcome;
use super::watch::{interrupted, patiently};
use crate::gpu::bindings::Resource;
use crate::gpu::{self, Mode, PassInfo};
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::study::Study;
use crate::measure::{Kind, Paper, Target, Variant};
use crate::report::table::{Align, Table};

struct Listed {
    paper: &'static str,
    variant: &'static str,
    passes: Vec<(std::sync::Arc<PassInfo>, u32)>,
    targets: Vec<Target>,
}

/// Prints the pass tables of `variants`.
pub fn list<S: Study>(study: &S, variants: &[S::Variant], machine: &MachineArgs, json: bool) -> Result<(), Failure> {
    let scene = study.load()?;
    let mut machine = Machine::open(&machine.resolve(0), S::NEEDS)?;
    let mut listed = Vec::new();
    for &variant in variants {
        let (built, sample) = patiently(false, &format!("making a frame of {}", variant.as_str()), || {
            let mut built = build(&machine, study, &scene, variant)?;
            let sample = machine.recorder.run_unless(interrupted(), Mode::Plain, |frame| built.paper.record(frame, 0));
            match sample {
                Err(gpu::Error::Interrupted) => {
                    Err(Failure::Running("interrupted before all passes were listed".into()))
                }
                other => Ok((built, other?)),
            }
        })?;
        let passes = sample.passes.iter().map(|p| (p.info.clone(), p.calls)).collect();
        let targets = built.paper.targets();
        listed.push(Listed { paper: S::PAPER, variant: variant.as_str(), passes, targets });
    }
    machine.check_validation()?;
    if json {
        let document: Vec<Value> = listed.iter().map(json_of).collect();
        outcome::print(&outcome::text(&document)?)
    } else {
        outcome::print(&listed.iter().map(text_of).collect::<Vec<_>>().join("\n"))
    }
}

fn json_of(listed: &Listed) -> Value {
    let passes: Vec<Value> = listed
        .passes
        .iter()
        .enumerate()
        .map(|(order, (info, calls))| {
            json!({
                "order": order + 1, "name": info.name, "kind": info.kind.as_str(), "section": info.section,
                "calls": calls, "shaders": info.shaders, "reads": info.reads, "writes": info.writes,
                "blend": info.blend, "depth": info.depth, "counting": info.counting,
                "shader_compiler": info.compiler.map(|c| c.to_string()),
            })
        })
        .collect();
    let targets: Vec<Value> = listed.targets.iter().map(|t| json!({"name": t.name, "shape": shape(t)})).collect();
    json!({"paper": listed.paper, "variant": listed.variant, "passes": passes, "targets": targets})
}

fn text_of(listed: &Listed) -> String {
    let style = outcome::style();
    let title = style.bold(&format!("{} {}", listed.paper, listed.variant));
    let mut table = Table::new(&[
        ("", Align::Right),
        ("pass", Align::Left),
        ("kind", Align::Left),
        ("section", Align::Left),
        ("calls", Align::Right),
        ("shaders", Align::Left),
        ("reads", Align::Left),
        ("writes", Align::Left),
        ("blend", Align::Left),
        ("depth and stencil", Align::Left),
    ]);
    let own = |names: &[String]| {
        let prefix = format!("{}/", listed.variant);
        names.iter().map(|n| n.strip_prefix(&prefix).unwrap_or(n)).collect::<Vec<_>>().join(" ")
    };
    for (order, (info, calls)) in listed.passes.iter().enumerate() {
        table.push(vec![
            (order + 1).to_string(),
            info.name.to_owned(),
            info.kind.as_str().to_owned(),
            info.section.to_owned(),
            calls.to_string(),
            info.shaders.join(" "),
            own(&info.reads),
            own(&info.writes),
            info.blend.join(" "),
            info.counting.into_iter().chain(info.depth).collect::<Vec<_>>().join("; "),
        ]);
    }
    let targets: Vec<String> = listed.targets.iter().map(|t| format!("{} ({})", t.name, shape(t))).collect();
    format!("{title}\n{}targets for --dump: {}\n", table.render(style), targets.join(", "))
}

fn shape(target: &Target) -> String {
    match &target.resource {
        Resource::Image(view) => {
            let layers = match (view.layer_count(), view.depth()) {
                (1, 1) => String::new(),
                (1, slices) => format!(" x {slices}"),
                (layers, _) => format!(" x {layers} layers"),
            };
            format!("{} x {}{layers} {:?}", view.width(), view.height(), view.image().desc().format)
        }
        Resource::Buffer(view) => {
            let rows = view.buffer().size_bytes() / 4 / u64::from(target.columns.max(1));
            let values = match target.kind {
                Kind::F32 => "f32",
                Kind::U32 => "u32",
                Kind::I32 => "i32",
            };
            format!("{rows} rows of {} {values}", target.columns)
        }
        Resource::Sampler(_) => String::new(),
    }
}
