//! Stage one as a viscous fluid (chapter 9, "Improved particle simulation"): smoothed particle hydrodynamics.
//!
//! ```text
//! cell-keys ─► sort-count ─► sort-sum ─► sort-scatter ─► arrange ─► cell-starts ─► sph-forces ─► sph-neighbours ─┐
//!   ┌──────────────────────────────────────────────────────────────────────────────────────────────────────────┘
//!   └─► sph-heat ─► sph-strain ─► sph-rheology ─► sph-drag ─► sph-viscosity ─► sph-predict ─► sph-neighbours-predicted ─┐
//!   ┌───────────────────────────────────────────────────────────────`─ a few dozen times ──────────────────────────────┘
//!   └─► sph-density ─► sph-correct ─► sph-finish
//!         `─ corrections ─´
//! ```
//!
//! Pressure is that of position-based fluids (Macklin and Mueller 2013), which no step makes unstable; viscosity is implicit
//! (Morris et al. 1997, by Chebyshev's semi-iteration), with `sph-rheology` one that follows from temperature and stress. All sums are gathered in the order of the cells: every run is the same
//! to the bit.

pub mod bed;
pub mod chebyshev;
pub mod check;
pub mod crust;
pub mod estimate;
pub mod heat;
pub mod kernel;
pub mod neighbours;
pub mod parameters;
pub mod rock;
mod scale;
mod sph_correct;
mod sph_density;
mod sph_drag;
mod sph_finish;
mod sph_forces;
mod sph_heat;
mod sph_inflow;
mod sph_neighbours;
mod sph_neighbours_predicted;
mod sph_predict;
mod sph_rheology;
mod sph_strain;
mod sph_viscosity;
pub mod start;
pub mod substeps;
pub mod surface_temperature;
pub mod toes;
pub mod vent;
pub mod work;

use std::sync::Arc;

use ash::vk;

use self::bed::Bed;
use self::chebyshev::Coefficients;
use self::heat::Rheology;
use self::neighbours::Neighbours;
use self::rock::{Layings, Rock};
pub use self::scale::Scale;
use self::sph_correct::sph_correct;
use self::sph_density::sph_density;
use self::sph_drag::sph_drag;
use self::sph_finish::sph_finish;
use self::sph_forces::sph_forces;
use self::sph_heat::sph_heat;
use self::sph_inflow::sph_inflow;
use self::sph_predict::sph_predict;
use self::sph_rheology::sph_rheology;
use self::sph_strain::sph_strain;
use self::sph_viscosity::sph_viscosity;
use self::vent::Inflow;
use self::work::{MOST_PASSES, OTHER_PASSES, Work};
use super::animate::State;
use super::gpu_driven::sort::Sort;
use super::gpu_driven::{Cells, by_cells};
use super::parameters::Parameters;
use super::targets::Context;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::{read_buffer, upload_each};
use crate::gpu::{Buffer, BufferDesc, Device, Error, Frame, ImageView, Pass};
use crate::host_block;

host_block! {
    pub(super) struct FlowConstants {
        space_m: [f32; 3],
        particles: u32,
        counts: [u32; 3],
        width: u32,
        gravity_m_s2: [f32; 3],
        time_step_s: f32,
        support_m: f32,
        volume: f32,
        drag: f32,
        listed: u32,
        kept: f32,
        gained: f32,
        margin_m: f32,
        periodic: f32,
        laplacian: f32,
        conduction: f32,
        given: f32,
        radiance: f32,
        ambient_k: f32,
        melt_k: f32,
        solidus_k: f32,
        per_viscosity: f32,
        stiffest: f32,
        share: f32,
        kept_rock: u32,
        turn: u32,
    }
}

host_block! {
    struct InflowConstants {
        first: u32,
        count: u32,
        width: u32,
    }
}

