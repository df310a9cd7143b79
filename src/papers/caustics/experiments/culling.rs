//! Section 6.1: what each step of culling drops, and what it costs.

use serde_json::{Value, json};

use super::super::culled_map::CullSteps;
use super::super::named_mesh::NamedMesh;
use super::super::setup::{Scene, Setup};
use super::super::{Caustics, Variant};
use super::{Context, accuracy, open};
use crate::measure::bench::build;
use crate::measure::estimate::Estimate;
use crate::measure::machine::Machine;
use crate::measure::measure::{Measurement, Watch, measure};
use crate::measure::parameter::Choice;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::median;
use crate::measure::study::Study;
use crate::measure::{Error, Paper, Variant as _};
use crate::papers::caustics::Parameters;

/// Passes that find the pairs, the planes of smart slicing among them.
const CULLING: [&str; 8] = [
    "position-pyramid",
    "depth-profile",
    "sub-boxes",
    "smart-planes",
    "cull",
    "cull-count",
    "cull-sum",
    "cull-compact",
];

/// The experiment: the level map with the same planes, and `culled` with every choice of its steps, interleaved.
///
/// # Errors
/// Errors of the device before the first row; what comes later ends the table, which is written first.
pub fn run(context: &mut Context<'_>) -> Result<(), Error> {
    let (meshes, mut machine) = open(context)?;
    let counts = context.options.counts();
    let named = NamedMesh::all(&meshes);
    let points: Vec<(&NamedMesh, u32)> = named.iter().flat_map(|mesh| counts.iter().map(move |&n| (mesh, n))).collect();
    let (mut rows, mut ended) = (Vec::new(), Ok(()));
    context.console.watch("caustics 6.1", &mut |watch| {
        for (index, &(mesh, planes)) in (0..).zip(&points) {
            let progress = &mut *watch.progress;
            let mut of_all =
                |done: u64, expected: u64| progress(index * expected + done, points.len() as u64 * expected);
            let mut watch = Watch { interrupted: watch.interrupted, progress: &mut of_all };
            let measured = point(context, &mut machine, mesh, planes, &mut watch);
            ended = measured.and_then(|more| {
                rows.extend(more);
                context.keep_table(&table(rows.clone()))
            });
            if ended.is_err() {
                break;
            }
        }
    });
    if rows.is_empty() {
        return ended.and(Err(Error::Interrupted));
    }
    let smallest = match &ended {
        Ok(()) => accuracy::smallest(context, &mut machine, &meshes, &[base(&context.setup), Variant::Culled])?,
        Err(_) => None,
    };
    let more: Vec<_> = smallest.into_iter().map(|table| ("smallest", table)).collect();
    let table = table(rows);
    let plot = table.lines("planes", "frame, ms", &["frame ms"])?;
    context.save(&context.file(".svg"), plot.as_bytes())?;
    context.publish_tables(&machine, &table, &more)?;
    ended.or_else(Error::unless_interrupted)
}

fn table(rows: Vec<Vec<Value>>) -> ResultTable {
    ResultTable {
        title: "Section 6.1: pairs of water triangle and plane that are drawn for the caustics map, by the steps that drop the \
                others; culling: position-pyramid to cull-compact, GPU ms; drawing: caustics-map",
        columns: &["mesh", "steps", "planes", "pairs", "fragments", "kept", "culling ms", "drawing ms", "frame ms"],
        rows,
    }
}

/// The rows of one mesh at one count of planes.
fn point(
    context: &Context<'_>,
    machine: &mut Machine,
    mesh: &NamedMesh,
    planes: u32,
    watch: &mut Watch<'_>,
) -> Result<Vec<Vec<Value>>, Error> {
    let setup = Setup { meshes: vec![mesh.source.clone()], ..context.setup.clone() };
    let scene = setup.load()?;
    let of_steps = |cull: CullSteps| {
        let parameters = Parameters { planes, cull, ..setup.parameters.clone() };
        (Setup { parameters, ..setup.clone() }, Variant::Culled, cull.name())
    };
    let mut sides: Vec<(Setup, Variant, &str)> = CullSteps::ALL.iter().copied().map(of_steps).collect();
    let base = base(&setup);
    sides.insert(0, (sides[0].0.clone(), base, base.as_str()));
    let mut papers = built(machine, &scene, &sides)?;
    let mut all: Vec<&mut dyn Paper> = papers.iter_mut().map(|paper| paper as &mut dyn Paper).collect();
    let measured = measure(&mut machine.recorder, &mut all, context.schedule(), watch)?;
    if measured.iter().any(|m| m.frame_ms.is_empty() || m.passes.iter().all(|pass| pass.counts.is_none())) {
        return Err(Error::Interrupted);
    }
    let rows = sides.iter().zip(&measured).map(|((_, _, steps), measured)| row(&mesh.name, planes, steps, measured));
    Ok(rows.collect())
}

/// The method whose light `culled` has.
fn base(setup: &Setup) -> Variant {
    if setup.parameters.culled_smart { Variant::LevelMapSmart } else { Variant::LevelMap }
}

fn built(machine: &Machine, scene: &Scene, sides: &[(Setup, Variant, &str)]) -> Result<Vec<Caustics>, Error> {
    let estimates = sides.iter().map(|(study, variant, _)| study.estimate(&machine.device, scene, *variant));
    Estimate::all(estimates).check(&machine.device, "all steps together")?;
    sides.iter().map(|(study, variant, _)| Ok(build(machine, study, scene, *variant)?.paper)).collect()
}

fn row(mesh: &str, planes: u32, steps: &str, measured: &Measurement) -> Vec<Value> {
    let drawing = measured.passes.iter().find(|pass| pass.info.name == "caustics-map");
    let counts = drawing.and_then(|pass| pass.counts);
    // Of the level map none: its smart slicing is the host's, which takes no time of the GPU.
    let culling = measured.passes.iter().filter(|pass| CULLING.contains(&pass.info.name));
    let culling_ms: f64 = culling.filter_map(|pass| median(&pass.gpu_ms)).sum();
    vec![
        json!(mesh),
        json!(steps),
        json!(planes),
        json!(counts.and_then(|counts| counts.primitives)),
        json!(counts.and_then(|counts| counts.fragments)),
        json!(counts.and_then(|counts| counts.samples_passed)),
        json!(Some(culling_ms).filter(|&ms| ms > 0.0)),
        json!(drawing.and_then(|pass| median(&pass.gpu_ms))),
        json!(median(&measured.frame_ms)),
    ]
}
