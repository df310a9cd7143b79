//! Light traced as photons through the exact water onto a plane: the truth that a caustics map approaches.

use crate::papers::caustics::reference::{AIR, Medium, ReceiverBox, ReferenceLight, WaterVertex, refract, transmitted};
use glam::{DVec2, DVec3};
use rayon::iter::{IntoParallelIterator, ParallelIterator};

/// Pieces of the water that are traced side by side; their maps are added up in one order, whatever the processor.
const PIECES: u32 = 16;

/// Photons over a rectangle of the water, evenly stratified in x and z.
#[derive(Clone, Copy, Debug)]
pub struct Photons {
    /// Least x and z, metres.
    pub low: DVec2,
    /// Greatest x and z, metres.
    pub high: DVec2,
    /// Strata along x and along z, one photon in each.
    pub strata: [u32; 2],
    /// Place of each photon in its stratum, 0 to 1: other places make an independent estimate.
    pub place: DVec2,
    /// The surface reflects a part of the light (Fresnel).
    pub is_reflected: bool,
}

impl Photons {
    /// I_c (eq. 4-18: flux per area perpendicular to the beam, after absorption) of each texel of a map of `resolution`
    /// texels a side on the plane y = `plane` of box space, row by row.
    pub fn map(
        &self,
        surface: impl Fn(f64, f64) -> WaterVertex + Sync,
        light: ReferenceLight,
        medium: Medium,
        receiver: &ReceiverBox,
        plane: f64,
        resolution: usize,
    ) -> Vec<f64> {
        let hit = |origin: DVec3, ray: DVec3| {
            let distance_m = (plane - origin.y) / ray.y;
            (ray.y < 0.0 && distance_m > 0.0).then_some((distance_m, DVec3::Y))
        };
        self.landed(surface, light, medium, receiver, hit, resolution)
    }

    /// The same on a receiver: `hit` gives the distance to the first place where a ray from a point, in box space, meets
    /// it and the normal there; what lands on a side that the light's box does not see is none of the map's.
    ///
    /// A texel of a slanting surface holds more of it than of a plane across the beam: its flux is taken per area
    /// perpendicular to the beam, down to beams that graze it by [`GRAZING`].
    pub fn landed(
        &self,
        surface: impl Fn(f64, f64) -> WaterVertex + Sync,
        light: ReferenceLight,
        medium: Medium,
        receiver: &ReceiverBox,
        hit: impl Fn(DVec3, DVec3) -> Option<(f64, DVec3)> + Sync,
        resolution: usize,
    ) -> Vec<f64> {
        let piece = |piece: u32| {
            let row = |piece: u32| (u64::from(self.strata[1]) * u64::from(piece) / u64::from(PIECES)) as u32;
            let rows = row(piece)..row(piece + 1);
            let mut map = vec![0.0; resolution * resolution];
            let texel_area_m2 = receiver.texel_area_m2(map.len());
            let strata = DVec2::new(f64::from(self.strata[0]), f64::from(self.strata[1]));
            let cell = (self.high - self.low) / strata;
            for (i, j) in rows.flat_map(|j| (0..self.strata[0]).map(move |i| (i, j))) {
                // Rows are shifted against each other, so that no lattice shows.
                let shift = DVec2::new((self.place.x + f64::from(j) * 0.618_033_988_75).fract(), self.place.y);
                let at = self.low + cell * (DVec2::new(f64::from(i), f64::from(j)) + shift);
                let vertex = surface(at.x, at.y);
                let incident = light.direction_at(vertex.position);
                let Some(refracted) = refract(incident, vertex.normal, AIR, medium.refraction_index) else { continue };
                // A stratum's piece of surface is its base over the normal's rise.
                let mut flux = cell.x * cell.y * -incident.dot(vertex.normal) / vertex.normal.y;
                if self.is_reflected {
                    flux *= transmitted(-incident.dot(vertex.normal), AIR, medium.refraction_index);
                }
                let (origin, ray) = (receiver.to_box(vertex.position), receiver.direction_to_box(refracted));
                let Some((distance_m, normal)) = hit(origin, ray).filter(|(_, normal)| normal.y > 0.0) else {
                    continue;
                };
                let place = origin + ray * distance_m;
                let column = (place.x / receiver.width + 0.5) * resolution as f64;
                let row = (place.z / receiver.depth + 0.5) * resolution as f64;
                if column >= 0.0 && row >= 0.0 && (column as usize) < resolution && (row as usize) < resolution {
                    let transmitted = (-medium.absorption_per_m * distance_m).exp();
                    let turned = (normal.dot(-ray) / (normal.y * -ray.y)).max(GRAZING);
                    map[row as usize * resolution + column as usize] +=
                        flux * transmitted / (-ray.y * turned * texel_area_m2);
                }
            }
            map
        };
        let maps: Vec<Vec<f64>> = (0..PIECES).into_par_iter().map(piece).collect();
        let add = |mut sum: Vec<f64>, map: Vec<f64>| {
            sum.iter_mut().zip(map).for_each(|(sum, light)| *sum += light);
            sum
        };
        maps.into_iter().reduce(add).unwrap_or_default()
    }
}

/// Least share of a beam's width, of that on a plane across it, that it may light of a slanting surface's map.
pub const GRAZING: f64 = 0.02;

/// Pearson's correlation of two maps.
pub fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut ab, mut aa, mut bb) = (0.0, 0.0, 0.0);
    for (x, y) in a.iter().zip(b) {
        let (x, y) = (x - mean_a, y - mean_b);
        ab += x * y;
        aa += x * x;
        bb += y * y;
    }
    ab / (aa * bb).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{OBLIQUE, WATER, horizontal};
    use crate::papers::caustics::reference::{flat_water_intensity, wave_vertex};

    #[test]
    fn flat_water_has_one_intensity() {
        let receiver = horizontal(1.0, -2.0).aligned(OBLIQUE);
        let murky = Medium { absorption_per_m: 0.3, ..WATER };
        let (low, high) = (DVec2::splat(-4.0), DVec2::splat(4.0));
        let photons = Photons { low, high, strata: [1500, 1500], place: DVec2::splat(0.5), is_reflected: false };
        let map = photons.map(|x, z| wave_vertex(&[], 0.0, x, z, 0.0), OBLIQUE, murky, &receiver, 0.0, 16);
        let distance_m = 2.0 / receiver.v.y;
        let direction = OBLIQUE.direction_at(DVec3::ZERO);
        let expected = flat_water_intensity(direction, murky, distance_m).unwrap();
        let mean = map.iter().sum::<f64>() / map.len() as f64;
        // The plane is perpendicular to the beam: d varies across it, its mean is that of the middle.
        assert!((mean / expected - 1.0).abs() < 0.01, "{mean} {expected}");
    }
}