/// Most iterations of a step's viscosity.
const MOST_ITERATIONS: u32 = 300;
/// Index of the start among the fluid's states.
const START: usize = 2;
/// The fluid.
pub struct Sph {
    /// By cells of the kernel's radius, of the start and of the two states.
    pub sort: Sort,
    /// Into the first two states.
    inflow: [Pass; 2],
    forces: [Pass; 3],
    neighbours: Neighbours,
    heat_pass: Pass,
    rheology: Option<Rheologic>,
    drag: Pass,
    viscosity: [Pass; 2],
    predict: Pass,
    density: [Pass; 2],
    correct: [Pass; 2],
    /// From each state.
    finish: [Pass; 3],
    /// Of a step, but for what changes from one to the next.
    pub(super) constants: FlowConstants,
    coefficients: Vec<Coefficients>,
    corrections: u32,
    work: Work,
    /// Steps of a frame.
    pub substeps: u32,
    /// Iterates of the velocities by cells, metres per second: the last step's are in the first where its iterations were
    /// even in number.
    pub velocities: [Arc<ImageView>; 2],
    /// Velocities that gravity alone leaves, and in the fourth component kelvin as the step begins.
    pub pushed: Arc<Buffer>,
    /// Kelvin as the step ends, and the steepness of a particle's face.
    pub heat: Arc<Buffer>,
    /// Predicted places by cells, metres, likewise by corrections.
    pub predicted: [Arc<ImageView>; 2],
    arrived: Arc<Buffer>,
    /// Factor of the constraint times h^-2, density over that at rest: before the last correction.
    pub factors: Arc<Buffer>,
    /// The ground: slopes along x and z, heights in metres.
    pub bed: Arc<ImageView>,
    /// The rock on it.
    pub rock: Rock,
}

/// Passes `sph-strain` and `sph-rheology`.
struct Rheologic {
    strain: Pass,
    pass: Pass,
    /// Rates of strain per second by cells: the tensor's diagonal, and twice what stands beside it.
    strains: [Arc<Buffer>; 2],
    viscosities: Arc<Buffer>,
}

