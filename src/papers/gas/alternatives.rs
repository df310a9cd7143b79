//! Alternatives of one picture: methods of its lists of fragments, of its rays and of its densities. A bench takes several and
//! measures them in turn.

use serde_json::{Map, Value as Json, json};

use super::parameters::or_off::OrOff;
use super::parameters::{Lists, March, Parameters};
use crate::field;
use crate::measure::Error;
use crate::measure::config::entries;
use crate::measure::parameter::{self, Cost, Given, Parameter, Range, Value};
use crate::papers::gas::model::Volume;

/// The methods that are asked for, of each kind at least one.
#[derive(Debug, Clone)]
pub struct Alternatives {
    /// Methods of the lists of fragments.
    pub lists: Vec<Lists>,
    /// Methods of rays through the gas.
    pub marches: Vec<March>,
    /// Entries of the tables of densities that rays read.
    pub density_caches: Vec<OrOff<u32>>,
    /// The optical depths that skipped bricks may have.
    pub skips: Vec<OrOff<f32>>,
    /// Columns and rows from one pixel whose gas is marched to the next.
    pub scales: Vec<u32>,
}

/// The paper's.
impl Default for Alternatives {
    fn default() -> Self {
        Alternatives {
            lists: vec![Lists::Linked],
            marches: vec![March::Steps],
            density_caches: vec![OrOff(None)],
            skips: vec![OrOff(None)],
            scales: vec![1],
        }
    }
}

impl Alternatives {
    /// Each option once.
    pub fn declared() -> Vec<Parameter<Alternatives>> {
        vec![
            Parameter::new("lists", field!(Alternatives.lists))
                .help(
                    "The way to the lists of fragments. linked: the rasteriser draws a box around each triangle, and \
                     fragments are linked as they come; tiles: triangles are put into tiles of 8 x 8 pixels, and of what \
                     an opaque triangle hides that fills a pixel only the next fragment is kept; k:N: as tiles, but a \
                     pixel keeps its N nearest fragments alone, 1 to 32. bench takes several, comma-separated, and \
                     measures them in turn",
                )
                .section("Combining A-buffer and volume rendering techniques")
                .cost(Cost::Pipelines)
                .unrecorded(),
            Parameter::new("march", field!(Alternatives.marches))
                .help(
                    "The way of rays through the gas. steps: in increments of a step; delta: by delta tracking, and of \
                     shadows that are traced by ratio tracking, whose mean is the integral, with `samples` ways of a ray \
                     through each section of gas. bench takes several, comma-separated, and measures them in turn",
                )
                .section("Volume rendering")
                .cost(Cost::Pipelines)
                .unrecorded(),
            Parameter::new("density-cache", field!(Alternatives.density_caches))
                .range(Range::from(2.0).to(512.0))
                .help(
                    "Entries along each axis of a table of the densities' values, made in every frame, which rays read in \
                     place of functions and files. bench takes several, comma-separated, and measures them in turn",
                )
                .section("Discussion of results")
                .cost(Cost::Pipelines)
                .unrecorded(),
            Parameter::new("skip-empty", field!(Alternatives.skips))
                .range(Range::from(0.0).to(100.0))
                .help(
                    "Rays skip bricks of a volume in which one through all of it loses at most this optical depth: 0 for \
                     those without any density, which leaves the picture as it is. bench takes several, comma-separated, \
                     and measures them in turn",
                )
                .section("Volume rendering")
                .cost(Cost::Pipelines)
                .unrecorded(),
            Parameter::new("volume-scale", field!(Alternatives.scales))
                .range(Range::from(1.0).to(16.0))
                .help(
                    "Gas is marched in the pixels of every so many columns and rows; the others take it from those around \
                     them that see it between the same surfaces, and march it where none does. bench takes several, \
                     comma-separated, and measures them in turn",
                )
                .section("Volume rendering")
                .cost(Cost::Buffers)
                .unrecorded(),
        ]
    }

