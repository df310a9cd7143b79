//! Lists of the particles near each one, by which all other passes sum.

use std::sync::Arc;

use ash::vk;

use super::super::gpu_driven::sort::Sort;
use super::super::targets::Context;
use super::over_cells;
use super::sph_neighbours::sph_neighbours;
use super::sph_neighbours_predicted::sph_neighbours_predicted;
use crate::gpu::pass::PassBuilder;
use crate::gpu::transfer::read_buffer;
use crate::gpu::{Buffer, BufferDesc, Device, Error, Pass};

/// Particles of a list, as in `lava/sph.glsl`.
const LISTED: u32 = 96;
/// Particles with a list: as many lists as every device takes in one buffer. All others look at the cells around them.
const MOST_LISTS: u32 = (1 << 27) / (4 * LISTED);

/// The lists, made twice in a step.
pub struct Neighbours {
    /// At the places where the step begins.
    pub began: Pass,
    /// At the predicted ones, with some that only corrections bring near.
    pub predicted: Pass,
    lists: Arc<Buffer>,
    counts: Arc<Buffer>,
    /// Drags of the viscosity, of each that is listed.
    pub drags: Arc<Buffer>,
    crowded: Arc<Buffer>,
}

/// Of so many particles those with a list.
pub fn listed(particles: u32) -> u32 {
    particles.min(MOST_LISTS)
}

/// Bytes of lists and drags for so many particles, and of the largest buffer.
pub fn bytes(particles: u32) -> (f64, f64) {
    let lists = 4.0 * f64::from(LISTED) * f64::from(listed(particles));
    (2.0 * lists + 4.0 * f64::from(particles), lists)
}

/// Particles that a pass looks at, for so many, where each that has no list looks at some.
pub fn looked_at(particles: u32, walked: f64) -> f64 {
    let lists = f64::from(listed(particles));
    lists * walked.min(LISTED.into()) + (f64::from(particles) - lists) * walked
}

impl Neighbours {
    /// Of particles in this order, at first and at their predicted places.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(context: Context<'_>, sort: &Sort, particles: u32, predicted: &Arc<Buffer>) -> Result<Self, Error> {
        let buffer = |name: &str, words: u64| {
            let desc = BufferDesc::new(context.name(name), 4 * words).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
            Buffer::new(context.device(), desc).map_err(|error| error.set_by("particles"))
        };
        let words = u64::from(LISTED) * u64::from(listed(particles));
        let (lists, drags) = (buffer("neighbours", words)?, buffer("drags", words)?);
        let counts = buffer("neighbour-counts", particles.into())?;
        let crowded = context.upload("crowded", vk::BufferUsageFlags::STORAGE_BUFFER, bytemuck::bytes_of(&0u32))?;
        Ok(Neighbours {
            began: sph_neighbours(context.shaders, sort, [&lists, &counts], &crowded)?,
            predicted: sph_neighbours_predicted(context.shaders, sort, [&lists, &counts], predicted)?,
            lists,
            counts,
            drags,
            crowded,
        })
    }

    /// Begins a pass that looks at the particles near each.
    pub fn over(&self, name: &'static str, shader: &str, sort: &Sort) -> PassBuilder {
        over_cells(name, shader, sort).with("neighbours", &self.lists).with("neighbour_counts", &self.counts)
    }

    /// Fails where a device's loops left particles out.
    ///
    /// # Errors
    /// [`Error::Pass`] for more particles in one place than a loop may take; errors of the Vulkan layer.
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        let bytes = read_buffer(device, &self.crowded)?;
        if bytes.iter().all(|byte| *byte == 0) {
            return Ok(());
        }
        let problem =
            "more than 7,200 particles lie in three cells above each other, beyond which drivers end loops; take a \
                       shorter `time-step` or fewer `particles`"
                .to_owned();
        Err(Error::Pass { pass: "sph-neighbours".to_owned(), problem })
    }
}
