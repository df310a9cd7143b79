//! The words of a command line of `ab`: which are its own, and which the sides may not have.

use std::ffi::{OsStr, OsString};

use clap::{Args, Command};

use super::AbArgs;
use crate::cli::Paper;
use crate::cli::failure::Failure;

/// Options of a bench that say where its record goes and what is printed: in `ab` they are its own, wherever they stand.
const OUTPUT: [&str; 4] = ["json", "out", "quiet", "help"];

/// Options of which every process would write the same file.
const FILES: [&str; 4] = ["--image", "--trace", "--csv", "--capture"];

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
        let mut command = AbArgs::augment_args(Command::new("ab"));
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

/// Arguments of the program with `ab`'s own options before the paper, behind which every word is one of both sides. An
/// option behind a paper that has one of that name is the paper's.
pub(in crate::cli) fn reordered(arguments: Vec<OsString>, papers: &[Paper]) -> Vec<OsString> {
    if arguments.get(1).is_none_or(|verb| verb != "ab") {
        return arguments;
    }
    let own = Own::all();
    let mut words = arguments.into_iter();
    let mut first: Vec<OsString> = words.by_ref().take(2).collect();
    let mut words = words.peekable();
    let (mut common, mut of_paper) = (Vec::new(), None);
    while let Some(word) = words.next() {
        let text = word.to_string_lossy().into_owned();
        let name = option_name(&text);
        if name == "--" {
            common.push(word);
            common.extend(words.by_ref());
            break;
        }
        let is_paper_s = |name: &str| of_paper.iter().flatten().any(|known: &String| *known == name);
        match own.iter().find(|option| option.is(name) && !is_paper_s(name)) {
            Some(option) => {
                let has_value = name.len() < text.len();
                let is_value = |next: &OsString| option.needs_value || next == "-" || !is_dashed(next);
                first.push(word);
                if option.takes_value && !has_value {
                    first.extend(words.next_if(is_value));
                }
            }
            None => {
                if of_paper.is_none() && !is_dashed(&word) {
                    of_paper = Some(bench_options(papers, &text));
                }
                common.push(word);
            }
        }
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

fn is_dashed(word: &OsStr) -> bool {
    word.to_string_lossy().starts_with('-')
}

/// A word without the value that it may hold.
fn option_name(word: &str) -> &str {
    word.split('=').next().unwrap_or_default()
}

impl AbArgs {
    /// Refuses options with which blocks would be none, or a file would be written by all processes.
    pub fn check_words(&self) -> Result<(), Failure> {
        let common: Vec<String> = self.common.iter().map(|word| word.to_string_lossy().into_owned()).collect();
        let has = |words: &[String], option: &str| words.iter().any(|word| option_name(word) == option);
        if [&common, &self.a.0, &self.b.0].into_iter().any(|words| has(words, "--processes")) {
            let message =
                "ab: --processes: each place of a block A B B A is one process; --blocks says how many there are";
            return Err(Failure::Input(message.to_owned()));
        }
        match FILES.into_iter().find(|option| has(&common, option)) {
            None => Ok(()),
            Some(option) => Err(Failure::Input(format!(
                "ab: {option} for both sides: all processes would write the same file; give each side its own, in --a and \
                 --b"
            ))),
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
            let words = reordered(typed.split(' ').map(OsString::from).collect(), &papers);
            let words: Vec<_> = words.iter().map(|word| word.to_string_lossy()).collect();
            assert_eq!(words.join(" "), expected, "{typed}");
        }
    }
}
