//! A paper's command line, made of its declarations: options of its parameters, and the verbs.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use clap::builder::{OsStringValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches};

use super::failure::Failure;
use super::options::{CommonArgs, DepthArgs, FRAMES_HELP, MachineArgs, REPEAT_HELP};
use super::outcome::{self, Terminal};
use super::render::PictureArgs;
use super::stress::{self, StressArgs};
use super::{bench, help, loading, passes, pool, reading, render, shader_folder, spelling};
use crate::file;
use crate::measure::bench::QUICKLY_READ;
use crate::measure::experiment::{Context, Doubts, Experiment};
use crate::measure::parameter::{self, Given, Parameter, Shape};
use crate::measure::shard::Shard;
use crate::measure::shared_sweep::Assembled;
use crate::measure::study::{Preset, Study, check_one};
use crate::measure::{Error, Variant};

/// The command of a paper with all its verbs.
pub fn command<S: Study>() -> Command {
    help::whole(Command::new(S::PAPER))
        .about(S::ABOUT)
        .subcommand_required(true)
        .arg_required_else_help(true)
        .subcommand(passes_command::<S>())
        .subcommand(bench_command::<S>())
        .subcommand(experiment_command::<S>())
        .subcommand(render_command::<S>())
        .subcommand(stress_command::<S>())
        .subcommands(window_commands::<S>())
        .subcommands(S::verbs().iter().map(own_command))
}

/// The window and what draws for it, where they were built in.
fn window_commands<S: Study>() -> Vec<Command> {
    #[cfg(feature = "window")]
    {
        let scene = |verb: &'static str, help: &str| {
            with_scene::<S>(Command::new(verb).arg(variant_list::<S>(help, "as for `render`")))
        };
        let view = super::view::command(scene("view", "One variant, or two beside each other"));
        let about = "Open a window: live passes, targets, variants side by side, parameters";
        let worker = help::whole(super::worker::command(scene("worker", "Variants")));
        vec![finish::<S>(view, about), worker]
    }
    #[cfg(not(feature = "window"))]
    Vec::new()
}

fn passes_command<S: Study>() -> Command {
    let command = Command::new("passes")
        .arg(variant_list::<S>("Variants to list, comma-separated, or all", "that of a preset made for one, or all"))
        .arg(Arg::new("json").long("json").action(ArgAction::SetTrue).help("Print JSON"));
    finish::<S>(MachineArgs::augment_args(with_scene::<S>(command)), "List the passes in the paper's order")
}

fn bench_command<S: Study>() -> Command {
    let benched = S::BENCHED.iter().map(|v| v.as_str()).collect::<Vec<_>>().join(",");
    let default = format!("that of a preset made for one, or {benched}");
    let variants = variant_list::<S>("Variants to measure, comma-separated, or all", &default);
    let command = with_scene::<S>(Command::new("bench").arg(variants));
    // A list in one word, too, takes the place of one before it.
    let is_joined = |arg: &Arg| arg.get_value_delimiter().is_some();
    finish::<S>(
        DepthArgs::augment_args(CommonArgs::augment_args(command))
            .mut_args(|arg| if is_joined(&arg) { arg.action(ArgAction::Set) } else { arg }),
        "Time one configuration in one or more variants, interleaved",
    )
}

