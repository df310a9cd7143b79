//! The arguments of `ab`: its own, and those that the sides may not have.

use std::ffi::{OsStr, OsString};

use clap::{Args, Command};

use super::AbArgs;
use crate::cli::Paper;
use crate::cli::failure::Failure;
use crate::cli::help;

/// Options of a bench that say where its record goes and what is printed: in `ab` they are its own, wherever they stand.
const OUTPUT: [&str; 5] = ["json", "out", "quiet", "help", "help-all"];

/// Options of which both sides would write the same file.
const FILES: [&str; 3] = ["--image", "--trace", "--capture"];

/// An option of `ab`.
struct Own {
    long: Option<String>,
    short: Option<char>,
    takes_value: bool,
    needs_value: bool,
}

impl Own {
    /// All of them.
    fn all() -> Vec<Self> {
        let mut command = help::shortened(AbArgs::augment_args(Command::new("ab")), &[]);
        command.build();
        let options = command.get_arguments().filter(|argument| !argument.is_positional());
        options
            .map(|argument| {
                let values = argument.get_num_args().unwrap_or_default();
                Own {
                    long: argument.get_long().map(str::to_owned),
                    short: argument.get_short(),
                    takes_value: values.takes_values(),
                    needs_value: values.min_values() > 0,
                }
            })
            .collect()
    }

    fn is(&self, name: &str) -> bool {
        match (name.strip_prefix("--"), name.strip_prefix('-')) {
            (Some(long), _) => self.long.as_deref() == Some(long),
            (None, Some(short)) => self.short.is_some_and(|own| short == own.to_string()),
            (None, None) => false,
        }
    }
}

/// Arguments of the program with `ab`'s own options before the paper, behind which every argument is one of both sides. An
/// option behind a paper that has one of that name is the paper's.
pub(in crate::cli) fn reordered(arguments: Vec<OsString>, papers: &[Paper]) -> Vec<OsString> {
    if arguments.get(1).is_none_or(|verb| verb != "ab") {
        return arguments;
    }
    let own = Own::all();
    let mut rest = arguments.into_iter();
    let mut first: Vec<OsString> = rest.by_ref().take(2).collect();
    let mut rest = rest.peekable();
    let (mut common, mut of_paper): (_, Option<Vec<String>>) = (Vec::new(), None);
    let is_paper = |argument: &OsString| papers.iter().any(|paper| argument == paper.name);
    let mut ends_without_value = false;
    while let Some(argument) = rest.next() {
        let text = argument.to_string_lossy().into_owned();
        let name = option_name(&text);
        if name == "--" {
            common.push(argument);
            common.extend(rest.by_ref());
            break;
        }
        let is_paper_s = |name: &str| of_paper.as_ref().is_some_and(|known| known.iter().any(|known| *known == name));
        match own.iter().find(|option| option.is(name) && !is_paper_s(name)) {
            Some(option) => {
                let has_value = name.len() < text.len();
                let is_value = |next: &OsString| {
                    option.needs_value || next == "-" || !is_dashed(next) && (of_paper.is_some() || !is_paper(next))
                };
                let value = if option.takes_value && !has_value { rest.next_if(is_value) } else { None };
                ends_without_value = option.takes_value && !has_value && value.is_none();
                first.push(argument);
                first.extend(value);
            }
            None => {
                if of_paper.is_none() && !is_dashed(&argument) {
                    of_paper = Some(bench_options(papers, &text));
                }
                common.push(argument);
            }
        }
    }
    if ends_without_value {
        // Or the paper would be its value.
        first.push("--".into());
    }
    first.extend(common);
    first
}

/// The options of a paper's bench, but for [`OUTPUT`], as they are typed.
fn bench_options(papers: &[Paper], name: &str) -> Vec<String> {
    let Some(paper) = papers.iter().find(|paper| paper.name == name) else { return Vec::new() };
    let command = (paper.command)();
    let bench = command.find_subcommand("bench");
    let long = bench.into_iter().flat_map(Command::get_arguments).filter_map(|argument| argument.get_long());
    long.filter(|long| !OUTPUT.contains(long)).map(|long| format!("--{long}")).collect()
}

