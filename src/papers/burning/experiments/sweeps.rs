//! The gain of the optimisations of 3.7, and the simulation's cost over the active triangles.

use serde_json::{Value, json};

use super::super::setup::Setup;
use super::timeline::{Snapshot, frame_before};
use crate::measure::Error;
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row};
use crate::papers::burning::{Parameters, Variant};
use crate::report::plot::{LineChart, Scale, Series};
use crate::report::record::{ExperimentRow, Run};

/// The passes that advance the state.
pub const SIMULATION: [&str; 5] =
    ["heat-boundary", "refinement", "internal-deformation", "block-weights", "block-rotation"];

/// Sum of the medians of passes; `None` without any of them.
pub fn gpu_ms(run: &Run, names: &[&str]) -> Option<f64> {
    let passes = run.passes.iter().filter(|p| names.contains(&p.name.as_str()));
    let times: Vec<f64> = passes.filter_map(|p| p.gpu_ms.as_ref().map(|s| s.median)).collect();
    (!times.is_empty()).then(|| times.iter().sum())
}

/// A run's result of that name; null where it has none.
pub fn result(run: &Run, name: &str) -> Value {
    run.results.get(name).cloned().unwrap_or(Value::Null)
}

/// A point under `shell`.
pub fn point(label: String, x: f64, study: Setup) -> Point<Setup> {
    Point { label, x, study, variants: vec![Variant::Shell], left_out: Vec::new() }
}

/// A setup with a change, whose frame 0 shows `tick`.
pub fn at_tick(setup: &Setup, tick: u32, change: impl FnOnce(&mut Parameters)) -> Setup {
    let mut study = setup.clone();
    change(&mut study.parameters);
    study.parameters.first_frame = frame_before(&study.parameters, tick);
    study
}

/// Block counts without any named: one, some, the dissertation's 336 and 3,375 (3.7.3), and more.
pub const BLOCKS: [[u32; 3]; 5] = [[1, 1, 1], [3, 3, 4], [6, 7, 8], [15, 15, 15], [30, 30, 30]];

/// 15,000 triangles at 336 blocks, and "slightly over 30" at 3,375.
const BLOCK_RATES: [([u32; 3], f64); 2] = [([6, 7, 8], 70.0), ([15, 15, 15], 30.0)];

/// One point a division into blocks, at `tick` of the fire.
pub fn block_points(setup: &Setup, tick: u32) -> Vec<Point<Setup>> {
    let of = |blocks: [u32; 3]| {
        let [x, y, z] = blocks;
        point(format!("{x}x{y}x{z}"), f64::from(x * y * z), at_tick(setup, tick, |p| p.blocks = blocks))
    };
    BLOCKS.map(of).into()
}

/// Notes the dissertation's frame rates and makes the table of the passes that know blocks.
pub fn block_table(rows: &mut [Row]) -> ResultTable {
    let mut table = Vec::new();
    for row in rows {
        let of = |([x, y, z], _): &&([u32; 3], f64)| row.label == format!("{x}x{y}x{z}");
        let paper = BLOCK_RATES.iter().find(of).map(|(_, frames_per_s)| *frames_per_s);
        let run = &mut row.run;
        let ours = run.median_frame_ms().map(|ms| 1e3 / ms);
        run.experiment = Some(ExperimentRow::new(format!("{} blocks", row.label), paper, ours, None));
        table.push(vec![
            json!(row.label),
            json!(row.x as u64),
            result(run, "occupied_blocks"),
            json!(run.median_frame_ms()),
            json!(ours),
            json!(paper),
            json!(gpu_ms(run, &["block-weights"])),
            json!(gpu_ms(run, &["block-rotation"])),
            json!(gpu_ms(run, &["vertex-mapping"])),
            json!(gpu_ms(run, &["flames"])),
        ]);
    }
    ResultTable {
        title: "Section 3.7.3: blocks",
        columns: &[
            "blocks",
            "count",
            "occupied",
            "frame ms",
            "frames/s",
            "dissertation",
            "weights ms",
            "rotation ms",
            "mapping ms",
            "flames ms",
        ],
        rows: table,
    }
}

