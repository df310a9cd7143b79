//! Culling (chapter 9): splats that are left out from each camera, and the times of what draws the others.

use glam::Vec3;
use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::measure::parameter::Choice as _;
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row};
use crate::papers::lava::{CAMERAS, SplatCulling, SurfaceDraw, Variant};
use crate::report::record::Run;
use crate::scene::Camera;

/// Every way to cull from every camera: the figures', one close to the lava and one low beside it, or the one that was given.
pub fn points(setup: &Setup, is_camera_given: bool) -> Vec<Point<Setup>> {
    let space_m = setup.parameters.space_m;
    let view = |eye: Vec3, target: Vec3| Camera { eye: eye * space_m, target: target * space_m, ..CAMERAS[0].1 };
    let close = view(Vec3::new(0.1, 1.2, 0.5), Vec3::new(0.2, 0.3, 0.5));
    let low = view(Vec3::new(0.5, 0.9, 3.5), Vec3::new(0.5, 0.2, 0.5));
    let cameras: Vec<(&'static str, Camera)> = if is_camera_given {
        vec![("given", setup.parameters.camera)]
    } else {
        CAMERAS.into_iter().chain([("close", close), ("low", low)]).collect()
    };
    let of = |(name, camera): (&'static str, Camera)| {
        SplatCulling::ALL.iter().map(move |&culling| {
            let mut study = setup.clone();
            (study.parameters.camera, study.parameters.culling) = (camera, culling);
            study.parameters.surface_draw = Some(SurfaceDraw::Splats);
            let label = format!("{name} {}", culling.name());
            Point { variants: vec![Variant::Paper], ..Point::single(&label, study) }
        })
    };
    cameras.into_iter().flat_map(of).collect()
}

/// Milliseconds of the passes of these names; none without one of them, or where one was not measured.
fn gpu_ms(run: &Run, names: &[&str]) -> Option<f64> {
    let passes = run.passes.iter().filter(|pass| names.contains(&pass.name.as_str()));
    passes.map(|pass| pass.gpu_ms.as_ref().map(|summary| summary.median)).reduce(|sum, ms| Some(sum? + ms?)).flatten()
}

/// Counts and times of every row, and its frame beside that of the camera without culling.
pub fn table(rows: &[Row]) -> ResultTable {
    let mut cells = Vec::new();
    let mut plain_ms = None;
    for row in rows {
        let (camera, culling) = row.label.split_once(' ').unwrap_or((&row.label, ""));
        let frame_ms = row.run.median_frame_ms();
        if culling == SplatCulling::Off.name() {
            plain_ms = frame_ms;
        }
        let count = |name: &str| row.run.results.get(name).cloned().unwrap_or(Value::Null);
        cells.push(vec![
            json!(camera),
            json!(culling),
            count("kept_splats"),
            count("kept_clusters"),
            json!(gpu_ms(&row.run, &["cull", "cull-sum", "cull-compact"])),
            json!(gpu_ms(&row.run, &["visibility", "blending"])),
            json!(frame_ms),
            json!(plain_ms.zip(frame_ms).map(|(plain, own)| plain / own)),
        ]);
    }
    ResultTable {
        title: "Culling: splats and clusters that stay, and their times",
        columns: &["camera", "culling", "splats", "clusters", "culling ms", "splats ms", "frame ms", "times faster"],
        rows: cells,
    }
}
