//! Tables 5-1 and 5-3, sections 6.1 and 6.3, and the appendix's curves: rendering time by number of planes, methods interleaved in one
//! process.

use serde_json::json;

use super::super::named_mesh::NamedMesh;
use super::super::setup::Setup;
use super::drawn::{self, Drawn};
use super::ratios::{self, Ratios};
use super::thesis::{TABLE_5_1, TABLE_5_3};
use crate::measure::Error;
use crate::measure::Variant as _;
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::experiment::NamedTable;
use crate::measure::sweep::{self, Point};
use crate::papers::caustics::Variant;
use crate::report::plot::{LineChart, Scale, Series};
use crate::report::record::{ExperimentRow, Run};
use crate::report::table::{Align, Style, Table, interval, number};
use crate::scene::MeshSource;

/// The methods that a sweep compares.
#[derive(Debug, Clone, Copy)]
pub struct Comparison {
    /// Heading of the table.
    pub title: &'static str,
    /// The method that ratios are taken against.
    pub base: Variant,
    /// Variants that are measured beside the first.
    pub others: &'static [Variant],
}

/// Table 5-1 and figure 5-10.
pub const LEVEL_MAP_AGAINST_VOLUMETRIC: Comparison = Comparison {
    title: "Table 5-1: level map against volumetric",
    base: Variant::LevelMap,
    others: &[Variant::Volumetric],
};

/// Table 5-3 and figure 5-11.
pub const NORMAL_AGAINST_SMART: Comparison = Comparison {
    title: "Table 5-3: normal against smart slicing",
    base: Variant::LevelMapSmart,
    others: &[Variant::LevelMap],
};

/// The comparison that chapter 6 proposes.
pub const CHAPTER_6: Comparison = Comparison {
    title: "Sections 6.1 and 6.3: culled and hit against the level map",
    base: Variant::LevelMap,
    others: &[Variant::Culled, Variant::Hit],
};

/// The same with smart slicing, which the level map has as a variant of its own.
pub const CHAPTER_6_SMART: Comparison = Comparison {
    title: "Sections 6.1 and 6.3: culled with smart planes, and hit, against level-map-smart",
    base: Variant::LevelMapSmart,
    ..CHAPTER_6
};

/// The appendix's graphs.
pub const ALL_THREE: Comparison = Comparison {
    title: "Appendix: rendering time by number of planes",
    base: Variant::LevelMap,
    others: &[Variant::Volumetric, Variant::LevelMapSmart],
};

impl Comparison {
    /// The base first.
    pub fn variants(&self) -> Vec<Variant> {
        std::iter::once(self.base).chain(self.others.iter().copied()).collect()
    }

    /// One point for each mesh and each count of planes, the methods interleaved.
    pub fn points(&self, setup: &Setup, meshes: &[MeshSource], counts: &[u32]) -> Vec<Point<Setup>> {
        let point = |mesh: &NamedMesh, planes: u32| {
            let mut study = Setup { meshes: vec![mesh.source.clone()], ..setup.clone() };
            study.parameters.planes = planes;
            let x = f64::from(planes);
            Point { label: mesh.name.clone(), x, study, variants: self.variants(), left_out: Vec::new() }
        };
        let meshes = NamedMesh::all(meshes);
        meshes.iter().flat_map(|mesh| counts.iter().map(move |&planes| point(mesh, planes))).collect()
    }

    /// The thesis's seconds for a variant.
    fn thesis(&self, mesh: &str, variant: Variant, planes: u32) -> Option<f64> {
        // Table 5-3 has the normal level map's times as well, digit for digit those of table 5-1.
        let table = if variant == Variant::LevelMapSmart { TABLE_5_3 } else { TABLE_5_1 };
        table.get(&format!("{mesh} {}", variant.as_str()), planes)
    }

    fn thesis_ratio(&self, mesh: &str, variant: Variant, planes: u32) -> Option<f64> {
        Some(self.thesis(mesh, variant, planes)? / self.thesis(mesh, self.base, planes)?)
    }
}

