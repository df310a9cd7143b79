//! Density and shadow tables (section "Calculation of the shadow table").

use std::sync::Arc;

use ash::vk;
use glam::Vec3;

use super::geometry::Geometry;
use super::model::Volume;
use super::parameters::Parameters;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;
use crate::scene::Light;

const SECTION: &str = "Shadow table";

host_block! {
    struct TableConstants {
        volume: u32,
    }
}

host_block! {
    struct WaveConstants {
        source: [f32; 3],
        is_point: u32,
        spacing_m: [f32; 3],
        distance: i32,
        cell: [i32; 3],
        first_density: u32,
        first_sum: u32,
    }
}

/// The tables of all volumes and lights.
pub struct Tables {
    /// A table a volume; x runs fastest.
    pub densities: Arc<Buffer>,
    /// A table a volume and light.
    pub shadows: Arc<Buffer>,
    density_pass: Pass,
    shadow_pass: Pass,
    sweeps: Vec<Sweep>,
    size: u32,
    volume_count: u32,
}

/// The wavefronts that fill the table of one volume and light.
struct Sweep {
    constants: WaveConstants,
    waves: u32,
}

impl Tables {
    /// # Errors
    /// [`Error::Limit`] for tables beyond what the device binds.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        geometry: &Geometry,
        parameters: &Parameters,
    ) -> Result<Self, Error> {
        let size = parameters.table_size;
        let entries = u64::from(size).pow(3);
        let volume_count = parameters.volumes.len();
        let table_count = (volume_count * parameters.lights.len()) as u64;
        let buffer = |name: &str, count: u64| {
            let desc = BufferDesc::new(format!("{label}/{name}"), 4 * entries * count);
            let buffer = Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER));
            buffer.map_err(|error| error.set_by("--table"))
        };
        let densities = buffer("density-table", volume_count as u64)?;
        let shadows = buffer("shadow-table", table_count)?;
        let density_pass = Pass::compute("density-table", SECTION, "gas/density-table.comp")
            .with("frame", &geometry.frame)
            .with("Volumes", &geometry.volumes)
            .with("Offsets", &geometry.offsets)
            .with("DensityTables", &densities)
            .constants::<TableConstants>()
            .build(shaders)?;
        let shadow_pass = Pass::compute("shadow-table", SECTION, "gas/shadow-table.comp")
            .with("frame", &geometry.frame)
            .with("DensityTables", &densities)
            .with("ShadowTables", &shadows)
            .constants::<WaveConstants>()
            .build(shaders)?;
        let mut sweeps = Vec::new();
        for (v, volume) in parameters.volumes.iter().enumerate() {
            for light in &parameters.lights {
                // The limit on buffers keeps both below 2^32.
                let [first_density, first_sum] = [v, sweeps.len()].map(|table| (table as u64 * entries) as u32);
                let sweep = Sweep::new(volume, light, size);
                let constants = WaveConstants { first_density, first_sum, ..sweep.constants };
                sweeps.push(Sweep { constants, ..sweep });
            }
        }
        let volume_count = volume_count as u32;
        Ok(Tables { densities, shadows, density_pass, shadow_pass, sweeps, size, volume_count })
    }

    /// Fills all tables.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.compute(&self.density_pass, |dispatch| {
            for volume in 0..self.volume_count {
                dispatch.constants(&TableConstants { volume }).threads(self.size, self.size, self.size);
            }
        })?;
        // A wave reads what the one before it wrote: each is a call of its own, with a barrier between them.
        let most = self.sweeps.iter().map(|s| s.waves).max().unwrap_or(0);
        for wave in 0..most {
            frame.compute(&self.shadow_pass, |dispatch| {
                for sweep in self.sweeps.iter().filter(|s| wave < s.waves) {
                    let constants = WaveConstants { distance: wave as i32, ..sweep.constants };
                    dispatch.constants(&constants).threads(self.size, self.size, 1);
                }
            })?;
        }
        Ok(())
    }
}

impl Sweep {
    fn new(volume: &Volume, light: &Light, size: u32) -> Self {
        let last = size as i32 - 1;
        let spacing = 2.0 * volume.half_extent_m / last as f32;
        let (source, is_point) = match *light {
            Light::Parallel { direction, .. } => (-direction.normalize_or(Vec3::NEG_Y) / spacing, 0),
            Light::Point { position, .. } => ((position - (volume.center - volume.half_extent_m)) / spacing, 1),
        };
        let cell = source.to_array().map(|along| match light {
            Light::Parallel { .. } => {
                if along >= 0.0 {
                    last
                } else {
                    -1
                }
            }
            Light::Point { .. } if along < 0.0 => -1,
            Light::Point { .. } if along > last as f32 => last,
            Light::Point { .. } => (along.floor() as i32).min(last - 1),
        });
        // The farther end of each axis, in entries from the cell.
        let farthest: i32 = cell.iter().map(|&c| c.max(last - 1 - c)).sum();
        Sweep {
            constants: WaveConstants {
                source: source.to_array(),
                is_point,
                spacing_m: spacing.to_array(),
                distance: 0,
                cell,
                first_density: 0,
                first_sum: 0,
            },
            waves: farthest.max(0) as u32 + 1,
        }
    }
}
