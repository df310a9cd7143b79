//! `worker`: what the window starts to draw for it. It is no verb of the user's.

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

use clap::builder::OsStringValueParser;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

use super::declared;
use super::failure::Failure;
use super::options::MachineArgs;
use super::shader_folder;
use crate::measure::Error;
use crate::measure::study::Study;
use crate::window::worker::{self, Start, Typed};

/// The verb, of a command with the options of the scene.
pub fn command(scene: Command) -> Command {
    let exchange = Arg::new("exchange").long("exchange").required(true).value_parser(OsStringValueParser::new());
    MachineArgs::augment_args(scene.arg(exchange)).hide(true).about("Draw for a window")
}

/// Draws for the window at the other end of standard input and output.
pub fn run<S: Study>(matches: &ArgMatches) -> Result<(), Failure> {
    let machine = MachineArgs::from_arg_matches(matches)?.resolve(0);
    let path = |name: &str| matches.get_one::<OsString>(name).map(PathBuf::from);
    let typed = S::parameters().into_iter().filter_map(|parameter| {
        let values = declared::typed(matches, &parameter)?.into_iter().map(OsStr::to_owned).collect();
        Some(Typed { name: parameter.name.to_owned(), values })
    });
    let start = Start {
        preset: matches.try_get_one::<String>("preset").ok().flatten().cloned(),
        typed: typed.collect(),
        variants: matches.get_many::<String>("variant").into_iter().flatten().cloned().collect(),
        machine,
        exchange: path("exchange").unwrap_or_default(),
        try_shaders: |folder| shader_folder::check(Some(folder)).map_err(|failure| Error::Input(failure.to_string())),
    };
    Ok(worker::run::<S>(start)?)
}