impl Sph {
    /// The steps between these states over a bed; the last state is the start and is not written.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, states: [&State; 3], particle_count: u32, bed: &Bed) -> Result<Self, Error> {
        let Context { shaders, parameters, .. } = context;
        let scale = Scale::of(parameters);
        let cells = scale.cells(parameters, particle_count);
        let label = context.name("sph");
        let context = Context { label: &label, ..context };
        let sort = Sort::new(context, &cells, &states.map(|state| &state.positions))?;
        let buffer = |name: &str, bytes: u64| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            let desc = BufferDesc::new(context.name(name), bytes * u64::from(particle_count)).usage(usage);
            Buffer::new(context.device(), desc).map_err(|error| error.set_by("particles"))
        };
        let texture = |name: &str| by_cells::texture(context, name, particle_count);
        let velocities = [texture("velocities-by-cells-a")?, texture("velocities-by-cells-b")?];
        let predicted = [texture("predicted-a")?, texture("predicted-b")?];
        let (pushing, arrived) = (texture("pushing")?, buffer("arrived", 16)?);
        let (pushed, change, factors) = (buffer("pushed", 16)?, buffer("change", 16)?, buffer("factors", 8)?);
        let wall_drags = buffer("wall-drags", 4)?;
        let unmet = context.upload("unmet", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&[0u32; 3]))?;
        let viscous = Viscous { pushed: &pushed, change: &change, wall_drags: &wall_drags, unmet: &unmet };
        let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
        let by_particles =
            upload_each(context.device(), &context.name("lasting"), usage, particle_count as usize, |_| [0.0f32; 4])
                .map_err(|error| error.set_by("particles"))?;
        let near = Neighbours::new(context, &sort, particle_count, &predicted[0])?;
        let heat = buffer("heat", 8)?;
        let latent = parameters.flow.heat.crystallising_k();
        let latent = context.upload("latent", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&latent))?;

        let is_level = bed.is_level();
        let bed = bed.texture(context)?;
        let ground = Ground { sort: &sort, near: &near, bed: &bed };
        let coefficients = chebyshev::coefficients(scale.stiffness * scale.stiffest);
        let rheology = match parameters.flow.heat.rheology {
            Rheology::Constant => None,
            Rheology::Basalt => {
                let strains = [buffer("strains-along", 16)?, buffer("strains-across", 16)?];
                let viscosities = buffer("viscosities", 4)?;
                let strain = sph_strain(shaders, ground, &pushed, strains.each_ref())?;
                let pass = sph_rheology(shaders, ground, strains.each_ref(), [&heat, &viscosities])?;
                Some(Rheologic { strain, pass, strains, viscosities })
            }
        };
        let corrections = parameters.flow.corrections;
        let width = states[0].positions.width();
        let renewal_steps = f64::from(parameters.flow.renewal_s) / scale.step_s;
        let size = (width, states[0].positions.height());
        let rock = Rock::new(context, size, buffer("carried", 16)?, renewal_steps)?;
        let inflow = |state: usize| sph_inflow(shaders, states[2], states[state], &rock.states[state], &by_particles);
        let forces = |state| sph_forces(shaders, &sort, state, &velocities[0], &by_particles, viscous);
        let viscosities = rheology.as_ref().map(|rheology| &rheology.viscosities);
        let viscosity = |[from, to]: [usize; 2]| {
            sph_viscosity(shaders, ground, [&velocities[from], &velocities[to]], viscous, viscosities)
        };
        let density = |from: usize| sph_density(shaders, ground, [&predicted[from], &pushing], [&factors, &unmet]);
        let correct = |to: usize| sph_correct(shaders, ground, [&pushing, &predicted[to]], &unmet);
        let solved = &velocities[coefficients.len() % 2];
        let lasting = Lasting { velocities: solved, pushed: &pushed, by_particles: &by_particles };
        let finish = |[from, to]: [usize; 2]| {
            let corrected = &predicted[corrections as usize % 2];
            sph_finish(shaders, &sort, corrected, [&arrived, &heat], lasting, states[to], (&rock, [from, to]))
        };
        Ok(Sph {
            inflow: [inflow(0)?, inflow(1)?],
            forces: [forces(states[0])?, forces(states[1])?, forces(states[2])?],
            heat_pass: sph_heat(shaders, ground, [&pushed, &latent], &heat)?,
            drag: sph_drag(shaders, ground, &wall_drags, viscosities)?,
            viscosity: [viscosity([0, 1])?, viscosity([1, 0])?],
            rheology,
            predict: sph_predict(shaders, ground, [solved, &predicted[0]], &unmet)?,
            density: [density(0)?, density(1)?],
            correct: [correct(1)?, correct(0)?],
            finish: [finish([0, 1])?, finish([1, 0])?, finish([2, 0])?],
            constants: FlowConstants { width, ..constants(parameters, &scale, &cells, is_level) },
            sort,
            coefficients,
            corrections,
            work: Work::of(parameters, &scale, &cells),
            substeps: scale.substeps,
            velocities,
            pushed,
            heat,
            predicted,
            arrived,
            factors,
            neighbours: near,
            bed,
            rock,
        })
    }

    /// A frame's steps, after those of so many frames. Where they are more work than `most_work`, or very many passes, they are several
    /// submissions.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, frames: u32, inflow: &Inflow, most_work: f64) -> Result<(), Error> {
        let first = frames.saturating_mul(self.substeps);
        for step in first..first.saturating_add(self.substeps) {
            let from = if step == 0 { START } else { 1 - step as usize % 2 };
            self.record_step(frame, from, step, [step, step + 1].map(|steps| inflow.after(steps)), most_work)?;
        }
        Ok(())
    }

    /// Frames of the whole pool in a submission of at most so much work; less than one where a frame is more.
    pub fn frames_within(&self, most_work: f64) -> f64 {
        self.work.steps_within(most_work, self.constants.particles) / f64::from(self.substeps)
    }

    /// The step of this number from a state, the third of which is the start. Of the particles that are `out`, `before` have been so in
    /// the last step.
    fn record_step(
        &self,
        frame: &mut Frame<'_>,
        from: usize,
        step: u32,
        [before, out]: [u32; 2],
        most_work: f64,
    ) -> Result<(), Error> {
        let Layings { kept, .. } = self.rock.layings(step);
        let kept_rock = u32::from(kept[0] > 0.0) | u32::from(kept[1] > 0.0) << 1;
        let constants = FlowConstants { particles: out, kept_rock, ..self.constants };
        let particles = out;
        // The start has all of them.
        if let Some(inflow) = self.inflow.get(from).filter(|_| out > before) {
            let constants = InflowConstants { first: before, count: out - before, width: constants.width };
            frame.compute(inflow, |dispatch| dispatch.constants(&constants).elements(constants.count))?;
        }
        // Of the least work so many passes fill a submission.
        let least = most_work / MOST_PASSES;
        let run = |frame: &mut Frame<'_>, pass: &Pass, constants: &FlowConstants, work: f64| {
            frame.reserve_work(pass, work.max(least), most_work)?;
            frame.compute(pass, |dispatch| dispatch.constants(constants).elements(particles))
        };
        let (each, walks, lists) = (f64::from(out), self.work.walks(out), self.work.lists(out));
        self.sort.record(frame, from, out)?;
        // The start has no step before it.
        let lasting = FlowConstants { kept: f32::from(u8::from(from < self.inflow.len())), ..constants };
        run(frame, &self.forces[from], &lasting, OTHER_PASSES * each.max(least))?;
        run(frame, &self.neighbours.began, &constants, walks)?;
        run(frame, &self.heat_pass, &constants, lists)?;
        if let Some(rheology) = &self.rheology {
            run(frame, &rheology.strain, &constants, lists)?;
            run(frame, &rheology.pass, &constants, lists)?;
        }
        run(frame, &self.drag, &constants, lists)?;
        for (at, &[kept, gained]) in self.coefficients.iter().enumerate() {
            let turn = at as u32 % 3;
            run(frame, &self.viscosity[at % 2], &FlowConstants { kept, gained, turn, ..constants }, lists)?;
        }
        run(frame, &self.predict, &constants, each)?;
        run(frame, &self.neighbours.predicted, &constants, walks)?;
        for at in 0..self.corrections as usize {
            let constants = FlowConstants { turn: at as u32 % 3, ..constants };
            run(frame, &self.density[at % 2], &constants, lists)?;
            run(frame, &self.correct[at % 2], &constants, lists)?;
        }
        run(frame, &self.finish[from], &constants, each)
    }

    /// Iterations of a step's viscosity.
    pub fn iterations(&self) -> usize {
        self.coefficients.len()
    }

    /// Viscosities over the melt's by cells; `None` where it is one for all.
    pub fn viscosities(&self) -> Option<&Arc<Buffer>> {
        self.rheology.as_ref().map(|rheology| &rheology.viscosities)
    }

    /// Rates of strain per second by cells as the last step began, the tensor's diagonal and twice what stands beside it; `None` where
    /// the viscosity does not follow them.
    pub fn strains(&self) -> Option<&[Arc<Buffer>; 2]> {
        self.rheology.as_ref().map(|rheology| &rheology.strains)
    }

    /// Places of the last step by cells, metres.
    pub fn arrived(&self) -> &Arc<Buffer> {
        &self.arrived
    }

    /// Mean temperature of the particles that radiate, of the first so many by cells; none where none does.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn skin_k(&self, device: &Arc<Device>, particles: usize) -> Result<Option<f64>, Error> {
        let heat = bytemuck::pod_collect_to_vec::<u8, [f32; 2]>(&read_buffer(device, &self.heat)?);
        let skin =
            heat.iter().take(particles).filter(|[_, steepness]| *steepness > 0.0).map(|[kelvin, _]| f64::from(*kelvin));
        let (count, sum) = skin.fold((0u32, 0.0), |(count, sum), kelvin| (count + 1, sum + kelvin));
        Ok((count > 0).then(|| sum / f64::from(count)))
    }

    /// Words by which passes say that they left out particles that count, as [`Neighbours::crowded`].
    pub(super) fn crowded(&self) -> &Arc<Buffer> {
        &self.neighbours.crowded
    }

    /// Fails where a device's loops left particles out.
    ///
    /// # Errors
    /// As [`Neighbours::check`].
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        self.neighbours.check(device)
    }
}

