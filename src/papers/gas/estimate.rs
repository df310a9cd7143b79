//! Sizes that follow from the parameters and the surfaces.

use super::blocks::{ColorBlock, LinkBlock, ObjectBlock, PixelBlock, SectionBlock, SurfaceBlock};
use super::capacity::{BufferLimit, Capacity};
use super::grid::Filter;
use super::model::Object;
use super::parameters::{March, Parameters, Variant};
use super::progress::StateBlock;
use super::tiles;
use crate::measure::estimate::Estimate;
use crate::papers::texels;

/// Bytes of a number.
const NUMBER: f64 = 4.0;
/// Bytes of a pixel of the radiance.
const RADIANCE: f64 = 16.0;
/// Passes of a band, those of the tables and of the picture.
const PASSES: u64 = 12;
/// Loads of the table of densities for a value.
const CACHED: f64 = 8.0;
/// Particles that a way of delta tracking meets, roughly: bounds are a few times the density.
const PARTICLES: f64 = 16.0;
/// Invocations of a trivial shader that an octave of noise costs, roughly.
const OCTAVE: f64 = 4.0;

fn bytes_of<T>() -> f64 {
    size_of::<T>() as f64
}

impl Parameters {
    /// Device memory, passes and shader invocations of a frame, as long as no list grows.
    pub(super) fn estimate(&self, variant: Variant, objects: &[Object], limit: BufferLimit) -> Estimate {
        let triangles: usize = objects.iter().map(|o| o.mesh.triangle_count()).sum();
        let capacity = Capacity::initial(self, triangles, limit);
        let pixels = f64::from(self.width) * f64::from(self.height);
        let band = f64::from(self.width) * f64::from(capacity.rows);
        let (fragments, sections) = (f64::from(capacity.fragments), f64::from(capacity.sections));
        let (lights, volumes) = (self.lights.len() as f64, self.volumes.len() as f64);
        let has_volume = variant != Variant::NoVolume && volumes > 0.0;
        let shadows = has_volume && variant != Variant::None;
        let table = if has_volume && variant.has_table() { f64::from(self.table_size).powi(3) } else { 0.0 };
        let vertices: usize = objects.iter().map(|o| o.mesh.positions.len()).sum();
        let (vertices, triangles) = (vertices as f64, triangles as f64);
        let of_fragment = bytes_of::<LinkBlock>() + bytes_of::<SurfaceBlock>() + bytes_of::<ColorBlock>();
        let of_pixel = 2.0 * NUMBER + bytes_of::<PixelBlock>() + bytes_of::<StateBlock>();
        let optional = |is_made: bool, bytes: f64| if is_made { bytes } else { 0.0 };

        let grids = self.volume_grids();
        let samples: usize = grids.iter().flatten().map(|grid| grid.samples.len()).sum();
        let samples_of_point = match self.filter {
            Filter::Trilinear => 8.0,
            Filter::Tricubic => 64.0,
        };
        let values = if grids.is_some() { samples_of_point } else { 1.0 + OCTAVE * f64::from(self.octaves()) };
        let octaves = if self.density_cache.is_some() { CACHED } else { values };
        let cube = |entries: u32| f64::from(entries).powi(3) * volumes;
        let cached = optional(has_volume, self.density_cache.map_or(0.0, cube));
        let bricks = optional(has_volume, self.brick_depth(variant).map_or(0.0, |_| cube(self.bricks)));
        let (points, ways) = match self.march {
            March::Steps => (f64::from(self.steps), 1.0),
            March::Delta => (PARTICLES, f64::from(self.samples)),
        };
        let marched = pixels / f64::from(self.volume_scale).powi(2);
        let steps = marched * points * ways * volumes;
        // A traced shadow takes up to half of the steps through a volume, and at least those of the sections' ends.
        let shadow_steps = match variant {
            Variant::Traced => lights * (0.5 * points) * octaves,
            _ => lights,
        };
        let is_marched = has_volume && variant != Variant::Froxel;
        let march = optional(is_marched, steps * (octaves + shadow_steps));
        let froxels: f64 = self.froxels.into_iter().map(f64::from).product();
        let froxels = optional(has_volume && variant == Variant::Froxel, froxels);
        let in_froxels = froxels * f64::from(self.samples) * volumes * (octaves + lights);
        let waves = 3 * u64::from(self.table_size);
        let bands = u64::from(self.height.div_ceil(capacity.rows.max(1)));
        let tables = u64::from(table > 0.0) * (1 + waves);
        Estimate {
            buffers: Vec::new(),
            bytes: vec![
                ("size", of_fragment * fragments + of_pixel * band + (RADIANCE + NUMBER) * pixels),
                ("object", tiles::bytes(self, capacity)),
                ("size", optional(has_volume, bytes_of::<SectionBlock>() * sections)),
                ("light", optional(shadows, NUMBER * fragments * lights)),
                ("volume-file", NUMBER * samples as f64),
                ("volume-temperature", optional(self.glows(), RADIANCE * samples as f64)),
                ("density-cache", 4.0 * NUMBER * cached),
                ("bricks", NUMBER * bricks),
                ("froxels", 2.0 * RADIANCE * froxels),
                ("table", 2.0 * NUMBER * table * volumes * (1.0 + lights)),
                ("object", texels::bytes_of(2.0 * vertices) + texels::bytes_of(triangles)),
                ("object", bytes_of::<ObjectBlock>() * objects.len() as f64),
            ],
            passes: Some((limit.parameters(), PASSES * bands + tables)),
            draws: None,
            invocations: vec![
                ("steps", march),
                ("froxels", in_froxels),
                ("density-cache", cached * values),
                ("bricks", optional(bricks > 0.0, bricks + cached + samples as f64)),
                ("table", table * volumes * (octaves + 8.0 * lights)),
                ("object", 50.0 * triangles * bands as f64),
                ("size", 100.0 * pixels),
            ],
        }
    }
}
