//! Every variant against paths on which light is scattered any number of times.

use glam::{DVec3, Vec3};
use serde_json::{Value, json};

use super::Context;
use crate::image::compare::{distances, heat_map};
use crate::image::{Rgba8, Samples, compare};
use crate::measure::bench::build;
use crate::measure::machine::Machine;
use crate::measure::measure::Watch;
use crate::measure::picture::{self, read_target};
use crate::measure::result_table::ResultTable;
use crate::measure::study::Study;
use crate::measure::{Error, Paper as _, Variant as _, components};
use crate::papers::gas::reference::paths::{MOST_SCATTERINGS, Paths, Scattered};
use crate::papers::gas::setup::{Scene, Setup};
use crate::papers::gas::{Parameters, Variant};

/// Opacity above which a pixel counts.
const SEEN: f64 = 0.01;

const COLUMNS: &[&str] = &["gas", "ambient", "light", "of all", "rms", "Luv mean", "Luv p99"];

/// The gas without the scene's surfaces, which paths do not meet, by every variant.
///
/// # Errors
/// [`Error::Input`] for a scene without gas, with solids, or with a path that has no end; [`Error::Parameter`], [`Error::Scene`],
/// [`Error::Gpu`], [`Error::Image`], [`Error::Output`], [`Error::Interrupted`].
pub fn run(context: &mut Context<'_>) -> Result<(), Error> {
    let setup = context.setup.named();
    let mut scene = setup.load()?;
    scene.objects.clear();
    let parameters = setup.parameters_in(&scene).into_owned();
    if parameters.volumes.is_empty() {
        return Err(Error::Input("`preset`: the scene has no volume: give `volume`".to_owned()));
    }
    if parameters.volumes.iter().any(|volume| volume.is_solid) {
        let message = "`preset`: a solid has a surface, and paths are of gases alone; give another scene";
        return Err(Error::Input(message.to_owned()));
    }
    let mut machine = context.open()?;
    let mut traced = Err(Error::Interrupted);
    context
        .console
        .watch("gas reference", &mut |watch| traced = Truth::traced(&parameters, context.options.paths, watch));
    let truth = traced?;
    let mut rows = truth.own_rows()?;
    context.picture("-all.png", &truth.shown(|pixel| pixel.all)?)?;
    context.picture("-once.png", &truth.shown(|pixel| pixel.once)?)?;
    let all = truth.shown(|pixel| pixel.all)?;
    for &variant in Variant::ALL.iter().filter(|variant| **variant != Variant::NoVolume) {
        let drawn = Drawn::new(&mut machine, &setup, &scene, variant)?;
        rows.push(truth.row(variant.as_str(), parameters.ambient, &drawn)?);
        let heat = heat_map(all.width(), all.height(), &distances(&drawn.picture, &all)?)?;
        context.picture(&format!("-{}-difference.png", variant.as_str()), &heat)?;
    }
    rows.push(truth.nearest_ambient(&mut machine, &setup, &scene)?);
    let title = "Gas of each variant beside light that is scattered any number of times";
    context.publish_table(&machine, &ResultTable { title, columns: COLUMNS, rows })
}

/// The gas that a variant draws.
struct Drawn {
    /// Light of the gas of each pixel, premultiplied.
    light: Vec<DVec3>,
    picture: Rgba8,
}

impl Drawn {
    fn new(machine: &mut Machine, setup: &Setup, scene: &Scene, variant: Variant) -> Result<Self, Error> {
        let mut built = build(machine, setup, scene, variant)?;
        let picture = picture::render(machine, &mut built.paper, 0)?;
        let background = setup.parameters.background.as_dvec3();
        let mut light = Vec::new();
        for target in built.paper.targets().iter().filter(|target| target.name == "radiance") {
            if let Samples::F32(values) = read_target(&machine.device, target)?.samples() {
                let of_pixel = |texel: &[f32]| {
                    let passed = 1.0 - f64::from(texel[3]);
                    Vec3::from_slice(texel).as_dvec3() - background * passed
                };
                light = values.chunks_exact(4).map(of_pixel).collect();
            }
        }
        Ok(Drawn { light, picture })
    }
}

/// The pixels as the paths have them.
struct Truth<'a> {
    parameters: &'a Parameters,
    pixels: Vec<Scattered>,
    /// Those that count.
    mask: Vec<bool>,
}

impl<'a> Truth<'a> {
    fn traced(parameters: &'a Parameters, paths: u32, watch: &mut Watch<'_>) -> Result<Self, Error> {
        // Paths ask the functions, whatever the variants' rays read.
        let own = Parameters { density_cache: None, ..parameters.clone() };
        let all = Paths::new(&own, own.scene_frame(0));
        let mut pixels = Vec::new();
        for row in 0..own.height {
            watch.check()?;
            let traced = all.row(row, paths).ok_or_else(|| {
                let message = "`tau`: light is scattered more than";
                Error::Input(format!("{message} {MOST_SCATTERINGS} times on some path; lower `tau` or `albedo`"))
            })?;
            pixels.extend(traced);
            (watch.progress)(u64::from(row) + 1, u64::from(own.height));
        }
        let mask = pixels.iter().map(|pixel| 1.0 - pixel.transparency > SEEN).collect();
        Ok(Truth { parameters, pixels, mask })
    }