/// Results of a step that are the next one's first guesses.
#[derive(Clone, Copy)]
struct Lasting<'a> {
    /// After viscosity.
    velocities: &'a Arc<ImageView>,
    /// Before it.
    pushed: &'a Arc<Buffer>,
    /// The difference for the next step, by the particles' numbers.
    by_particles: &'a Arc<Buffer>,
}

/// Buffers of all iterations of the viscosity.
#[derive(Clone, Copy)]
struct Viscous<'a> {
    /// Right side.
    pushed: &'a Arc<Buffer>,
    /// Of the last iteration.
    change: &'a Arc<Buffer>,
    wall_drags: &'a Arc<Buffer>,
    /// Words by which iterations say whether there is more to do.
    unmet: &'a Arc<Buffer>,
}

/// Begins a pass over the particles by cells.
pub(super) fn over_cells(name: &'static str, shader: &str, sort: &Sort) -> PassBuilder {
    Pass::compute(name, "9", shader).constants::<FlowConstants>().with("starts", &sort.starts)
}

/// And asks for their places as the step begins.
pub(super) fn over_places(name: &'static str, shader: &str, sort: &Sort) -> PassBuilder {
    over_cells(name, shader, sort).with("places_by_cells", &sort.places)
}

/// The particles by cells, and the ground under them.
#[derive(Clone, Copy)]
struct Ground<'a> {
    sort: &'a Sort,
    near: &'a Neighbours,
    bed: &'a Arc<ImageView>,
}

