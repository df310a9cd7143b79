//! Every method's maps against photons in double precision, beside their time: what a user needs to choose one.

mod cases;
mod certain;
mod judge;
mod pictures;
mod settings;
mod smallest;
mod truth;

use std::sync::atomic::{AtomicBool, Ordering};

use serde_json::{Value, json};

use self::cases::{Case, cases};
pub use self::certain::MOST_PHOTONS;
use self::certain::more_photons;
use self::judge::{Found, Verdict, judge};
use self::pictures::TruePicture;
use self::settings::{Setting, all_settings, some_settings};
use self::truth::{FRAME, Surface, Truth, trace};
use super::super::named_mesh::NamedMesh;
use super::super::numbered;
use super::super::setup::{Scene, Setup};
use super::super::water::Grid;
use super::super::{Caustics, Variant};
use super::{Context, MeshSource};
use crate::gpu::{self, Mode};
use crate::image::Samples;
use crate::measure::bench::build;
use crate::measure::estimate::Estimate;
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::measure::picture::read_target;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::median;
use crate::measure::study::Study;
use crate::measure::{Error, Paper};
use crate::report::plot::{LineChart, Scale, Series};

/// One method with its numbers on one scene.
struct Row {
    case: &'static str,
    mesh: String,
    setting: Setting,
    verdict: Verdict,
    /// Luv difference of the picture from that of the true light, mean and 99th percentile.
    seen: [f64; 2],
    /// Of each half of the truth, for a texel of the greatest map.
    photons: u32,
    frame_ms: f64,
}

/// A mesh under one light and one water, and what is tried on it.
struct Trial {
    case: Case,
    mesh: NamedMesh,
    settings: Vec<Setting>,
    /// Of the first case, which is tried in all settings.
    is_first: bool,
}

/// Diffuse light below which none is divided by it: half floats then have no digits left.
const LEAST_DIFFUSE: f32 = 0.02;
/// Height of a texel without a receiver.
const EMPTY: f32 = -1e30;

/// Frames of each method that are timed, unless more are asked for.
const FRAMES: (u32, u32) = (3, 1);

/// Errors in percent that the smallest map and plane count are sought for, unless others are given.
const ERRORS: [u32; 4] = [20, 10, 5, 2];

/// The smallest map and plane count of some variants on those meshes for each error that was given; none without any.
///
/// # Errors
/// As [`run`].
pub fn smallest(
    context: &Context<'_>,
    machine: &mut Machine,
    meshes: &[MeshSource],
    variants: &[Variant],
) -> Result<Option<ResultTable>, Error> {
    let errors = context.options.errors(&[]);
    if errors.is_empty() {
        return Ok(None);
    }
    let mut trials = trials(context, meshes, &sizes(context)?, &context.options.counts())?;
    trials.retain(|trial| trial.is_first);
    trials.iter_mut().for_each(|trial| trial.settings.retain(|setting| variants.contains(&setting.variant)));
    let (mut rows, mut ended) = (Vec::new(), Ok(()));
    let mut keep = |_: &[Row]| Ok(());
    context.console.watch("caustics photons", &mut |watch| {
        ended = measure(context, machine, &trials, watch, &mut rows, &mut keep);
    });
    ended?;
    Ok(Some(smallest::table(&rows, &errors)))
}

/// A round sphere, a plane, and a receiver that hides parts of itself.
fn meshes(context: &Context<'_>) -> Vec<MeshSource> {
    if context.given.has("mesh") {
        return context.setup.meshes.clone();
    }
    vec![MeshSource::Sphere, MeshSource::Plane, MeshSource::Teapot]
}

