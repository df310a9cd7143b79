//! A user's set-up, its scene, and the results of its runs.

use std::borrow::Cow;

use serde_json::{Map, Value, json};

use super::axes;
use super::experiments::{self, Options};
use super::kinds;
use crate::field;
use crate::gpu::{self, Device, Feature, ShaderLibrary};
use crate::measure::Error;
use crate::measure::Paper;
use crate::measure::bench::Built;
use crate::measure::config::{add_object_triangles, entries};
use crate::measure::estimate::{DRAWN_BYTES, Estimate};
use crate::measure::experiment::Experiment;
use crate::measure::machine::Machine;
use crate::measure::measure::Measurement;
use crate::measure::parameter::{self, Cost, Given, Parameter};
use crate::measure::parameter::{Choice as _, Value as _};
use crate::measure::statistics::median;
use crate::measure::stress::Axis;
use crate::measure::study::{Identity, Metrics, Preset, Study};
use crate::papers::lava::{
    Bed, DRAWN, Inflow, Kept, Lava, NEEDS, Object, Parameters, Particles, Rock, RockSource, Shading, Sides, Simulation,
    Variant,
};
use crate::scene::loading::CREASE_DEG;
use crate::scene::{HeightMapSource, Mesh, notes, promised_triangles};

/// A user's choice of everything.
#[derive(Debug, Clone)]
pub struct Setup {
    /// The numbers.
    pub parameters: Parameters,
    /// The rock texture.
    pub rock: RockSource,
    /// Height map of the ground under a fluid; without one the space's floor.
    pub bed: Option<HeightMapSource>,
    /// Polygon meshes in the simulation space.
    pub objects: Vec<Object>,
    /// Crease angle of meshes without normals, degrees.
    pub crease_deg: f32,
    /// Name of the preset or experiment that they come from.
    pub preset: Option<String>,
    /// Names of the parameters that were given.
    pub given: Given,
}

impl Default for Setup {
    fn default() -> Self {
        Setup {
            parameters: Parameters::default(),
            rock: RockSource::Plates,
            bed: None,
            objects: Vec::new(),
            crease_deg: CREASE_DEG,
            preset: None,
            given: Given::default(),
        }
    }
}

impl Setup {
    /// Those numbers, and nothing else.
    fn of(parameters: Parameters) -> Self {
        Setup { parameters, ..Setup::default() }
    }

    /// Those numbers of a crust whose cracks are its own.
    fn crusted(parameters: Parameters) -> Self {
        Setup { rock: RockSource::Crust, ..Setup::of(parameters) }
    }

    /// Checks the parameters, and that what is drawn can be drawn together.
    ///
    /// # Errors
    /// [`Error::Parameter`], [`Error::Input`].
    pub fn check(&self) -> Result<(), Error> {
        self.parameters.validate()?;
        if let Some([floor, top]) = self.parameters.temperatures_k {
            let refused = |problem| Err(Error::Input(format!("`temperatures` {floor},{top}: {problem}")));
            if self.parameters.simulation == Simulation::Sph {
                return refused("the fluid's particles carry their own; give `melt-temperature`");
            }
            if !self.parameters.is_blackbody {
                return refused("the constant colour has no temperature; give `color` blackbody");
            }
        }
        if let Some(bed) = &self.bed {
            let refused = |problem| Err(Error::Input(format!("`bed` {bed}: {problem}")));
            if self.parameters.simulation == Simulation::Free {
                return refused("free particles know no ground; give `simulation` sph");
            }
            if self.parameters.flow.sides == Sides::Periodic {
                return refused("a map does not repeat; choose `sides` walls");
            }
            if self.parameters.flow.vent.toe_m3 > 0.0 {
                return refused("where toes break out follows from the slope of a level floor; give `toe-volume` 0");
            }
        }
        match (self.objects.first(), self.parameters.shading) {
            (Some(object), Shading::Particles) => {
                let problem = "particles are points, without a surface that could hide it; choose another `shading`";
                Err(Error::Input(format!("`object` {}: {problem}", object.text())))
            }
            _ => Ok(()),
        }
    }