fn experiment_command<S: Study>() -> Command {
    let names = S::experiments().into_iter().map(|e| PossibleValue::new(e.name).help(e.help));
    let name = Arg::new("name").value_name("NAME").help("Table or figure of the paper").required_unless_present("list");
    let heeded: Vec<&str> = S::experiments().iter().flat_map(|e| e.options).copied().collect();
    let own: Vec<_> = S::options().into_iter().filter(|o| heeded.contains(&o.name)).collect();
    let command = Command::new("experiment")
        .arg(name.value_parser(PossibleValuesParser::new(names)))
        .arg(Arg::new("list").long("list").action(ArgAction::SetTrue).help("List the experiments"))
        .arg(shard_argument("Of the points of a sweep, the part I of N; assemble joins the records"))
        .arg(assembled_argument())
        .args(options(&own, &S::Options::default()));
    let command = CommonArgs::augment_args(with_scene::<S>(command));
    let (frames, repeat) = S::EXPERIMENT_FRAMES;
    let default = |number: u32| format!("[default: {number}, or the experiment's own number]");
    let command = command
        .mut_arg("frames", |arg| arg.help(format!("{FRAMES_HELP} {}", default(frames))))
        .mut_arg("repeat", |arg| arg.help(format!("{REPEAT_HELP} {}", default(repeat))));
    finish::<S>(command, "Reproduce one table or figure, ours beside the paper's")
}

fn shard_argument(help: &'static str) -> Arg {
    let parser = |text: &str| text.parse::<Shard>();
    Arg::new("shard").long("shard").value_name("I/N").value_parser(parser).help(help)
}

fn assembled_argument() -> Arg {
    let parser = clap::value_parser!(PathBuf);
    let help = "Publish what the shards have measured and assemble has joined, and measure nothing";
    let argument = Arg::new("assembled").long("assembled").value_name("FILE.json");
    argument.value_parser(parser).conflicts_with("shard").help(help)
}

fn render_command<S: Study>() -> Command {
    let rendered = S::RENDERED.as_str();
    let variant = Arg::new("variant")
        .long("variant")
        .value_name("VARIANT")
        .help(format!("Variant to render [default: the preset's if it has one, or {rendered}]"))
        .value_parser(PossibleValuesParser::new(S::Variant::ALL.iter().map(|v| v.as_str())));
    let command = with_scene::<S>(Command::new("render").arg(variant));
    finish::<S>(PictureArgs::augment_args(command), "Write pictures and intermediate targets")
}

fn stress_command<S: Study>() -> Command {
    let rendered = S::RENDERED.as_str();
    let default = format!("that of a preset made for one, or {rendered}");
    let variants = variant_list::<S>("Variants to grow, comma-separated, or all", &default);
    let command = with_scene::<S>(Command::new("stress").arg(variants.long("variants").alias("variant")));
    finish::<S>(
        StressArgs::augment_args(command),
        "Grow one axis until a limit of time, memory, device or correctness stops it",
    )
}

/// A verb that no other paper has, with the parameters and options that it heeds.
fn own_command<S: Study>(verb: &Experiment<S>) -> Command {
    let heeded = |p: &Parameter<S>| !verb.refuses.iter().any(|(name, _)| *name == p.name);
    let scene: Vec<_> = S::parameters().into_iter().filter(heeded).collect();
    let own: Vec<_> = S::options().into_iter().filter(|o| verb.options.contains(&o.name)).collect();
    let json = Arg::new("json").long("json").value_name("FILE").num_args(0..=1).default_missing_value("-");
    let command =
        Command::new(verb.name).args(options(&own, &S::Options::default())).args(options(&scene, &S::default())).arg(
            json.value_parser(OsStringValueParser::new())
                .help_heading("Output")
                .help("Write what was found as JSON; to standard output without a file"),
        );
    finish::<S>(command, verb.help)
}

/// A verb: its help opens with everyday options, its own and those of the paper. An option that is given again takes the place of the
/// first, as what a side of `ab` sets comes after what both have; lists grow.
fn finish<S: Study>(command: Command, about: &'static str) -> Command {
    let (parameters, options) = (S::parameters(), S::options());
    let parameters = parameters.iter().filter(|p| p.is_everyday).map(|p| p.name);
    let options = options.iter().filter(|o| o.is_everyday).map(|o| o.name);
    let own = help::everyday(command.get_name()).iter().copied();
    let everyday: Vec<&str> = own.chain(parameters).chain(options).collect();
    help::shortened(command.about(about).long_about(None).args_override_self(true), &everyday)
        .disable_version_flag(true)
}

