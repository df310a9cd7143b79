//! Both variants in turn: what the readbacks cost, stage by stage.

use serde_json::{Value, json};

use super::super::setup::Setup;
use crate::measure::parameter::Choice as _;
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row};
use crate::papers::lava::SurfaceDraw;
use crate::report::record::{Pass, Summary};

/// Each variant by its own drawing, then both by splats and both by rays; by the one drawing that was asked for.
pub fn points(setup: &Setup) -> Vec<Point<Setup>> {
    let draws = match setup.parameters.surface_draw {
        Some(draw) => vec![Some(draw)],
        None => vec![None, Some(SurfaceDraw::Splats), Some(SurfaceDraw::March)],
    };
    let point = |draw: Option<SurfaceDraw>| {
        let mut study = setup.clone();
        study.parameters.surface_draw = draw;
        Point::single(draw.map_or("own", SurfaceDraw::name), study)
    };
    draws.into_iter().map(point).collect()
}

/// The stage of the thesis that a pass belongs to.
pub fn stage(pass: &Pass) -> &'static str {
    match pass.section.as_deref().and_then(|section| section.split('.').next()) {
        Some("5") => "one",
        Some("6") => "two",
        _ => "three",
    }
}

/// The stages of every row, and its frame beside that of the first variant of its point.
pub fn table(rows: &[Row]) -> ResultTable {
    let mut cells = Vec::new();
    for row in rows {
        let variant = row.run.variant.as_str();
        let sum = |passes: &[&Pass], of: &dyn Fn(&Pass) -> Option<&Summary>| -> Value {
            let found: Vec<f64> = passes.iter().filter_map(|pass| of(pass)).map(|summary| summary.median).collect();
            if found.is_empty() { Value::Null } else { json!(found.iter().sum::<f64>()) }
        };
        let times = |passes: &[&Pass]| {
            [
                sum(passes, &|pass| pass.gpu_ms.as_ref()),
                sum(passes, &|pass| pass.host_ms.as_ref()),
                sum(passes, &|pass| pass.wait_ms.as_ref()),
            ]
        };
        for wanted in ["one", "two", "three"] {
            let passes: Vec<&Pass> = row.run.passes.iter().filter(|pass| stage(pass) == wanted).collect();
            let [gpu, host, wait] = times(&passes);
            cells.push(vec![
                json!(row.label),
                json!(variant),
                json!(wanted),
                gpu,
                host,
                wait,
                Value::Null,
                Value::Null,
            ]);
        }
        let [gpu, host, wait] = times(&row.run.passes.iter().collect::<Vec<_>>());
        let frame_ms = row.run.median_frame_ms();
        let first_ms = rows.iter().find(|first| first.label == row.label).and_then(|first| first.run.median_frame_ms());
        let ratio = first_ms.zip(frame_ms).map(|(first, own)| first / own);
        cells.push(vec![
            json!(row.label),
            json!(variant),
            json!("all"),
            gpu,
            host,
            wait,
            json!(frame_ms),
            json!(ratio),
        ]);
    }
    ResultTable {
        title: "Readbacks: where a frame's time goes with them and without",
        columns: &["drawing", "variant", "stage", "gpu ms", "host ms", "wait ms", "frame ms", "times faster"],
        rows: cells,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;
    use crate::report::record::PassKind;

    #[test]
    fn stages_follow_from_the_sections() {
        let of = |section: &str| {
            let section = (!section.is_empty()).then(|| section.to_owned());
            stage(&Pass { section, ..example::pass("pass", PassKind::Graphics) })
        };
        assert_eq!(["5.1", "5.2", "6.4", "7.2", ""].map(of), ["one", "one", "two", "three", "three"]);
        let drawings = |setup: &Setup| points(setup).into_iter().map(|point| point.label).collect::<Vec<_>>();
        let mut setup = Setup::default();
        assert_eq!(drawings(&setup), ["own", "splats", "march"]);
        setup.parameters.surface_draw = Some(SurfaceDraw::March);
        assert_eq!(drawings(&setup), ["march"]);
    }
}
