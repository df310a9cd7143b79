//! The smallest map and plane count that reaches a given error, by each method.

use serde_json::{Value, json};

use super::Row;
use crate::measure::result_table::ResultTable;

/// One row for each mesh of the first case, error and method that was tried in several sizes; empty cells where none of them
/// reaches it.
pub fn table(rows: &[Row], errors: &[u32]) -> ResultTable {
    let first = rows.first().map(|row| row.case);
    let tried: Vec<&Row> = rows.iter().filter(|row| Some(row.case) == first).collect();
    let mut methods: Vec<(&str, String)> = Vec::new();
    for row in &tried {
        let method = (row.mesh.as_str(), row.setting.name());
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    let mut found = Vec::new();
    for (mesh, method) in &methods {
        let of_method = tried.iter().filter(|row| row.mesh == *mesh && row.setting.name() == *method);
        for &error in errors {
            let reached = of_method.clone().filter(|row| 100.0 * row.verdict.rms_at_truth <= f64::from(error));
            let least = reached.min_by_key(|row| (row.setting.map_size, row.setting.plane_count));
            let cells = least.map_or([Value::Null, Value::Null, Value::Null], |row| {
                [json!(row.setting.map_size), row.setting.planes(), json!(row.frame_ms)]
            });
            found.push([json!(mesh), json!(method), json!(error)].into_iter().chain(cells).collect());
        }
    }
    ResultTable {
        title: "The smallest map, and with it the fewest planes, of those tried whose rms seen is no greater than so many percent",
        columns: &["mesh", "method", "percent", "map", "planes", "frame ms"],
        rows: found,
    }
}

#[cfg(test)]
mod tests {
    use super::super::judge::Verdict;
    use super::super::settings::Setting;
    use super::*;
    use crate::papers::caustics::{IntensityRule, Variant};

    fn row(variant: Variant, map_size: u32, plane_count: u32, rms_at_truth: f64) -> Row {
        let setting = Setting { variant, map_size, plane_count, coverage: 1, intensity: IntensityRule::Face };
        let verdict = Verdict { correlation: 1.0, rms: 0.0, greatest: 1.0, flux: 1.0, rms_at_truth, halves: 1.0 };
        Row { case: "as set", mesh: "sphere".to_owned(), setting, verdict, seen: [0.0; 2], photons: 100, frame_ms: 2.0 }
    }

    #[test]
    fn the_smaller_map_comes_before_the_fewer_planes() {
        let rows = [
            row(Variant::LevelMap, 64, 31, 0.18),
            row(Variant::LevelMap, 64, 11, 0.4),
            row(Variant::LevelMap, 128, 3, 0.15),
            row(Variant::Hit, 64, 0, 0.1),
        ];
        let found = table(&rows, &[20, 12]);
        let cells: Vec<_> = found.rows.iter().map(|row| (row[3].as_u64(), row[4].as_u64())).collect();
        let level_map = [(Some(64), Some(31)), (None, None)];
        assert_eq!(cells, [level_map, [(Some(64), None), (Some(64), None)]].concat());
    }
}
