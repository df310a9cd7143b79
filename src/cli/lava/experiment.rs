//! `experiment NAME`: one figure of the thesis, its frame rate, or how the method scales.

use clap::{Args, ValueEnum};

use super::LavaArgs;
use crate::cli::experiment::{ExperimentArgs, NameArgs, Publication, name_of};
use crate::cli::failure::Failure;
use crate::cli::options::CommonArgs;
use crate::cli::outcome;
use crate::measure::machine::Machine;
use crate::measure::sweep::{Point, Swept};
use crate::papers::lava::experiments::figures::{Drawing, Drawn, Figure};
use crate::papers::lava::experiments::scaling::{self, Axis};
use crate::papers::lava::{experiments::results, setup::Setup};

/// The figures and tables that are reproduced.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Name {
    /// Figure 4.1: the position and the velocity texture
    #[value(name = "fig-4.1")]
    Fig41,
    /// Figure 4.2: the density texture, the normal/height texture, the heights as colour
    #[value(name = "fig-4.2")]
    Fig42,
    /// Figure 4.3: the depth texture, the calculated colour and the rock, the lava
    #[value(name = "fig-4.3")]
    Fig43,
    /// Figure 5.1: the texture of 65,536 particles
    #[value(name = "fig-5.1")]
    Fig51,
    /// Figure 5.2: the particles as points
    #[value(name = "fig-5.2")]
    Fig52,
    /// Figure 6.2: a density texture
    #[value(name = "fig-6.2")]
    Fig62,
    /// Figure 6.3: the normal/height texture
    #[value(name = "fig-6.3")]
    Fig63,
    /// Figure 6.4: normals and heights on the lava's surface
    #[value(name = "fig-6.4")]
    Fig64,
    /// Figure 7.1: the depth texture of the visibility pass
    #[value(name = "fig-7.1")]
    Fig71,
    /// Figure 7.2: the rock texture on the surface
    #[value(name = "fig-7.2")]
    Fig72,
    /// Figure 7.3: the calculated colours, and with the rock
    #[value(name = "fig-7.3")]
    Fig73,
    /// Figure 8.1: the lava from the side
    #[value(name = "fig-8.1")]
    Fig81,
    /// Figure 8.2: the lava, second camera
    #[value(name = "fig-8.2")]
    Fig82,
    /// Figure 8.3: the lava, third camera
    #[value(name = "fig-8.3")]
    Fig83,
    /// Figure 8.4: the lava, fourth camera
    #[value(name = "fig-8.4")]
    Fig84,
    /// Figure 8.5: four splat sizes
    #[value(name = "fig-8.5")]
    Fig85,
    /// Chapter 8: frames a second, beside the thesis's 20
    Results,
    /// Particles, splats and grid points against each pass's time, host work included
    Scaling,
}

#[derive(Debug, Clone, Args)]
pub struct Experiments {
    #[command(flatten)]
    asked: NameArgs<Name>,
    /// Frame of a figure's pictures and textures, 0 to 100000
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    frame: u32,
    #[command(flatten)]
    scene: LavaArgs,
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
        let is_figure = Figure::named(&name_of(&name)).is_some();
        let output = &self.common.output;
        vec![
            (!is_figure && self.frame > 0, "--frame: this experiment measures frames from 0 on; give --frames"),
            (is_figure && output.json.is_some(), "--json: a figure is pictures; `results` has a record"),
            (is_figure && output.csv.is_some(), "--csv: a figure is pictures; `results` has rows"),
            (
                is_figure && name != Name::Fig85 && self.scene.shading.is_some(),
                "--shading: the figure's parts have their own; render takes any",
            ),
            (
                name == Name::Fig85 && self.scene.splat_radius.is_some(),
                "--splat-radius: the figure's parts have their own; render takes any",
            ),
        ]
    }

    fn perform(&self, name: Name, publication: &Publication<'_>) -> Result<(), Failure> {
        let figure = Figure::named(&publication.name);
        let setup = match figure {
            Some(figure) => self.scene.over(figure.parameters(), Some(&publication.name)),
            None => self.scene.over(self.scene.preset_parameters(), Some(&publication.name)),
        };
        figure.map_or_else(|| setup.check(), |figure| figure.check(&setup))?;
        let points = match name {
            Name::Scaling => Axis::ALL.iter().flat_map(|axis| axis.points(&setup)).collect(),
            _ => vec![Point::single(&publication.name, setup.clone())],
        };
        scaling::check(&points)?;
        let mut machine = self.open()?;
        match figure {
            Some(figure) => self.draw(publication, &mut machine, figure, &setup)?,
            None => {
                let swept = self.sweep(publication, &mut machine, &points)?;
                self.publish(publication, &machine, name, swept)?;
            }
        }
        machine.check_validation()?;
        Ok(())
    }
}

impl Experiments {
    fn draw(
        &self,
        publication: &Publication<'_>,
        machine: &mut Machine,
        figure: Figure,
        setup: &Setup,
    ) -> Result<(), Failure> {
        let Drawing { parts, warnings } = figure.draw(machine, setup, self.frame)?;
        for (suffix, drawn) in parts {
            let suffix = format!("{suffix}.png");
            match drawn {
                Drawn::Picture(picture) => publication.picture(&suffix, &picture)?,
                Drawn::Texture(texture) => publication.drawing(&suffix, &texture)?,
            }
        }
        warnings.iter().for_each(|warning| outcome::warn(publication.output, warning));
        Ok(())
    }

    fn publish(
        &self,
        publication: &Publication<'_>,
        machine: &Machine,
        name: Name,
        swept: Swept,
    ) -> Result<(), Failure> {
        let mut rows = swept.rows;
        if name == Name::Scaling {
            let facts = scaling::table(&rows);
            let plots = Axis::ALL
                .into_iter()
                .filter_map(|axis| {
                    let svg = scaling::plot(&rows, axis).transpose()?;
                    Some(svg.map(|svg| (format!("-{}.svg", axis.as_str().replace(' ', "-")), svg)))
                })
                .collect::<Result<Vec<_>, _>>()?;
            let runs = rows.into_iter().map(|row| row.run).collect();
            publication.save(&publication.file("-exponents.csv"), facts.csv().as_bytes())?;
            publication.runs(machine, runs, facts.render(outcome::style()), &plots)?;
        } else {
            for row in &mut rows {
                results::beside_the_thesis(&mut row.run);
                results::note_floors(&mut row.run);
            }
            let table = rows.iter().map(|row| results::render(&row.run, outcome::style())).collect();
            let plots = rows.iter().map(|row| results::plot(&row.run)).collect::<Result<Vec<_>, _>>()?;
            let plots: Vec<_> = plots.into_iter().map(|svg| (".svg".to_owned(), svg)).collect();
            publication.runs(machine, rows.into_iter().map(|row| row.run).collect(), table, &plots)?;
        }
        swept.stopped.map_or(Ok(()), |error| Err(error.into()))
    }
}
