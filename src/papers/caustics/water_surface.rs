//! Pass `water-surface` (section 5.2): vertices of the water's mesh in the shape of a sum of sine waves or of a height
//! map.

use std::f64::consts::TAU;
use std::sync::Arc;

use ash::vk;
use glam::DVec2;

use super::resources::Context;
use super::water::{Grid, LEVEL_M, Wave, waves};
use super::water_map::WaterMap;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Location, Pass};
use crate::host_block;

const STORAGE: vk::BufferUsageFlags = vk::BufferUsageFlags::STORAGE_BUFFER;
/// Waves that the shaders' block has room for: the greatest number of `waves`.
const MOST_WAVES: usize = 64;

host_block! {
    pub struct WaveBlock {
        vector: [f32; 2],
        phase_rad: f32,
        amplitude_m: f32,
    }
}

impl WaveBlock {
    /// The wave at a time. Its phase is reduced here, where whole turns of late frames are lost without a trace.
    fn new(wave: &Wave, time_s: f64) -> Self {
        let phase_rad = (wave.phase_rad - wave.angular_frequency * time_s).rem_euclid(TAU);
        WaveBlock {
            vector: wave.vector.as_vec2().to_array(),
            phase_rad: phase_rad as f32,
            amplitude_m: wave.amplitude_m as f32,
        }
    }
}

host_block! {
    /// Placement of a height map: x and z of its node (columns / 2, rows / 2), spacing, samples along x and z.
    pub struct MapBlock {
        node: [f32; 2],
        spacing: [f32; 2],
        columns: u32,
        rows: u32,
    }
}

host_block! {
    struct WavesConstants {
        corner: [f32; 2],
        cell: [f32; 2],
        columns: u32,
        rows: u32,
        wave_count: u32,
        level_m: f32,
    }
}

host_block! {
    struct MapConstants {
        map: MapBlock,
        corner: [f32; 2],
        cell: [f32; 2],
        columns: u32,
        rows: u32,
        level_m: f32,
    }
}

/// Shape of the water on the device.
pub enum Shape {
    Waves {
        /// [`WaveBlock`]\[[`MOST_WAVES`]\] of the frame.
        list: Arc<Buffer>,
        /// The waves before the frame's phases; none for flat water.
        waves: Vec<Wave>,
    },
    Map {
        /// Coefficients of the interpolating spline, one float a sample, row by row.
        coefficients: Arc<Buffer>,
        /// Position, spacing and size of the map.
        place: MapBlock,
    },
}

impl Shape {
    fn new(context: Context<'_>, middle: DVec2) -> Result<Self, Error> {
        match &context.parameters.water_map {
            None => Self::waves(context),
            Some(map) => Self::map(context, middle, map),
        }
    }

    fn waves(context: Context<'_>) -> Result<Self, Error> {
        let size_bytes = size_of::<[WaveBlock; MOST_WAVES]>() as u64;
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let desc = BufferDesc::new(context.name("waves"), size_bytes).usage(usage).location(Location::Upload);
        Ok(Shape::Waves { list: Buffer::new(context.device(), desc)?, waves: waves(context.parameters) })
    }

    fn map(context: Context<'_>, middle: DVec2, map: &WaterMap) -> Result<Self, Error> {
        let coefficients = context
            .upload("water-map", STORAGE, bytemuck::cast_slice(map.coefficients()))
            .map_err(|error| error.set_by("water-map"))?;
        let (columns, rows) = (map.heights().width(), map.heights().height());
        let spacing = map.heights().spacing_m();
        // Places are measured from a node near the middle: far from it single precision has fewer digits to spare.
        let past_middle = |samples: u32| f64::from(samples / 2) - f64::from(samples - 1) / 2.0;
        let node = middle + spacing * DVec2::new(past_middle(columns), past_middle(rows));
        let place = MapBlock { node: node.as_vec2().to_array(), spacing: spacing.as_vec2().to_array(), columns, rows };
        Ok(Shape::Map { coefficients, place })
    }
}

/// The pass, with the water on the device.
pub struct WaterSurface {
    /// The mesh.
    pub grid: Grid,
    /// Positions and normals, row by row.
    pub vertices: Arc<Buffer>,
    /// Three a triangle.
    pub indices: Arc<Buffer>,
    /// Waves or a height map.
    pub shape: Shape,
    pass: Pass,
}

/// Floats of a `WaterVertex` of the shaders: position and normal, four each.
pub const VERTEX_FLOATS: u32 = 8;

impl WaterSurface {
    /// Uploads shape and indices; `middle` is where the middle of a height map lies, x and z in metres.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, grid: Grid, middle: DVec2) -> Result<Self, Error> {
        let shape = Shape::new(context, middle)?;
        let size_bytes = u64::from(grid.vertex_count()) * u64::from(VERTEX_FLOATS) * 4;
        let by_triangles = |error: Error| error.set_by("water-triangles");
        let vertices = Buffer::new(context.device(), BufferDesc::new(context.name("water"), size_bytes).usage(STORAGE));
        let vertices = vertices.map_err(by_triangles)?;
        let usage = vk::BufferUsageFlags::INDEX_BUFFER | STORAGE;
        let indices = context.upload("water-indices", usage, bytemuck::cast_slice(&grid.indices()));
        let indices = indices.map_err(by_triangles)?;
        let pass = |shader| Pass::compute("water-surface", "5.2", shader).with("water", &vertices);
        let pass = match &shape {
            Shape::Waves { list, .. } => {
                pass("caustics/water-surface.comp").with("waves", list).constants::<WavesConstants>()
            }
            Shape::Map { coefficients, .. } => {
                pass("caustics/water-surface-map.comp").with("coefficients", coefficients).constants::<MapConstants>()
            }
        };
        Ok(WaterSurface { grid, vertices, indices, pass: pass.build(context.shaders)?, shape })
    }

    /// Evaluates the surface at `time_s`; a height map stands still.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, time_s: f64) -> Result<(), Error> {
        let Grid { corner, cell, columns, rows } = self.grid;
        let (corner, cell) = (corner.as_vec2().to_array(), cell.as_vec2().to_array());
        let (columns, rows, level_m) = (columns + 1, rows + 1, LEVEL_M as f32);
        if let Shape::Waves { list, waves } = &self.shape {
            let mut blocks: [WaveBlock; MOST_WAVES] = bytemuck::Zeroable::zeroed();
            for (block, wave) in blocks.iter_mut().zip(waves) {
                *block = WaveBlock::new(wave, time_s);
            }
            list.write(0, bytemuck::cast_slice(&blocks))?;
        }
        frame.compute(&self.pass, |dispatch| {
            match &self.shape {
                Shape::Waves { waves, .. } => {
                    let wave_count = waves.len() as u32;
                    dispatch.constants(&WavesConstants { corner, cell, columns, rows, wave_count, level_m })
                }
                Shape::Map { place, .. } => {
                    dispatch.constants(&MapConstants { map: *place, corner, cell, columns, rows, level_m })
                }
            }
            .elements(self.grid.vertex_count());
        })
    }
}
