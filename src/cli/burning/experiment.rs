//! `experiment NAME`: one table or figure of the dissertation, what its optimisations buy, or how the method scales.

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};

use super::BurningArgs;
use crate::cli::experiment::{ExperimentArgs, NameArgs, Publication};
use crate::cli::failure::Failure;
use crate::cli::options::CommonArgs;
use crate::cli::outcome;
use crate::cli::watch::watched;
use crate::measure::machine::Machine;
use crate::measure::result_table::ResultTable;
use crate::measure::sweep::{Point, Row, Swept};
use crate::papers::burning::Variant;
use crate::papers::burning::experiments::course::{Look, follow};
use crate::papers::burning::experiments::rates::{CLAIMS, Claim};
use crate::papers::burning::experiments::refining::{self, Line, Measured, is_half_refined};
use crate::papers::burning::experiments::strips::{FIGURES, Figure};
use crate::papers::burning::experiments::sweeps::{self, Limited};
use crate::papers::burning::setup::Setup;

/// The tables and figures that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Section 3.8: frames a second of a shell at its busiest, beside the dissertation's 70
    #[value(name = "3.8")]
    Results38,
    /// Table 4.2: refining where it burns against subdividing everything, until half is refined
    #[value(name = "4.2")]
    Table42,
    /// Section 5.5: frames a second of a solid of 45,000 triangles, beside 60
    #[value(name = "5.5")]
    Results55,
    /// Section 6.5: frames a second of 40,000 melting triangles, beside 60
    #[value(name = "6.5")]
    Results65,
    /// Section 3.7.3: blocks from 1 to 27,000
    Blocks,
    /// Sections 3.7.1 and 3.7.2: limits of the active vertices, and ticks spread over frames
    Limits,
    /// The picture strips of figures 3.1 to 6.5
    Sequence,
    /// 1,000 to 1,000,000 triangles: active triangles a second of each simulation pass
    Scaling,
}

impl Name {
    fn claim(self) -> Option<Claim> {
        let section = match self {
            Name::Results38 => "3.8",
            Name::Results55 => "5.5",
            Name::Results65 => "6.5",
            _ => return None,
        };
        CLAIMS.into_iter().find(|claim| claim.section == section)
    }
}

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    #[command(flatten)]
    asked: NameArgs<Name>,
    /// Figures of `sequence`, comma-separated [default: all]
    #[arg(long, value_name = "F,F,..", value_delimiter = ',', value_parser = PossibleValuesParser::new(FIGURES))]
    figures: Vec<String>,
    /// Frames of the strips of `sequence`, comma-separated and rising, each 0 to 100000 [default: each figure's own]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(0..=100_000))]
    moments: Vec<u32>,
    /// Triangles of `scaling`, comma-separated [default: 1000 to 1000000, two a decade]
    #[arg(long, value_name = "N,N,..", value_delimiter = ',')]
    counts: Vec<u32>,
    #[command(flatten)]
    scene: BurningArgs,
    #[command(flatten)]
    common: CommonArgs,
}

impl ExperimentArgs for Experiments {
    type Study = Setup;
    type Name = Name;

    const FRAMES: u32 = 3;
    const REPEAT: u32 = 3;

    fn asked(&self) -> &NameArgs<Name> {
        &self.asked
    }

    fn common(&self) -> &CommonArgs {
        &self.common
    }

    fn unsuited(&self, name: Name) -> Vec<(bool, &'static str)> {
        let (output, scene) = (&self.common.output, &self.scene);
        let is_sequence = name == Name::Sequence;
        let is_scaling = name == Name::Scaling;
        let is_table = name == Name::Table42;
        // Their frames are found by following the fire.
        let finds_frames = !is_sequence && !is_scaling;
        let has_preset = !matches!(name, Name::Blocks | Name::Limits);
        vec![
            (!is_sequence && !self.figures.is_empty(), "--figures: this experiment draws none; sequence does"),
            (!is_sequence && !self.moments.is_empty(), "--moments: this experiment draws none; sequence does"),
            (!self.moments.is_sorted_by(|a, b| a < b), "--moments: the frames must rise"),
            (!is_scaling && !self.counts.is_empty(), "--counts: this experiment has none; scaling does"),
            (has_preset && scene.preset.is_some(), "--preset: this experiment has its own objects"),
            (finds_frames && scene.first_frame.is_some(), "--first-frame: this experiment finds its own frames"),
            (finds_frames && scene.time_step.is_some(), "--time-step: this experiment measures a tick a frame"),
            (
                is_table && self.common.measure.frames.is_some(),
                "--frames: this experiment measures all until half is refined",
            ),
            (is_table && scene.time_division.is_some(), "--time-division: this experiment measures a tick a frame"),
            (is_table && scene.triangles.is_some(), "--triangles: this experiment has its own counts"),
            (is_scaling && scene.triangles.is_some(), "--triangles: this experiment sweeps them; give --counts"),
            (name == Name::Blocks && scene.blocks.is_some(), "--blocks: this experiment sweeps them"),
            (name == Name::Limits && scene.active_limit.is_some(), "--active-limit: this experiment sweeps it"),
            (name == Name::Limits && scene.time_division.is_some(), "--time-division: this experiment sweeps it"),
            (name == Name::Limits && scene.no_preload, "--no-preload: this experiment measures both"),
            (is_sequence && output.json.is_some(), "--json: a sequence is pictures; `3.8` has a record"),
            (is_sequence && output.csv.is_some(), "--csv: a sequence is pictures; `3.8` has rows"),
        ]
    }

