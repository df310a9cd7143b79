//! Caustics maps, their combination and the cast (sections 4.5, 4.6, 5.2.1 and 5.2.2).

use crate::papers::caustics::reference::position_map::nearest_surfaces;
use crate::papers::caustics::reference::raster::TexelTriangle;
use crate::papers::caustics::reference::{
    Cell, EDGE_BAND_TEXELS, IlluminationVolume, Medium, PositionMap, ReceiverBox, ReceiverTriangle, diffuse, intensity,
    intersection_triangle,
};
use glam::{DVec2, DVec3};

/// Intersection triangles thinner than this, in texels, have an area that single precision cannot hold to 1e-4.
const SLIVER_TEXELS: f64 = 1.0 / 8.0;

/// The light that a receiver gets from one light of unit intensity: a square map, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct CausticsMap {
    /// Texels a side.
    pub resolution: usize,
    /// I_c: the sum over the accepted intersection triangles.
    pub intensity: Vec<f64>,
    /// cos θ_t as the mean weighted by intensity, so that I_c cos θ_t is the flux per area of the map; 1 without light.
    pub cos_refracted: Vec<f64>,
    /// Texels that single precision or snapped vertices may decide differently: the centre lies within
    /// [`EDGE_BAND_TEXELS`] of an edge of an accepted intersection triangle, inside a sliver of one, at an outline of
    /// the receiver, or its surface lies at a cell's boundary.
    pub excluded: Vec<bool>,
}

/// Draws the intersection triangles of every plane additively and keeps a texel where the position map's height lies in
/// the plane's cell (4.4, 4.5, figure 4-15).
pub fn caustics_map(
    receiver: &ReceiverBox,
    cells: &[Cell],
    volumes: &[IlluminationVolume],
    medium: Medium,
    positions: &PositionMap,
) -> CausticsMap {
    let texels = positions.y.len();
    let mut intensity = vec![0.0; texels];
    let mut normal_flux = vec![0.0; texels];
    let mut excluded: Vec<bool> =
        (0..texels).map(|texel| is_uncertain(positions, texel, cells, receiver.height_tolerance_m())).collect();
    for cell in cells {
        for lit in lit_triangles(receiver, cell.plane, volumes, medium, positions.resolution) {
            let is_sliver = lit.projected.altitude() < SLIVER_TEXELS;
            for (texel, center) in lit.projected.texels(positions.resolution) {
                if !positions.y[texel].is_some_and(|y| cell.accepts(y)) {
                    continue;
                }
                excluded[texel] |= lit.projected.distance_to_edge(center) < EDGE_BAND_TEXELS;
                if let Some(weights) = lit.projected.weights(center) {
                    intensity[texel] += interpolate(lit.intensity, weights);
                    normal_flux[texel] += interpolate(lit.normal_flux, weights);
                    excluded[texel] |= is_sliver;
                }
            }
        }
    }
    let mean_cos = |(flux, intensity): (&f64, &f64)| {
        if *intensity > 0.0 { flux / intensity } else { 1.0 }
    };
    CausticsMap {
        resolution: positions.resolution,
        cos_refracted: normal_flux.iter().zip(&intensity).map(mean_cos).collect(),
        intensity,
        excluded,
    }
}

/// Multiplies a caustics map into the diffuse map: I_c x I_d, texel by texel (5.2.2).
pub fn combine(intensity: &[f64], diffuse_map: &[DVec3]) -> Vec<DVec3> {
    let lit = intensity.iter().zip(diffuse_map);
    lit.map(|(&intensity, &diffuse)| diffuse * intensity).collect()
}

/// The volumetric method's combined map (5.2.1): for every plane a slice image of the receiver within its cell,
/// multiplied by the plane's own caustics map, and the slices put together nearest to the light first. `None` on the
/// background.
pub fn volumetric(
    receiver: &ReceiverBox,
    cells: &[Cell],
    volumes: &[IlluminationVolume],
    medium: Medium,
    triangles: &[ReceiverTriangle],
    albedo: DVec3,
    resolution: usize,
) -> Vec<Option<DVec3>> {
    let mut combined = vec![None; resolution * resolution];
    for cell in cells {
        let within = |y| cell.accepts(y);
        let slice = nearest_surfaces(receiver, triangles, resolution, DVec2::ZERO, within);
        let mut caustics = vec![0.0; slice.len()];
        for lit in lit_triangles(receiver, cell.plane, volumes, medium, resolution) {
            for (texel, center) in lit.projected.texels(resolution) {
                if let Some(weights) = lit.projected.weights(center) {
                    caustics[texel] += interpolate(lit.intensity, weights);
                }
            }
        }
        for (texel, surface) in slice.iter().enumerate() {
            let color = surface.map(|surface| diffuse(albedo, surface.normal, -receiver.v) * caustics[texel]);
            combined[texel] = combined[texel].or(color);
        }
    }
    combined
}

