//! The particles move one step, from one pair of textures into the other: pass `animate` (section 5.1), or the passes of the
//! fluid.

use std::sync::Arc;

use ash::vk;

use super::parameters::Parameters;
use super::sph::Sph;
use super::sph::parameters::Simulation;
use super::sph::vent::Inflow;
use super::start::Particles;
use super::targets::{Context, FLOATS};
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Blend, Error, Frame, Image, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;
use crate::measure::estimate::submission_work;

host_block! {
    struct MotionConstants {
        space_m: [f32; 3],
        time_step_s: f32,
    }
}

/// One position and one velocity texture, a texel for each particle.
#[derive(Clone)]
pub struct State {
    /// Metres.
    pub positions: Arc<ImageView>,
    /// Metres per second; of a fluid the temperature in kelvin in alpha.
    pub velocities: Arc<ImageView>,
}

/// The steps, with their ping-pong textures.
pub struct Animate {
    motion: Motion,
    /// The states that steps write alternately.
    pub states: [State; 2],
    inflow: Inflow,
    steps: u32,
    /// Turns of a fluid's loops in one submission. A frame of more is several.
    pub most_work: f64,
}

/// By [`Simulation`].
enum Motion {
    Free(Free),
    Sph(Box<Sph>),
}

/// The thesis's.
struct Free {
    /// Writes the first state from the start.
    first: Pass,
    /// Each writes the state of its index from the other.
    ping_pong: [Pass; 2],
    constants: MotionConstants,
}

impl Free {
    fn new(
        shaders: &ShaderLibrary,
        parameters: &Parameters,
        start: &State,
        states: &[State; 2],
    ) -> Result<Self, Error> {
        let first = Pass::graphics("animate", "5.1", "common/fullscreen.vert", "lava/animate.frag")
            .constants::<MotionConstants>()
            .with("positions", &start.positions)
            .with("velocities", &start.velocities)
            .whole(&["positions", "velocities"])
            // Each coordinate moves by its velocity times the step.
            .multiply_adds(|counts| Some(3 * counts.samples_passed?))
            .color(&states[0].positions, Load::Discard, Blend::Replace)
            .color(&states[0].velocities, Load::Discard, Blend::Replace)
            .build(shaders)?;
        let step = |from: &State, to: &State| {
            first
                .rebind()
                .with("positions", &from.positions)
                .with("velocities", &from.velocities)
                .color(0, &to.positions, Load::Discard)
                .color(1, &to.velocities, Load::Discard)
                .build(shaders)
        };
        let ping_pong = [step(&states[1], &states[0])?, step(&states[0], &states[1])?];
        let constants = MotionConstants { space_m: parameters.space_m.to_array(), time_step_s: parameters.time_step_s };
        Ok(Free { first, ping_pong, constants })
    }
}

impl Animate {
    /// `label` goes before the names of the textures.
    ///
    /// # Errors
    /// Errors of the Vulkan layer; [`Error::Limit`] for more particles than a texture holds.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        particles: &Particles,
    ) -> Result<Self, Error> {
        let context = Context { shaders, label, parameters };
        let (width, height) = Particles::texture_size(particles.positions.len() as u32);
        let target = |name: String| {
            let mut desc = context.desc(&name, FLOATS, width, height);
            if parameters.simulation == Simulation::Sph {
                desc = desc.usage(vk::ImageUsageFlags::STORAGE | vk::ImageUsageFlags::SAMPLED);
            }
            Image::new(context.device(), desc)?.view()
        };
        let state = |suffix: &str| -> Result<State, Error> {
            let (positions, velocities) =
                (target(format!("positions{suffix}"))?, target(format!("velocities{suffix}"))?);
            Ok(State { positions, velocities })
        };
        // The start stays, so that a restart moves nothing.
        let start = state("-start")?;
        let states = [state("-a")?, state("-b")?];
        load(shaders, particles, &start)?;
        let motion = match parameters.simulation {
            Simulation::Free => Motion::Free(Free::new(shaders, parameters, &start, &states)?),
            Simulation::Sph => {
                let count = particles.positions.len() as u32;
                Motion::Sph(Box::new(Sph::new(context, [&states[0], &states[1], &start], count, &particles.bed)?))
            }
        };
        let inflow = Inflow::of(parameters, particles.positions.len() as u32);
        let most_work = submission_work(context.device());
        Ok(Animate { motion, states, inflow, steps: 0, most_work })
    }

    /// Moves the particles one step, or a fluid by those of a frame.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        match &self.motion {
            Motion::Free(Free { first, ping_pong, constants }) => {
                let pass = if self.steps == 0 { first } else { &ping_pong[self.steps as usize % 2] };
                frame.graphics(pass, |draw| draw.constants(constants).vertices(3))?;
            }
            Motion::Sph(sph) => {
                sph.record(frame, self.steps, &self.inflow, self.most_work)?;
            }
        }
        self.steps += 1;
        Ok(())
    }

    /// The fluid; `None` where the particles move by themselves.
    pub fn sph(&self) -> Option<&Sph> {
        match &self.motion {
            Motion::Free(_) => None,
            Motion::Sph(sph) => Some(sph),
        }
    }

    /// Back to the start.
    pub fn restart(&mut self) {
        self.steps = 0;
    }

    /// Frames since the start, each a step but of a fluid.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Positions and velocities after the last step; the first state before any.
    pub fn state(&self) -> &State {
        &self.states[self.current()]
    }

    /// Particles that are there after the last step: all, unless they come out of a vent.
    pub fn out(&self) -> u32 {
        self.inflow.out(self.steps)
    }

    /// Steps in the time of a frame.
    pub fn substeps(&self) -> u32 {
        self.sph().map_or(1, |sph| sph.substeps)
    }

    /// Frames that `most` steps make, one at least, and of a fluid no more than a submission holds.
    pub fn frames_within(&self, most: u32) -> u32 {
        let held = self.sph().map_or(f64::INFINITY, |sph| sph.frames_within(self.most_work));
        (most / self.substeps()).min(held as u32).max(1)
    }

    /// Index of the state that the last step wrote; the first before any.
    pub fn current(&self) -> usize {
        (self.steps.saturating_mul(self.substeps()).saturating_sub(1) % 2) as usize
    }
}

/// Fills `start` with the particles and their temperatures; what is left of the last row stays at the origin and at rest.
fn load(shaders: &ShaderLibrary, particles: &Particles, start: &State) -> Result<(), Error> {
    let Particles { positions, velocities, temperatures_k, .. } = particles;
    for (view, values, last) in
        [(&start.positions, positions, &[][..]), (&start.velocities, velocities, &temperatures_k[..])]
    {
        let size = (view.width(), view.height());
        upload_rows(shaders.device(), view, size, |first_row, bytes| {
            let first = (first_row * view.width()) as usize;
            let mut values = values.iter().skip(first);
            let mut last = last.iter().skip(first);
            for texel in bytes.chunks_exact_mut(16) {
                let last = last.next().copied().unwrap_or(0.0);
                let value = values.next().map_or([0.0; 4], |v| v.extend(last).to_array());
                texel.copy_from_slice(bytemuck::bytes_of(&value));
            }
        })?;
    }
    Ok(())
}
