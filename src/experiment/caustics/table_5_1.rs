//! Table 5-1 and figure 5-10: the rendering time of the level map against the volumetric method by number of planes.

use std::path::PathBuf;

use serde_json::json;

use super::{Setup, bench};
use crate::experiment::compare::{Ratio, ratio_within_process};
use crate::experiment::error::Error;
use crate::experiment::machine::Machine;
use crate::experiment::measure::{Schedule, Watch};
use crate::papers::caustics::Variant;
use crate::report::plot::{LineChart, Scale, Series};
use crate::report::record::{ExperimentRow, Limits, Run};
use crate::report::table::{Align, Style, Table};
use crate::scene::MeshSource;

/// The thesis's table 5-1 in seconds, on a GeForce 6800. It prints one volumetric column for teapot and sphere, digit for
/// digit, which two measurements cannot have given: the sphere's ratios rest on the teapot's times.
const THESIS: &str = include_str!("table_5_1.csv");

/// The thesis's meshes that we have, and scanned and sculpted ones from `assets/`, as far as they are there.
pub fn default_meshes() -> Vec<MeshSource> {
    let shipped = ["assets/meshes/bunny.obj", "assets/meshes/wuson.stl"].map(PathBuf::from);
    let shipped = shipped.into_iter().filter(|path| path.is_file()).map(MeshSource::File);
    [MeshSource::Teapot, MeshSource::Sphere].into_iter().chain(shipped).collect()
}

/// A sweep over meshes and plane counts.
pub struct Sweep {
    pub setup: Setup,
    pub meshes: Vec<MeshSource>,
    pub counts: Vec<u32>,
    pub schedule: Schedule,
    pub limits: Option<Limits>,
}

/// One row of our table.
#[derive(Debug, Clone)]
struct Row {
    mesh: String,
    planes: u32,
    level_map_ms: f64,
    volumetric_ms: f64,
    ratio: Ratio,
    thesis: Option<(f64, f64)>,
    level_map_bytes: u64,
    volumetric_bytes: u64,
}

/// What the sweep found.
pub struct Outcome {
    pub runs: Vec<Run>,
    rows: Vec<Row>,
}

impl Sweep {
    /// Measures both variants, interleaved, at every count for every mesh. An interrupted sweep keeps its finished
    /// rows.
    ///
    /// # Errors
    /// [`Error::Gpu`], [`Error::Scene`], [`Error::Parameter`]; [`Error::Interrupted`] before the first row.
    pub fn run(&self, machine: &mut Machine, watch: &mut Watch<'_>) -> Result<Outcome, Error> {
        let mut outcome = Outcome { runs: Vec::new(), rows: Vec::new() };
        for mesh in &self.meshes {
            let mut setup = self.setup.clone();
            setup.meshes = vec![mesh.clone()];
            setup.preset = Some("5-1".to_owned());
            let scene = setup.load()?;
            for &planes in &self.counts {
                setup.parameters.planes = planes;
                setup.parameters.validate()?;
                let variants = [Variant::LevelMap, Variant::Volumetric];
                let limits = self.limits.as_ref();
                match bench(machine, &setup, &scene, &variants, self.schedule, limits, watch) {
                    Ok(runs) => outcome.add(mesh, planes, runs.into_iter().map(|r| r.run).collect()),
                    Err(Error::Interrupted) if !outcome.rows.is_empty() => return Ok(outcome),
                    Err(error) => return Err(error),
                }
                if watch.interrupted.load(std::sync::atomic::Ordering::Relaxed) {
                    return Ok(outcome);
                }
            }
        }
        Ok(outcome)
    }
}

impl Outcome {
    fn add(&mut self, mesh: &MeshSource, planes: u32, mut runs: Vec<Run>) {
        let thesis = thesis(&mesh.to_string(), planes);
        let samples = |run: &Run| run.frame_ms.as_ref().map(|s| s.samples.clone()).unwrap_or_default();
        if let [level_map, volumetric] = &mut runs[..]
            && let Some(ratio) = ratio_within_process(&samples(level_map), &samples(volumetric))
        {
            let name = mesh_name(mesh);
            let paper = thesis.map(|(level_map, volumetric)| volumetric / level_map);
            let row = ExperimentRow {
                row: format!("{name}, {planes} planes: volumetric / level-map"),
                paper,
                ours: Some(ratio.ratio),
                ratio: paper.map(|paper| ratio.ratio / paper),
            };
            volumetric.experiment = Some(row);
            volumetric.results.insert("ratio_interval".into(), json!(ratio.interval));
            let bytes = |run: &Run| run.memory.device_bytes.unwrap_or(0);
            self.rows.push(Row {
                mesh: name,
                planes,
                level_map_ms: ratio.a_median_ms,
                volumetric_ms: ratio.b_median_ms,
                thesis,
                level_map_bytes: bytes(level_map),
                volumetric_bytes: bytes(volumetric),
                ratio,
            });
        }
        self.runs.append(&mut runs);
    }