/// The colour of an object: Σ over lights of (I_c x I_d) + I_a, the ambient light once (eq. 4-19, 4-20). Each pair is a
/// light's I_c, its spectrum included, and its I_d.
pub fn cast(lights: &[(DVec3, DVec3)], ambient: DVec3) -> DVec3 {
    ambient + lights.iter().map(|(caustics, diffuse)| caustics * diffuse).sum::<DVec3>()
}

/// An intersection triangle on the map with the light at its corners.
struct LitTriangle {
    projected: TexelTriangle,
    intensity: [f64; 3],
    normal_flux: [f64; 3],
}

fn lit_triangles(
    receiver: &ReceiverBox,
    plane: f64,
    volumes: &[IlluminationVolume],
    medium: Medium,
    resolution: usize,
) -> impl Iterator<Item = LitTriangle> {
    volumes.iter().filter_map(move |volume| {
        let hit = intersection_triangle(volume, receiver, plane)?;
        let intensity = intensity(volume, &hit, medium.absorption_per_m)?;
        let corners = hit.corners.map(|p| receiver.to_texels(p, resolution));
        Some(LitTriangle {
            projected: TexelTriangle::new(corners)?,
            intensity,
            normal_flux: std::array::from_fn(|i| intensity[i] * hit.cos_refracted[i]),
        })
    })
}

fn interpolate(corners: [f64; 3], weights: [f64; 3]) -> f64 {
    corners.iter().zip(weights).map(|(c, w)| c * w).sum()
}

