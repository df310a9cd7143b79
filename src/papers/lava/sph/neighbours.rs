//! Lists of the particles near each one, by which all other passes sum.

use std::sync::Arc;

use ash::vk;

use super::super::gpu_driven::by_cells::texture_of_rows;
use super::super::gpu_driven::sort::Sort;
use super::super::targets::Context;
use super::over_places;
use super::sph_neighbours::sph_neighbours;
use super::sph_neighbours_predicted::sph_neighbours_predicted;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, BufferDesc, Device, Error, ImageView, Pass};
use crate::papers::texels::{self, ROW};

/// Particles of a list, as in `lava/sph.glsl`.
const LISTED: u32 = 96;
/// Particles in three cells above each other at most, as there.
pub const MOST_IN_COLUMN: u32 = 7200;
/// Of a stretch through the whole height at most, for the crust's relief, as in `lava/crust-relief.comp`.
const MOST_OF_RELIEF: u32 = MOST_IN_COLUMN / 4;
/// Lists in a row of their textures, in eights that lie side by side, as there.
const LISTS_OF_ROW: u32 = ROW / (8 * LISTED / 4) * 8;
/// Particles with a list: as many lists as every device takes in one texture. All others look at the cells around them.
const MOST_LISTS: u32 = LISTS_OF_ROW * ROW; // every device has as many rows

/// The lists, made twice in a step.
pub struct Neighbours {
    /// At the places where the step begins.
    pub began: Pass,
    /// At the predicted ones, with some that only corrections bring near.
    pub predicted: Pass,
    lists: Arc<ImageView>,
    counts: Arc<Buffer>,
    /// Drags of the viscosity, of each that is listed.
    pub drags: Arc<ImageView>,
    /// uint\[4\], as in `lava/crowded.glsl`: 1 where a pass left out particles that count.
    pub crowded: Arc<Buffer>,
}

/// Of so many particles those with a list.
pub fn listed(particles: u32) -> u32 {
    particles.min(MOST_LISTS)
}

/// Bytes of so many particles' lists and drags, and of the five textures by cells.
pub fn bytes(particles: u32) -> f64 {
    let rows = 2 * listed(particles).div_ceil(LISTS_OF_ROW) + 5 * particles.div_ceil(ROW);
    texels::bytes_of_rows(rows) as f64 + 4.0 * f64::from(particles)
}

/// Particles that a pass looks at, for so many, where each that has no list looks at some.
pub fn looked_at(particles: u32, walked: f64) -> f64 {
    let lists = f64::from(listed(particles));
    lists * walked.min(LISTED.into()) + (f64::from(particles) - lists) * walked
}

impl Neighbours {
    /// Of particles in this order, and at `predicted` places.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, sort: &Sort, particles: u32, predicted: &Arc<ImageView>) -> Result<Self, Error> {
        let rows = listed(particles).div_ceil(LISTS_OF_ROW);
        let lists = texture_of_rows(context, "neighbours", rows)?;
        let drags = texture_of_rows(context, "drags", rows)?;
        let desc = BufferDesc::new(context.name("neighbour-counts"), 4 * u64::from(particles));
        let counts = Buffer::new(context.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
            .map_err(|error| error.set_by("particles"))?;
        let crowded =
            context.upload("crowded", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&[0u32; 4]))?;
        Ok(Neighbours {
            began: sph_neighbours(context.shaders, sort, (&lists, &counts), &crowded)?,
            predicted: sph_neighbours_predicted(context.shaders, sort, (&lists, &counts), predicted)?,
            lists,
            counts,
            drags,
            crowded,
        })
    }

    /// Begins a pass that looks at the particles near each.
    pub fn over(&self, name: &'static str, shader: &str, sort: &Sort) -> PassBuilder {
        over_places(name, shader, sort).with("neighbours", &self.lists).with("neighbour_counts", &self.counts)
    }

    /// Fails where particles that count were left out, since a device would end the loops over them.
    ///
    /// # Errors
    /// [`Error::Pass`] for more particles in one place than a loop may take; errors of the Vulkan layer.
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(device, &self.crowded)?);
        let (shorter, smaller) =
            ("a shorter `time-step` or fewer `particles`", "fewer `particles` or a smaller `space`");
        let passes = [
            ("sph-neighbours", MOST_IN_COLUMN, "in three cells above each other", shorter),
            ("surface-temperature", MOST_IN_COLUMN, "near the surface in one column of cells", smaller),
            ("surface-motion", MOST_IN_COLUMN, "in one column of cells", smaller),
            ("crust-relief", MOST_OF_RELIEF, "near the surface in one column of cells", smaller),
        ];
        let Some(((pass, most, place, remedy), _)) = passes.into_iter().zip(words).find(|(_, word)| *word != 0) else {
            return Ok(());
        };
        let problem = format!("more than {most} particles lie {place}, beyond which drivers end loops; take {remedy}");
        Err(Error::Pass { pass: pass.to_owned(), problem })
    }
}
