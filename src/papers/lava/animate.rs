//! Pass `animate` (section 5.1): the particles move one step, from one pair of textures into the other.

use std::sync::Arc;

use super::parameters::Parameters;
use super::start::Particles;
use super::targets::{Context, FLOATS};
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Blend, Error, Frame, ImageView, Load, Pass, ShaderLibrary};
use crate::host_block;

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
    /// Metres per second.
    pub velocities: Arc<ImageView>,
}

/// The pass, with its ping-pong textures.
pub struct Animate {
    /// Writes the first state from the start.
    first: Pass,
    /// Each writes the state of its index from the other.
    ping_pong: [Pass; 2],
    /// The states that steps write alternately.
    pub states: [State; 2],
    constants: MotionConstants,
    steps: u32,
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
        let state = |suffix: &str| -> Result<State, Error> {
            let target = |name: &str| context.target(&format!("{name}{suffix}"), FLOATS, width, height);
            Ok(State { positions: target("positions")?, velocities: target("velocities")? })
        };
        // The start stays, so that a restart moves nothing.
        let start = state("-start")?;
        let states = [state("-a")?, state("-b")?];
        load(shaders, particles, &start)?;

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
        Ok(Animate { first, ping_pong, states, constants, steps: 0 })
    }

    /// Moves the particles one step.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let pass = if self.steps == 0 { &self.first } else { &self.ping_pong[self.steps as usize % 2] };
        frame.graphics(pass, |draw| {
            draw.constants(&self.constants).vertices(3);
        })?;
        self.steps += 1;
        Ok(())
    }

    /// Back to the start.
    pub fn restart(&mut self) {
        self.steps = 0;
    }

    /// Steps since the start.
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Positions and velocities after the last step; the first state before any.
    pub fn state(&self) -> &State {
        &self.states[self.current()]
    }

    /// Index of the state that the last step wrote; the first before any.
    pub fn current(&self) -> usize {
        (self.steps.saturating_sub(1) % 2) as usize
    }
}

/// Fills `start` with the particles; what is left of the last row stays at the origin and at rest.
fn load(shaders: &ShaderLibrary, particles: &Particles, start: &State) -> Result<(), Error> {
    for (view, values) in [(&start.positions, &particles.positions), (&start.velocities, &particles.velocities)] {
        let size = (view.width(), view.height());
        upload_rows(shaders.device(), view, size, |first_row, bytes| {
            let first = (first_row * view.width()) as usize;
            let mut values = values.iter().skip(first);
            for texel in bytes.chunks_exact_mut(16) {
                let value = values.next().map_or([0.0; 4], |v| v.extend(0.0).to_array());
                texel.copy_from_slice(bytemuck::bytes_of(&value));
            }
        })?;
    }
    Ok(())
}
