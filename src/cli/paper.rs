//! A paper's command line as the verbs see it; the verbs themselves are the same for all papers.

use std::convert::Infallible;
use std::fmt::Debug;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use super::bench::{self, BenchArgs};
use super::experiment::ExperimentArgs;
use super::failure::Failure;
use super::passes::{self, PassesArgs};
use super::render::{self, RenderArgs};
use crate::measure::Variant;
use crate::measure::study::Study;

/// A paper's scene options.
pub trait PaperArgs: Args + Clone + Debug + 'static {
    type Study: Study;
    /// The options of its verb `experiment`.
    type Experiment: ExperimentArgs<Study = Self::Study>;
    /// The verbs that no other paper has.
    type Own: OwnVerbs;

    /// One line on the paper.
    const ABOUT: &'static str;
    /// Variants of a bench that names none, comma-separated.
    const BENCHED: &'static str;
    /// The variant of a picture that names neither one nor a preset.
    const RENDERED: &'static str;

    /// The setup: typed values, over the preset's numbers, over the defaults.
    ///
    /// # Errors
    /// [`Failure::Input`] for options of which one would not be heeded.
    fn resolve(&self) -> Result<Self::Study, Failure>;

    /// The variant that the named preset is made for, where it is one alone.
    fn preset_variant(&self) -> Option<VariantOf<Self>> {
        None
    }

    /// The variant of a picture that names none: the preset's, or the paper's.
    fn rendered(&self) -> VariantOf<Self> {
        self.preset_variant().or_else(|| find(Self::RENDERED)).unwrap_or(VariantOf::<Self>::ALL[0])
    }

    /// The study that the main job measures, in the variants of [`PaperArgs::BENCHED`].
    fn quick() -> Self::Study;
}

/// A paper's own verbs; [`Infallible`] where there are none.
pub trait OwnVerbs: Subcommand + Debug + 'static {
    fn run(&self) -> Result<(), Failure>;
}

impl OwnVerbs for Infallible {
    fn run(&self) -> Result<(), Failure> {
        match *self {}
    }
}

pub type VariantOf<P> = <<P as PaperArgs>::Study as Study>::Variant;

/// One value of `--variant`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VariantWord<V> {
    One(V),
    All,
}

fn find<V: Variant>(word: &str) -> Option<V> {
    V::ALL.iter().copied().find(|v| v.as_str() == word)
}

/// Values of a list of variants: each variant's name, and `all`.
pub fn variant_words<V: Variant>() -> impl TypedValueParser<Value = VariantWord<V>> {
    PossibleValuesParser::new(V::ALL.iter().map(|v| v.as_str()).chain(["all"]))
        .map(|word| find(&word).map_or(VariantWord::All, VariantWord::One))
}

/// The value of one variant.
pub fn variant_word<V: Variant>() -> impl TypedValueParser<Value = V> {
    // The parser has let through no other value than a variant's name.
    PossibleValuesParser::new(V::ALL.iter().map(|v| v.as_str())).map(|word| find(&word).unwrap_or(V::ALL[0]))
}

/// The variants that a list of values means, in the paper's order, each once.
pub fn resolve<V: Variant>(words: &[VariantWord<V>]) -> Vec<V> {
    let wanted = |v: &V| words.contains(&VariantWord::All) || words.contains(&VariantWord::One(*v));
    V::ALL.iter().copied().filter(wanted).collect()
}

/// The variants of a bench that names none.
pub fn benched<P: PaperArgs>() -> Vec<VariantOf<P>> {
    let words = P::BENCHED.split(',').filter_map(find).map(VariantWord::One);
    resolve(&words.collect::<Vec<_>>())
}

/// The variants that were named, or else the preset's, or else `usual`.
pub fn chosen<P: PaperArgs>(
    words: &[VariantWord<VariantOf<P>>],
    scene: &P,
    usual: impl FnOnce() -> Vec<VariantOf<P>>,
) -> Vec<VariantOf<P>> {
    match (words, scene.preset_variant()) {
        ([], Some(variant)) => vec![variant],
        ([], None) => usual(),
        (words, _) => resolve(words),
    }
}

/// The verbs of a paper.
#[derive(Debug, Subcommand)]
pub enum Verb<P: PaperArgs> {
    /// List the passes in the paper's order
    Passes(Box<PassesArgs<P>>),
    /// Time one configuration in one or more variants, interleaved
    Bench(Box<BenchArgs<P>>),
    /// Reproduce one table or figure, ours beside the paper's
    Experiment(Box<P::Experiment>),
    /// Write pictures and intermediate targets
    Render(Box<RenderArgs<P>>),
    #[command(flatten)]
    Own(P::Own),
}

/// A paper as a subcommand of `fumarole`.
#[derive(Debug, Args)]
pub struct PaperCommand<P: PaperArgs> {
    #[command(subcommand)]
    verb: Verb<P>,
}

impl<P: PaperArgs> PaperCommand<P> {
    pub fn run(&self) -> Result<(), Failure> {
        match &self.verb {
            Verb::Passes(arguments) => passes::run(arguments),
            Verb::Bench(arguments) => bench::run(arguments),
            Verb::Experiment(arguments) => arguments.run(),
            Verb::Render(arguments) => render::run(arguments),
            Verb::Own(verb) => verb.run(),
        }
    }
}

#[derive(Debug, Parser)]
#[command(version, propagate_version = true)]
struct Binary<P: PaperArgs> {
    #[command(flatten)]
    command: PaperCommand<P>,
}

/// Runs a paper's own binary.
pub fn binary<P: PaperArgs>() -> Result<(), Failure> {
    let command = Binary::<P>::command().name(P::Study::PAPER).bin_name(P::Study::PAPER).about(P::ABOUT);
    let parsed = Binary::<P>::from_arg_matches(&command.get_matches()).unwrap_or_else(|error| error.exit());
    parsed.command.run()
}