/// The experiment.
///
/// # Errors
/// [`Error::Input`] for sizes that do not divide the greatest, a limit or an error of the device before the first scene is
/// done; what comes later ends the table, which is written first.
pub fn run(context: &mut Context<'_>) -> Result<(), Error> {
    let sizes = sizes(context)?;
    let counts = context.options.counts();
    let trials = trials(context, &meshes(context), &sizes, &counts)?;
    let mut machine = context.open()?;
    let (mut rows, mut ended) = (Vec::new(), Ok(()));
    let mut keep = |rows: &[Row]| context.keep_table(&table(rows));
    context.console.watch("caustics accuracy", &mut |watch| {
        ended = measure(context, &mut machine, &trials, watch, &mut rows, &mut keep);
    });
    if rows.is_empty() {
        return ended.and(Err(Error::Interrupted));
    }
    let smallest = smallest::table(&rows, &context.options.errors(&ERRORS));
    context.publish_tables(&machine, &table(&rows), &[("smallest", smallest)])?;
    for (suffix, svg) in plots(&rows)? {
        context.save(&context.file(&suffix), svg.as_bytes())?;
    }
    ended.or_else(Error::unless_interrupted)
}

/// Sides of maps, the greatest last, which the others divide.
fn sizes(context: &Context<'_>) -> Result<Vec<u32>, Error> {
    let mut sizes = context.options.sizes();
    sizes.sort_unstable();
    sizes.dedup();
    let greatest = sizes.last().copied().unwrap_or(1);
    match sizes.iter().find(|size| !greatest.is_multiple_of(**size)) {
        None => Ok(sizes),
        Some(size) => Err(Error::Input(format!(
            "`sizes`: maps of {size} and {greatest} texels are compared texel by texel; give sizes that divide the greatest"
        ))),
    }
}

/// The first case is tried on every mesh in all settings, the others on the first mesh, or with `cross` on every one, in some.
fn trials(context: &Context<'_>, meshes: &[MeshSource], sizes: &[u32], counts: &[u32]) -> Result<Vec<Trial>, Error> {
    let meshes = NamedMesh::all(meshes);
    let mut trials = Vec::new();
    for (number, case) in cases(context).into_iter().enumerate() {
        for (index, mesh) in meshes.iter().enumerate() {
            let is_first = number == 0;
            if !is_first && index > 0 && !context.options.cross {
                continue;
            }
            let settings = if is_first { all_settings(sizes, counts) } else { some_settings(sizes, counts) };
            let setup = case.setup(context, mesh);
            for setting in &settings {
                setting.of(&setup).parameters.validate()?;
            }
            setup.load()?;
            trials.push(Trial { case: case.clone(), mesh: mesh.clone(), settings, is_first });
        }
    }
    Ok(trials)
}

/// Adds the rows of one trial after the other; `keep` takes what is there after each.
fn measure(
    context: &Context<'_>,
    machine: &mut Machine,
    trials: &[Trial],
    watch: &mut Watch<'_>,
    rows: &mut Vec<Row>,
    keep: &mut dyn FnMut(&[Row]) -> Result<(), Error>,
) -> Result<(), Error> {
    let total = trials.len() as u64;
    for (index, trial) in (0..).zip(trials) {
        let progress = &mut *watch.progress;
        let mut of_all = |done: u64, expected: u64| progress(index * expected + done, total * expected);
        let mut watch = Watch { interrupted: watch.interrupted, progress: &mut of_all };
        let measured = measure_trial(context, machine, trial, &mut watch);
        rows.extend(measured?);
        keep(rows)?;
    }
    Ok(())
}