/// The command with the paper's parameters and presets as options.
fn with_scene<S: Study>(command: Command) -> Command {
    let presets = S::presets();
    let command = if presets.is_empty() { command } else { command.arg(preset_option(&presets)) };
    command.args(options(&S::parameters(), &S::default())).arg(loading::option())
}

fn preset_option<S: Study>(presets: &[Preset<S>]) -> Arg {
    let names = presets.iter().map(|preset| PossibleValue::new(preset.name).help(preset.help));
    Arg::new("preset")
        .long("preset")
        .help_heading("Scene")
        .value_name("NAME")
        .value_parser(PossibleValuesParser::new(names))
        .help("Take the numbers of a figure or table; options given beside it win")
}

fn variant_list<S: Study>(help: &str, default: &str) -> Arg {
    Arg::new("variant")
        .long("variant")
        .value_name("VARIANT,..")
        .action(ArgAction::Append)
        .value_delimiter(',')
        .help(format!("{help} [default: {default}]"))
        .value_parser(PossibleValuesParser::new(S::Variant::ALL.iter().map(|v| v.as_str()).chain(["all"])))
}

/// The option of each parameter; of one that is on by default also its opposite.
fn options<S: 'static>(parameters: &[Parameter<S>], default: &S) -> Vec<Arg> {
    parameters.iter().flat_map(|parameter| arguments(parameter, default)).collect()
}

/// Names of the opposites of flags.
fn opposite(name: &str) -> String {
    format!("no-{name}")
}

fn arguments<S: 'static>(parameter: &Parameter<S>, default: &S) -> Vec<Arg> {
    let shape = parameter.shape();
    let is_on = parameter.text(default) == "on";
    let option = |name: String| Arg::new(name.clone()).long(name).help_heading(parameter.group);
    if shape.is_flag {
        // The one that changes nothing is taken and not listed.
        let help = help(parameter, default);
        let flag = option(parameter.name.to_owned()).help(&help).hide(is_on);
        let other = option(opposite(parameter.name)).help(help::switched_off(&help)).hide(!is_on);
        let overridden = [opposite(parameter.name), parameter.name.to_owned()];
        let switches = [flag, other].map(|switch| switch.action(ArgAction::SetTrue));
        return switches.into_iter().zip(overridden).map(|(switch, other)| switch.overrides_with(other)).collect();
    }
    let action = if shape.is_list { ArgAction::Append } else { ArgAction::Set };
    let arg = option(parameter.name.to_owned())
        .value_name(parameter.placeholder)
        .action(action)
        .help(help(parameter, default))
        .allow_hyphen_values(shape.is_signed && shape.placeholder.contains([',', 'x']))
        .allow_negative_numbers(shape.is_signed)
        .conflicts_with_all(parameter.excludes);
    let arg = if shape.is_list && shape.joins { arg.value_delimiter(',') } else { arg };
    let arg = parameter.requires.into_iter().fold(arg, |arg, name| arg.requires(name));
    vec![if shape.choices.is_empty() { arg.value_parser(parser(parameter)) } else { arg.value_parser(names(shape)) }]
}

fn names(shape: Shape) -> impl TypedValueParser<Value = OsString> {
    let names = shape.choices.iter().map(|(name, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(names).map(OsString::from)
}

/// Checks the form of a value and passes it on as it was typed.
fn parser<S: 'static>(parameter: &Parameter<S>) -> impl TypedValueParser<Value = OsString> + use<S> {
    let parse = parameter.parser();
    OsStringValueParser::new().try_map(move |text| parse(&[OsStr::new(&text)]).map(|()| text))
}

/// Help with range, unit, default and section.
fn help<S: 'static>(parameter: &Parameter<S>, default: &S) -> String {
    let bounds = Some(parameter.bounds()).filter(|bounds| !bounds.is_empty()).map(|bounds| format!(", {bounds}"));
    let repeatable = if parameter.shape().is_list && !parameter.shape().joins { "; repeatable" } else { "" };
    let default = if parameter.shape().is_flag { String::new() } else { parameter.default_of(default) };
    let default = if default.is_empty() { default } else { format!(" [default: {default}]") };
    let section = if parameter.section.is_empty() { String::new() } else { format!(" ({})", parameter.section) };
    let help = spelling::every(parameter.help);
    format!("{help}{}{repeatable}{section}{default}", bounds.unwrap_or_default())
}

