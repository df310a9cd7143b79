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
    /// A wavefront: the entries of one distance from the light's cell. Lengths are in entries of the table.
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
        /// Distance along columns' and rows' axis that is not counted.
        free: [i32; 2],
        /// Unit vectors along the axes of columns and of rows.
        column_axis: [i32; 3],
        /// First entry of the volume's and light's sums.
        first_sum: u32,
        row_axis: [i32; 3],
    }
}

/// The pass `shadow-table`.
pub struct ShadowTable {
    /// Sums of density times metres: a table a volume and light, `table_size` entries along each axis, x fastest, of each its own
    /// and that of the one after it in x.
    pub sums: Arc<Buffer>,
    pass: Pass,
    sweeps: Vec<Sweep>,
    size: u32,
}

/// The wavefronts that fill the table of one volume and light: the entries of one Manhattan distance from the light's cell,
/// along each axis from where on it is the longest of some entry's ray to the light. An entry follows from some that are one
/// nearer along the longest axis of its own ray, and no farther along the others.
struct Sweep {
    /// Of distance 0.
    first: WaveConstants,
    /// Distance along each axis that is not counted: no entry within it has its longest way along the axis.
    free: [i32; 3],
    /// Axes of columns and of rows; along the third one, where all distance counts, the entries of a wavefront are found.
    axes: [usize; 2],
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
                        sweep.axes.map(|axis| sweep.extent(axis, wave as i32, self.size as i32));
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
        // The least and the greatest length of all entries' rays along each axis; 1e-4 is far beyond rounding.
        let lengths = source.map(|along| match is_point {
            false => (along.abs(), along.abs()),
            true => ((-along).max(along - last as f32).max(0.0), along.abs().max((along - last as f32).abs())),
        });
        let least = |axis: usize| lengths[axis].0 * (1.0 - 1e-4);
        let free = [0, 1, 2].map(|axis| {
            let wanted = least((axis + 1) % 3).max(least((axis + 2) % 3));
            // Its length at distance d: in the light's own cell, and in those beside it, that much more than d at most.
            let at_cell = if (0..last).contains(&cell[axis]) { 1.0 } else { lengths[axis].0 };
            match is_point {
                _ if lengths[axis].1 < wanted => last + 1,
                true => ((wanted - at_cell).ceil() as i32).saturating_sub(1).clamp(0, last + 1),
                false => 0,
            }
        });
        // The axis of which the shortest ray is the longest counts from 0 on.
        let axes = match free {
            [_, _, 0] => [0, 1],
            [_, 0, _] => [0, 2],
            _ => [1, 2],
        };
        let unit = |axis: usize| [0, 1, 2].map(|other| i32::from(other == axis));
        let farthest: i32 = (0..3).map(|axis| (farthest_from(cell[axis], last) - free[axis]).max(0)).sum();
        Sweep {
            first: WaveConstants {
                source,
                is_point: is_point.into(),
                spacing_m: spacing_m.to_array(),
                distance: 0,
                cell,
                first_density,
                first_column: [0; 2],
                free: axes.map(|axis| free[axis]),
                column_axis: unit(axes[0]),
                first_sum,
                row_axis: unit(axes[1]),
            },
            free,
            axes,
            count: farthest as u32 + 1,
        }
    }

    /// The first entry along an axis that a wavefront may have, and the number of those from there on.
    fn extent(&self, axis: usize, distance: i32, size: i32) -> (i32, u32) {
        let last = size - 1;
        let farthest = |other: usize| (farthest_from(self.first.cell[other], last) - self.free[other]).max(0);
        let of_others: i32 = (0..3).filter(|&other| other != axis).map(farthest).sum();
        let nearest = if distance > of_others { distance - of_others + self.free[axis] } else { 0 };
        let farthest = distance + self.free[axis];
        let (low, high) = match self.first.cell[axis] {
            -1 => (nearest, farthest),
            cell if cell == last => (last - farthest, last - nearest),
            cell => (cell - farthest, cell + 1 + farthest),
        };
        let (low, high) = (low.max(0), high.min(last));
        (low, (high - low + 1).max(1) as u32)
    }
}