fn measure_trial(
    context: &Context<'_>,
    machine: &mut Machine,
    trial: &Trial,
    watch: &mut Watch<'_>,
) -> Result<Vec<Row>, Error> {
    let setup = trial.case.setup(context, &trial.mesh);
    let scene = setup.load()?;
    let schedule = context.measure.schedule(FRAMES);
    let warmup = schedule.warmup.max(1);
    let rounds = warmup.saturating_add(schedule.frames.saturating_mul(schedule.repeat));
    let greatest = trial.settings.iter().map(|setting| setting.map_size).max().unwrap_or(1);
    let sides = trial.settings.iter().map(|setting| (setting, setting.of(&setup)));
    let estimates = sides.clone().map(|(setting, study)| study.estimate(&machine.device, &scene, setting.variant));
    Estimate::all(estimates).check(&machine.device, "all settings together")?;
    let papers = sides.map(|(setting, study)| Ok(build(machine, &study, &scene, setting.variant)?.paper));
    let mut papers = papers.collect::<Result<Vec<_>, Error>>()?;

    // Photons first: what the device cannot hold has been refused, and a wrong number of photons shows at once.
    let all = papers.iter().map(Caustics::grid);
    let grid = all.reduce(covering).ok_or_else(|| Error::Input("`counts`: give at least one".into()))?;
    let mut photons = context.options.photons();
    let interrupted = watch.interrupted;
    let traced = |photons| truths(&setup, &scene, &grid, (greatest, photons), interrupted);
    let mut truths = traced(photons)?;

    // Methods in turn, so that drift meets all alike. The photons count as much as all frames, a picture as much as one.
    let mut frame_ms = vec![Vec::new(); papers.len()];
    let mut done = u64::from(rounds) * papers.len() as u64;
    let expected = 2 * done + papers.len() as u64;
    (watch.progress)(done, expected);
    for round in 0..rounds {
        for (paper, times) in papers.iter_mut().zip(&mut frame_ms) {
            let sample =
                machine.recorder.run_unless(watch.interrupted, Mode::Plain, |frame| paper.record(frame, FRAME));
            let sample = sample.map_err(|error| match error {
                gpu::Error::Interrupted => Error::Interrupted,
                other => other.into(),
            })?;
            if round >= warmup {
                times.push(sample.frame_ms);
            }
            done += 1;
            (watch.progress)(done, expected);
            watch.check()?;
        }
    }

    papers.iter_mut().try_for_each(|paper| paper.settle(&machine.shaders).map(drop))?;
    let lights = 0..setup.parameters.lights.len();
    let lit: Vec<[usize; 2]> = lights.flat_map(|light| (0..scene.receivers.len()).map(move |r| [light, r])).collect();
    let level_map = |size: u32| {
        let is_it = |setting: &Setting| setting.variant == Variant::LevelMap && setting.map_size == size;
        trial.settings.iter().position(is_it).map(|at| &papers[at])
    };
    let of_papers = papers.iter().zip(&trial.settings).map(|(paper, setting)| {
        match level_map(setting.map_size).filter(|_| setting.variant == Variant::Volumetric) {
            Some(level_map) => volumetric(machine, paper, &lit, level_map),
            None => maps(machine, paper, &lit),
        }
    });
    let found = of_papers.collect::<Result<Vec<_>, Error>>()?;
    let judged = |truths: &[Truth]| {
        let verdicts = found.iter().zip(&trial.settings).map(|(found, setting)| {
            judge(found, truths).ok_or_else(|| {
                let name = setting.name();
                Error::Input(format!("judging {name} on {}: no texel is lit; take larger `sizes`", trial.mesh.name))
            })
        });
        verdicts.collect::<Result<Vec<Verdict>, Error>>()
    };
    let mut verdicts = judged(&truths)?;
    let mut before = None;
    while !context.options.has_photons() {
        let halves = verdicts.iter().map(|verdict| verdict.halves).fold(f64::NAN, f64::min);
        let Some(more) = more_photons(photons, halves, before) else { break };
        (photons, before) = (more, Some(halves));
        truths = traced(photons)?;
        verdicts = judged(&truths)?;
    }
    // Of the truths' size, with maps of its own.
    let has_all = |setting: &Setting| setting.map_size == greatest && setting.variant != Variant::Volumetric;
    let exact = trial.settings.iter().position(has_all);
    let truth = exact.map(|at| {
        let heights: Vec<&[f32]> = found[at].iter().map(|map| map.heights.as_slice()).collect();
        TruePicture::of(machine, &mut papers[at], &heights, &truths)
    });
    let truth = truth.transpose()?.flatten();
    let mut rows = Vec::new();
    for (index, (verdict, setting)) in verdicts.into_iter().zip(&trial.settings).enumerate() {
        watch.check()?;
        let seen = truth.as_ref().map(|truth| truth.difference(machine, &mut papers[index])).transpose()?;
        let seen = seen.map_or([f64::NAN; 2], |seen| [seen.mean, seen.p99]);
        done += 1;
        (watch.progress)(done, expected);
        let frame_ms = median(&frame_ms[index]).unwrap_or(f64::NAN);
        let (case, mesh) = (trial.case.name, trial.mesh.name.clone());
        rows.push(Row { case, mesh, setting: *setting, verdict, seen, photons, frame_ms });
    }
    Ok(rows)
}