    /// The table, ours beside the thesis's.
    pub fn render(&self, style: Style) -> String {
        let mut table = Table::new(&[
            ("mesh", Align::Left),
            ("planes", Align::Right),
            ("level-map ms", Align::Right),
            ("volumetric ms", Align::Right),
            ("ratio", Align::Right),
            ("95 % interval", Align::Left),
            ("thesis ratio", Align::Right),
            ("ours / thesis", Align::Right),
            ("level-map MiB", Align::Right),
            ("volumetric MiB", Align::Right),
        ]);
        let mib = |bytes: u64| format!("{:.1}", bytes as f64 / f64::from(1 << 20));
        for row in &self.rows {
            let paper = row.thesis.map(|(level_map, volumetric)| volumetric / level_map);
            let flag = if row.mesh == "sphere" { "*" } else { "" };
            table.push(vec![
                row.mesh.clone(),
                row.planes.to_string(),
                format!("{:.2}", row.level_map_ms),
                format!("{:.2}", row.volumetric_ms),
                format!("{:.3}", row.ratio.ratio),
                format!("{:.3} to {:.3}", row.ratio.interval[0], row.ratio.interval[1]),
                paper.map_or(String::new(), |p| format!("{p:.2}{flag}")),
                paper.map_or(String::new(), |p| format!("{:.2}", row.ratio.ratio / p)),
                mib(row.level_map_bytes),
                mib(row.volumetric_bytes),
            ]);
        }
        let mut text = table.render(style);
        if self.rows.iter().any(|row| row.mesh == "sphere" && row.thesis.is_some()) {
            text.push_str(
                "* the thesis prints the teapot's volumetric times for the sphere as well, digit for digit; its ratios \
                 for the sphere rest on them\n",
            );
        }
        text
    }

    /// Figure 5-10: time against the number of planes; the thesis's teapot is drawn dashed, scaled to our level map's
    /// time at its largest count so that the shapes compare.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn plot(&self) -> Result<String, Error> {
        let mut series = Vec::new();
        let mut meshes: Vec<&str> = self.rows.iter().map(|row| row.mesh.as_str()).collect();
        meshes.dedup();
        for mesh in meshes {
            let of = |value: fn(&Row) -> f64| -> Vec<(f64, f64)> {
                let rows = self.rows.iter().filter(|row| row.mesh == mesh);
                rows.map(|row| (f64::from(row.planes), value(row))).collect()
            };
            series.push(ours(format!("{mesh}, level map"), of(|row| row.level_map_ms)));
            series.push(ours(format!("{mesh}, volumetric"), of(|row| row.volumetric_ms)));
        }
        let last = self.rows.iter().filter(|row| row.thesis.is_some()).max_by_key(|row| row.planes);
        if let Some((row, (level_map_s, _))) = last.and_then(|row| Some((row, row.thesis?))) {
            let scale = row.level_map_ms / level_map_s;
            for (name, volumetric) in [("level map", false), ("volumetric", true)] {
                let points = (3..=row.planes).filter_map(|planes| {
                    let (a, b) = thesis(&row.mesh, planes)?;
                    Some((f64::from(planes), scale * if volumetric { b } else { a }))
                });
                series.push(Series {
                    name: format!("thesis, {}, {name}, scaled", row.mesh),
                    points: points.collect(),
                    reference: true,
                });
            }
        }
        let chart = LineChart {
            title: "Table 5-1: rendering time by number of planes".to_owned(),
            x_label: "planes".to_owned(),
            y_label: "frame, ms".to_owned(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            series,
        };
        Ok(chart.to_svg()?)
    }
}

fn ours(name: String, points: Vec<(f64, f64)>) -> Series {
    Series { name, points, reference: false }
}

/// A mesh's word, or its file's name without the folder.
fn mesh_name(mesh: &MeshSource) -> String {
    match mesh {
        MeshSource::File(path) => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        other => other.to_string(),
    }
}

/// The thesis's times of level map and volumetric in seconds.
fn thesis(mesh: &str, planes: u32) -> Option<(f64, f64)> {
    let mut lines = THESIS.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let header = lines.next()?;
    let column = header.iter().position(|name| *name == format!("{mesh} level-map"))?;
    let row = lines.find(|row| row[0] == planes.to_string())?;
    Some((row[column].parse().ok()?, row[column + 1].parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_is_read_as_printed() {
        assert_eq!(thesis("teapot", 3), Some((0.068, 0.13)));
        assert_eq!(thesis("dolphin", 31), Some((0.513, 1.222)));
        assert_eq!(thesis("sphere", 101), Some((1.572, 4.413)));
        assert_eq!(thesis("teapot", 2), None);
        assert_eq!(thesis("bunny", 31), None);
        assert!((3..=101).all(|planes| thesis("teapot", planes).is_some()));
    }

    #[test]
    fn the_thesis_prints_one_volumetric_column_twice() {
        let same = |planes| thesis("teapot", planes).map(|t| t.1) == thesis("sphere", planes).map(|t| t.1);
        assert!((3..=101).all(same));
    }
}
