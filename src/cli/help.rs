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

/// The command whose `--help` lists every option, and whose `--help-all` is the same.
pub fn whole(command: Command) -> Command {
    let help = Arg::new("help").short('h').long("help").alias("help-all").action(ArgAction::Help);
    command.disable_help_flag(true).arg(help.help("Print help").help_heading(None))
}

/// Help of the option that switches off what the help of its opposite tells of. Where that names what is there else, after an
/// "or", it is told as what the option sets.
pub fn switched_off(help: &str) -> String {
    let mut characters = help.chars();
    let first = characters.next().into_iter();
    // Not of a name in capitals.
    let is_word = characters.clone().next().is_none_or(|second| !second.is_uppercase());
    let first: String = if is_word { first.flat_map(char::to_lowercase).collect() } else { first.collect() };
    format!("Switch off: {first}{}", characters.as_str().replacen(", or ", "; instead ", 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposites_tell_of_what_they_switch_off() {
        assert_eq!(switched_off("Draw the ground"), "Switch off: draw the ground");
        assert_eq!(switched_off("solid: let ash leave"), "Switch off: solid: let ash leave");
        assert_eq!(switched_off("SPH in place of it"), "Switch off: SPH in place of it");
        assert_eq!(switched_off("A part"), "Switch off: a part");
        assert_eq!(switched_off(""), "Switch off: ");
        assert_eq!(
            switched_off("Let it fall, or leave it there (3.5)"),
            "Switch off: let it fall; instead leave it there (3.5)"
        );
    }
}
