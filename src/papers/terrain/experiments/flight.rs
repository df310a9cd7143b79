//! A flight over maps in tiles: which pictures had to wait for tiles, how many came, and how long that took.

use std::time::Instant;

use glam::Vec3;
use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::gpu::Mode;
use crate::measure::Paper;
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::parameter::EyeAndTarget;
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::{Error, ParameterError};
use crate::papers::terrain::{Parameters, Variant, View};
use crate::scene::Camera;

/// Pictures without `frames`.
pub const PICTURES: u32 = 60;

/// Columns that the plot shows.
pub const TIMES: [&str; 3] = ["frame ms", "marks ms", "stall ms"];

/// The camera of a picture on the way, `t` from 0 to 1.
fn between(first: &Camera, last: &EyeAndTarget, t: f32) -> Camera {
    Camera { eye: first.eye.lerp(last.eye, t), target: first.target.lerp(last.target, t), ..*first }
}

/// Checks the last camera of a flight that begins at `first`, as the option `to` gives it; all else was checked before.
fn check_last(parameters: &Parameters, first: &Camera, last: &EyeAndTarget) -> Result<(), ParameterError> {
    let view = View::Camera(between(first, last, 1.0));
    let checked = Parameters { view, ..parameters.clone() }.validate();
    checked.map_err(|error| ParameterError { name: "to", ..error })
}

/// A row for each of so many pictures, at least two, from the setup's camera straight to another; without one as far north as the
/// maps reach. A picture is drawn again until it lacks no tile that the pool has room for: what comes before its last drawing, which
/// is the frame, is a stall; a last drawing that marks what it reads tells that it is one.
///
/// # Errors
/// [`Error::Gpu`], [`Error::Scene`], [`Error::Parameter`].
pub fn table(
    machine: &mut Machine,
    setup: &Setup,
    last: Option<EyeAndTarget>,
    pictures: u32,
) -> Result<ResultTable, Error> {
    let scene = setup.load()?;
    let mut paper = build(machine, setup, &scene, Variant::TiledCompute)?.paper;
    let extent = paper.scene.extent;
    let first = setup.parameters.camera(&extent);
    last.as_ref().map_or(Ok(()), |last| check_last(&setup.parameters, &first, last))?;
    let north = (extent.low.z - extent.high.z) as f32 * Vec3::Z;
    let last = last.unwrap_or(EyeAndTarget { eye: first.eye + north, target: first.target + north });
    // Pipelines are compiled when they are first used.
    machine.recorder.run(Mode::Plain, |frame| paper.record(frame, 0))?;
    let mut before = paper.tiles().unwrap_or_default();
    let mut rows = Vec::new();
    for picture in 0..pictures {
        let camera = between(&first, &last, picture as f32 / (pictures - 1) as f32);
        paper.set_view(View::Camera(camera));
        let (mut stalls, mut stall_ms) = (0, 0.0);
        let (frame_ms, marks_ms) = loop {
            let started = Instant::now();
            machine.recorder.run(Mode::Plain, |frame| paper.record(frame, picture))?;
            let frame_ms = started.elapsed().as_secs_f64() * 1e3;
            let is_settled = paper.settle(&machine.shaders)?;
            let all_ms = started.elapsed().as_secs_f64() * 1e3;
            if is_settled {
                break (frame_ms, all_ms - frame_ms);
            }
            stalls += 1;
            stall_ms += all_ms;
        };
        let now = paper.tiles().unwrap_or_default();
        rows.push(vec![
            json!(picture),
            json!(frame_ms),
            json!(marks_ms),
            json!(stalls),
            json!(stall_ms),
            json!(now.loaded - before.loaded),
            json!(now.held),
            json!(now.missing),
        ]);
        before = now;
    }
    machine.drawn.add(paper.warnings());
    Ok(ResultTable {
        title: "A flight over tiles: frames, and what they waited for",
        columns: &[
            "picture",
            "frame ms",
            "marks ms",
            "stalls",
            "stall ms",
            "tiles loaded",
            "tiles held",
            "tiles missing",
        ],
        rows,
    })
}

/// A line on all rows of [`table`].
pub fn summary(table: &ResultTable) -> String {
    let number = |row: &[Value], column: usize| row[column].as_f64().unwrap_or(0.0);
    let rows = || table.rows.iter().map(Vec::as_slice);
    let stalled = rows().filter(|row| number(row, 3) > 0.0).count();
    let longest_ms = rows().map(|row| number(row, 4)).fold(0.0, f64::max);
    let missing = rows().map(|row| number(row, 7)).sum::<f64>();
    format!(
        "{stalled} of {} pictures waited for tiles, {longest_ms:.1} ms the longest; {missing} tiles were missing",
        table.rows.len()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flight_ends_at_a_camera_that_sees_something() {
        let first = Camera {
            eye: Vec3::new(0.0, 500.0, 900.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            vertical_fov_rad: 0.7,
            near_m: 0.01,
            far_m: 1e6,
        };
        let check = |eye: Vec3, target: Vec3| {
            check_last(&Parameters::default(), &first, &EyeAndTarget { eye, target }).map_err(|error| error.to_string())
        };
        assert_eq!(check(Vec3::new(50.0, 500.0, -900.0), Vec3::ZERO), Ok(()));
        let nothing = check(Vec3::ONE, Vec3::ONE).unwrap_err();
        assert!(nothing.starts_with("to 1,1,1,1,1,1: ") && nothing.contains("move one of them"), "{nothing}");
        let far = check(Vec3::new(0.0, 1e9, 0.0), Vec3::ZERO).unwrap_err();
        assert!(far.starts_with("to ") && far.contains("within 100000 km"), "{far}");
    }

    #[test]
    fn a_summary_counts_stalls_and_what_is_missing() {
        let row = |stalls: u32, stall_ms: f64, missing: u32| {
            vec![json!(0), json!(5.0), json!(6.0), json!(stalls), json!(stall_ms), json!(3), json!(9), json!(missing)]
        };
        let rows = vec![row(2, 7.25, 0), row(0, 0.0, 0), row(1, 3.0, 4)];
        let said = summary(&ResultTable { title: "", columns: &[], rows });
        assert_eq!(said, "2 of 3 pictures waited for tiles, 7.2 ms the longest; 4 tiles were missing");
    }
}
