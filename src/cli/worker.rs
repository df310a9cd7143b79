//! `worker`: what the window starts to draw for it. It is no verb of the user's.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::OsStringValueParser;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};

use super::declared::opposite;
use super::failure::Failure;
use super::options::MachineArgs;
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
    let start = Start {
        preset: matches.try_get_one::<String>("preset").ok().flatten().cloned(),
        typed: typed::<S>(matches),
        variants: matches.get_many::<String>("variant").into_iter().flatten().cloned().collect(),
        machine,
        exchange: path("exchange").unwrap_or_default(),
    };
    Ok(worker::run::<S>(start)?)
}

/// The parameters that were typed, as they were typed.
fn typed<S: Study>(matches: &ArgMatches) -> Vec<Typed> {
    let is_typed = |name: &str| matches.value_source(name) == Some(ValueSource::CommandLine);
    let value = |parameter: &crate::measure::parameter::Parameter<S>| {
        let name = parameter.name;
        if parameter.shape().is_flag {
            let on = is_typed(name) && matches.get_flag(name);
            let opposite = opposite(name);
            let off = is_typed(&opposite) && matches.get_flag(&opposite);
            return (on || off).then(|| vec![OsString::from(if on { "true" } else { "false" })]);
        }
        is_typed(name).then(|| matches.get_many::<OsString>(name).into_iter().flatten().cloned().collect())
    };
    let parameters = S::parameters();
    let each =
        parameters.iter().map(|parameter| Some(Typed { name: parameter.name.to_owned(), values: value(parameter)? }));
    each.flatten().collect()
}
