//! `view`: the paper in a window, live, pass by pass.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{ArgMatches, Args, Command, FromArgMatches, ValueEnum};

use super::failure::Failure;
use super::options::{MachineArgs, number_in};
use super::watch::on_interruption;
use super::{Paper, listed, paper_names};
use crate::gpu::swapchain::PresentMode;
use crate::measure::study::Study;
use crate::window;

/// The window itself.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Window")]
struct WindowArgs {
    /// Frame that is shown first
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=i64::from(u32::MAX - 1)))]
    frame: u32,
    /// Fill the display
    #[arg(long)]
    fullscreen: bool,
    /// Way of presenting pictures; the display says which it offers
    #[arg(long, value_enum, default_value = "fifo")]
    present_mode: PresentModeArg,
    /// Size of text and controls, 0.5 to 4, times the display's own scale
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f32,
    /// Play from the start, and end after N frames of the paper
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    exit_after: Option<u32>,
    /// Write where the window's controls are, as JSON, after each frame of the window
    #[arg(long, value_name = "FILE", hide = true)]
    controls: Option<PathBuf>,
}

/// [`PresentMode`] as it is typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PresentModeArg {
    /// Every picture in turn, at the display's pace
    Fifo,
    /// As fifo, and at once where one comes late
    FifoRelaxed,
    /// The newest picture at the display's pace
    Mailbox,
    /// At once
    Immediate,
}

impl PresentModeArg {
    fn mode(self) -> PresentMode {
        match self {
            PresentModeArg::Fifo => PresentMode::Fifo,
            PresentModeArg::FifoRelaxed => PresentMode::FifoRelaxed,
            PresentModeArg::Mailbox => PresentMode::Mailbox,
            PresentModeArg::Immediate => PresentMode::Immediate,
        }
    }
}

fn parse_scale(text: &str) -> Result<f32, String> {
    number_in(text, 0.5..=4.0, "a scale of 0.5 to 4")
}

/// The verb, of a command with the options of the scene and of variants.
pub fn command(scene: Command) -> Command {
    WindowArgs::augment_args(MachineArgs::augment_args(scene))
}

/// Opens the window on a paper whose set-up was checked.
pub fn run<S: Study>(matches: &ArgMatches) -> Result<(), Failure> {
    let window = WindowArgs::from_arg_matches(matches)?;
    let machine = MachineArgs::from_arg_matches(matches)?.resolve(0);
    let variants: Vec<&String> = matches.get_many("variant").into_iter().flatten().collect();
    if variants.len() > 2 || variants.iter().any(|variant| *variant == "all") {
        return Err(Failure::Input("--variant: a window shows one variant, or two beside each other".into()));
    }
    let of_machine = Command::new("machine");
    let of_machine = MachineArgs::augment_args(of_machine);
    let of_window = WindowArgs::augment_args(Command::new("window"));
    let is_of = |command: &Command, id: &str| command.get_arguments().any(|argument| argument.get_id() == id);
    // Groups of options have names too.
    let paper = super::declared::command::<S>();
    let is_option = |id: &str| paper.find_subcommand("view").is_some_and(|view| is_of(view, id));
    let options = window::Options {
        papers: listed().iter().map(|paper| paper.name).collect(),
        paper: S::PAPER.to_owned(),
        arguments: typed(matches, |id| is_option(id) && !is_of(&of_machine, id) && !is_of(&of_window, id)),
        common: typed(matches, |id| is_of(&of_machine, id)),
        frame: window.frame,
        is_fullscreen: window.fullscreen,
        present_mode: window.present_mode.mode(),
        scale: window.scale,
        exit_after: window.exit_after,
        validate: machine.validate,
        controls: window.controls,
    };
    window::run(options, on_interruption).map_err(Failure::from)
}

/// The options that were typed, of those that are wanted, as one would type them.
fn typed(matches: &ArgMatches, is_wanted: impl Fn(&str) -> bool) -> Vec<OsString> {
    let mut arguments = Vec::new();
    for id in matches.ids().map(clap::Id::as_str) {
        if matches.value_source(id) != Some(ValueSource::CommandLine) || !is_wanted(id) {
            continue;
        }
        let option = |value: Option<&std::ffi::OsStr>| {
            let mut argument = OsString::from(format!("--{}", id.replace('_', "-")));
            if let Some(value) = value {
                argument.push("=");
                argument.push(value);
            }
            argument
        };
        match matches.try_get_one::<bool>(id) {
            Ok(Some(true)) => arguments.push(option(None)),
            Ok(_) => {}
            Err(_) => arguments.extend(matches.get_raw(id).into_iter().flatten().map(|value| option(Some(value)))),
        }
    }
    arguments
}

/// `fumarole view [PAPER] ...` as `fumarole PAPER view ...`; without a paper the first of the list, or where help is asked for
/// alone, as it is.
///
/// # Errors
/// [`Failure::Input`] for a word that names no paper.
pub fn reordered(arguments: Vec<OsString>) -> Result<Vec<OsString>, Failure> {
    if arguments.get(1).is_none_or(|verb| verb != "view") {
        return Ok(arguments);
    }
    let asks_for_help = |argument: &OsString| ["-h", "--help", "--help-all"].iter().any(|help| argument == help);
    if arguments.get(2).is_some_and(asks_for_help) {
        return Ok(arguments);
    }
    let papers = listed();
    let mut rest = arguments.into_iter();
    let program = rest.next().unwrap_or_default();
    let verb = rest.next().unwrap_or_default();
    let mut rest = rest.peekable();
    let named = rest.next_if(|argument| papers.iter().any(|paper| argument == paper.name));
    if named.is_none()
        && let Some(word) = rest.peek().map(|word| word.to_string_lossy()).filter(|word| !word.starts_with('-'))
    {
        let names = paper_names(&papers);
        return Err(Failure::Input(format!("view {word}: there is no such paper; name one of {names}")));
    }
    let first = papers.first().map_or("", |paper| paper.name);
    let paper = named.unwrap_or_else(|| OsString::from(first));
    Ok([program, paper, verb].into_iter().chain(rest).collect())
}

/// The verb before a paper is named, as help tells of it.
pub fn before_paper(command: Command, papers: &[Paper]) -> Command {
    let usage = "fumarole view [PAPER] [OPTIONS]";
    let names = paper_names(papers);
    command.override_usage(usage).after_help(format!(
        "PAPER is one of {names}; without it the first. Options, of each paper its own: fumarole view PAPER --help"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arguments(text: &str) -> Vec<OsString> {
        text.split(' ').map(OsString::from).collect()
    }

    #[test]
    fn the_paper_may_follow_the_verb_or_be_left_out() {
        for (typed, expected) in [
            ("fumarole view gas --frame 3", "fumarole gas view --frame 3"),
            ("fumarole view gas --help", "fumarole gas view --help"),
            ("fumarole view --frame 3", "fumarole lava view --frame 3"),
            ("fumarole view --help", "fumarole view --help"),
            ("fumarole gas view", "fumarole gas view"),
            ("fumarole", "fumarole"),
        ] {
            assert_eq!(reordered(arguments(typed)).unwrap(), arguments(expected));
        }
        let refused = reordered(arguments("fumarole view foo")).unwrap_err().to_string();
        assert!(refused.starts_with("view foo: ") && refused.contains("lava, gas"), "{refused}");
    }
}
