//! Parameters that tell runs of one method apart, in the names that people read.

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};

use serde_json::Value;

use super::record::Run;

/// Of each run the parameters, the seed and the number of frames that tell it from others of its paper, variant and preset,
/// with a comma before each; empty for one without such others. In the order of the runs.
pub fn alternatives<'a>(runs: impl IntoIterator<Item = &'a Run>) -> Vec<String> {
    let runs: Vec<&Run> = runs.into_iter().collect();
    let mut methods: HashMap<_, Vec<&Run>> = HashMap::new();
    for run in &runs {
        methods.entry(method(run)).or_default().push(run);
    }
    let telling: HashMap<_, _> = methods.iter().map(|(method, others)| (*method, telling(others))).collect();
    runs.iter().map(|run| telling.get(&method(run)).map_or_else(String::new, |telling| told(run, telling))).collect()
}

fn method(run: &Run) -> (&str, &str, Option<&str>) {
    (&run.paper, &run.variant, run.preset.as_deref())
}

/// Fields beside the parameters that may tell runs apart like one.
const BESIDE: [&str; 2] = ["seed", "frames"];

fn names(run: &Run) -> impl Iterator<Item = &str> {
    let beside = BESIDE.into_iter().filter(|name| !run.config.contains_key(*name));
    run.config.keys().map(String::as_str).chain(beside)
}

fn parameter<'a>(run: &'a Run, name: &str) -> Option<Cow<'a, Value>> {
    match (run.config.get(name), name) {
        (Some(value), _) => Some(Cow::Borrowed(value)),
        (None, "seed") => Some(Cow::Owned(run.seed.into())),
        (None, "frames") => Some(Cow::Owned(run.frames.into())),
        (None, _) => None,
    }
}

/// Names of the parameters in which not all are alike: whoever differs from another does so in one of them.
fn telling<'a>(others: &[&'a Run]) -> BTreeSet<&'a str> {
    let Some((first, rest)) = others.split_first() else { return BTreeSet::new() };
    let differing = rest.iter().flat_map(|other| {
        names(first).chain(names(other)).filter(|name| parameter(first, name) != parameter(other, name))
    });
    differing.collect()
}

fn told(run: &Run, telling: &BTreeSet<&str>) -> String {
    let named = names(run).filter(|name| telling.contains(name));
    named.filter_map(|name| Some(format!(", {name} {}", text(&*parameter(run, name)?)?))).collect()
}

/// The most numbers of a list that a reader takes in at once, as extents are.
const FEW: usize = 4;

/// A plain value, names such as those of meshes, or a few numbers; longer lists tell a reader nothing.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Array(items) if items.is_empty() => None,
        Value::Array(items) if items.len() <= FEW && items.iter().all(Value::is_number) => {
            Some(items.iter().map(Value::to_string).collect::<Vec<_>>().join("x"))
        }
        Value::Array(items) => {
            let names: Option<Vec<&str>> = items.iter().map(Value::as_str).collect();
            names.map(|names| names.join(" "))
        }
        Value::Object(_) => None,
        plain => Some(plain.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::report::example;

    #[test]
    fn runs_of_one_method_are_told_apart_by_what_differs() {
        let run = |variant: &str, planes: u32, has_shadow: bool| {
            let mut run = example::full().runs.remove(0);
            run.variant = variant.to_owned();
            run.config.insert("planes".to_owned(), planes.into());
            run.config.insert("shadow".to_owned(), has_shadow.into());
            run.config.insert("curve".to_owned(), json!([planes, 0, 0, 0, 0]));
            run
        };
        let mut runs =
            vec![run("slices", 7, true), run("slices", 11, true), run("march", 31, false), run("slices", 7, true)];
        runs[1].config.insert("layers".to_owned(), 3.into());
        runs[0].config.insert("mesh".to_owned(), json!(["teapot", "sphere"]));
        runs[3].config.insert("splats".to_owned(), json!([16, 8, 4]));
        let found = alternatives(&runs);
        assert_eq!(found, [", planes 7, mesh teapot sphere", ", planes 11, layers 3", "", ", planes 7, splats 16x8x4"]);

        // What no parameter tells.
        let mut runs = [run("slices", 7, true), run("slices", 7, true), run("march", 7, true)];
        (runs[0].seed, runs[1].seed) = (5, 6);
        assert_eq!(alternatives(&runs), [", seed 5", ", seed 6", ""]);
        (runs[1].seed, runs[0].frames, runs[1].frames) = (5, 2, 3);
        assert_eq!(alternatives(&runs), [", frames 2", ", frames 3", ""]);
    }
}
