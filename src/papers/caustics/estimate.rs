//! Sizes that follow from the parameters and the receivers.

use super::bounding_box::{Axes, ReceiverBox};
use super::parameters::{Parameters, Variant};
use super::planes::{Fit, most_fitted, threshold};
use super::position_pyramid;
use super::receiver::ReceiverInput;
use super::water::{Grid, cells};
use crate::measure::estimate::Estimate;
use crate::scene::{Bounds, Light};

/// Bytes of a number, and of a texel of light.
const NUMBER: f64 = 4.0;
const LIGHT: f64 = 8.0;
/// Passes of a frame, beside those of each receiver under each light.
const PASSES: u64 = 8;
/// Invocations of a fragment shader that a vertex costs where a CPU runs vertex work on one thread.
const VERTEX: f64 = 8.0;

impl Parameters {
    /// Device memory, passes, draws and shader invocations of a frame with its picture.
    pub(super) fn estimate(&self, variant: Variant, receivers: &[ReceiverInput]) -> Estimate {
        let vertices: usize = receivers.iter().map(|r| r.mesh.positions.len()).sum();
        let triangles: usize = receivers.iter().map(|r| r.mesh.triangle_count()).sum();
        let (vertices, triangles) = (vertices as f64, triangles as f64);
        let lights = self.lights.len() as f64;
        let lit = if variant == Variant::Stencil { 0.0 } else { lights * receivers.len() as f64 };
        let (columns, rows) = match variant {
            Variant::Hit => self.refined_cells(receivers),
            _ => cells(self.water_triangles),
        };
        let water_vertices = (f64::from(columns) + 1.0) * (f64::from(rows) + 1.0);
        let water_triangles = 2.0 * f64::from(columns) * f64::from(rows);
        let pixels = f64::from(self.width) * f64::from(self.height);
        let texels = f64::from(self.map_size).powi(2);
        let planes = f64::from(self.planes);
        // Smart slicing on the device has room for the most that the levels may ask for; no padded box is higher than its mesh is
        // long.
        let culled = match self.smart_on_device() {
            Some(epsilon_m) => {
                let lengths = receivers.iter().map(|r| f64::from(r.mesh.bounds().diagonal().length()));
                let height = 1.002 * lengths.fold(0.0, f64::max);
                let epsilon = threshold(height, self.planes, epsilon_m);
                f64::from(most_fitted(&Fit::of_each(height, self.smart.levels, epsilon)))
            }
            None => planes,
        };
        let layers = f64::from(self.layers);
        let coverage = f64::from(self.coverage).powi(2);
        let water_map = self.water_map.as_ref().map_or(0, |map| size_of_val(map.coefficients())) as f64;
        // Halves of halves, down to four triangles.
        let leaves = f64::from(((triangles / 4.0).ceil() as u32).max(1).next_power_of_two());

        // Position, depth and caustics, diffuse and combined light.
        let maps = (3.0 * NUMBER + 2.0 * LIGHT) * texels;
        let entries = position_pyramid::extent(self.map_size).map(|n| n as f64).iter().product::<f64>();
        let pyramid = NUMBER * (texels + 2.0 * entries);
        // What lies on every plane follows the planes and its own size: a refusal names both.
        let by_planes = match variant {
            Variant::Volumetric => "map-size` or `planes",
            Variant::Hit => "water-triangles",
            Variant::Culled if self.smart_on_device().is_some() => "water-triangles`, `levels` or `planes",
            _ => "water-triangles` or `planes",
        };
        let (of_map, of_planes, of_pixel) = match variant {
            Variant::LevelMap => (maps, 0.0, NUMBER + LIGHT + NUMBER),
            Variant::LevelMapSmart => (maps + NUMBER * texels, 0.0, NUMBER + LIGHT + NUMBER),
            // Heights and their pyramid; a bit and three indices a pair of triangle and plane, and a count a triangle.
            Variant::Culled => (
                maps + pyramid,
                water_triangles * (culled * 3.0 * NUMBER + ((culled / 32.0).ceil() + 1.0) * NUMBER),
                NUMBER + LIGHT + NUMBER,
            ),
            // Heights, their pyramid, and two words of light a texel, of each surface, of which those below the first have maps of
            // their own and one depth; where the water's vertices land and how bright, which triangles straddle, and where.
            Variant::Hit => (
                maps + pyramid
                    + layers * 2.0 * NUMBER * texels
                    + if self.layers > 1 { NUMBER * texels } else { 0.0 }
                    + (layers - 1.0) * (3.0 * NUMBER + 2.0 * LIGHT) * texels,
                5.0 * NUMBER * water_vertices + 3.0 * NUMBER * water_triangles,
                NUMBER + LIGHT + NUMBER,
            ),
            Variant::Volumetric => ((3.0 * NUMBER + LIGHT) * texels, LIGHT * texels * planes, NUMBER + LIGHT + NUMBER),
            // Positions, normals and albedo of what is seen, and stencils beside the depth.
            Variant::Stencil => (0.0, 0.0, 2.0 * NUMBER + LIGHT + NUMBER + 4.0 * NUMBER + 2.0 * LIGHT),
        };
        let drawn = if self.coverage > 1 && variant != Variant::Hit { NUMBER * texels * coverage } else { 0.0 };
        let shadow_maps = if self.shadows { lights.min(lit) * 3.0 * NUMBER * texels } else { 0.0 };

        let draws = match variant {
            Variant::Culled | Variant::Hit | Variant::Stencil => lit,
            _ => lit * planes,
        };
        let passes = if variant == Variant::Volumetric { 2.0 * lit * planes } else { 0.0 };
        let pairs = water_triangles
            * match variant {
                Variant::Stencil => 4.0 * lights,
                Variant::Hit => lit,
                _ => lit * planes,
            };
        // Triangles that lie over one another fold the light some times; the sides of the volumes cross many pixels.
        let shaded = match variant {
            Variant::Stencil => 0.05 * water_triangles * lights * pixels,
            Variant::Volumetric => lit * texels * planes * (8.0 + 2.0 * coverage),
            // The water's triangles cover the map some times, and a ray takes some steps.
            Variant::Hit => lit * (texels * 16.0 + water_vertices * 32.0),
            _ => lit * texels * (8.0 + 2.0 * planes * coverage),
        };
        Estimate {
            buffers: Vec::new(),
            bytes: vec![
                ("mesh", 24.0 * vertices + 12.0 * triangles),
                ("mesh", 32.0 * (2.0 * leaves - 1.0) + 12.0 * vertices + 12.0 * triangles),
                ("water-triangles", 32.0 * water_vertices + 12.0 * water_triangles + 48.0 * water_vertices * lights),
                ("water-map", water_map),
                ("map-size", lit * of_map + shadow_maps),
                ("map-size` or `coverage", lit * drawn),
                (by_planes, lit * of_planes),
                ("size", of_pixel * pixels),
            ],
            passes: Some(("planes", PASSES + (passes + 8.0 * lit.max(1.0)) as u64)),
            draws: Some(("planes", draws as u64)),
            invocations: vec![
                (if variant == Variant::Volumetric { "map-size" } else { "planes" }, shaded),
                ("water-triangles", VERTEX * pairs + water_vertices * (4.0 + 2.0 * f64::from(self.waves.count))),
                ("samples", pixels * f64::from(self.samples) * (60.0 + 10.0 * f64::from(self.waves.count))),
                ("mesh", VERTEX * vertices * lit.max(1.0)),
            ],
        }
    }

    /// Cells along x and z of the water that the variant `hit` refines.
    fn refined_cells(&self, receivers: &[ReceiverInput]) -> (u32, u32) {
        let points = receivers.iter().flat_map(|r| r.mesh.positions.iter().copied());
        let center = Bounds::of_points(points).center().as_dvec3();
        let index = f64::from(self.refraction_index);
        let of_light = |light: &Light| {
            let axes = Axes::aligned_with(light, center, index);
            let around = move |r: &ReceiverInput| ReceiverBox::around(axes, &r.mesh.positions);
            receivers.iter().map(around).zip(std::iter::repeat(*light)).collect::<Vec<_>>()
        };
        let boxes: Vec<_> = self.lights.iter().flat_map(of_light).collect();
        let Grid { columns, rows, .. } = Grid::over(&boxes, self).refined(&boxes, self);
        (columns, rows)
    }
}