    /// The ground under the lava, which fits into the space with it.
    fn load_bed(&self) -> Result<Bed, Error> {
        let Some(source) = &self.bed else { return Ok(Bed::level()) };
        let Parameters { space_m, particles, flow, .. } = &self.parameters;
        let map = source.load()?;
        let (voids, percent) = (map.voids(), 100.0 * map.void_fraction());
        if voids > 0 {
            let filled = "they are filled from their neighbours";
            notes::tell(format!("`bed` {source}: {voids} samples, {percent:.1} %, are void: {filled}"));
        }
        let bed = Bed::of(&map, *space_m, flow.spacing_m(*particles));
        let lava_m = if flow.vent.effusion_m3_s > 0.0 { flow.vent.radius_m } else { flow.block_m.y };
        let (_, highest_m) = bed.highest();
        let needed_m = highest_m + f64::from(lava_m);
        if needed_m <= f64::from(space_m.y) {
            return Ok(bed);
        }
        let problem = format!(
            "it rises to {highest_m:.3} metres, and lava needs {lava_m} above it: make the `space` {needed_m:.3} metres high at least"
        );
        Err(Error::Input(format!("`bed` {source}: {problem}")))
    }
}

/// A setup with its particles placed, its rock decoded and its objects loaded.
pub struct Scene {
    /// As they start.
    pub particles: Particles,
    /// One of the two that we make, or that of a file.
    pub rock: Cow<'static, Rock>,
    /// In the simulation space, metres.
    pub objects: Vec<Mesh>,
}

impl Study for Setup {
    const PAPER: &'static str = "lava";
    const NEEDS: &'static [Feature] = &NEEDS;

    type Variant = Variant;
    type Scene = Scene;
    type Paper = Lava;

    /// Checks the parameters, decodes the rock, places the particles and loads the objects. A rock that is no PNG is an
    /// [`Error::Image`].
    fn load(&self) -> Result<Scene, Error> {
        self.check()?;
        let space_m = self.parameters.space_m;
        let objects =
            self.objects.iter().map(|object| object.load(space_m, self.crease_deg)).collect::<Result<_, _>>()?;
        let particles = Particles::of(&self.parameters).over(self.load_bed()?);
        // Last, for a small file can have many texels.
        let rock = self.rock.load()?;
        Ok(Scene { particles, rock, objects })
    }

    fn make(&self, shaders: &ShaderLibrary, label: &str, scene: &Scene, variant: Variant) -> Result<Lava, gpu::Error> {
        let (p, Scene { particles, rock, objects }) = (&self.parameters, scene);
        Ok(Lava::new(shaders, label, variant, p, particles, rock, objects)?.given(self.given.clone()))
    }

    fn reconfigure(&self, scene: &Scene, paper: &mut Lava, changed: &Given) -> Result<bool, Error> {
        if !changed.is_within(&DRAWN) {
            return Ok(false);
        }
        self.check()?;
        paper.set_drawn(&self.parameters, &scene.rock, &scene.objects)?;
        Ok(true)
    }

    fn estimate(&self, _: &Device, scene: &Scene, variant: Variant) -> Estimate {
        let mut estimate = self.parameters.estimate(variant, &scene.rock, &scene.objects);
        estimate.bytes.push(("bed", scene.particles.bed.bytes()));
        estimate
    }

    fn promised_triangles(&self) -> Result<u64, Error> {
        Ok(promised_triangles(self.objects.iter().map(|object| &object.source))?)
    }

    fn foresee(&self, triangles: u64, _: Variant) -> Estimate {
        Estimate { bytes: vec![("object", DRAWN_BYTES * triangles as f64)], ..Estimate::default() }
    }

    fn identity(&self) -> Identity {
        Identity::new(&self.preset, (self.parameters.width, self.parameters.height), self.parameters.seed)
    }

    fn config(&self, scene: &Scene, paper: &Lava) -> Map<String, Value> {
        let mut config = parameter::config(&Self::parameters(), self);
        config.insert("surface_draw".to_owned(), json!(self.parameters.surface_draw(paper.variant()).name()));
        if self.parameters.is_blackbody && self.parameters.simulation == Simulation::Free {
            config.insert("temperatures".to_owned(), json!(self.parameters.temperatures_k()));
        }
        let slope_deg = self.parameters.flow.slope_deg(scene.particles.bed.is_level());
        config.extend(entries([("rho", json!(self.parameters.rho())), ("slope", json!(slope_deg))]));
        config.extend(paper.animate.sph().map(|sph| ("substeps".to_owned(), json!(sph.substeps))));
        add_object_triangles(&mut config, &scene.objects);
        config
    }

    fn summary(&self) -> String {
        let p = &self.parameters;
        format!("{} particles, {} x {} splats", p.particles, p.splats[0], p.splats[1])
    }

