//! The table of a paper's options, as its page shows it.

use super::{help, spelling};
use crate::measure::parameter::Parameter;
use crate::measure::study::Study;

/// Rows of option, default and meaning, in Markdown: presets, and every parameter in the order of its declaration.
pub fn options_table<S: Study>() -> String {
    let mut table = "| option | default | meaning |\n| --- | --- | --- |\n".to_owned();
    let presets = S::presets();
    if !presets.is_empty() {
        let names: Vec<String> = presets.iter().map(|preset| format!("`{}`: {}", preset.name, preset.help)).collect();
        table += &row("--preset NAME", "", &format!("take the numbers of a figure or table. {}", names.join("; ")));
    }
    let default = S::default();
    for parameter in S::parameters() {
        table += &parameter_row(&parameter, &default);
    }
    table
}

/// Rows of axis, first value, end and meaning, in Markdown, the default axis first.
pub fn axes_table<S: Study>() -> String {
    let mut table = "| axis | from | to | what grows | throughput in |\n| --- | ---: | ---: | --- | --- |\n".to_owned();
    for axis in S::axes() {
        let most = if axis.most == u64::MAX { String::new() } else { axis.most.to_string() };
        let (name, start, help, unit) = (axis.name, axis.start, axis.help, axis.amount_unit());
        table += &format!("| `{name}` | {start} | {most} | {help} | {unit} a second |\n");
    }
    table
}

fn parameter_row<S: 'static>(parameter: &Parameter<S>, default: &S) -> String {
    let shape = parameter.shape();
    let is_opposite = shape.is_flag && parameter.text(default) == "on";
    let (option, value) = if shape.is_flag {
        let prefix = if is_opposite { "no-" } else { "" };
        (format!("--{prefix}{}", parameter.name), "off".to_owned())
    } else {
        (format!("--{} {}", parameter.name, parameter.placeholder), parameter.default_of(default))
    };
    let meaning = spelling::every(parameter.help);
    let mut meaning = if is_opposite { help::switched_off(&meaning) } else { meaning };
    if !shape.choices.is_empty() {
        let choices: Vec<String> = shape.choices.iter().map(|(name, help)| format!("`{name}`: {help}")).collect();
        meaning += &format!(". {}", choices.join("; "));
    }
    for addition in [parameter.bounds(), parameter.section.to_owned()] {
        if !addition.is_empty() {
            meaning += &format!("; {addition}");
        }
    }
    if shape.is_list && !shape.joins {
        meaning += "; repeatable";
    }
    row(&option, &value, &meaning)
}

fn row(option: &str, default: &str, meaning: &str) -> String {
    let cell = |text: &str| text.replace('|', "\\|");
    format!("| `{}` | {} | {} |\n", cell(option), cell(default), cell(meaning))
}
