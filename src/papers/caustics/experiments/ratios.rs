//! Ratios of the methods at one count of planes, with their intervals: level map against volumetric by time and memory,
//! and smart slicing against slicing normally by the fraction of planes that it draws.

use serde_json::{Map, Value, json};

use crate::measure::Variant as _;
use crate::measure::compare::{Ratio, ratio_within_process};
use crate::measure::config::entries;
use crate::measure::experiment::NamedTable;
use crate::measure::result_table::ResultTable;
use crate::measure::statistics::median;
use crate::papers::caustics::Variant;
use crate::report::record::{Pass, Run};

/// Level map against volumetric at one count of planes.
struct AgainstVolumetric {
    time: Ratio,
    has_less_memory: Option<bool>,
}

/// Smart slicing against slicing normally at one count of planes.
struct AgainstNormal {
    /// Planes drawn of those that slicing normally draws.
    fraction: f64,
    /// GPU time of the caustics maps, which depends on the planes alone.
    caustics_map: Option<Ratio>,
    /// Frame less profiling and readback over the normal frame.
    cost: Option<Ratio>,
}

/// The ratios of one mesh at one count of planes, as far as the methods were measured that they compare.
pub struct Ratios {
    mesh: String,
    planes: u32,
    against_volumetric: Option<AgainstVolumetric>,
    against_normal: Option<AgainstNormal>,
}

impl Ratios {
    /// Those of interleaved runs of one configuration, noted in their results.
    pub fn of(mesh: &str, planes: u32, runs: &mut [Run]) -> Self {
        let [level, smart, volumetric] = [Variant::LevelMap, Variant::LevelMapSmart, Variant::Volumetric]
            .map(|variant| runs.iter().position(|run| run.variant == variant.as_str()));
        let pair = |base: Option<usize>, over: Option<usize>| Some((&runs[base?], &runs[over?]));
        let against_volumetric = pair(level, volumetric).and_then(|(level, other)| against_volumetric(level, other));
        let against_normal = pair(level, smart).and_then(|(level, smart)| against_normal(level, smart));
        if let (Some(ratios), Some(at)) = (&against_volumetric, volumetric) {
            runs[at].results.extend(ratios.results());
        }
        if let (Some(ratios), Some(at)) = (&against_normal, smart) {
            runs[at].results.extend(ratios.results());
        }
        Ratios { mesh: mesh.to_owned(), planes, against_volumetric, against_normal }
    }
}

fn pass<'a>(run: &'a Run, name: &str) -> Option<&'a Pass> {
    run.passes.iter().find(|pass| pass.name == name)
}

fn against_volumetric(level: &Run, volumetric: &Run) -> Option<AgainstVolumetric> {
    let time = ratio_within_process(volumetric.frame_samples(), level.frame_samples())?;
    let bytes = level.memory.device_bytes.zip(volumetric.memory.device_bytes);
    let has_less_memory = bytes.map(|(level, volumetric)| level < volumetric);
    Some(AgainstVolumetric { time, has_less_memory })
}

fn against_normal(level: &Run, smart: &Run) -> Option<AgainstNormal> {
    let drawn = |run: &Run| run.results.get("planes_drawn").and_then(Value::as_f64).filter(|&planes| planes > 0.0);
    let fraction = drawn(smart)? / drawn(level)?;
    fn gpu_ms(run: &Run) -> Option<&[f64]> {
        Some(&pass(run, "caustics-map")?.gpu_ms.as_ref()?.samples)
    }
    let caustics_map = gpu_ms(smart).zip(gpu_ms(level)).and_then(|(smart, level)| ratio_within_process(level, smart));
    let cost = without_profiling(smart).and_then(|smart| ratio_within_process(level.frame_samples(), &smart));
    Some(AgainstNormal { fraction, caustics_map, cost })
}

