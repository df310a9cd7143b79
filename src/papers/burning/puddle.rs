//! `puddle`: what melts gathers on the ground. Ours: the dissertation's wax loses its volume.

use std::sync::Arc;

use ash::vk;

use super::Burning;
use super::buffers::Buffers;
use super::ping_pong::{self, PingPong, Work, new, old};
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Volumes of the wax (`burning/puddle.glsl`), in 2^32ths of a cubed diagonal.
    #[derive(Default)]
    pub struct Film {
        /// That the mesh encloses after the tick.
        pub mesh_volume: i32,
        /// That it enclosed after the first tick.
        pub volume_at_start: i32,
        /// Of the puddle before the tick.
        pub puddle_volume: u32,
        /// Of the puddle after it.
        pub spread_volume: u32,
        /// That has evaporated.
        pub evaporated: u32,
        /// Of the vertices that melted in the tick.
        pub weight: u32,
        /// 1 after the first tick.
        pub has_started: u32,
        /// That had evaporated before the tick.
        pub evaporated_before: u32,
    }
}

/// Cells along each side.
pub const PUDDLE_CELLS: u32 = 128;
/// Of the square that they cover about the object's base, diagonals.
pub const PUDDLE_HALF_WIDTH: f32 = 1.28;

/// Of the buffers: heights twice over, what has melted, and the corners of the drawn cells.
pub(super) const BYTES: u32 = 4 * PUDDLE_CELLS * PUDDLE_CELLS * (2 * 2 + 1 + 6);

/// The pass with its buffers.
pub struct Puddle {
    steps: PingPong<5>,
    /// uint\[cells\] twice, ping-pong as the states are: volume over each cell.
    pub heights: [Arc<Buffer>; 2],
    /// [`Film`].
    pub film: Arc<Buffer>,
}

impl Burning {
    /// The puddle, of what melts.
    pub fn puddle(&self) -> Option<&Puddle> {
        self.puddle.as_ref()
    }
}

impl Puddle {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(shaders: &ShaderLibrary, label: &str, buffers: &mut Buffers) -> Result<Self, Error> {
        let cells = PUDDLE_CELLS * PUDDLE_CELLS;
        let zeros = |name: &str, bytes: usize| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(shaders.device(), &format!("{label}/{name}"), usage, &vec![0; bytes])
        };
        let heights = [zeros("puddle-a", 4 * cells as usize)?, zeros("puddle-b", 4 * cells as usize)?];
        let film = zeros("film", size_of::<Film>())?;
        let melted = zeros("melted", 4 * cells as usize)?;
        let volumes = buffers.triangle_chunks.word(shaders, &format!("{label}/chunk-volumes"))?;
        for buffer in heights.iter().chain([&film, &volumes]) {
            buffers.keep(shaders, buffer)?;
        }
        let step = |name: &str| Pass::compute("puddle", "", &format!("burning/{name}.comp")).with("Films", &film);
        let clear = step("puddle-clear").with("Melted", &melted);
        let volume = step("puddle-volume")
            .with("constants", &buffers.constants)
            .with("Triangles", &buffers.triangles)
            .with("Volumes", &volumes);
        let volume = buffers.triangle_chunks.changing(volume);
        let weights = step("puddle-weights")
            .with("constants", &buffers.constants)
            .with("Labels", &buffers.labels)
            .with("Alive", &buffers.alive)
            .with("Melted", &melted);
        let weights = buffers.vertex_chunks.changing(weights);
        let spread = step("puddle").with("constants", &buffers.constants).with("Melted", &melted);
        let [before, after] = [old("OldState", &buffers.states), new("NewState", &buffers.states)];
        let rising = [old("OldHeights", &heights), new("NewHeights", &heights)];
        let build = |pass, swapped: &[_]| ping_pong::build(shaders, pass, swapped);
        let steps = PingPong::new([
            (build(clear, &[])?, Work::Elements(cells)),
            (build(volume, &[after])?, Work::Indirect),
            (build(step("puddle-start"), &[])?, Work::Elements(1)),
            (build(weights, &[before, after])?, Work::Indirect),
            (build(spread, &rising)?, Work::Elements(cells)),
        ]);
        Ok(Puddle { steps, heights, film })
    }

    /// Records the tick that writes the state of index `tick`.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, tick: usize) -> Result<(), Error> {
        self.steps.record(frame, tick)
    }
}
