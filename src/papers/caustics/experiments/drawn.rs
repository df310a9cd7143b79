//! Sections 6.1 and 6.3: the triangles that each method draws for its caustics maps, and the time of the maps.

use serde_json::{Value, json};

use crate::measure::Variant as _;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::median;
use crate::papers::caustics::Variant;
use crate::report::record::{Pass, Run};

/// Passes before the caustics maps and after them, which all methods share.
const SHARED: [&str; 6] =
    ["position-diffuse-map", "position-map", "diffuse-map", "water-surface", "illumination-volumes", "combine"];
const LAST: &str = "cast";

/// One method at one count of planes.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawn {
    mesh: String,
    planes: u32,
    method: String,
    /// Of the level map and its culling pairs of water triangle and plane, of `hit` triangles of the refined water.
    triangles: Option<u64>,
    /// None for `hit`, which adds its light up in compute passes.
    fragments: Option<u64>,
    /// GPU time of all passes between the rays and the combination.
    maps_ms: Option<f64>,
}

impl Drawn {
    pub fn of(mesh: &str, planes: u32, run: &Run) -> Self {
        let caustics_map = run.passes.iter().find(|pass| pass.name == "caustics-map");
        let counts = caustics_map.and_then(|pass| pass.statistics.as_ref());
        let is_hit = run.variant == Variant::Hit.as_str();
        let refined = run.results.get("refined_triangles").and_then(Value::as_u64);
        let is_of_maps = |pass: &&Pass| !SHARED.contains(&pass.name.as_str()) && pass.name != LAST;
        let gpu_ms = |pass: &Pass| pass.gpu_ms.as_ref().and_then(|times| median(&times.samples));
        let maps_ms: f64 = run.passes.iter().filter(is_of_maps).filter_map(gpu_ms).sum();
        Drawn {
            mesh: mesh.to_owned(),
            planes,
            method: run.variant.clone(),
            triangles: if is_hit { refined } else { counts.and_then(|counts| counts.primitives) },
            fragments: if is_hit { None } else { counts.and_then(|counts| counts.fragments) },
            maps_ms: Some(maps_ms).filter(|&ms| ms > 0.0),
        }
    }
}

/// A table of what was drawn.
pub fn table(all: &[Drawn]) -> ResultTable {
    let cells = |drawn: &Drawn| {
        let Drawn { mesh, planes, method, triangles, fragments, maps_ms } = drawn;
        vec![json!(mesh), json!(planes), json!(method), json!(triangles), json!(fragments), json!(maps_ms)]
    };
    ResultTable {
        title: "Triangles: pairs of water triangle and plane; of hit, triangles of the refined water, wherever they land. Maps: all \
                passes but those that every method has",
        columns: &["mesh", "planes", "method", "triangles", "fragments", "maps ms"],
        rows: all.iter().map(cells).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::config::entries;
    use crate::measure::statistics::summarize;
    use crate::report::example;
    use crate::report::record::{PassKind, Statistics};

    fn timed(name: &str, ms: f64) -> Pass {
        Pass { gpu_ms: summarize(&[ms]), ..example::pass(name, PassKind::Compute) }
    }

    #[test]
    fn maps_are_all_that_lies_between_rays_and_combination() {
        let statistics = Some(Statistics { primitives: Some(70), fragments: Some(900), ..Statistics::default() });
        let caustics_map = Pass { statistics, ..timed("caustics-map", 4.0) };
        let passes = vec![timed("water-surface", 100.0), timed("cull", 3.0), caustics_map, timed("combine", 100.0)];
        let culled = Run { variant: "culled".to_owned(), passes, ..example::run() };
        let drawn = Drawn::of("sphere", 31, &culled);
        assert_eq!((drawn.triangles, drawn.fragments, drawn.maps_ms), (Some(70), Some(900), Some(7.0)));
        let hit = Run { variant: "hit".to_owned(), results: entries([("refined_triangles", json!(80))]), ..culled };
        let hit = Drawn::of("sphere", 31, &hit);
        assert_eq!((hit.triangles, hit.fragments), (Some(80), None));
        let cells = |drawn: &Drawn| table(std::slice::from_ref(drawn)).rows.remove(0)[2..].to_vec();
        assert_eq!(cells(&drawn), [json!("culled"), json!(70), json!(900), json!(7.0)]);
        assert_eq!(cells(&hit), [json!("hit"), json!(80), Value::Null, json!(7.0)]);
    }
}
