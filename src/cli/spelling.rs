//! Names of parameters in messages, spelled as options: papers write `` `planes` ``, users read `--planes`.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use clap::Command;

static OPTIONS: OnceLock<BTreeSet<String>> = OnceLock::new();

/// Learns the options of a command and of all below it; of several commands the first.
pub fn learn(command: &Command) {
    fn collect(command: &Command, names: &mut BTreeSet<String>) {
        names.extend(command.get_arguments().filter_map(|arg| arg.get_long()).map(str::to_owned));
        command.get_subcommands().for_each(|below| collect(below, names));
    }
    OPTIONS.get_or_init(|| {
        let mut names = BTreeSet::new();
        collect(command, &mut names);
        names
    });
}

/// The message with its options spelled; other names, as those of verbs, keep their backticks.
pub fn options(message: &str) -> String {
    spelled(message, |name| OPTIONS.get().is_some_and(|options| options.contains(name)))
}

/// The text with every name in backticks spelled as an option.
pub fn every(text: &str) -> String {
    spelled(text, |_| true)
}

fn spelled(message: &str, is_option: impl Fn(&str) -> bool) -> String {
    let mut pieces = message.split('`');
    let mut text = pieces.next().unwrap_or_default().to_owned();
    while let Some(name) = pieces.next() {
        text += &if is_option(name) { format!("--{name}") } else { format!("`{name}`") };
        text += pieces.next().unwrap_or_default();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_lose_their_backticks_and_other_names_keep_them() {
        let is_option = |name: &str| name == "planes";
        assert_eq!(
            spelled("`planes` 0: lower it; `bench` takes several", is_option),
            "--planes 0: lower it; `bench` takes several"
        );
        assert_eq!(spelled("nothing", is_option), "nothing");
        assert_eq!(spelled("", is_option), "");
    }
}