/// One method at one count.
struct Row {
    mesh: String,
    /// The name that the thesis's tables may know it by.
    model: String,
    planes: u32,
    variant: Variant,
    /// Planes that were drawn; none of a method without them.
    drawn: Option<u64>,
    frame_ms: f64,
    device_bytes: u64,
    /// Time over the base's; absent for the base itself.
    ratio: Option<Ratio>,
    thesis: Option<f64>,
}

/// A sweep's rows with what they are compared with.
pub struct Outcome {
    comparison: Comparison,
    runs: Vec<Run>,
    rows: Vec<Row>,
    ratios: Vec<Ratios>,
    /// The pictures, where the comparison is of them.
    drawn: Vec<Drawn>,
}

impl Outcome {
    /// Notes in every run's record its ratio to the base, beside the thesis's. The rows are those of
    /// [`Comparison::points`] over `meshes`.
    pub fn new(comparison: Comparison, meshes: &[MeshSource], rows: Vec<sweep::Row>) -> Self {
        let meshes = NamedMesh::all(meshes);
        let place = |row: sweep::Row| ((row.label, row.x as u32), row.run);
        let (places, mut runs): (Vec<_>, Vec<_>) = rows.into_iter().map(place).unzip();
        let mut outcome =
            Outcome { comparison, runs: Vec::new(), rows: Vec::new(), ratios: Vec::new(), drawn: Vec::new() };
        let methods = comparison.variants().len();
        for (places, runs) in places.chunks(methods).zip(runs.chunks_mut(methods)) {
            let (name, planes) = &places[0];
            if let Some(mesh) = meshes.iter().find(|mesh| mesh.name == *name) {
                outcome.add(mesh, *planes, runs);
            }
        }
        Outcome { runs, ..outcome }
    }

    /// One mesh at one count: a run of each method, the base first.
    fn add(&mut self, mesh: &NamedMesh, planes: u32, runs: &mut [Run]) {
        let base = runs.first().map(|run| run.frame_samples().to_vec()).unwrap_or_default();
        for (index, (run, variant)) in runs.iter_mut().zip(self.comparison.variants()).enumerate() {
            let ratio = (index > 0).then(|| ratio_within_process(&base, run.frame_samples())).flatten();
            let thesis = self.comparison.thesis_ratio(&mesh.model, variant, planes).filter(|_| index > 0);
            if let Some(ratio) = &ratio {
                run.experiment = Some(ExperimentRow {
                    row: format!(
                        "{}, {planes} planes: {} / {}",
                        mesh.name,
                        variant.as_str(),
                        self.comparison.base.as_str()
                    ),
                    paper: thesis,
                    interval: ratio.interval,
                    ours: Some(ratio.ratio),
                    ratio: thesis.map(|thesis| ratio.ratio / thesis),
                });
                run.results.insert("ratio_interval".into(), json!(ratio.interval));
            }
            self.rows.push(Row {
                mesh: mesh.name.clone(),
                model: mesh.model.clone(),
                planes,
                variant,
                drawn: run.results.get("planes_drawn").and_then(|v| v.as_u64()),
                frame_ms: run.median_frame_ms().unwrap_or(f64::NAN),
                device_bytes: run.memory.device_bytes.unwrap_or(0),
                ratio,
                thesis,
            });
        }
        if self.comparison.others.contains(&Variant::Hit) {
            self.drawn.extend(runs.iter().map(|run| Drawn::of(&mesh.name, planes, run)));
        }
        self.ratios.push(Ratios::of(&mesh.name, planes, runs));
    }

    /// The runs, for the record.
    pub fn into_runs(self) -> Vec<Run> {
        self.runs
    }