/// Frame times of smart slicing without what it does beyond slicing normally: the profile, and the wait for the position
/// map. That wait contains the drawing of the maps, which slicing normally does too: their GPU time stays.
fn without_profiling(smart: &Run) -> Option<Vec<f64>> {
    let profile = &pass(smart, "depth-profile")?.host_ms.as_ref()?.samples;
    let wait = &pass(smart, "read-positions")?.wait_ms.as_ref()?.samples;
    let maps = ["position-diffuse-map", "position-map", "diffuse-map"].into_iter().filter_map(|name| pass(smart, name));
    let maps_ms: f64 = maps.map(|map| median(&map.gpu_ms.as_ref()?.samples)).sum::<Option<f64>>()?;
    let frames = smart.frame_samples();
    if frames.len() != profile.len() || frames.len() != wait.len() {
        return None;
    }
    Some(
        frames.iter().zip(profile).zip(wait).map(|((frame, profile), wait)| frame - profile - wait + maps_ms).collect(),
    )
}

impl AgainstVolumetric {
    fn results(&self) -> Map<String, Value> {
        entries([
            ("level_map_over_volumetric", json!(self.time.ratio)),
            ("level_map_over_volumetric_interval", json!(self.time.interval)),
            ("level_map_has_less_memory", json!(self.has_less_memory)),
        ])
    }
}

impl AgainstNormal {
    fn results(&self) -> Map<String, Value> {
        entries([
            ("planes_share", json!(self.fraction)),
            ("caustics_map_over_normal", json!(self.caustics_map.map(|m| m.ratio))),
            ("caustics_map_over_normal_interval", json!(self.caustics_map.and_then(|m| m.interval))),
            ("cost_over_normal", json!(self.cost.map(|m| m.ratio))),
            ("cost_over_normal_interval", json!(self.cost.and_then(|m| m.interval))),
            ("cost_over_share", json!(self.cost.map(|m| m.ratio / self.fraction))),
        ])
    }
}

/// The ratios of a sweep as tables, each with its name; none where it compares neither.
pub fn tables(all: &[Ratios]) -> Vec<NamedTable> {
    let against_volumetric = ResultTable {
        title: "Level map against volumetric: time of a frame, above 1 where the level map is the faster one, with the ends of \
                its 95 % interval; memory",
        columns: &["mesh", "planes", "volumetric / level-map", "from", "to", "level-map has less memory"],
        rows: all.iter().filter_map(Ratios::volumetric_row).collect(),
    };
    let against_normal = ResultTable {
        title: "Smart slicing over slicing normally, with the ends of 95 % intervals. caustics-map: GPU time of that pass. cost: \
                frame less depth-profile and the wait for the position map, but for the maps' own GPU time",
        columns: &[
            "mesh",
            "planes",
            "share drawn",
            "caustics-map",
            "caustics-map from",
            "caustics-map to",
            "cost",
            "cost from",
            "cost to",
            "cost / share",
        ],
        rows: all.iter().filter_map(Ratios::normal_row).collect(),
    };
    let tables = [("against-volumetric", against_volumetric), ("against-normal", against_normal)];
    tables.into_iter().filter(|(_, table)| !table.rows.is_empty()).collect()
}

impl Ratios {
    fn volumetric_row(&self) -> Option<Vec<Value>> {
        let row = self.against_volumetric.as_ref()?;
        // As in the table of frames: over the level map.
        let ends = row.time.interval.map(|[low, high]| [1.0 / high, 1.0 / low]);
        Some(vec![
            json!(self.mesh),
            json!(self.planes),
            json!(1.0 / row.time.ratio),
            json!(ends.map(|[low, _]| low)),
            json!(ends.map(|[_, high]| high)),
            json!(row.has_less_memory.map(|less| if less { "yes" } else { "no" })),
        ])
    }

    fn normal_row(&self) -> Option<Vec<Value>> {
        let row = self.against_normal.as_ref()?;
        let with_ends = |ratio: Option<Ratio>| {
            let ends = ratio.and_then(|ratio| ratio.interval);
            [json!(ratio.map(|r| r.ratio)), json!(ends.map(|[low, _]| low)), json!(ends.map(|[_, high]| high))]
        };
        let mut cells = vec![json!(self.mesh), json!(self.planes), json!(row.fraction)];
        cells.extend(with_ends(row.caustics_map));
        cells.extend(with_ends(row.cost));
        cells.push(json!(row.cost.map(|cost| cost.ratio / row.fraction)));
        Some(cells)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::statistics::summarize;
    use crate::report::example;
    use crate::report::record::PassKind;
    use crate::report::table::Style;

    fn render(all: &[Ratios]) -> String {
        tables(all).iter().map(|(_, table)| table.render(Style::default())).collect()
    }

    /// Frames that differ by 1 %.
    fn frames(median_ms: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| median_ms * (0.99 + 0.02 * i as f64 / (count - 1) as f64)).collect()
    }