    /// Pixels that count, with the number of each.
    fn counted(&self) -> impl Iterator<Item = (usize, &Scattered)> {
        self.pixels.iter().enumerate().filter(|(at, _)| self.mask[*at])
    }

    /// A mean over the pixels that count and their channels.
    fn mean(&self, of: impl Fn(usize, &Scattered) -> DVec3) -> f64 {
        let count = self.counted().count().max(1);
        self.counted().map(|(at, pixel)| of(at, pixel).element_sum() / 3.0).sum::<f64>() / count as f64
    }

    /// The mean of both halves as a picture over the background.
    fn shown(&self, halves: impl Fn(&Scattered) -> [DVec3; 2]) -> Result<Rgba8, Error> {
        self.picture(|pixel| middle(halves(pixel)))
    }

    fn picture(&self, light: impl Fn(&Scattered) -> DVec3) -> Result<Rgba8, Error> {
        let background = self.parameters.background.as_dvec3();
        let texel = |pixel: &Scattered| {
            let [r, g, b] = (light(pixel) + background * pixel.transparency).as_vec3().to_array();
            [r, g, b, 1.0]
        };
        let linear: Vec<f32> = self.pixels.iter().flat_map(texel).collect();
        Ok(Rgba8::from_linear(self.parameters.width, self.parameters.height, &linear)?)
    }

    /// Root mean square of the distance of some light from all light; the halves' product has no noise in its mean.
    fn rms(&self, light: impl Fn(usize, &Scattered) -> [DVec3; 2]) -> f64 {
        let square = self.mean(|at, pixel| {
            let [a, b] = light(at, pixel);
            (a - pixel.all[0]) * (b - pixel.all[1])
        });
        square.max(0.0).sqrt()
    }

    /// The truth itself, with the noise of its mean as its distance, and what of it was scattered once.
    fn own_rows(&self) -> Result<Vec<Vec<Value>>, Error> {
        let light = |halves: fn(&Scattered) -> [DVec3; 2]| self.mean(|_, pixel| middle(halves(pixel)));
        let (all, once) = (light(|pixel| pixel.all), light(|pixel| pixel.once));
        let apart = |pixel: &Scattered| pixel.all[0] - pixel.all[1];
        let noise = self.mean(|_, pixel| apart(pixel) * apart(pixel)).sqrt() / 2.0;
        let [first, second] = [0, 1].map(|half: usize| self.picture(|pixel| pixel.all[half]));
        // Of the mean, half of what it is between the halves.
        let between = compare(&first?, &second?, Some(&self.mask))?;
        let seen = compare(&self.shown(|pixel| pixel.once)?, &self.shown(|pixel| pixel.all)?, Some(&self.mask))?;
        let ambient = components(self.parameters.ambient);
        let once_rms = self.rms(|_, pixel| pixel.once);
        Ok(vec![
            vec![
                json!("scattered at will"),
                json!(ambient),
                json!(all),
                json!(1.0),
                json!(noise),
                json!(between.mean / 2.0),
                json!(between.p99 / 2.0),
            ],
            vec![
                json!("scattered once"),
                json!(ambient),
                json!(once),
                json!(once / all),
                json!(once_rms),
                json!(seen.mean),
                json!(seen.p99),
            ],
        ])
    }

    fn row(&self, name: &str, ambient: Vec3, drawn: &Drawn) -> Result<Vec<Value>, Error> {
        let seen = compare(&drawn.picture, &self.shown(|pixel| pixel.all)?, Some(&self.mask))?;
        let light = self.mean(|at, _| drawn.light[at]);
        let all = self.mean(|_, pixel| middle(pixel.all));
        Ok(vec![
            json!(name),
            json!(components(ambient)),
            json!(light),
            json!(light / all),
            json!(self.rms(|at, _| [drawn.light[at]; 2])),
            json!(seen.mean),
            json!(seen.p99),
        ])
    }

    /// `traced` under the ambient light by which it comes the nearest, channel by channel: the light without any is fixed, and
    /// what ambient light adds is proportional to it.
    fn nearest_ambient(&self, machine: &mut Machine, setup: &Setup, scene: &Scene) -> Result<Vec<Value>, Error> {
        let mut draw = |ambient: Vec3| {
            let mut setup = setup.clone();
            setup.parameters.ambient = ambient;
            Drawn::new(machine, &setup, scene, Variant::Traced)
        };
        let (dark, bright) = (draw(Vec3::ZERO)?, draw(Vec3::ONE)?);
        let (mut products, mut squares) = (DVec3::ZERO, DVec3::ZERO);
        for (at, pixel) in self.counted() {
            let added = bright.light[at] - dark.light[at];
            products += added * (middle(pixel.all) - dark.light[at]);
            squares += added * added;
        }
        let nearest = (products / squares.max(DVec3::splat(1e-30))).as_vec3().clamp(Vec3::ZERO, Vec3::splat(64.0));
        self.row("traced, nearest ambient", nearest, &draw(nearest)?)
    }
}

fn middle([a, b]: [DVec3; 2]) -> DVec3 {
    (a + b) / 2.0
}