/// Distance from a cell to the farther end of its axis, in entries.
fn farthest_from(cell: i32, last: i32) -> i32 {
    cell.max(last - 1 - cell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::gas::parameters::default_volume;
    use crate::papers::gas::scenes::Preset;

    fn point(x: f32, y: f32, z: f32) -> Light {
        Light::Point { position: Vec3::new(x, y, z), intensity: Vec3::ONE }
    }

    fn parallel(x: f32, y: f32, z: f32) -> Light {
        Light::Parallel { direction: Vec3::new(x, y, z), intensity: Vec3::ONE }
    }

    /// The wavefronts' extents hold every entry of their distance, and those of a light beside the table are not half empty.
    #[test]
    fn extents_hold_their_entries() {
        let size = 9;
        let lights = [point(0.3, -0.2, 0.6), point(3.0, 0.1, -4.0), point(2.0, 5.0, 3.0), point(1.0, 1.0, 1.0)];
        let sides = [
            parallel(1.0, 0.2, 0.0),
            parallel(0.1, -1.0, 0.3),
            parallel(0.0, 0.0, 1.0),
            point(0.1, 9.0, 0.2),
            point(0.3, 1e12, 0.2),
        ];
        let slanted = [point(2.2, 0.4, 3.0), point(-3.0, -2.2, 0.2), point(0.3, 1.5, -0.4)];
        for light in lights.into_iter().chain(sides).chain(slanted) {
            let sweep = Sweep::new(&default_volume(), &light, size, 0, 0);
            let along = |entry: i32, cell: i32| if entry <= cell { cell - entry } else { entry - cell - 1 };
            let (mut entries, mut threads) = (0, 0);
            for wave in 0..sweep.count as i32 {
                let [(x, columns), (y, rows)] = sweep.axes.map(|axis| sweep.extent(axis, wave, size as i32));
                threads += columns * rows;
                for i in 0..(size * size * size) as i32 {
                    let entry = [i % 9, i / 9 % 9, i / 81];
                    let counted =
                        (0..3).map(|axis| (along(entry[axis], sweep.first.cell[axis]) - sweep.free[axis]).max(0));
                    if counted.sum::<i32>() == wave {
                        entries += 1;
                        let is_in =
                            |axis: usize, first: i32, count: u32| (first..first + count as i32).contains(&entry[axis]);
                        let [column, row] = sweep.axes;
                        assert!(is_in(column, x, columns) && is_in(row, y, rows), "{light:?} {wave} {entry:?}");
                    }
                }
            }
            assert_eq!(entries, size * size * size, "{light:?}");
            assert!(threads < 2 * entries, "{light:?}: {threads}");
        }
    }

    /// An entry's wavefront is after those of all that it follows from: one nearer along the longest axis of its ray, and as near
    /// or one nearer along the others.
    #[test]
    fn wavefronts_follow_what_they_read() {
        let size = 9;
        let mut random = crate::scene::random::Random::new(5);
        for light in 0..300 {
            let place = [0; 3].map(|_| random.range(-4.0, 4.0));
            let light = if light % 5 == 0 {
                parallel(place[0], place[1], place[2])
            } else {
                point(place[0], place[1], place[2])
            };
            let sweep = Sweep::new(&default_volume(), &light, size, 0, 0);
            let WaveConstants { source, is_point, cell, .. } = sweep.first;
            let wave = |entry: [i32; 3]| -> i32 {
                let along = |axis: usize| match entry[axis] <= cell[axis] {
                    true => cell[axis] - entry[axis],
                    false => entry[axis] - cell[axis] - 1,
                };
                (0..3).map(|axis| (along(axis) - sweep.free[axis]).max(0)).sum()
            };
            assert_eq!(sweep.free[3 - sweep.axes[0] - sweep.axes[1]], 0, "{light:?}");
            for i in 0..729 {
                let entry = [i % 9, i / 9 % 9, i / 81];
                let way = [0, 1, 2].map(|a| if is_point == 0 { source[a] } else { source[a] - entry[a] as f32 });
                let longest = way.iter().fold(0.0_f32, |most, w| most.max(w.abs()));
                let leaves = |a: usize| (entry[a] == 0 && way[a] < 0.0) || (entry[a] == 8 && way[a] > 0.0);
                if (0..3).any(leaves) || (is_point != 0 && longest <= 1.0) {
                    continue;
                }
                let axis = (0..3).find(|&a| way[a].abs() == longest).unwrap();
                let step = way.map(|w| if w >= 0.0 { 1 } else { -1 });
                for corner in 0..4 {
                    let moved = |a: usize| a == axis || corner >> i32::from(a == (axis + 1) % 3) & 1 == 1;
                    let read = [0, 1, 2].map(|a| (entry[a] + if moved(a) { step[a] } else { 0 }).clamp(0, 8));
                    assert!(wave(read) < wave(entry), "{light:?}: {entry:?} reads {read:?}");
                }
            }
        }
    }

    /// Under a light at infinity, and under a far one along an axis, a wavefront is a plane; a second axis counts from where on
    /// some ray is longest along it.
    #[test]
    fn wavefronts_are_as_few_as_the_rays_allow() {
        let count = |light: Light| Sweep::new(&default_volume(), &light, 64, 0, 0).count;
        assert_eq!(count(parallel(0.3, -1.0, 0.45)), 64);
        assert_eq!(count(parallel(1.0, 0.0, 0.0)), 64);
        assert_eq!(count(point(0.2, 0.1, -20.0)), 64);
        assert_eq!(count(point(9.0, 0.1, 9.0)), 127);
        let steam = Preset::Fig8.scene().parameters;
        assert_eq!(Sweep::new(&steam.volumes[0], &steam.lights[0], 64, 0, 0).count, 69);
        assert_eq!(count(parallel(1.0, 1.0, 1.0)), 190, "of equal lengths any is the longest");
        assert!(count(point(0.1, 0.2, 0.3)) < 190, "inside");
    }
}