    fn run(variant: Variant, frame_ms: &[f64], planes: u32, device_bytes: u64) -> Run {
        let mut run = Run { variant: variant.as_str().to_owned(), frame_ms: summarize(frame_ms), ..example::run() };
        run.results = entries([("planes_drawn", json!(planes))]);
        run.memory.device_bytes = Some(device_bytes);
        run
    }

    #[test]
    fn the_level_map_is_set_against_the_volumetric_method() {
        let of = |level_ms: f64, count: usize, bytes: u64| {
            let mut runs = [
                run(Variant::LevelMap, &frames(level_ms, count), 11, bytes),
                run(Variant::Volumetric, &frames(10.0, count), 11, 100),
            ];
            let ratios = Ratios::of("sphere", 11, &mut runs);
            let text = render(&[ratios]);
            assert!(text.contains(&format!("{:.3}", 10.0 / level_ms)), "{text}");
            runs[1].results.clone()
        };
        let results = of(9.0, 9, 50);
        assert!((results["level_map_over_volumetric"].as_f64().unwrap() - 0.9).abs() < 1e-9);
        assert!(results["level_map_over_volumetric_interval"].is_array());
        assert_eq!(results["level_map_has_less_memory"], true);
        assert_eq!(of(9.0, 9, 100)["level_map_has_less_memory"], false);
        assert_eq!(of(9.0, 3, 50)["level_map_over_volumetric_interval"], Value::Null);
    }

    fn timed(name: &str, time: impl Fn(&mut Pass)) -> Pass {
        let mut pass = example::pass(name, PassKind::Host);
        time(&mut pass);
        pass
    }

    /// 10 of 20 planes: 10 ms of a frame of 20 ms are the planes', 2 ms the maps'.
    fn sliced(smart_frame_ms: f64) -> [Run; 2] {
        let mut level = run(Variant::LevelMap, &frames(20.0, 9), 20, 100);
        level.passes.push(timed("caustics-map", |p| p.gpu_ms = summarize(&frames(10.0, 9))));
        let mut smart = run(Variant::LevelMapSmart, &frames(smart_frame_ms, 9), 10, 100);
        smart.passes = vec![
            timed("position-diffuse-map", |p| p.gpu_ms = summarize(&[2.0; 9])),
            timed("read-positions", |p| p.wait_ms = summarize(&[5.0; 9])),
            timed("depth-profile", |p| p.host_ms = summarize(&[1.0; 9])),
            timed("caustics-map", |p| p.gpu_ms = summarize(&frames(6.0, 9))),
        ];
        [smart, level]
    }

    #[test]
    fn smart_slicing_costs_its_share_without_what_profiling_takes() {
        // Less 1 ms of profile and 5 ms of waiting, of which 2 ms draw the maps.
        let mut runs = sliced(14.0);
        let all = [Ratios::of("sphere", 20, &mut runs)];
        let results = &runs[0].results;
        let of = |name: &str| results[name].as_f64().unwrap();
        assert_eq!(of("planes_share"), 0.5);
        assert!((of("caustics_map_over_normal") - 0.6).abs() < 1e-9);
        assert!((of("cost_over_normal") - 0.5).abs() < 1e-9);
        assert!((of("cost_over_share") - 1.0).abs() < 1e-9);
        let text = render(&all);
        assert!(text.contains("0.500") && text.contains("1.000"), "{text}");
    }

    #[test]
    fn what_was_not_timed_is_absent() {
        let mut runs = sliced(14.0);
        runs[0].passes.retain(|pass| pass.name != "depth-profile");
        let all = [Ratios::of("sphere", 20, &mut runs)];
        assert_eq!(runs[0].results["cost_over_normal"], Value::Null);
        assert_eq!(runs[0].results["cost_over_normal_interval"], Value::Null);
        assert!(render(&all).contains("0.500"));
    }
}