/// Sets the parameters that were typed, in the order in which they are declared.
fn read<S: 'static>(matches: &ArgMatches, parameters: &[Parameter<S>], setup: &mut S) -> Result<(), Failure> {
    for parameter in parameters {
        let Some(values) = typed(matches, parameter) else { continue };
        let set = parameter.set(setup, &values);
        set.map_err(|reason| Failure::Input(format!("--{}: {reason}", parameter.name)))?;
    }
    Ok(())
}

/// The values of a parameter that were typed; `true` or `false` of a flag.
pub fn typed<'a, S: 'static>(matches: &'a ArgMatches, parameter: &Parameter<S>) -> Option<Vec<&'a OsStr>> {
    if parameter.shape().is_flag {
        let flag = |name: &str| matches.try_get_one::<bool>(name).ok().flatten() == Some(&true);
        let on = flag(parameter.name);
        return (on || flag(&opposite(parameter.name))).then(|| vec![OsStr::new(if on { "true" } else { "false" })]);
    }
    let values = matches.try_get_many::<OsString>(parameter.name).ok().flatten()?;
    Some(values.map(OsString::as_os_str).collect())
}

/// Names that were typed.
fn given(matches: &ArgMatches) -> Given {
    let typed = |id: &clap::Id| matches.value_source(id.as_str()) == Some(ValueSource::CommandLine);
    let names = matches.ids().filter(|id| typed(id));
    names.map(|id| id.as_str().strip_prefix("no-").unwrap_or(id.as_str()).to_owned()).collect()
}

/// A scene as it was typed.
struct Typed<'a, S: Study> {
    matches: &'a ArgMatches,
    preset: Option<Preset<S>>,
}

impl<'a, S: Study> Typed<'a, S> {
    fn new(matches: &'a ArgMatches) -> Self {
        let name = matches.try_get_one::<String>("preset").ok().flatten();
        let preset = name.and_then(|name| S::presets().into_iter().find(|preset| preset.name == name));
        Typed { matches, preset }
    }

    /// The setup: typed values, over the preset's numbers, over the defaults.
    fn resolve(&self) -> Result<S, Failure> {
        let mut setup = self.preset.as_ref().map_or_else(S::default, Preset::setup);
        read(self.matches, &S::parameters(), &mut setup)?;
        setup.resolve(&given(self.matches))?;
        Ok(setup)
    }

    /// The same, of one value a parameter.
    ///
    /// # Errors
    /// [`Failure::Input`] where there are several to be measured in turn.
    fn resolve_one(&self) -> Result<S, Failure> {
        let setup = self.resolve()?;
        check_one(&setup)?;
        Ok(setup)
    }

    fn preset_variant(&self) -> Option<S::Variant> {
        self.preset.as_ref().and_then(|preset| preset.variant)
    }

    /// The variants that were named, each once, or else the preset's, or else `usual`.
    fn variants(&self, usual: &[S::Variant]) -> Vec<S::Variant> {
        let named: Vec<&String> = self.matches.get_many("variant").into_iter().flatten().collect();
        match (named.as_slice(), self.preset_variant()) {
            ([], Some(variant)) => vec![variant],
            ([], None) => usual.to_vec(),
            (names, _) if names.iter().any(|name| *name == "all") => S::Variant::ALL.to_vec(),
            (names, _) => {
                let is_named = |v: &S::Variant| names.iter().any(|name| *name == v.as_str());
                S::Variant::ALL.iter().copied().filter(is_named).collect()
            }
        }
    }
}

