//! `refinement` (4.4): the triangles of the refinement pattern that are in use, and the level of detail that they are
//! drawn at (4.5).

use std::sync::Arc;

use ash::vk;

use super::buffers::Buffers;
use super::framing;
use super::model::{Model, tree};
use super::parameters::Parameters;
use crate::gpu::transfer::upload;
use crate::gpu::{Buffer, Error, Frame, Pass, ShaderLibrary};
use crate::host_block;

host_block! {
    /// Push constants of `burning/refinement.comp`.
    struct Dispatch {
        /// Level of the nodes to split.
        level: u32,
        /// Barycentric points of a coarse triangle.
        points: u32,
    }
}

/// The pass of an object whose triangles are refined where they are about to burn.
pub struct Refinement {
    /// int\[coarse triangles * nodes\]: -1 split, 0 unused, 1 drawn. Nodes of a coarse triangle stand level by level.
    pub statuses: Arc<Buffer>,
    /// The finest level that is drawn.
    pub(super) level_of_detail: u32,
    /// Finds the eligible coarse triangles, splits nodes above the finest level, and splits the others.
    steps: [Pass; 3],
    levels: u32,
    coarse_count: u32,
    /// Barycentric points of a coarse triangle.
    points: u32,
}

impl Refinement {
    /// Makes the state in which the coarse triangles alone are in use.
    ///
    /// # Errors
    /// [`Error::Limit`] for more nodes than the device binds; what Vulkan answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        buffers: &mut Buffers,
        model: &Model,
    ) -> Result<Self, Error> {
        let (levels, coarse_count) = (model.levels, model.coarse_count());
        let table = |name: &str, bytes: &[u8]| {
            let usage = vk::BufferUsageFlags::STORAGE_BUFFER;
            upload(shaders.device(), &format!("{label}/{name}"), usage, bytes)
        };
        let mut statuses = vec![0; coarse_count as usize * tree::nodes_of(levels) as usize];
        for root in statuses.iter_mut().step_by(tree::nodes_of(levels) as usize) {
            *root = 1;
        }
        let points = tree::barycentric_points(levels);
        let statuses = table("statuses", bytemuck::cast_slice::<i32, u8>(&statuses))?;
        let eligible = table("eligible", &vec![0; 4 * coarse_count as usize])?;
        let step = |name: &str| {
            Pass::compute("refinement", "4.4", &format!("burning/refinement-{name}.comp"))
                .constants::<Dispatch>()
                .with("constants", &buffers.constants)
                .with("Triangles", &buffers.triangles)
        };
        let find = step("eligible")
            .with("BarycentricPoints", &table("barycentric-points", bytemuck::cast_slice(&points))?)
            .with("Labels", &buffers.labels)
            .with("Eligible", &eligible);
        let split = |name: &str| step(name).with("Statuses", &statuses).with("Alive", &buffers.alive);
        let split_finest = split("finest").with("TriangleLabels", &buffers.triangle_labels).with("Eligible", &eligible);
        let steps = Pass::steps([find.build(shaders)?, split_finest.build(shaders)?, split("inner").build(shaders)?]);
        buffers.keep(shaders, &statuses)?;
        buffers.keep(shaders, &eligible)?;
        let level_of_detail = drawn_level(parameters, model, levels);
        Ok(Refinement { statuses, level_of_detail, steps, levels, coarse_count, points: points.len() as u32 })
    }

    /// Nodes of the patterns of all coarse triangles.
    pub(super) fn node_count(&self) -> u32 {
        self.coarse_count * tree::nodes_of(self.levels)
    }

    /// Splits what the areas of this tick ask for.
    ///
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        let mut run = |step: &Pass, level: u32, threads: u32| {
            let constants = Dispatch { level, points: self.points };
            frame.compute(step, |dispatch| dispatch.constants(&constants).elements(self.coarse_count * threads))
        };
        let [find, split_finest, split] = &self.steps;
        run(find, self.levels, self.points)?;
        // A level reads what the one below it wrote.
        (0..self.levels).rev().try_for_each(|level| {
            let step = if level + 1 == self.levels { split_finest } else { split };
            run(step, level, tree::triangles_of(level))
        })
    }
}

/// Finest level that is drawn: the user's, or by the distance of the camera.
pub(super) fn drawn_level(parameters: &Parameters, model: &Model, levels: u32) -> u32 {
    let distance = framing::camera(parameters, model).eye.distance(model.bounds.center());
    parameters.level_of_detail.unwrap_or_else(|| level_of_detail(levels, distance)).min(levels)
}

/// Distance from the camera to the object's middle, in diagonals, up to which all levels are drawn.
const FULL_DETAIL: f32 = 2.5;

/// The finest level that an object of `levels` levels is drawn at from `distance` diagonals away: one less from
/// [`FULL_DETAIL`] on and for each doubling. Nearer is finer; the text's "directly proportional to the distance" is the
/// other way round.
pub fn level_of_detail(levels: u32, distance: f32) -> u32 {
    let left_out = (distance / FULL_DETAIL).log2().ceil().max(0.0);
    levels.saturating_sub(left_out as u32)
}

#[cfg(test)]
mod tests {
    use super::level_of_detail;

    #[test]
    fn each_doubling_of_the_distance_leaves_a_level_out() {
        let levels = [0.0, 1.7, 2.5, 2.6, 5.0, 5.1, 20.0, 45.0, 1e9].map(|d| level_of_detail(5, d));
        assert_eq!(levels, [5, 5, 5, 4, 4, 3, 2, 0, 0]);
        assert_eq!(level_of_detail(2, 6.0), 0);
    }
}