/// A fire under a limit of active vertices, and its snapshots.
pub struct Limited {
    /// Most triangles that the limit of section 3.7.1 lets burn.
    pub limit: u32,
    /// States over time.
    pub snapshots: Vec<Snapshot>,
}

/// The limits that are tried: none, a half and a quarter of the most vertices that burn at once without.
pub fn limits(free: &[Snapshot]) -> Vec<u32> {
    let peak = free.iter().map(|snapshot| snapshot.counts.active_vertices).max().unwrap_or(0);
    vec![0, (peak / 2).max(1), (peak / 4).max(1)]
}

/// The setup under a limit.
pub fn limited(setup: &Setup, limit: u32) -> Setup {
    let parameters = Parameters { active_limit: limit, ..setup.parameters.clone() };
    Setup { parameters, ..setup.clone() }
}

/// Each limited fire where most vertices burn.
pub fn limit_points(setup: &Setup, fires: &[Limited]) -> Vec<Point<Setup>> {
    let of = |fire: &Limited| {
        let mut study = limited(setup, fire.limit);
        let fullest = fire.snapshots.iter().rev().max_by_key(|snapshot| snapshot.counts.active_vertices);
        study.parameters.first_frame =
            frame_before(&setup.parameters, fullest.map_or(1, |snapshot| snapshot.counts.tick));
        point(format!("limit {}", fire.limit), f64::from(fire.limit), study)
    };
    fires.iter().map(of).collect()
}

/// Gain and cost of each limit (3.7.1).
pub fn limit_table(fires: &[Limited], rows: &[Row]) -> ResultTable {
    let rows = fires.iter().zip(rows).map(|(fire, row)| {
        let peak = fire.snapshots.iter().map(|snapshot| snapshot.counts.active_vertices).max();
        vec![
            json!(fire.limit),
            json!(peak),
            json!(fire.snapshots.last().map(|snapshot| snapshot.counts.tick)),
            result(&row.run, "active_triangles"),
            json!(gpu_ms(&row.run, &SIMULATION)),
            json!(row.run.median_frame_ms()),
        ]
    });
    ResultTable {
        title: "Section 3.7.1: limits of the active vertices, where most are active",
        columns: &["limit", "most active", "ticks", "active triangles", "simulation ms", "frame ms"],
        rows: rows.collect(),
    }
}

/// Frames that a tick is spread over.
pub const DIVISIONS: [u32; 4] = [1, 2, 4, 8];

/// A tick, spread over 1 to 8 frames.
pub fn division_points(setup: &Setup, tick: u32) -> Vec<Point<Setup>> {
    let of = |division: u32| {
        let study = at_tick(setup, tick, |p| p.time_division = division);
        point(format!("division {division}"), f64::from(division), study)
    };
    DIVISIONS.map(of).into()
}

/// Gain of time division (3.7.2): frames of one tick differ, and the player sees the longest.
pub fn division_table(rows: &[Row]) -> ResultTable {
    let rows = rows.iter().map(|row| {
        let summary = row.run.frame_ms.as_ref();
        let mean = summary.map(|s| s.mean);
        vec![
            json!(row.x as u32),
            json!(mean),
            json!(summary.map(|s| s.median)),
            json!(summary.map(|s| s.max)),
            json!(mean.map(|ms| 1e3 / ms / row.x)),
        ]
    });
    ResultTable {
        title: "Section 3.7.2: a tick spread over frames",
        columns: &["division", "mean frame ms", "median frame ms", "longest frame ms", "ticks/s"],
        rows: rows.collect(),
    }
}

/// A tick with everything loaded before, and without.
pub fn loading_points(setup: &Setup, tick: u32) -> Vec<Point<Setup>> {
    let of = |preload: bool| {
        let study = at_tick(setup, tick, |p| p.preload = preload);
        point(format!("preload {preload}"), f64::from(u8::from(preload)), study)
    };
    [true, false].map(of).into()
}

