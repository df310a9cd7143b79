//! Sizes that follow from the parameters, the maps and the objects.

use super::mesh::{BLOCK_INDICES, MESH_SIDE};
use super::packed::{is_packed, packed_bytes};
use super::page_table::{PageTable, TILE};
use super::parameters::{Base, Interpolation, Lod, Parameters, Start, Variant};
use super::pyramid::Shape;
use super::quadtree::PATCH_SIDE;
use super::scene::Inputs;
use super::selection::Patch;
use super::start::TILE_PIXELS;
use super::tiles::pool_side;
use crate::gpu::Device;
use crate::measure::estimate::Estimate;
use crate::scene::Samples;

/// Bytes of a number, and of four.
const NUMBER: f64 = 4.0;
const VECTOR: f64 = 16.0;
/// Invocations of a trivial shader that a step of a ray costs, roughly.
const STEP: f64 = 4.0;

impl Parameters {
    /// Device memory, passes and shader invocations of a frame; `map` names the parameter that sets the maps' sizes.
    pub(super) fn estimate(
        &self,
        device: &Device,
        variant: Variant,
        inputs: &Inputs<'_>,
        map: &'static str,
    ) -> Estimate {
        let pixels = self.pixels() as f64;
        let is_host = variant.is_host();
        let is_mesh = variant.is_rasterised();
        let shades_objects = self.shadows && !inputs.objects.is_empty();
        let bounds = match self.interpolation {
            Interpolation::Bilinear => 1.0,
            Interpolation::Bicubic => 2.0,
        };
        let walks = matches!(variant, Variant::DdaCompute | Variant::DdaFragment);
        let is_packed = walks && is_packed(device, self, inputs.maps.iter().map(|input| &*input.map));
        let (mut levels, mut packed, mut pools, mut indices, mut steps, mut vertices) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for input in inputs.maps {
            let samples = &input.map;
            let shape = Shape::new(samples.width(), samples.height());
            let (width, height) = shape.extent();
            let sample = if matches!(samples.samples(), Samples::Float(_)) { NUMBER } else { 0.5 * NUMBER };
            let whole = f64::from(width) * f64::from(height) * sample * (1.0 + bounds);
            if variant == Variant::TiledCompute {
                let tile = f64::from(TILE * TILE) * sample;
                let most = self.tile_bytes() as f64 / inputs.maps.len() as f64 / tile;
                let table = PageTable::new(shape, self.interpolation, most as usize, pool_side(device));
                let (columns, rows) = table.pool();
                // Of the pool, and the one that is on its way to it.
                pools += (f64::from(columns) * f64::from(rows) + 1.0) * tile;
            } else {
                levels += whole;
                packed += if is_packed { packed_bytes(samples) as f64 } else { 0.0 };
            }
            let side = f64::from(shape.width.max(shape.height));
            // Level by level, or cell by cell.
            steps += match variant {
                Variant::DdaCompute | Variant::DdaFragment | Variant::DdaCpu => side,
                _ => 4.0 * side.log2() + if self.lod == Lod::Exact { 8.0 } else { 0.0 },
            };
            if variant == Variant::MeshLod {
                let patches = |nodes: u32| f64::from((nodes - 1).div_ceil(PATCH_SIDE));
                let most = patches(shape.width) * patches(shape.height);
                indices += 6.0 * NUMBER * f64::from(PATCH_SIDE * PATCH_SIDE) + size_of::<Patch>() as f64 * most;
                // A vertex for a few pixels, less where triangles may be farther off; and the patches' bounds, once.
                let cells = f64::from(shape.width) * f64::from(shape.height);
                vertices += cells.min(pixels / f64::from(self.mesh_error_px)) + cells;
            } else if is_mesh && side <= f64::from(MESH_SIDE) {
                let columns = shape.width - 1;
                let rows = (BLOCK_INDICES / (6 * columns)).clamp(1, shape.height - 1);
                indices += 6.0 * NUMBER * f64::from(columns) * f64::from(rows);
                vertices += 6.0 * f64::from(columns) * f64::from(shape.height);
            }
        }
        let on_device = !is_host || shades_objects;
        let maps = inputs.maps.len() as f64;
        let is_united = maps > 1.0 && !is_host && !is_mesh;
        // A target for the prior map's hits as well where there are several.
        let targets = if is_united { 2.0 } else { 1.0 };
        let drape = inputs.drape.map_or(0.0, |drape| f64::from(drape.size().0) * f64::from(drape.size().1));
        let of_pixel = if is_host { 3.0 * VECTOR + 2.0 * NUMBER } else { (1.0 + targets) * VECTOR + NUMBER };
        let of_pixel = of_pixel + if is_mesh { NUMBER } else { 0.0 };
        let starts = if walks && self.base == Base::Plane && self.start == Start::Tiles {
            maps * NUMBER / f64::from(TILE_PIXELS * TILE_PIXELS)
        } else {
            0.0
        };
        let light = if self.shadows && !is_host { NUMBER * if maps > 1.0 { 2.0 } else { 1.0 } } else { 0.0 };
        let objects = if inputs.objects.is_empty() { 0.0 } else { NUMBER };
        let lit_objects = if shades_objects { VECTOR + NUMBER * if maps > 1.0 { 3.0 } else { 2.0 } } else { 0.0 };
        let occlusion = if shades_objects && !is_host { NUMBER } else { 0.0 };
        let mesh_bytes: usize =
            inputs.objects.iter().map(|mesh| 24 * mesh.positions.len() + 4 * mesh.indices.len()).sum();
        // The tree of the objects' triangles: halves of halves, down to four of them.
        let triangles: usize = inputs.objects.iter().map(|mesh| mesh.triangle_count()).sum();
        let leaves = f64::from((triangles.div_ceil(4) as u32).max(1).next_power_of_two());
        let corners: usize = inputs.objects.iter().map(|mesh| 12 * mesh.positions.len()).sum();
        let tree = if shades_objects { 32.0 * (2.0 * leaves - 1.0) + (corners + 12 * triangles) as f64 } else { 0.0 };
        let mesh_vertices: usize = inputs.objects.iter().map(|mesh| mesh.indices.len()).sum();

        let surface = if self.interpolation == Interpolation::Bicubic { 8.0 } else { 1.0 };
        let rays = pixels * if self.shadows { 2.0 } else { 1.0 };
        Estimate {
            buffers: Vec::new(),
            bytes: vec![
                (map, if on_device { levels } else { 0.0 } + indices),
                ("corners", packed),
                ("tile-memory", pools),
                ("drape", NUMBER * if on_device { drape } else { 0.0 }),
                ("size", (of_pixel + starts + light + objects + lit_objects + occlusion) * pixels),
                ("object", mesh_bytes as f64 + tree),
            ],
            passes: Some(("object", 10 + 4 * inputs.maps.len() as u64 + 2 * inputs.objects.len() as u64)),
            draws: None,
            invocations: vec![
                ("size", rays * (10.0 + STEP * steps * surface)),
                (map, 8.0 * vertices + maps * levels),
                ("object", 8.0 * mesh_vertices as f64),
            ],
        }
    }
}