/// The smallest rectangle of water over both meshes of it.
fn covering(a: Grid, b: Grid) -> Grid {
    let low = a.corner.min(b.corner);
    let high = (a.corner + a.extent_m()).max(b.corner + b.extent_m());
    Grid { corner: low, cell: high - low, columns: 1, rows: 1 }
}

/// The truth of each receiver under each light, light by light, as the paper has its maps.
fn truths(
    setup: &Setup,
    scene: &Scene,
    grid: &Grid,
    (size, photons): (u32, u32),
    interrupted: &AtomicBool,
) -> Result<Vec<Truth>, Error> {
    let surface = Surface::of(&setup.parameters, &scene.receivers);
    let lights = setup.parameters.lights.iter();
    let mut truths = Vec::new();
    for of in lights.flat_map(|light| (0..scene.receivers.len()).map(move |receiver| (light, receiver))) {
        if interrupted.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        let truth = trace(&setup.parameters, &surface, &scene.receivers, of, grid, (size, photons));
        truths.push(truth.ok_or_else(|| Error::Input("tracing photons: the light does not come from above".into()))?);
    }
    Ok(truths)
}

/// One value of each texel of a frame's target.
fn read(machine: &Machine, paper: &Caustics, name: &str, indices: [usize; 2]) -> Result<Vec<f32>, Error> {
    let name = numbered(name, &indices);
    let targets = paper.targets();
    let target = targets.iter().find(|target| target.name == name);
    let raster = target.map(|target| read_target(&machine.device, target)).transpose()?;
    let Some(raster) = raster else { return Err(Error::Input(format!("reading {name}: the frame has no such map"))) };
    let channels = raster.shape().dimensions().last().map_or(1, |&count| count as usize);
    match raster.samples() {
        Samples::F32(values) => Ok(values.iter().step_by(channels).copied().collect()),
        _ => Err(Error::Input(format!("reading {name}: the map holds no floats"))),
    }
}

/// The maps of a frame, in the order of `lit`: each a light and a receiver.
fn maps(machine: &Machine, paper: &Caustics, lit: &[[usize; 2]]) -> Result<Vec<Found>, Error> {
    let found = |&at: &[usize; 2]| {
        let [light, heights] = ["caustics-map", "position-map"].map(|name| read(machine, paper, name, at));
        Ok(Found { light: light?, heights: heights? })
    };
    lit.iter().map(found).collect()
}

/// The light of the volumetric method, whose caustics map is of one plane after the other: that of its combined map, over the
/// diffuse light of the level map of its size, whose heights are those of the receiver and not of planes.
fn volumetric(
    machine: &Machine,
    paper: &Caustics,
    lit: &[[usize; 2]],
    level_map: &Caustics,
) -> Result<Vec<Found>, Error> {
    let exact = maps(machine, level_map, lit)?;
    let found = |(&at, Found { heights, .. }): (&[usize; 2], Found)| {
        let combined = read(machine, paper, "combined-map", at)?;
        let diffuse = read(machine, level_map, "diffuse-map", at)?;
        // Where a face turns away from the light there is nothing to divide by, and nothing is held.
        let is_lit = |diffuse: f32| diffuse > LEAST_DIFFUSE;
        let light = combined.iter().zip(&diffuse).map(|(lit, &d)| if is_lit(d) { lit / d } else { 0.0 });
        let heights = heights.iter().zip(&diffuse).map(|(&height, &d)| if is_lit(d) { height } else { EMPTY });
        Ok(Found { light: light.collect(), heights: heights.collect() })
    };
    lit.iter().zip(exact).map(found).collect()
}