/// True where the texel's coverage, or the cell that accepts it, may be decided either way.
fn is_uncertain(positions: &PositionMap, texel: usize, cells: &[Cell], tolerance_m: f64) -> bool {
    let Some([low, high]) = positions.y_range[texel] else {
        return false;
    };
    let (low, high) = (low - tolerance_m, high + tolerance_m);
    let split = |cell: &Cell| {
        let overlaps = low < cell.upper && high >= cell.lower;
        overlaps && !(cell.accepts(low) && cell.accepts(high))
    };
    positions.at_outline[texel] || cells.iter().any(split)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{
        Mesh, OBLIQUE, OVERHEAD, Receiver, WATER, gentle_waves, horizontal, sphere, tilted,
    };
    use crate::papers::caustics::reference::{
        ReferenceLight, depth_profile, diffuse_map, illumination_volumes, keep_occupied, place_planes, position_map,
        smart_planes, smart_sub_boxes, uniform_epsilon, wave_vertex,
    };

    const MURKY: Medium = Medium { absorption_per_m: 0.1, ..WATER };
    const RESOLUTION: usize = 64;

    struct Drawing {
        receiver: ReceiverBox,
        positions: PositionMap,
        volumes: Vec<IlluminationVolume>,
    }

    impl Drawing {
        fn new(object: &Receiver, light: ReferenceLight) -> Self {
            let waves = gentle_waves();
            let water = Mesh::grid(22, 4.0, |x, z| wave_vertex(&waves, 0.0, x, z, 0.4));
            let receiver = object.aligned(light);
            Self {
                positions: position_map(&receiver, &object.triangles, RESOLUTION),
                volumes: illumination_volumes(water.water(), light, MURKY),
                receiver,
            }
        }

        fn caustics(&self, cells: &[Cell]) -> CausticsMap {
            caustics_map(&self.receiver, cells, &self.volumes, MURKY, &self.positions)
        }
    }

    #[test]
    fn volumetric_and_level_map_agree() {
        let mut object = sphere(16, 0.7);
        object.triangles.extend(tilted().triangles);
        let albedo = DVec3::new(0.9, 0.5, 0.3);
        for light in [OVERHEAD, OBLIQUE, ReferenceLight::Point { position: DVec3::new(1.0, 6.0, 0.5) }] {
            let drawing = Drawing::new(&object, light);
            let cells = place_planes(drawing.receiver.height, 9);
            let map = drawing.caustics(&cells);
            let level = combine(&map.intensity, &diffuse_map(&drawing.receiver, &drawing.positions, albedo));
            let slices =
                volumetric(&drawing.receiver, &cells, &drawing.volumes, MURKY, &object.triangles, albedo, RESOLUTION);
            assert!(level.iter().filter(|c| c.x > 0.1).count() > RESOLUTION * RESOLUTION / 4);
            for (texel, slice) in slices.iter().enumerate() {
                assert_eq!(slice.is_some(), drawing.positions.y[texel].is_some());
                assert!((slice.unwrap_or(DVec3::ZERO) - level[texel]).length() < 1e-12);
            }
        }
    }

    #[test]
    fn dropping_empty_planes_changes_nothing_and_smart_planes_light_the_same_texels() {
        let drawing = Drawing::new(&sphere(24, 1.0), OBLIQUE);
        let height = drawing.receiver.height;
        let cells = place_planes(height, 12);
        let map = drawing.caustics(&cells);
        let kept = keep_occupied(&cells, &drawing.positions);
        assert!(kept.len() < cells.len());
        assert_eq!(drawing.caustics(&kept).intensity, map.intensity);

        let histogram = depth_profile(&drawing.positions, height, 100);
        let sub_boxes = smart_sub_boxes(&histogram);
        let smart = smart_planes(height, 100, &sub_boxes, uniform_epsilon(height, 12));
        let smart_map = drawing.caustics(&smart);
        let mut difference = 0.0;
        for (a, b) in map.intensity.iter().zip(&smart_map.intensity) {
            assert_eq!(*a > 0.0, *b > 0.0);
            difference += (a - b).abs();
        }
        assert!(difference < 0.05 * map.intensity.iter().sum::<f64>());
    }

    #[test]
    fn few_texels_are_excluded_and_no_value_is_lost_to_rounding() {
        for object in [horizontal(1.5, -2.0), tilted(), sphere(24, 1.0)] {
            for light in [OVERHEAD, OBLIQUE] {
                let drawing = Drawing::new(&object, light);
                let map = drawing.caustics(&place_planes(drawing.receiver.height, 9));
                let excluded = map.excluded.iter().filter(|&&e| e).count();
                let fraction = excluded as f64 / map.excluded.len() as f64;
                assert!(fraction > 0.0 && fraction < 0.02, "{fraction}");
                let outline = drawing.positions.at_outline.iter().zip(&map.excluded);
                assert!(outline.into_iter().all(|(&at, &excluded)| excluded || !at));
                assert!(map.intensity.iter().all(|i| i.is_finite() && *i >= 0.0));
                assert!(map.cos_refracted.iter().all(|c| *c > 0.0 && *c <= 1.0 + 1e-12));
            }
        }
    }

    #[test]
    fn moving_the_samples_within_the_band_changes_no_texel_that_is_not_excluded() {
        let drawing = Drawing::new(&tilted(), OVERHEAD);
        let cells = place_planes(drawing.receiver.height, 9);
        let map = drawing.caustics(&cells);
        let shift = 0.9 * EDGE_BAND_TEXELS * drawing.receiver.width / RESOLUTION as f64;
        let moved_box =
            ReceiverBox { center: drawing.receiver.center + drawing.receiver.u * shift, ..drawing.receiver };
        let moved_positions = position_map(&moved_box, &tilted().triangles, RESOLUTION);
        let moved = caustics_map(&moved_box, &cells, &drawing.volumes, MURKY, &moved_positions);
        for texel in 0..map.intensity.len() {
            let (before, after) = (map.intensity[texel], moved.intensity[texel]);
            let close = (before - after).abs() < 2e-3 * before;
            assert!(close || map.excluded[texel], "texel {texel}: {before} {after}");
        }
    }

    #[test]
    fn a_surface_on_a_cell_boundary_and_light_through_a_sliver_are_excluded() {
        let floor = horizontal(1.5, -2.0);
        let drawing = Drawing::new(&floor, OVERHEAD);
        let on_boundary = drawing.caustics(&place_planes(drawing.receiver.height, 2));
        assert!(on_boundary.excluded.iter().all(|&excluded| excluded));

        // A strip of water a tenth of a texel wide, over the centres of one column of texels.
        let texel_m = drawing.receiver.width / RESOLUTION as f64;
        let strip = Mesh::grid(1, 1.0, |x, z| wave_vertex(&[], 0.0, (0.5 + 0.05 * x) * texel_m, z, 0.0));
        let volumes = illumination_volumes(strip.water(), OVERHEAD, MURKY);
        let narrow = Drawing { volumes, ..drawing };
        let map = narrow.caustics(&place_planes(narrow.receiver.height, 1));
        let lit = map.intensity.iter().zip(&map.excluded);
        let lit: Vec<bool> = lit.filter(|(i, _)| **i > 0.0).map(|(_, e)| *e).collect();
        assert!(lit.len() > 30 && lit.iter().all(|&excluded| excluded));
    }

    #[test]
    fn the_cast_adds_lights_and_the_ambient_light_once() {
        let (red, half, dim) = (DVec3::X, DVec3::splat(0.5), DVec3::splat(0.1));
        let color = cast(&[(red * 2.0, half), (DVec3::ONE, half)], dim);
        assert!((color - DVec3::new(1.6, 0.6, 0.6)).length() < 1e-15);
        assert_eq!(cast(&[], dim), dim);
    }
}