    fn perform(&self, name: Name, publication: &Publication<'_>) -> Result<(), Failure> {
        match name {
            Name::Results38 | Name::Results55 | Name::Results65 => {
                name.claim().map_or(Ok(()), |claim| self.claim(publication, claim))
            }
            Name::Table42 => self.table(publication),
            Name::Blocks => self.blocks(publication),
            Name::Limits => self.limits(publication),
            Name::Sequence => self.sequence(publication),
            Name::Scaling => self.scaling(publication),
        }
    }
}

impl Experiments {
    /// Follows a fire under a progress bar.
    fn follow(
        &self,
        machine: &mut Machine,
        setup: &Setup,
        variant: Variant,
        step: u32,
        is_enough: impl Fn(&Look) -> bool,
    ) -> Result<Vec<Look>, Failure> {
        Ok(watched(self.common.output.quiet, "following the fire", |watch| {
            follow(machine, setup, variant, step, watch, is_enough)
        })?)
    }

    fn claim(&self, publication: &Publication<'_>, claim: Claim) -> Result<(), Failure> {
        let setup = self.scene.over(claim.preset.setup());
        setup.check()?;
        let mut machine = self.open()?;
        let looks = self.follow(&mut machine, &setup, claim.preset.variant(), STEP, |_| false)?;
        let mut swept = self.sweep(publication, &mut machine, &[claim.point(&setup, &looks)?])?;
        swept.rows.iter_mut().for_each(|row| claim.note(&mut row.run));
        let style = outcome::style();
        let table = swept.rows.iter().map(|row| claim.render(&row.label, &row.run, style)).collect();
        let plots = swept.rows.iter().map(|row| Ok((".svg".to_owned(), claim.plot(&row.run)?)));
        let plots = plots.collect::<Result<Vec<_>, Failure>>()?;
        publish(publication, &machine, swept.rows, table, &plots)?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    fn table(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let setups = refining::TABLE.map(|line| line.setup(&|setup| self.scene.over(setup)));
        setups.iter().try_for_each(Setup::check)?;
        let mut machine = self.open()?;
        let mut measured = Vec::new();
        let mut stopped = None;
        for (line, setup) in refining::TABLE.into_iter().zip(&setups) {
            let (looks, swept) = self.refining(publication, &mut machine, line, setup)?;
            measured.push(Measured::new(line, looks, swept.rows));
            stopped = swept.stopped;
            if stopped.is_some() {
                break;
            }
        }
        let (passes, curves) = (refining::passes(&measured), refining::curves(&measured));
        publication.save(&publication.file("-passes.csv"), passes.csv().as_bytes())?;
        publication.save(&publication.file("-curves.csv"), curves.csv().as_bytes())?;
        let (table, plot) = (refining::render(&measured, outcome::style()), refining::plot(&measured)?);
        let rows = measured.into_iter().flat_map(Measured::into_rows).collect();
        publish(publication, &machine, rows, table, &[(".svg".to_owned(), plot)])?;
        machine.check_validation()?;
        stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    /// Every frame of one box until half of its coarse triangles are refined, once unless more is asked for.
    fn refining(
        &self,
        publication: &Publication<'_>,
        machine: &mut Machine,
        line: Line,
        setup: &Setup,
    ) -> Result<(Vec<Look>, Swept), Failure> {
        let looks = self.follow(machine, setup, Variant::LowPoly, 1, is_half_refined)?;
        let mut all = self.clone();
        all.common.measure.frames = Some(looks.len() as u32);
        all.common.measure.repeat = self.common.measure.repeat.or(Some(1));
        let swept = all.sweep(publication, machine, &line.points(setup))?;
        Ok((looks, swept))
    }

    fn blocks(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let setup = self.scene.over(self.scene.preset_or_default());
        setup.check()?;
        let mut machine = self.open()?;
        let looks = self.follow(&mut machine, &setup, Variant::Shell, STEP, |_| false)?;
        let points = sweeps::block_points(&setup, sweeps::busiest_tick(&looks)?);
        let mut swept = self.sweep(publication, &mut machine, &points)?;
        let facts = sweeps::block_table(&mut swept.rows);
        let plot = facts
            .bars("ms", &["weights ms", "rotation ms", "mapping ms", "flames ms"])
            .map_err(crate::measure::Error::from)?;
        publish_facts(publication, &machine, swept.rows, &facts, &[(".svg".to_owned(), plot)])?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }

    fn limits(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let setup = self.scene.over(self.scene.preset_or_default());
        setup.check()?;
        let mut machine = self.open()?;
        let free = self.follow(&mut machine, &setup, Variant::Shell, STEP, |_| false)?;
        let mut fires = Vec::new();
        for limit in sweeps::limits(&free) {
            let looks = match limit {
                0 => free.clone(),
                _ => self.follow(&mut machine, &sweeps::limited(&setup, limit), Variant::Shell, STEP, |_| false)?,
            };
            fires.push(Limited { limit, looks });
        }
        let limited = self.sweep(publication, &mut machine, &sweeps::limit_points(&setup, &fires))?;
        // Whole ticks under every division.
        let mut all = self.clone();
        all.common.measure.frames = self.common.measure.frames.or(sweeps::DIVISIONS.last().map(|most| 2 * most));
        let divided = all.sweep(publication, &mut machine, &sweeps::division_points(&setup, &free)?)?;
        let loaded = self.sweep(publication, &mut machine, &sweeps::loading_points(&setup, &free)?)?;
        let tables = [
            sweeps::limit_table(&fires, &limited.rows),
            sweeps::division_table(&divided.rows),
            sweeps::loading_table(&loaded.rows),
        ];
        publication.save(&publication.file("-active.csv"), tables[0].csv().as_bytes())?;
        publication.save(&publication.file("-division.csv"), tables[1].csv().as_bytes())?;
        publication.save(&publication.file("-loading.csv"), tables[2].csv().as_bytes())?;
        let text = tables.iter().map(|table| table.render(outcome::style())).collect::<Vec<_>>().join("\n");
        publish(
            publication,
            &machine,
            limited.rows.into_iter().chain(divided.rows).chain(loaded.rows).collect(),
            text,
            &[],
        )?;
        machine.check_validation()?;
        limited.stopped.or(divided.stopped).or(loaded.stopped).map_or(Ok(()), |error| Err(error.into()))
    }

    fn sequence(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let wanted = |name: &str| self.figures.is_empty() || self.figures.iter().any(|figure| figure == name);
        let mut figures: Vec<Figure> =
            FIGURES.into_iter().filter(|name| wanted(name)).filter_map(Figure::named).collect();
        for figure in &mut figures {
            if !self.moments.is_empty() {
                figure.frames.clone_from(&self.moments);
            }
            for strip in &mut figure.strips {
                strip.setup = self.scene.over(strip.setup.clone());
                strip.setup.check()?;
            }
        }
        let mut machine = self.open()?;
        for figure in figures {
            let drawn = figure.draw(&mut machine)?;
            publication.picture(&format!("-{}.png", figure.name), &drawn)?;
        }
        machine.check_validation()?;
        Ok(())
    }

    fn scaling(&self, publication: &Publication<'_>) -> Result<(), Failure> {
        let setup = self.scene.over(sweeps::scaling_setup());
        let counts = if self.counts.is_empty() { &sweeps::COUNTS[..] } else { &self.counts };
        let points: Vec<Point<Setup>> = sweeps::scaling_points(&setup, counts);
        points.iter().try_for_each(|point| point.study.check())?;
        let mut machine = self.open()?;
        let swept = self.sweep(publication, &mut machine, &points)?;
        let facts = sweeps::scaling_table(&swept.rows);
        publication.save(&publication.file("-rates.csv"), facts.csv().as_bytes())?;
        let plot = sweeps::scaling_plot(&swept.rows)?;
        publish_facts(publication, &machine, swept.rows, &facts, &[(".svg".to_owned(), plot)])?;
        machine.check_validation()?;
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }
}

/// Ticks between two looks at a fire that is followed.
const STEP: u32 = 10;

fn publish(
    publication: &Publication<'_>,
    machine: &Machine,
    rows: Vec<Row>,
    table: String,
    plots: &[(String, String)],
) -> Result<(), Failure> {
    publication.runs(machine, rows.into_iter().map(|row| row.run).collect(), table, plots)
}

fn publish_facts(
    publication: &Publication<'_>,
    machine: &Machine,
    rows: Vec<Row>,
    facts: &ResultTable,
    plots: &[(String, String)],
) -> Result<(), Failure> {
    publish(publication, machine, rows, facts.render(outcome::style()), plots)
}