fn table(rows: &[Row]) -> ResultTable {
    let row = |row: &Row| {
        let Row { case, mesh, setting, verdict, seen: [mean, p99], photons, frame_ms } = row;
        let Verdict { correlation, rms, greatest, flux, rms_at_truth, halves } = *verdict;
        let numbers = [correlation, rms, greatest, flux, rms_at_truth, *mean, *p99, halves];
        let names = [json!(case), json!(mesh), json!(setting.name()), json!(setting.map_size), setting.planes()];
        let more = [json!(photons), json!(frame_ms)];
        names.into_iter().chain(numbers.map(|number| json!(number))).chain(more).collect::<Vec<Value>>()
    };
    ResultTable {
        title: "Accuracy: caustics maps against photons in double precision, over the texels that receivers fill. correlation, \
                rms (of the truth's mean), greatest texel and flux (of the truth's): at the map's own size; rms seen: at the \
                greatest size, the map interpolated; picture, its p99: L*u*v* difference (eq. 2-9) from the picture whose light \
                is the photons', over its pixels with caustics; halves: correlation of the truth's two halves at the map's size; photons: \
                of each half, for a texel of the greatest map",
        columns: &[
            "case",
            "mesh",
            "method",
            "map",
            "planes",
            "correlation",
            "rms",
            "greatest",
            "flux",
            "rms seen",
            "picture",
            "picture p99",
            "halves",
            "photons",
            "frame ms",
        ],
        rows: rows.iter().map(row).collect(),
    }
}

/// Error over time of each mesh in the first case, with its file's suffix.
fn plots(rows: &[Row]) -> Result<Vec<(String, String)>, Error> {
    let Some(first) = rows.first().map(|row| row.case) else { return Ok(Vec::new()) };
    let mut meshes: Vec<&str> = rows.iter().filter(|row| row.case == first).map(|row| row.mesh.as_str()).collect();
    meshes.dedup();
    let suffix = |mesh: &str| if meshes.len() == 1 { ".svg".to_owned() } else { format!("-{mesh}.svg") };
    let plot = |mesh: &&str| {
        let mut series: Vec<Series> = Vec::new();
        for row in rows.iter().filter(|row| row.case == first && row.mesh == *mesh) {
            let name = match row.setting.has_planes() {
                true => format!("{}, {}", row.setting.name(), row.setting.map_size),
                false => row.setting.name(),
            };
            let point = (row.frame_ms, row.verdict.rms_at_truth);
            match series.iter_mut().find(|series| series.name == name) {
                Some(line) => line.points.push(point),
                None => series.push(Series { name, points: vec![point], reference: false }),
            }
        }
        let chart = LineChart {
            title: format!("Error over time, {mesh}"),
            x_label: "frame, ms".to_owned(),
            y_label: "root mean square of the error, of the mean light".to_owned(),
            x_scale: Scale::Log,
            y_scale: Scale::Log,
            series,
        };
        Ok((suffix(mesh), chart.to_svg()?))
    };
    meshes.iter().map(plot).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn two_meshes_of_water_are_covered_by_one() {
        let a = Grid { corner: DVec2::new(-1.0, 0.0), cell: DVec2::ONE, columns: 2, rows: 2 };
        let b = Grid { corner: DVec2::new(0.0, -1.0), cell: DVec2::splat(0.5), columns: 2, rows: 2 };
        let both = covering(a, b);
        assert_eq!((both.corner, both.extent_m()), (DVec2::new(-1.0, -1.0), DVec2::new(2.0, 3.0)));
    }
}
