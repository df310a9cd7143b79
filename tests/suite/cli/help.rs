//! Help opens with a dozen options at most; behind `--help-all` stand all of them.

use super::program::fumarole;

/// The help that a command prints.
fn help(command: &str, option: &str) -> String {
    fumarole(command).arg(option).run().succeeded().stdout
}

/// Names of the commands below the one whose help this is.
fn commands(help: &str) -> Vec<&str> {
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let lines = list.lines().take_while(|line| !line.is_empty());
    // What is deeper is the rest of a line above it.
    let names = lines.filter_map(|line| line.strip_prefix("  ")).filter(|line| !line.starts_with(' '));
    names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect()
}

/// Names of the options that a help lists.
fn options(help: &str) -> Vec<&str> {
    let named = help.lines().filter_map(|line| {
        let text = line.trim_start();
        let is_option = match line.len() - text.len() {
            2 => text.starts_with('-'),
            6 => text.starts_with("--"),
            _ => false,
        };
        text.split([' ', ',', '=', '[']).find(|word| word.starts_with("--")).filter(|_| is_option)
    });
    named.collect()
}

/// The number of options that a help says there are in all.
fn promised(help: &str) -> Option<usize> {
    let (number, _) = help.split_once(" options, by group: --help-all")?;
    number.rsplit_once("All ")?.1.parse().ok()
}

#[test]
fn help_opens_with_a_dozen_options_and_help_all_lists_every_one() {
    let own = help("", "--help");
    let papers = ["lava", "gas", "caustics", "burning", "terrain"];
    let (papers, own): (Vec<&str>, Vec<&str>) = commands(&own).into_iter().partition(|name| papers.contains(name));
    assert_eq!(papers.len(), 5);
    let mut verbs: Vec<String> = own.into_iter().map(str::to_owned).collect();
    for paper in papers {
        let text = help(paper, "--help");
        let of_paper = commands(&text);
        assert!(of_paper.len() >= 5, "{paper}: {of_paper:?}");
        verbs.extend(of_paper.iter().map(|verb| format!("{paper} {verb}")));
    }
    let mut shortened = 0;
    for verb in &verbs {
        let text = help(verb, "--help");
        let first = options(&text);
        assert!((1..=12).contains(&first.len()), "{verb}: {} options\n{text}", first.len());
        let Some(count) = promised(&text) else {
            assert!(!verb.contains(' '), "{verb} does not say how many options there are\n{text}");
            continue;
        };
        shortened += 1;
        let whole = help(verb, "--help-all");
        let all = options(&whole);
        assert!(first.iter().all(|option| all.contains(option)), "{verb}: {first:?} of {all:?}");
        let of_help = ["--help", "--help-all", "--version"];
        let others = all.iter().filter(|option| !of_help.contains(option)).count();
        assert_eq!(others, count, "{verb}\n{whole}");
        assert!(first.len() < count, "{verb}: {first:?} of {count}");
    }
    assert!(shortened >= 33, "{shortened} of {verbs:?}");
}

#[test]
fn help_all_is_taken_everywhere() {
    for command in ["", "caustics", "compare", "report", "assemble", "devices"] {
        assert_eq!(help(command, "--help-all"), help(command, "--help"), "{command}");
        assert_eq!(options(&help(command, "--help")).iter().filter(|option| **option == "--help").count(), 1);
    }
}

#[test]
fn opposites_of_flags_read_as_they_are() {
    let flags = [("caustics", "--no-mrt"), ("burning", "--no-ground"), ("gas", "--no-geometry-stage")];
    for (paper, flag) in flags {
        let text = help(&format!("{paper} render"), "--help-all");
        let (_, after) = text.split_once(&format!("      {flag}\n")).unwrap();
        assert!(after.trim_start().starts_with("Switch off: "), "{flag}: {after}");
        let help = after.split("\n\n").next().unwrap_or_default();
        assert!(!help.contains(", or "), "{flag}: {help}");
    }
}

/// Of a paper's own numbers, where they are others than a bench's.
#[test]
fn defaults_in_help_are_those_that_are_taken() {
    for (verb, frames, repeat) in [("caustics bench", 10, 3), ("caustics experiment", 3, 3), ("gas experiment", 1, 5)] {
        let text = help(verb, "--help-all").split_whitespace().collect::<Vec<_>>().join(" ");
        for (what, number) in
            [("Frames in one repetition, 1 to 100000", frames), ("Repetitions of those frames, 1 to 10000", repeat)]
        {
            assert!(text.contains(&format!("{what} [default: {number}")), "{verb}: {text}");
        }
    }
}

#[test]
fn options_of_a_steps_frames_are_of_measuring() {
    let text = help("terrain stress", "--help-all");
    let (_, measuring) = text.split_once("\nMeasuring:\n").unwrap();
    let is_heading = |line: &&str| line.ends_with(':') && !line.starts_with(' ');
    let measuring = measuring.lines().take_while(|line| !is_heading(line)).collect::<Vec<_>>().join("\n");
    assert_eq!(options(&measuring), ["--warmup", "--frames", "--repeat"]);
}

#[cfg(feature = "window")]
#[test]
fn the_window_names_the_papers_before_one_is_chosen() {
    for text in [help("view", "--help"), help("view", "--help-all"), help("help", "view")] {
        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(text.contains("Usage: fumarole view [PAPER] [OPTIONS]"), "{text}");
        assert!(text.contains("lava, gas, caustics, burning, terrain"), "{text}");
    }
    fumarole("view foo").run().refused(2, &["view foo", "lava, gas, caustics, burning, terrain"]);
}