    fn metrics(
        &self,
        machine: &mut Machine,
        measured: &mut [(Built<Self>, Measurement)],
    ) -> Result<Vec<Metrics>, Error> {
        let mut metrics = Vec::with_capacity(measured.len());
        for (built, measurement) in measured {
            let mut results = results(&self.parameters, &built.paper, measurement);
            if let Some(Kept { splats, clusters, of_clusters }) = built.paper.splatting.kept(&machine.device)? {
                let counts = [("kept_splats", splats), ("kept_clusters", clusters), ("splat_clusters", of_clusters)];
                results.extend(entries(counts.map(|(name, count)| (name, json!(count)))));
            }
            results.extend(entries([experiments::points::measure(machine, &built.paper)?]));
            metrics.push(Metrics { results, warnings: built.paper.warnings() });
        }
        Ok(metrics)
    }

    const ABOUT: &'static str = "Lava: particles to density to isosurface to splats (Unnthorsson), pass by pass";
    const BENCHED: &'static [Variant] = &[Variant::Paper];
    const RENDERED: Variant = Variant::Paper;
    const SHARED: &'static [&'static str] = &["scaling"];

    type Options = Options;

    fn parameters() -> Vec<Parameter<Self>> {
        let numbers = Parameters::declared().into_iter();
        let scene = [
            Parameter::new("rock", field!(Setup.rock))
                .help(
                    "Picture of the rock that is laid over the lava: plates with bright cracks between them, or the grain of a crust \
                     without any: plates, crust, or a PNG file of at least 2 x 2 texels",
                )
                .section("7.2")
                .cost(Cost::Buffers),
            Parameter::new("bed", field!(Setup.bed))
                .help(
                    "With sph: height map of the ground, which covers the space in its own proportions, the lowest place at the \
                     floor: volcano, maunga-whau, jacksboro, or a .hgt, .hdr with .bil or .dem, .tif, .png or .asc file",
                )
                .section("9")
                .cost(Cost::Buffers),
            Parameter::new("object", field!(Setup.objects))
                .help(
                    "Polygon mesh in the simulation space: teapot, sphere, box, bunny, plane, or an OBJ, PLY, STL, glTF or \
                     GLB file. Without a place it is fitted into the middle; @own: at its own coordinates; @X,Y,Z[,DEGREES[,SCALE]]: \
                     the middle of its lower side in metres, its turn about the vertical, the factor of its own size",
                )
                .cost(Cost::Buffers)
                .everyday(),
            parameter::crease_angle(field!(Setup.crease_deg)),
        ];
        numbers.map(|p| p.inside(|s: &Setup| &s.parameters, |s| &mut s.parameters)).chain(scene).collect()
    }

    fn options() -> Vec<Parameter<Options>> {
        experiments::options()
    }

    fn presets() -> Vec<Preset<Self>> {
        let kind = |name, help, setup| Preset { name, help, variant: Some(Variant::GpuDriven), setup };
        vec![
            Preset {
                name: "results",
                help: "Chapter 8: the pictures and the 20 frames a second",
                variant: None,
                setup: Setup::default,
            },
            Preset {
                name: "fig-6.2",
                help: "Figures 5.1, 5.2 and 6.2: 65,536 particles, a finer grid",
                variant: None,
                setup: || Setup::of(Parameters::of_figure_6_2()),
            },
            Preset {
                name: "fig-8.5",
                help: "Figure 8.5 at its smallest splats, which leave holes; other radii make its other parts",
                variant: None,
                setup: || {
                    let parameters = Parameters { splat_radius_m: 0.001875, ..Parameters::default() };
                    Setup { parameters, ..Setup::default() }
                },
            },
            kind("pahoehoe", "Section 3.2: a thin fluid sheet that chills after a metre or two", || {
                Setup::crusted(kinds::pahoehoe())
            }),
            kind("ropy", "Section 3.2: pahoehoe under a stiff skin that folds as it slows", || {
                Setup::crusted(kinds::ropy())
            }),
            kind("toes", "Section 3.2: slow pahoehoe that breaks out of its skin as toe after toe", || {
                Setup::crusted(kinds::toes())
            }),
            kind("aa", "Section 3.3: thicker, more viscous and yet faster", || Setup::crusted(kinds::aa())),
        ]
    }

    fn axes() -> Vec<Axis<Self>> {
        axes::all()
    }

    fn experiments() -> Vec<Experiment<Self>> {
        experiments::all()
    }

    fn quick() -> Self {
        Setup::default()
    }

    fn preset_mut(&mut self) -> &mut Option<String> {
        &mut self.preset
    }

    fn resolve(&mut self, given: &Given) -> Result<(), Error> {
        self.given = given.clone();
        Ok(())
    }
}

