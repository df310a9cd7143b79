//! Help: a dozen everyday options at first, and all of them by group.

use clap::{Arg, ArgAction, Command};

/// Options of a verb that its first help lists beside the paper's own. With those that a paper declares to be everyday, six
/// at most, they are a dozen.
pub fn everyday(verb: &str) -> &'static [&'static str] {
    match verb {
        "passes" => &["variant", "preset", "device", "json"],
        "bench" => &["variant", "preset", "device", "frames", "json", "image"],
        "experiment" => &["list", "preset", "device", "frames", "json"],
        "render" => &["variant", "preset", "frame", "dump", "device", "image"],
        "stress" => &["variant", "preset", "axis", "list", "budget", "device"],
        "view" => &["variant", "preset", "frame", "fullscreen", "scale", "device"],
        // A verb that one paper alone has.
        _ => &["json"],
    }
}

/// Everyday options of the program's own verbs that have more than a dozen.
pub const OF_PROGRAM: [(&str, &[&str]); 3] = [
    ("ab", &["a", "b", "env", "binary", "budget", "blocks", "out", "margin", "fail_above", "markdown", "json"]),
    ("all", &["device", "shader_dir", "validate", "out", "json", "csv", "trace", "report", "quiet"]),
    ("stress", &["shard", "factor", "budget", "until", "device", "out", "markdown", "quiet"]),
];

/// The command whose `--help` lists what is `everyday` alone, and whose `--help-all` lists every option.
pub fn shortened(command: Command, everyday: &[&str]) -> Command {
    let options = command.get_arguments().filter(|arg| !arg.is_positional());
    let all = options.filter(|arg| !arg.is_hide_set()).count();
    let is_listed = |arg: &Arg| {
        let name = arg.get_id().as_str();
        arg.is_positional() || everyday.contains(&name.strip_prefix("no-").unwrap_or(name))
    };
    let help = |name: &'static str, action, text: &'static str| {
        Arg::new(name).long(name).action(action).hide_short_help(true).help(text)
    };
    command
        .disable_help_flag(true)
        .mut_args(|arg| if is_listed(&arg) { arg } else { arg.hide_short_help(true) })
        .arg(help("help", ArgAction::HelpShort, "Print help on everyday options").short('h'))
        .arg(help("help-all", ArgAction::HelpLong, "Print help on every option"))
        .after_help(format!("All {all} options, by group: --help-all"))
        .after_long_help("")
}
