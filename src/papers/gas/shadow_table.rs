//! `shadow-table`: the density between each entry and each light, summed (section "Calculation of the shadow table").

use std::sync::Arc;

use glam::Vec3;

use super::context::Context;
use super::model::Volume;
use super::scene_buffers::SceneBuffers;
use crate::gpu::{Buffer, Error, Frame, Pass};
use crate::host_block;
use crate::scene::Light;

host_block! {
    /// A wavefront: the entries of one Manhattan distance from the light's cell. Lengths are in entries of the table.
    struct WaveConstants {
        /// A point light's position, or the direction towards a light at infinity.
        source: [f32; 3],
        is_point: u32,
        /// Metres between entries.
        spacing_m: [f32; 3],
        distance: i32,
        cell: [i32; 3],
        /// First entry of the volume's densities.
        first_density: u32,
        /// First column and row of entries that the wavefront may have.
        first_column: [i32; 2],
        /// First entry of the volume's and light's sums.
        first_sum: u32,
    }
}

/// The pass `shadow-table`.
pub struct ShadowTable {
    /// Sums of density times metres: a table a volume and light, `table_size` entries along each axis, x fastest.
    pub sums: Arc<Buffer>,
    pass: Pass,
    sweeps: Vec<Sweep>,
    size: u32,
}

/// The wavefronts that fill the table of one volume and light.
struct Sweep {
    /// Of distance 0.
    first: WaveConstants,
    count: u32,
}

impl ShadowTable {
    /// # Errors
    /// [`Error::Limit`] for tables beyond what the device binds.
    pub fn new(context: &Context<'_>, scene: &SceneBuffers, densities: &Arc<Buffer>) -> Result<Self, Error> {
        let parameters = context.parameters;
        let size = parameters.table_size;
        let sums = context.table("shadow-table", (parameters.volumes.len() * parameters.lights.len()) as u64)?;
        let pass = Pass::compute("shadow-table", "Shadow table", "gas/shadow-table.comp")
            .with("frame", &scene.frame)
            .with("DensityTables", densities)
            .with("ShadowTables", &sums)
            .constants::<WaveConstants>()
            .build(context.shaders)?;
        let mut sweeps = Vec::new();
        for (v, volume) in parameters.volumes.iter().enumerate() {
            for light in &parameters.lights {
                // The limit on buffers keeps both below 2^32.
                let [density, sum] = [v, sweeps.len()].map(|table| (table as u64 * u64::from(size).pow(3)) as u32);
                sweeps.push(Sweep::new(volume, light, size, density, sum));
            }
        }
        Ok(ShadowTable { sums, pass, sweeps, size })
    }

    /// A wave reads what the one before it wrote: each is a call of its own, with a barrier between them.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let most = self.sweeps.iter().map(|s| s.count).max().unwrap_or(0);
        for wave in 0..most {
            frame.compute(&self.pass, |dispatch| {
                for sweep in self.sweeps.iter().filter(|s| wave < s.count) {
                    let [(x, columns), (y, rows)] =
                        [0, 1].map(|axis| sweep.extent(axis, wave as i32, self.size as i32));
                    let constants = WaveConstants { distance: wave as i32, first_column: [x, y], ..sweep.first };
                    dispatch.constants(&constants).threads(columns, rows, 1);
                }
            })?;
        }
        Ok(())
    }
}

impl Sweep {
    fn new(volume: &Volume, light: &Light, size: u32, first_density: u32, first_sum: u32) -> Self {
        let last = size as i32 - 1;
        let spacing_m = 2.0 * volume.half_extent_m / last as f32;
        let (source, is_point) = match *light {
            Light::Parallel { direction, .. } => (-direction.normalize_or(Vec3::NEG_Y) / spacing_m, false),
            Light::Point { position, .. } => ((position - (volume.center - volume.half_extent_m)) / spacing_m, true),
        };
        let source = source.to_array();
        let cell = source.map(|along| match is_point {
            false if along >= 0.0 => last,
            true if along > last as f32 => last,
            _ if along < 0.0 => -1,
            _ => (along.floor() as i32).min(last - 1),
        });
        // The farther end of each axis, in entries from the cell.
        let farthest: i32 = cell.iter().map(|&c| c.max(last - 1 - c)).sum();
        Sweep {
            first: WaveConstants {
                source,
                is_point: is_point.into(),
                spacing_m: spacing_m.to_array(),
                distance: 0,
                cell,
                first_density,
                first_column: [0; 2],
                first_sum,
            },
            count: farthest.max(0) as u32 + 1,
        }
    }

    /// The first entry along an axis that a wavefront may have, and the number of those from there on.
    fn extent(&self, axis: usize, distance: i32, size: i32) -> (i32, u32) {
        let last = size - 1;
        let farthest = |cell: i32| cell.max(last - 1 - cell);
        let of_others: i32 = (0..3).filter(|&other| other != axis).map(|other| farthest(self.first.cell[other])).sum();
        let nearest = (distance - of_others).max(0);
        let (low, high) = match self.first.cell[axis] {
            -1 => (nearest, distance),
            cell if cell == last => (last - distance, last - nearest),
            cell => (cell - distance, cell + 1 + distance),
        };
        let (low, high) = (low.max(0), high.min(last));
        (low, (high - low + 1).max(1) as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::gas::parameters::default_volume;

    /// The wavefronts' extents hold every entry of their distance, and those of a light beside the table are not half empty.
    #[test]
    fn extents_hold_their_entries() {
        let size = 9;
        for position in [Vec3::new(0.3, -0.2, 0.6), Vec3::new(3.0, 0.1, -4.0), Vec3::new(2.0, 5.0, 3.0), Vec3::ONE] {
            let light = Light::Point { position, intensity: Vec3::ONE };
            let sweep = Sweep::new(&default_volume(), &light, size, 0, 0);
            let along = |entry: i32, cell: i32| if entry <= cell { cell - entry } else { entry - cell - 1 };
            let (mut entries, mut threads) = (0, 0);
            for wave in 0..sweep.count as i32 {
                let [(x, columns), (y, rows)] = [0, 1].map(|axis| sweep.extent(axis, wave, size as i32));
                threads += columns * rows;
                for i in 0..(size * size * size) as i32 {
                    let entry = [i % 9, i / 9 % 9, i / 81];
                    if (0..3).map(|axis| along(entry[axis], sweep.first.cell[axis])).sum::<i32>() == wave {
                        entries += 1;
                        let is_in = |entry: i32, first: i32, count: u32| (first..first + count as i32).contains(&entry);
                        assert!(is_in(entry[0], x, columns) && is_in(entry[1], y, rows), "{position} {wave} {entry:?}");
                    }
                }
            }
            assert_eq!(entries, size * size * size, "{position}");
            assert!(threads < 2 * entries, "{position}: {threads}");
        }
    }
}
