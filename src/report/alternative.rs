//! What tells runs of one method apart, in the names that people read.

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
    let differs = |name: &str| others.iter().any(|other| other.config().get(name) != one.config().get(name));
    let telling = one.config().iter().filter(|(name, value)| !value.is_array() && !value.is_object() && differs(name));
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    telling.map(|(name, value)| format!(", {name} {}", text(value))).collect()
}
