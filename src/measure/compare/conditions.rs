//! Conditions beside the work that may change a time: environment, program, shaders, and the pictures that were drawn.

use std::collections::{BTreeMap, BTreeSet};

use super::Input;
use super::matching::{Configuration, Difference};
use crate::report::record::{Environment, Record, Run};

/// All that differs between the sides beside their times: environment and program of every record, and of the configurations
/// that are compared the shaders of the passes that both have, and pictures that both have drawn.
pub(super) fn differences_between(
    a: &[Input],
    b: &[Input],
    pairs: &[(Configuration, Configuration)],
) -> Vec<Difference> {
    let of = |side: &[Input]| Values::of(side.iter().flat_map(|input| of_record(&input.record)));
    let mut differences = of(a).differences(&of(b));
    differences.extend(pairs.iter().flat_map(|(a, b)| of_drawing(a, b)));
    differences.sort_by(|x, y| x.what.cmp(&y.what));
    differences
}

/// The values of each condition on one side: the same runs in another order have the same.
struct Values(BTreeMap<String, BTreeSet<String>>);

impl Values {
    fn of(conditions: impl IntoIterator<Item = (String, String)>) -> Self {
        let mut values: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (what, value) in conditions {
            values.entry(what).or_default().insert(value);
        }
        Values(values)
    }

    fn differences(&self, other: &Values) -> Vec<Difference> {
        let names: BTreeSet<&String> = self.0.keys().chain(other.0.keys()).collect();
        let values = |side: &Values, name: &String| side.0.get(name).into_iter().flatten().cloned().collect();
        let differing = names.into_iter().filter(|name| self.0.get(*name) != other.0.get(*name));
        differing.map(|name| Difference { what: name.clone(), a: values(self, name), b: values(other, name) }).collect()
    }
}

/// Differences of a pair in what it is drawn with, and in what it has drawn, by the name that A has.
fn of_drawing(a: &Configuration, b: &Configuration) -> Vec<Difference> {
    let name = format!("{} {}{}", a.first().paper, a.first().variant, a.alternative);
    let has_pass =
        |side: &Configuration, name: &str| side.runs().any(|run| run.passes.iter().any(|pass| pass.name == name));
    let has_picture = |side: &Configuration| side.runs().any(|run| run.image.is_some());
    let conditions = |side: &Configuration| {
        let pictures = side.runs().filter_map(|run| run.image.as_ref()).filter(|_| has_picture(a) && has_picture(b));
        let pictures = pictures.map(|image| (format!("picture of {name}"), image.sha256.clone()));
        let of_passes = side.runs().flat_map(|run: &Run| &run.passes);
        let of_passes = of_passes.filter(|pass| has_pass(a, &pass.name) && has_pass(b, &pass.name)).flat_map(|pass| {
            let place = format!("{name} {}", pass.name);
            let compiler = pass.shader_compiler.iter();
            let compiler = compiler.map(|compiler| (format!("shader_compiler of {place}"), compiler.clone()));
            let shaders = pass.shaders.iter();
            let shaders = shaders.map(|shader| (format!("SPIR-V of {place}: {}", shader.name), shader.sha256.clone()));
            compiler.chain(shaders).collect::<Vec<_>>()
        });
        Values::of(pictures.chain(of_passes))
    };
    conditions(a).differences(&conditions(b))
}

/// The properties of device, host and build that a time may depend on, by their paths in the record.
fn conditions(environment: &Environment) -> Vec<(String, String)> {
    let (device, host, build) = (&environment.device, &environment.host, &environment.build);
    let some = |value: &Option<String>| value.clone().unwrap_or_else(|| "unknown".to_owned());
    let number = |value: Option<u32>| value.map_or_else(|| "unset".to_owned(), |value| value.to_string());
    let mut conditions: Vec<(String, String)> = [
        ("device.name", device.name.clone()),
        ("device.type", device.kind.as_str().to_owned()),
        ("device.driver_version", some(&device.driver_version)),
        ("host.os", host.os.clone()),
        ("host.cpu", some(&host.cpu)),
        ("host.cpu_governor", some(&host.cpu_governor)),
        ("host.logical_cores", number(host.logical_cores)),
        ("host.lp_num_threads", number(host.lp_num_threads)),
        ("layers", environment.layers.join(", ")),
        ("build.git_commit", some(&build.git_commit)),
        ("build.profile", some(&build.profile)),
        ("build.executable_sha256", some(&build.executable_sha256)),
    ]
    .into_iter()
    .map(|(name, value)| (name.to_owned(), value))
    .collect();
    // The thread count stands above.
    let variables =
        host.variables.iter().filter(|(name, _)| *name != "LP_NUM_THREADS" || host.lp_num_threads.is_none());
    conditions.extend(variables.map(|(name, value)| (format!("host.variables.{name}"), value.clone())));
    conditions
}

/// The first of [`conditions`] in which two machines differ, with the values of both.
pub fn difference_of_machines(a: &Environment, b: &Environment) -> Option<[String; 3]> {
    let [a, b] = [a, b].map(|environment| conditions(environment).into_iter().collect::<BTreeMap<_, _>>());
    let what = a.keys().chain(b.keys()).find(|what| a.get(*what) != b.get(*what))?;
    let value = |of: &BTreeMap<String, String>| of.get(what).cloned().unwrap_or_else(|| "unset".to_owned());
    Some([what.clone(), value(&a), value(&b)])
}

/// The same of a record, with what keeps no parts of one measurement apart but may be what a difference comes from.
fn of_record(record: &Record) -> Vec<(String, String)> {
    let mut conditions = conditions(&record.environment);
    let (device, host, build) = (&record.environment.device, &record.environment.host, &record.environment.build);
    let some = |value: &Option<String>| value.clone().unwrap_or_else(|| "unknown".to_owned());
    let others = [
        ("device.driver", some(&device.driver)),
        ("device.uuid", some(&device.uuid)),
        ("device.api_version", device.api_version.clone()),
        ("host.kernel", some(&host.kernel)),
        ("loader", some(&record.environment.loader)),
        ("build.rustc", some(&build.rustc)),
    ];
    conditions.extend(others.map(|(name, value)| (name.to_owned(), value)));
    conditions
}