fn is_dashed(argument: &OsStr) -> bool {
    argument.to_string_lossy().starts_with('-')
}

/// An argument without the value that it may hold.
fn option_name(argument: &str) -> &str {
    argument.split('=').next().unwrap_or_default()
}

impl AbArgs {
    /// Refuses options with which blocks would be none, a file would be written twice, or that would do nothing.
    pub fn check_arguments(&self) -> Result<(), Failure> {
        let common: Vec<String> = self.common.iter().map(|argument| argument.to_string_lossy().into_owned()).collect();
        let has = |arguments: &[String], option: &str| arguments.iter().any(|argument| option_name(argument) == option);
        let sides = [("--a", &self.a.0), ("--b", &self.b.0)];
        let anywhere = |option: &str| has(&common, option) || sides.iter().any(|(_, own)| has(own, option));
        let refused = |message: String| Err(Failure::Input(format!("ab: {message}")));
        if let Some(option) = ["--processes", "--process"].into_iter().find(|option| anywhere(option)) {
            return refused(format!(
                "{option}: each place of a block A B B A is one process; --blocks says how many there are"
            ));
        }
        if anywhere("--csv") {
            return refused(
                "--csv: every process would write it anew; ab-a.json and ab-b.json in --out hold all of them"
                    .to_owned(),
            );
        }
        for (side, own) in sides {
            let taken = ["--json", "--out", "--quiet", "-q", "--help", "-h", "--help-all"];
            if let Some(option) = taken.into_iter().find(|option| has(own, option)) {
                return refused(format!("{option} in {side}: the output is ab's own; give {option} outside of {side}"));
            }
        }
        if let Some(option) = FILES.into_iter().find(|option| has(&common, option)) {
            return refused(format!(
                "{option} for both sides: both would write the same file; give each side its own, in --a and --b"
            ));
        }
        match self.verdict.option_given().filter(|_| self.shard.is_some()) {
            None => Ok(()),
            Some(option) => refused(format!(
                "{option} with --shard: a shard compares nothing; give {option} to compare --blocks, after assemble"
            )),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::listed;

    #[test]
    fn own_options_may_stand_anywhere_but_for_names_of_the_paper_s() {
        let cases = [
            // As it is.
            ("fumarole ab --blocks 2 gas --planes 3", "fumarole ab --blocks 2 gas --planes 3"),
            ("fumarole gas bench --json --b", "fumarole gas bench --json --b"),
            ("fumarole ab gas --planes 3 -- --b x", "fumarole ab gas --planes 3 -- --b x"),
            // Values that begin with a dash, that may be absent, and behind an equals sign.
            ("fumarole ab gas --planes 3 --a --seed=2 --b=x -q", "fumarole ab --a --seed=2 --b=x -q gas --planes 3"),
            ("fumarole ab gas --json --frames 2 --out x", "fumarole ab --json --out x gas --frames 2"),
            ("fumarole ab --json gas --frames 2", "fumarole ab --json -- gas --frames 2"),
            ("fumarole ab gas --frames 2 --json", "fumarole ab --json -- gas --frames 2"),
            ("fumarole ab --json f gas --frames 2", "fumarole ab --json f gas --frames 2"),
            ("fumarole ab gas --json - --margin 3% bench", "fumarole ab --json - --margin 3% gas bench"),
            ("fumarole ab gas --env A:X=1 --env B:X=2", "fumarole ab --env A:X=1 --env B:X=2 gas"),
            // A name that the paper has too.
            (
                "fumarole ab --blocks 3 burning --blocks 4x4x4 --budget 9",
                "fumarole ab --blocks 3 --budget 9 burning --blocks 4x4x4",
            ),
            ("fumarole ab gas --blocks 3", "fumarole ab --blocks 3 gas"),
        ];
        let papers = listed();
        for (typed, expected) in cases {
            let arguments = reordered(typed.split(' ').map(OsString::from).collect(), &papers);
            let arguments: Vec<_> = arguments.iter().map(|argument| argument.to_string_lossy()).collect();
            assert_eq!(arguments.join(" "), expected, "{typed}");
        }
    }
}
