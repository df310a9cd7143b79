//! Passes on the processor: section 4's first application, by rows on all cores.

use std::sync::Arc;

use rayon::prelude::*;

use super::blocks::TerrainBlock;
use super::geometric_transformation::SceneView;
use super::height_field::{Field, FieldWork, HeightField};
use super::parameters::Parameters;
use super::pyramid::Texel;
use super::ray_caster::{Footprint, RayCaster};
use crate::gpu::{Frame, PassInfo};

/// A pass that has a value for each pixel, row by row.
pub struct HostPass<V> {
    /// Name, section, reads and writes.
    pub info: Arc<PassInfo>,
    /// Pixels of a row.
    pub width: u32,
    /// Of each pixel, row by row.
    pub values: Vec<V>,
}

/// The work of a pass on one pixel.
pub trait PixelWork<V>: Sync {
    /// Changes the value of pixel `index` by one map.
    fn run<T: Texel>(&self, caster: &RayCaster<'_, T>, pixel: (u32, u32), index: usize, value: &mut V);
}

impl<V: Copy + Send + Sync> HostPass<V> {
    pub fn new(info: Arc<PassInfo>, parameters: &Parameters, value: V) -> Self {
        HostPass { info, width: parameters.width, values: vec![value; parameters.pixels()] }
    }

    /// Works on all pixels of one map after the other, `start` being the values before the first.
    pub fn record(
        &mut self,
        frame: &mut Frame<'_>,
        (maps, view): (&[HeightField], &SceneView),
        (start, footprint): (Option<V>, Footprint),
        work: &impl PixelWork<V>,
    ) -> &[V] {
        let HostPass { ref info, width, ref mut values } = *self;
        frame.host(info, || {
            if let Some(start) = start {
                values.par_iter_mut().for_each(|value| *value = start);
            }
            for (map, terrain) in maps.iter().zip(&view.terrains) {
                map.with(Rows { terrain, footprint, width: width as usize, values, work });
            }
        });
        values
    }
}

struct Rows<'a, V, W> {
    terrain: &'a TerrainBlock,
    footprint: Footprint,
    width: usize,
    values: &'a mut [V],
    work: &'a W,
}

impl<V: Send, W: PixelWork<V>> FieldWork for Rows<'_, V, W> {
    type Output = ();

    fn run<T: Texel>(self, field: Field<'_, T>) {
        let Rows { terrain, footprint, width, values, work } = self;
        let caster = RayCaster { terrain, field, footprint };
        values.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
            for (x, value) in row.iter_mut().enumerate() {
                work.run(&caster, (x as u32, y as u32), y * width + x, value);
            }
        });
    }
}
