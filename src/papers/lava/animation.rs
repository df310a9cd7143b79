//! Stage one (chapter 5): the particles move on the device, are read back and sorted into clusters on the host.

use std::sync::Arc;

use ash::vk;

use super::clusters::{Clusters, Point};
use super::parameters::Parameters;
use super::particles::Particles;
use super::targets::{FLOATS, target};
use crate::gpu::transfer::upload_rows;
use crate::gpu::{Blend, Buffer, BufferDesc, Error, Frame, ImageView, Load, Location, Pass, PassInfo, ShaderLibrary};
use crate::host_block;

host_block! {
    struct MotionConstants {
        space_m: [f32; 3],
        time_step_s: f32,
    }
}

/// One position and one velocity texture.
#[derive(Clone)]
struct State {
    positions: Arc<ImageView>,
    velocities: Arc<ImageView>,
}

/// The passes and resources of stage one.
pub struct Animation {
    /// Writes the first state from the start.
    first: Pass,
    /// Write either state from the other.
    turns: [Pass; 2],
    read_positions: [Pass; 2],
    cluster: Arc<PassInfo>,
    states: [State; 2],
    readback: Arc<Buffer>,
    clusters: Clusters,
    /// One vertex buffer a cluster, each with room for every particle.
    vertices: Vec<Arc<Buffer>>,
    constants: MotionConstants,
    count: u32,
    /// Steps since the start.
    steps: u32,
}

impl Animation {
    /// # Errors
    /// What the Vulkan layer answers; [`Error::Limit`] for more particles than a texture holds.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        particles: &Particles,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let count = particles.positions.len() as u32;
        let (width, height) = Particles::texture_size(count);
        let state = |which: &str| -> Result<State, Error> {
            let image = |what: &str| target(shaders, format!("{label}/{what}{which}"), FLOATS, width, height);
            Ok(State { positions: image("positions")?, velocities: image("velocities")? })
        };
        // The start stays, so that a restart moves nothing.
        let start = state("-start")?;
        let states = [state("-a")?, state("-b")?];
        load(shaders, particles, &start)?;

        let first = Pass::graphics("animate", "5.1", "common/fullscreen.vert", "lava/animate.frag")
            .constants::<MotionConstants>()
            .with("positions", &start.positions)
            .with("velocities", &start.velocities)
            .color(&states[0].positions, Load::Discard, Blend::Replace)
            .color(&states[0].velocities, Load::Discard, Blend::Replace)
            .build(shaders)?;
        let turn = |from: &State, to: &State| {
            first
                .rebind()
                .with("positions", &from.positions)
                .with("velocities", &from.velocities)
                .color(0, &to.positions, Load::Discard)
                .color(1, &to.velocities, Load::Discard)
                .build(shaders)
        };
        let turns = [turn(&states[1], &states[0])?, turn(&states[0], &states[1])?];

        let texels = u64::from(width) * u64::from(height);
        let desc = BufferDesc::new(format!("{label}/position-readback"), 16 * texels).location(Location::Readback);
        let readback = Buffer::new(device, desc)?;
        let read = |state: &State| Pass::copy("read-positions", "5.2", &state.positions, &readback);
        let read_positions = [read(&states[0]), read(&states[1])];

        let vertices = (0..parameters.clusters())
            .map(|k| host_vertices(shaders, format!("{label}/cluster-{k}"), u64::from(count)))
            .collect::<Result<Vec<_>, _>>()?;
        let names: Vec<&str> = vertices.iter().map(|v| v.name()).collect();
        Ok(Animation {
            first,
            turns,
            read_positions,
            cluster: PassInfo::host("cluster", "5.2", &[readback.name()], &names),
            states,
            readback,
            clusters: Clusters::new(parameters),
            vertices,
            constants: MotionConstants { space_m: parameters.space_m.to_array(), time_step_s: parameters.time_step_s },
            count,
            steps: 0,
        })
    }

    /// Moves the particles one step, reads them back and clusters them.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        self.animate(frame)?;
        let read = &self.read_positions[self.current()];
        frame.copy(read)?;
        frame.wait_for(read)?;
        let Animation { clusters, vertices, readback, count, .. } = self;
        frame.host(&self.cluster, || {
            readback.read(readback.size_bytes(), |bytes| {
                let texels: &[[f32; 4]] = bytemuck::cast_slice(bytes);
                // The last row of the texture may hold more texels than there are particles.
                clusters.classify(texels.get(..*count as usize).unwrap_or(texels));
            })?;
            for (buffer, particles) in vertices.iter().zip(&clusters.particles) {
                buffer.write(0, bytemuck::cast_slice(particles))?;
            }
            Ok(())
        })
    }

    /// Moves the particles one step.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn animate(&mut self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let pass = if self.steps == 0 { &self.first } else { &self.turns[self.steps as usize % 2] };
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

    /// Each cluster's vertex buffer, lowest cluster first.
    pub fn vertices(&self) -> &[Arc<Buffer>] {
        &self.vertices
    }

    /// The particles of the last frame's clusters, lowest cluster first.
    pub fn clusters(&self) -> &[Vec<Point>] {
        &self.clusters.particles
    }

    /// The position textures of both states, which take turns.
    pub fn positions(&self) -> [&Arc<ImageView>; 2] {
        self.states.each_ref().map(|state| &state.positions)
    }

    /// Number of particles.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Positions and velocities after the last step; the first state before any.
    pub fn state(&self) -> (&Arc<ImageView>, &Arc<ImageView>) {
        let state = &self.states[self.current()];
        (&state.positions, &state.velocities)
    }

    fn current(&self) -> usize {
        (self.steps.saturating_sub(1) % 2) as usize
    }
}

/// A vertex buffer that the host fills, with room for `count` points. It begins as zeros, so that all of it may be bound
/// however few are drawn.
///
/// # Errors
/// What the Vulkan layer answers.
pub fn host_vertices(shaders: &ShaderLibrary, name: String, count: u64) -> Result<Arc<Buffer>, Error> {
    let desc = BufferDesc::new(name, count * size_of::<Point>() as u64)
        .usage(vk::BufferUsageFlags::VERTEX_BUFFER)
        .location(Location::Upload);
    let buffer = Buffer::new(shaders.device(), desc)?;
    buffer.write(0, &vec![0; buffer.size_bytes() as usize])?;
    Ok(buffer)
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