/// Runs the verb that was typed.
pub fn run<S: Study>(matches: &ArgMatches) -> Result<(), Failure> {
    let Some((verb, matches)) = matches.subcommand() else { return Ok(()) };
    // The window's own process reads nothing, and is to stay the only thread until it draws.
    if verb != "view" {
        pool::start()?;
        if let Ok(folder) = matches.try_get_one::<PathBuf>("shader_dir")
            && !is_part(matches)
        {
            shader_folder::check(folder.map(PathBuf::as_path))?;
        }
    }
    loading::begin(matches);
    let result = run_verb::<S>(verb, matches);
    loading::end();
    result
}

/// True of a process that one of ours has started for a part of its work.
fn is_part(matches: &ArgMatches) -> bool {
    let is_typed = |name: &str| matches.value_source(name) == Some(ValueSource::CommandLine);
    ["process", "step_report"].into_iter().any(|name| matches.try_contains_id(name).is_ok() && is_typed(name))
}

/// Checks a bench of these arguments as far as that goes without a device, and lists the files that it writes.
///
/// # Errors
/// All that it would refuse before that; large mesh files are not read.
pub fn check_bench<S: Study>(matches: &ArgMatches) -> Result<Vec<PathBuf>, Failure> {
    let typed = Typed::<S>::new(matches);
    let common = CommonArgs::from_arg_matches(matches)?;
    outcome::check(&common.output)?;
    let setup = typed.resolve()?;
    let written = bench::check(&common, &setup, &typed.variants(S::BENCHED))?;
    shader_folder::check(common.machine.shader_dir())?;
    if setup.promised_triangles()? < QUICKLY_READ {
        loading::begin(matches);
        let loaded = setup.load();
        loading::end();
        loaded?;
    }
    Ok(written)
}

/// The files that a bench of these arguments reads; none where they are refused.
pub fn read_by_bench<S: Study>(matches: &ArgMatches) -> Vec<PathBuf> {
    match (Typed::<S>::new(matches).resolve(), MachineArgs::from_arg_matches(matches)) {
        (Ok(setup), Ok(machine)) => reading::by_study(&setup, &machine),
        _ => Vec::new(),
    }
}

fn run_verb<S: Study>(verb: &str, matches: &ArgMatches) -> Result<(), Failure> {
    let typed = Typed::<S>::new(matches);
    match verb {
        "passes" => {
            let machine = MachineArgs::from_arg_matches(matches)?;
            let setup = typed.resolve_one()?;
            passes::list(&setup, &typed.variants(S::Variant::ALL), &machine, matches.get_flag("json"))
        }
        "bench" => {
            let common = CommonArgs::from_arg_matches(matches)?;
            outcome::check(&common.output)?;
            let setup = typed.resolve()?;
            let depth = DepthArgs::from_arg_matches(matches)?;
            bench::publish(&common, &depth, &setup, &typed.variants(S::BENCHED))
        }
        "render" => {
            let setup = typed.resolve_one()?;
            let name = matches.get_one::<String>("variant");
            let named = name.and_then(|name| S::Variant::ALL.iter().copied().find(|v| v.as_str() == name));
            let variant = named.unwrap_or_else(|| setup.rendered(typed.preset_variant()));
            render::draw(variant, &PictureArgs::from_arg_matches(matches)?, || Ok(setup))
        }
        "stress" => {
            let arguments = StressArgs::from_arg_matches(matches)?;
            let setup = typed.resolve_one()?;
            let variants = typed.variants(&[setup.rendered(None)]);
            stress::run(&arguments, setup, variants, &given(matches))
        }
        "experiment" => experiment(matches, &typed),
        #[cfg(feature = "window")]
        "worker" => super::worker::run::<S>(matches),
        #[cfg(feature = "window")]
        "view" => {
            typed.resolve_one()?;
            super::view::run::<S>(matches)
        }
        verb => own_verb(verb, matches, &typed),
    }
}