impl Ground<'_> {
    /// Begins a pass over the particles that feels the walls.
    fn over_places(self, name: &'static str, shader: &str) -> PassBuilder {
        over_places(name, shader, self.sort).with("bed", self.bed)
    }

    /// And looks at those near each of them.
    fn over_neighbours(self, name: &'static str, shader: &str) -> PassBuilder {
        self.near.over(name, shader, self.sort).with("bed", self.bed)
    }
}

fn constants(parameters: &Parameters, scale: &Scale, cells: &Cells, is_level: bool) -> FlowConstants {
    let flow = &parameters.flow;
    let (sine, cosine) = flow.slope_deg(is_level).to_radians().sin_cos();
    FlowConstants {
        space_m: parameters.space_m.to_array(),
        particles: cells.particles,
        counts: cells.counts,
        width: 0,
        gravity_m_s2: [flow.gravity_m_s2 * sine, -flow.gravity_m_s2 * cosine, 0.0],
        time_step_s: scale.step_s as f32,
        support_m: scale.support_m as f32,
        volume: scale.volume as f32,
        drag: (2.0 * scale.stiffness * scale.laplacian) as f32,
        listed: neighbours::listed(cells.particles),
        kept: 0.0,
        gained: 0.0,
        margin_m: scale.margin_m as f32,
        periodic: f32::from(u8::from(flow.sides == parameters::Sides::Periodic)),
        laplacian: scale.laplacian as f32,
        conduction: (2.0 * scale.heat_stiffness * scale.laplacian) as f32,
        given: (scale.given * kernel::face_per_steepness()) as f32,
        radiance: scale.radiance as f32,
        ambient_k: flow.heat.ambient_k,
        melt_k: flow.heat.melt_k,
        solidus_k: flow.heat.solidus_k,
        per_viscosity: 1.0 / flow.viscosity_pa_s.max(f32::MIN_POSITIVE),
        stiffest: scale.stiffest as f32,
        share: 0.0,
        kept_rock: 3,
        turn: 0,
    }
}