    /// Checks that no method stands there twice.
    ///
    /// # Errors
    /// [`Error::Input`] with the first that does.
    pub fn check_distinct(&self) -> Result<(), Error> {
        check_once("lists", &self.lists)?;
        check_once("march", &self.marches)?;
        check_once("density-cache", &self.density_caches)?;
        check_once("skip-empty", &self.skips)?;
        check_once("volume-scale", &self.scales)
    }

    /// Checks every range, and refuses what makes no difference to any alternative.
    ///
    /// # Errors
    /// [`Error::Parameter`] for one outside of its range, [`Error::Input`] with one that was given in vain.
    pub fn check_used(&self, given: &Given, volumes: &[Volume]) -> Result<(), Error> {
        parameter::check(&Self::declared(), self)?;
        let first =
            ["march", "density-cache", "skip-empty", "volume-scale", "bricks"].into_iter().find(|name| given.has(name));
        if let Some(name) = first.filter(|_| volumes.is_empty()) {
            return Err(Error::Input(format!("`{name}`: the scene has no volume: give `volume`")));
        }
        let has_bricks = self.marches.contains(&March::Delta) || self.skips.iter().any(|skip| skip.0.is_some());
        if given.has("bricks") && !has_bricks {
            let message = "`bricks`: no ray asks for them: give `skip-empty`, or `march` delta";
            return Err(Error::Input(message.to_owned()));
        }
        // Of a solid the normals are found at a quarter of a step.
        let has_steps = self.marches != [March::Delta] || volumes.iter().any(|volume| volume.is_solid);
        if given.has("steps") && !has_steps {
            return Err(Error::Input("`steps`: `march` delta has none: give `samples`".to_owned()));
        }
        Ok(())
    }

    /// Each alone, those of the last kind changing fastest.
    pub fn alone(&self) -> Vec<Alternatives> {
        let mut all = Vec::new();
        for &lists in &self.lists {
            for &march in &self.marches {
                for &cache in &self.density_caches {
                    for &skip in &self.skips {
                        let of = |&scale| Alternatives {
                            lists: vec![lists],
                            marches: vec![march],
                            density_caches: vec![cache],
                            skips: vec![skip],
                            scales: vec![scale],
                        };
                        all.extend(self.scales.iter().map(of));
                    }
                }
            }
        }
        all
    }

    /// Sets the first ones.
    pub fn apply(&self, parameters: &mut Parameters) {
        parameters.lists = self.lists.first().copied().unwrap_or(Lists::Linked);
        parameters.march = self.marches.first().copied().unwrap_or(March::Steps);
        parameters.density_cache = OrOff::first(&self.density_caches);
        parameters.skip_empty = OrOff::first(&self.skips);
        parameters.volume_scale = self.scales.first().copied().unwrap_or(1);
    }
}

impl Parameters {
    /// The methods as the record has them.
    pub(super) fn alternative_config(&self) -> Map<String, Json> {
        entries([
            ("lists", self.lists.json()),
            ("march", self.march.json()),
            ("density_cache", json!(self.density_cache)),
            ("skip_empty", json!(self.skip_empty)),
            ("volume_scale", json!(self.volume_scale)),
        ])
    }

    /// The same in words, where it is not the paper's.
    pub(super) fn alternative_text(&self) -> String {
        let mut text = self.lists.text();
        if self.march == March::Delta {
            text += ", delta tracking";
        }
        if let Some(entries) = self.density_cache {
            text += &format!(", densities from {entries} entries a side");
        }
        if let Some(depth) = self.skip_empty {
            text += &format!(", bricks up to {depth} skipped");
        }
        if self.volume_scale > 1 {
            text += &format!(", gas of every {}th column and row", self.volume_scale);
        }
        text
    }
}

fn check_once<T: Value + PartialEq>(name: &str, methods: &[T]) -> Result<(), Error> {
    let Some((_, twice)) = methods.iter().enumerate().find(|(at, method)| methods[..*at].contains(method)) else {
        return Ok(());
    };
    Err(Error::Input(format!("`{name}`: {} stands there twice; name each once", twice.text())))
}
