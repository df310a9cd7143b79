//! The command line of what is seen.

use super::choice::{Choice, Resolved};
use crate::measure::Variant;
use crate::measure::machine::MachineOptions;
use crate::measure::study::{Preset, Study};
use crate::window::protocol::Verb;

/// Arguments behind the program's name: the paper, the verb, and what differs from the defaults or the preset, which
/// are those of the first side. A second side of the same set-up is a second variant of a bench.
pub fn line<S: Study>(
    verb: Verb,
    frame: u32,
    choice: &Choice,
    sides: &[Resolved<S>],
    machine: &MachineOptions,
) -> Vec<String> {
    let Some(side) = sides.first() else { return Vec::new() };
    let name = match verb {
        Verb::Bench => "bench",
        Verb::Render => "render",
    };
    let mut line = vec![S::PAPER.to_owned(), name.to_owned()];
    line.extend(side.preset.iter().map(|preset| option("preset", preset)));
    let is_alike = |other: &&Resolved<S>| other.preset == side.preset && other.compiler == side.compiler;
    let shown = if verb == Verb::Bench { sides.len() } else { 1 };
    let mut variants: Vec<&str> = sides[..shown].iter().filter(is_alike).map(|side| side.variant.as_str()).collect();
    variants.dedup();
    line.push(option("variant", &variants.join(",")));
    line.extend(parameters(choice, side));
    if side.compiler != crate::gpu::Compiler::default() {
        line.push(option("shader-compiler", &side.compiler.to_string()));
    }
    line.extend(machine.shader_dir.iter().map(|folder| option("shader-dir", &folder.display().to_string())));
    line.extend(machine.device.iter().map(|device| option("device", device)));
    line.extend(machine.validate.then(|| "--validate".to_owned()));
    if verb == Verb::Render && frame > 0 {
        line.push(option("frame", &frame.to_string()));
    }
    line
}

/// A value that begins with a minus is none of its own.
fn option(name: &str, value: &str) -> String {
    format!("--{name}={value}")
}

/// The options of what was set by hand and changes something, and of what they must stand beside.
fn parameters<S: Study>(choice: &Choice, side: &Resolved<S>) -> Vec<String> {
    let preset = side.preset.as_ref().and_then(|name| S::presets().into_iter().find(|preset| preset.name == name));
    let base = preset.as_ref().map_or_else(S::default, Preset::setup);
    let parameters = S::parameters();
    let typed = |name: &str| choice.typed.iter().find(|typed| typed.name == name);
    let is_required =
        |name: &str| parameters.iter().any(|other| other.requires == Some(name) && typed(other.name).is_some());
    let mut line = Vec::new();
    for parameter in &parameters {
        let name = parameter.name;
        let text = parameter.text(&side.study);
        match typed(name) {
            Some(_) if parameter.shape().is_flag && text == parameter.text(&base) => {}
            Some(typed) if parameter.shape().is_flag => {
                let is_on = typed.values.iter().any(|value| value == "true");
                line.push(if is_on { format!("--{name}") } else { format!("--no-{name}") });
            }
            Some(typed) if text != parameter.text(&base) || is_required(name) => {
                let values: Vec<_> = typed.values.iter().map(|value| value.to_string_lossy()).collect();
                match parameter.shape().joins {
                    true => line.push(option(name, &values.join(","))),
                    false => line.extend(values.iter().map(|value| option(name, value))),
                }
            }
            None if is_required(name) && !text.is_empty() => line.push(option(name, &text)),
            _ => {}
        }
    }
    line
}