/// Work per second of the passes that do it: GPU time, and host time where the thesis leaves the work to the host.
fn results(parameters: &Parameters, paper: &Lava, measurement: &Measurement) -> Map<String, Value> {
    let time_s = |names: &[&str]| {
        let of = |name: &&str| {
            let pass = measurement.passes.iter().find(|p| p.info.name == *name)?;
            median(&pass.gpu_ms).or_else(|| median(&pass.host_ms))
        };
        let times: Vec<f64> = names.iter().map(of).collect::<Option<_>>()?;
        Some(times.iter().sum::<f64>() / 1e3).filter(|&s| s > 0.0)
    };
    let rate = |count: f64, names: &[&str]| json!(time_s(names).map(|s| count / s));
    let particles = particles_out(parameters, measurement);
    let grid_points = parameters.density.iter().map(|&n| f64::from(n)).product::<f64>();
    let splats = parameters.splats.iter().map(|&n| f64::from(n)).product::<f64>();
    let sorted = ["cell-keys", "sort-count", "sort-sum", "sort-scatter", "arrange", "cell-starts"];
    let moved: Vec<&str> = match parameters.simulation {
        Simulation::Free => vec!["animate"],
        // Some of the fluid's passes depend on its numbers.
        Simulation::Sph => {
            measurement.passes.iter().map(|p| p.info.name).filter(|name| name.starts_with("sph-")).collect()
        }
    };
    let is_sorted = paper.variant() == Variant::GpuDriven || parameters.simulation == Simulation::Sph;
    let clustered = (paper.variant() == Variant::Paper).then_some("cluster");
    let on_particles: Vec<&str> =
        moved.into_iter().chain(sorted.into_iter().filter(|_| is_sorted)).chain(clustered).chain(["density"]).collect();
    let frame_ms = median(&measurement.frame_ms);
    entries([
        ("frames_per_s", json!(frame_ms.map(|ms| 1e3 / ms))),
        ("accepted_grid_points", json!(paper.accepted().map(|accepted| accepted.count))),
        ("density_range", json!(paper.accepted().map(|accepted| accepted.density_range))),
        ("particles_per_s", rate(particles, &on_particles)),
        ("grid_points_per_s", rate(grid_points, &["density", "extract"])),
        ("splats_per_s", rate(splats, &["visibility", "blending"])),
    ])
}

/// Particles in the middle one of the measured frames, as the times are the middle ones. A vent lets out more from frame to frame, so that the
/// frame in the middle has the median.
fn particles_out(parameters: &Parameters, measurement: &Measurement) -> f64 {
    let inflow = Inflow::of(parameters, parameters.particles);
    let frames = frames(measurement);
    let [below, above] = [frames.div_ceil(2), frames / 2 + 1].map(|after| f64::from(inflow.out(after as u32)));
    0.5 * (below + above)
}

/// Frames of a repetition.
fn frames(measurement: &Measurement) -> usize {
    let Measurement { frame_ms, gpu_ms, bracket_ms, .. } = measurement;
    let [plain, timestamped, bracketed] = [frame_ms, gpu_ms, bracket_ms].map(Vec::len);
    match measurement.repeat as usize {
        // The bracketed frames come last: a repetition that was given up among them has all of the others.
        repeat if plain == timestamped && bracketed < plain => plain / (repeat + 1),
        0 => plain,
        repeat => bracketed / repeat,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::lava::{Flow, Vent};

    /// Also where a repetition was given up half-way, and of particles that are all there from the start.
    #[test]
    fn particles_of_a_vent_are_those_of_the_measured_frames() {
        let measured = |repeat: u32, [plain, timestamped, bracketed]: [usize; 3]| Measurement {
            repeat,
            frame_ms: vec![1.0; plain],
            gpu_ms: vec![1.0; timestamped],
            bracket_ms: vec![1.0; bracketed],
            ..Measurement::default()
        };
        let vent = Vent { effusion_m3_s: 0.018, ..Vent::default() };
        let flow = Flow { vent, ..Flow::default() };
        let erupting = Parameters { simulation: Simulation::Sph, flow, ..Parameters::default() };
        // 1000 in 30 frames: 500 after 15 and 533 after 16.
        for (repeat, counts) in
            [(1, [30; 3]), (2, [60; 3]), (2, [70, 60, 60]), (2, [90, 70, 60]), (2, [90, 90, 75]), (0, [30, 7, 0])]
        {
            assert_eq!(particles_out(&erupting, &measured(repeat, counts)), 516.5, "{repeat} {counts:?}");
        }
        assert_eq!(particles_out(&erupting, &measured(0, [1, 0, 0])), 33.0);
        assert_eq!(particles_out(&Parameters::default(), &measured(1, [30; 3])), 40_000.0);
    }
}