/// Gain of loading ahead (3.7.4).
pub fn loading_table(rows: &[Row]) -> ResultTable {
    let rows = rows.iter().map(|row| {
        let loaded = if row.x > 0.0 { "before" } else { "in every frame" };
        vec![json!(loaded), json!(gpu_ms(&row.run, &["loading"])), json!(row.run.median_frame_ms())]
    });
    ResultTable {
        title: "Section 3.7.4: what never changes, loaded",
        columns: &["loaded", "loading ms", "frame ms"],
        rows: rows.collect(),
    }
}

/// Triangles without any named.
pub const COUNTS: [u32; 7] = [1_000, 3_162, 10_000, 31_623, 100_000, 316_228, 1_000_000];

/// The numbers of `scaling`: a fast fire without particles, where about half of the object burns.
pub fn scaling_setup() -> Setup {
    let parameters = Parameters { speed_per_s: 0.5, first_frame: 60, fire: 0, smoke: 0, ..Parameters::default() };
    Setup { parameters, ..Setup::default() }
}

/// One point a number of triangles.
pub fn scaling_points(setup: &Setup, counts: &[u32]) -> Vec<Point<Setup>> {
    let of = |&count: &u32| {
        point(format!("{count} triangles"), f64::from(count), Setup { triangles: Some(count), ..setup.clone() })
    };
    counts.iter().map(of).collect()
}

/// Active triangles a second of each simulation pass and of all together.
pub fn scaling_table(rows: &[Row]) -> ResultTable {
    let mut table = Vec::new();
    for row in rows {
        let active = result(&row.run, "active_triangles").as_f64();
        let mut push = |pass: &str, ms: Option<f64>| {
            let rate =
                active.zip(ms).filter(|(_, ms)| *ms > 0.0).map(|(active, ms)| (active / ms * 1e3).round() as u64);
            let total = result(&row.run, "finest_triangles");
            table.push(vec![total, json!(active.map(|n| n as u64)), json!(pass), json!(ms), json!(rate)]);
        };
        for pass in SIMULATION {
            if let Some(ms) = gpu_ms(&row.run, &[pass]) {
                push(pass, Some(ms));
            }
        }
        push("simulation", gpu_ms(&row.run, &SIMULATION));
        push("frame", row.run.median_frame_ms());
    }
    ResultTable {
        title: "Scaling: active triangles a second",
        columns: &["triangles", "active", "pass", "ms", "active triangles/s"],
        rows: table,
    }
}

/// Time of each simulation pass over active triangles, both scales logarithmic.
///
/// # Errors
/// [`Error::Plot`].
pub fn scaling_plot(rows: &[Row]) -> Result<String, Error> {
    let active = |run: &Run| result(run, "active_triangles").as_f64();
    let labels = ["Burning: time of each pass by active triangles", "active triangles"];
    passes_plot(rows, labels, &active, ("frame", &Run::median_frame_ms))
}

/// A number of a run, where it has it.
pub type OfRun<'a> = &'a dyn Fn(&Run) -> Option<f64>;

/// Time of each simulation pass, and one by its name, over `x` above 0; both scales logarithmic.
///
/// # Errors
/// [`Error::Plot`].
pub fn passes_plot(
    rows: &[Row],
    [title, x_label]: [&str; 2],
    x: OfRun<'_>,
    whole: (&str, OfRun<'_>),
) -> Result<String, Error> {
    let line = |name: &str, ms: OfRun<'_>| {
        let points = rows.iter().filter_map(|row| Some((x(&row.run)?, ms(&row.run)?)));
        Series { name: name.to_owned(), points: points.filter(|(x, _)| *x > 0.0).collect(), reference: false }
    };
    let mut series: Vec<Series> = SIMULATION.iter().map(|pass| line(pass, &|run| gpu_ms(run, &[pass]))).collect();
    series.push(line(whole.0, whole.1));
    series.retain(|s| !s.points.is_empty());
    let chart = LineChart {
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: "ms".to_owned(),
        x_scale: Scale::Log,
        y_scale: Scale::Log,
        series,
    };
    Ok(chart.to_svg()?)
}