fn experiment<S: Study>(matches: &ArgMatches, typed: &Typed<'_, S>) -> Result<(), Failure> {
    let experiments = S::experiments();
    let name = matches.get_one::<String>("name").filter(|_| !matches.get_flag("list"));
    let Some(experiment) = name.and_then(|name| experiments.iter().find(|e| e.name == name)) else {
        return outcome::print(&experiments.iter().map(|e| format!("{:14}{}\n", e.name, e.help)).collect::<String>());
    };
    let common = CommonArgs::from_arg_matches(matches)?;
    outcome::check(&common.output)?;
    let mut options = S::Options::default();
    read(matches, &S::options(), &mut options)?;
    parameter::check(&S::options(), &options).map_err(Error::from)?;
    let mut context = Context {
        name: experiment.name,
        preset: typed.preset.clone(),
        setup: typed.resolve_one()?,
        options,
        given: given(matches),
        machine: common.machine.resolve(common.measure.process),
        measure: common.measure.options(),
        destinations: common.output.destinations(),
        shard: matches.get_one("shard").copied(),
        assembled: matches.get_one::<PathBuf>("assembled").map(|path| Assembled::read(path)).transpose()?,
        console: &Terminal { is_quiet: common.output.quiet },
        doubts: Doubts::default(),
    };
    *context.setup.preset_mut() = Some(experiment.name.to_owned());
    let mut read = reading::by_study(&context.setup, &common.machine);
    read.extend(reading::named(&S::options(), &context.options));
    read.extend(matches.get_one::<PathBuf>("assembled").cloned());
    let mut written = vec![context.json_file(), context.csv_file()];
    // Among the files that it names itself are pictures, plots and tables.
    written.extend(read.iter().filter_map(|path| own_file(&context, path)).next());
    outcome::check_apart(&written, &read)?;
    Ok(context.run(experiment)?)
}

/// Endings of all files that experiments write.
const WRITTEN: [&str; 4] = ["json", "csv", "svg", "png"];

/// The file of the experiment's own, by begin and end of its name, that this one is.
fn own_file<S: Study>(context: &Context<'_, S>, read: &Path) -> Option<PathBuf> {
    let (begin, name) = (context.file(""), read.file_name()?);
    let rest = name.to_str()?.strip_prefix(begin.file_name()?.to_str()?)?;
    let ending = rest.rsplit('.').next()?;
    let is_own = rest.starts_with(['-', '.']) && WRITTEN.iter().any(|written| written.eq_ignore_ascii_case(ending));
    let own = is_own.then(|| begin.with_file_name(name))?;
    (file::destination(&own) == file::destination(read)).then_some(own)
}

fn own_verb<S: Study>(name: &str, matches: &ArgMatches, typed: &Typed<'_, S>) -> Result<(), Failure> {
    let Some(verb) = S::verbs().into_iter().find(|verb| verb.name == name) else { return Ok(()) };
    let mut options = S::Options::default();
    read(matches, &S::options(), &mut options)?;
    let defaults = CommonArgs::defaults();
    let mut destinations = defaults.output.destinations();
    destinations.json = matches.get_one::<OsString>("json").map(PathBuf::from);
    let mut context = Context {
        name: verb.name,
        preset: typed.preset.clone(),
        setup: typed.resolve_one()?,
        options,
        given: given(matches),
        machine: defaults.machine.resolve(0),
        measure: defaults.measure.options(),
        destinations,
        shard: None,
        assembled: None,
        console: &Terminal { is_quiet: false },
        doubts: Doubts::default(),
    };
    let mut read = reading::named(&S::parameters(), &context.setup);
    read.extend(reading::named(&S::options(), &context.options));
    let json = context.destinations.json.iter().filter(|path| path.as_os_str() != "-");
    json.clone().try_for_each(|path| outcome::check_file(path))?;
    outcome::check_apart(json, &read)?;
    let ended = (verb.run)(&mut context);
    context.say_warnings()?;
    Ok(ended?)
}
