//! What tells runs of one method apart, in the names that people read.

use std::collections::{BTreeSet, HashMap};

use serde_json::{Map, Value};

use super::record::Run;

/// What has a name: its method's, with parameters where several have one method.
pub trait Named {
    /// Paper, variant and preset.
    fn method(&self) -> (&str, &str, Option<&str>);

    /// Every parameter under its option's name.
    fn config(&self) -> &Map<String, Value>;
}

impl Named for Run {
    fn method(&self) -> (&str, &str, Option<&str>) {
        (&self.paper, &self.variant, self.preset.as_deref())
    }

    fn config(&self) -> &Map<String, Value> {
        &self.config
    }
}

/// The parameters that tell one from others of its variant and preset, with a comma before each; empty for one without
/// such others.
pub fn alternative<'a, T: Named + 'a>(one: &T, all: impl IntoIterator<Item = &'a T>) -> String {
    let others: Vec<&T> = all.into_iter().filter(|other| other.method() == one.method()).collect();
    told(one, &telling(&others))
}

/// [`alternative`] of each among all, in their order.
pub fn alternatives<T: Named>(all: &[T]) -> Vec<String> {
    let mut methods: HashMap<_, Vec<&T>> = HashMap::new();
    for one in all {
        methods.entry(one.method()).or_default().push(one);
    }
    let telling: HashMap<_, _> = methods.iter().map(|(method, others)| (*method, telling(others))).collect();
    all.iter().map(|one| telling.get(&one.method()).map_or_else(String::new, |telling| told(one, telling))).collect()
}

/// Names of the parameters in which not all are alike: whoever differs from another does so in one of them.
fn telling<'a, T: Named>(others: &[&'a T]) -> BTreeSet<&'a str> {
    let Some((first, rest)) = others.split_first() else { return BTreeSet::new() };
    let differing = rest.iter().flat_map(|other| {
        let names = first.config().keys().chain(other.config().keys());
        names.filter(move |name| first.config().get(*name) != other.config().get(*name))
    });
    differing.map(String::as_str).collect()
}

fn told<T: Named>(one: &T, telling: &BTreeSet<&str>) -> String {
    let named = one.config().iter().filter(|(name, _)| telling.contains(name.as_str()));
    named.filter_map(|(name, value)| Some(format!(", {name} {}", text(value)?))).collect()
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
        runs[1].config.insert("seed".to_owned(), 3.into());
        runs[0].config.insert("mesh".to_owned(), json!(["teapot", "sphere"]));
        runs[3].config.insert("splats".to_owned(), json!([16, 8, 4]));
        let found = alternatives(&runs);
        assert_eq!(found, [", planes 7, mesh teapot sphere", ", planes 11, seed 3", "", ", planes 7, splats 16x8x4"]);
        for (run, found) in runs.iter().zip(found) {
            assert_eq!(alternative(run, &runs), found);
        }
    }
}