    /// The table, ours beside the thesis's.
    pub fn render(&self, style: Style) -> String {
        let mut table = Table::new(&[
            ("mesh", Align::Left),
            ("planes", Align::Right),
            ("method", Align::Left),
            ("drawn", Align::Right),
            ("frame ms", Align::Right),
            ("device MiB", Align::Right),
            ("ratio", Align::Right),
            ("95 % interval", Align::Left),
            ("thesis", Align::Right),
            ("ours / thesis", Align::Right),
        ]);
        for row in &self.rows {
            let flag = if is_doubtful(row) { "*" } else { "" };
            let ratio = row.ratio.as_ref();
            table.push(vec![
                row.mesh.clone(),
                row.planes.to_string(),
                row.variant.as_str().to_owned(),
                row.drawn.map_or(String::new(), |planes| planes.to_string()),
                format!("{:.2}", row.frame_ms),
                format!("{:.1}", row.device_bytes as f64 / f64::from(1 << 20)),
                number(ratio.map(|r| r.ratio), 3),
                interval(ratio.and_then(|r| r.interval)),
                row.thesis.map_or(String::new(), |t| format!("{t:.2}{flag}")),
                number(ratio.zip(row.thesis).map(|(r, t)| r.ratio / t), 2),
            ]);
        }
        let mut text = format!("{}\n{}", style.bold(self.comparison.title), table.render(style));
        text.push_str(&format!("ratio: frame time over that of {}\n", self.comparison.base.as_str()));
        if self.rows.iter().any(is_doubtful) {
            text.push_str(
                "* the thesis prints the teapot's volumetric times for the sphere as well, digit for digit; this ratio \
                 rests on them\n",
            );
        }
        text
    }

    /// Tables after it, each with its name.
    pub fn tables(&self) -> Vec<NamedTable> {
        let drawn = (!self.drawn.is_empty()).then(|| ("drawn", drawn::table(&self.drawn)));
        ratios::tables(&self.ratios).into_iter().chain(drawn).collect()
    }

    /// Time against the number of planes, a plot for each mesh with its file's suffix; the thesis's curves are drawn dashed,
    /// scaled so that its base meets ours at the largest count: shapes compare, machines do not.
    ///
    /// # Errors
    /// [`Error::Plot`].
    pub fn plots(&self) -> Result<Vec<(String, String)>, Error> {
        let mut meshes: Vec<&str> = self.rows.iter().map(|row| row.mesh.as_str()).collect();
        meshes.dedup();
        let suffix = |mesh: &str| if meshes.len() == 1 { ".svg".to_owned() } else { format!("-{mesh}.svg") };
        meshes.iter().map(|mesh| Ok((suffix(mesh), self.plot(mesh)?))).collect()
    }

    fn plot(&self, mesh: &str) -> Result<String, Error> {
        let rows: Vec<&Row> = self.rows.iter().filter(|row| row.mesh == mesh).collect();
        let ours = self.comparison.variants().into_iter().map(|variant| Series {
            name: variant.as_str().to_owned(),
            points: rows
                .iter()
                .filter(|row| row.variant == variant)
                .map(|row| (f64::from(row.planes), row.frame_ms))
                .collect(),
            reference: false,
        });
        let chart = LineChart {
            title: format!("{}, {mesh}", self.comparison.title),
            x_label: "planes".to_owned(),
            y_label: "frame, ms".to_owned(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            series: ours.chain(self.thesis_series(&rows)).collect(),
        };
        Ok(chart.to_svg()?)
    }

    fn thesis_series(&self, rows: &[&Row]) -> Vec<Series> {
        let base = self.comparison.base;
        let of_base = rows.iter().filter(|row| row.variant == base);
        let Some(last) = of_base.max_by_key(|row| row.planes) else { return Vec::new() };
        let model = &last.model;
        let Some(seconds) = self.comparison.thesis(model, base, last.planes) else { return Vec::new() };
        let scale = last.frame_ms / seconds;
        let curve = |variant: Variant| {
            let at = |planes| Some((f64::from(planes), scale * self.comparison.thesis(model, variant, planes)?));
            (3..=last.planes).filter_map(at).collect::<Vec<_>>()
        };
        self.comparison
            .variants()
            .into_iter()
            .map(|variant| Series {
                name: format!("thesis, {}, scaled", variant.as_str()),
                points: curve(variant),
                reference: true,
            })
            .filter(|series| !series.points.is_empty())
            .collect()
    }
}

fn is_doubtful(row: &Row) -> bool {
    row.model == "sphere" && row.variant == Variant::Volumetric && row.thesis.is_some()
}
