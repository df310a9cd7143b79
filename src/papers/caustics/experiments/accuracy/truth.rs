//! The light of a scene by photons in double precision, as the maps of an exact method would hold it.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::super::super::reference::{
    HeightField, Medium, Photons, ReceiverBox, ReferenceLight, Tracer, WaterVertex, Wave, align_box, wave_vertex,
};
use super::super::super::water::{Grid, LEVEL_M, waves};
use super::super::super::{Parameters, ReceiverInput};
use crate::scene::{Bounds, Light};

/// The frame whose water it is: the first, at 0 s.
pub const FRAME: u32 = 0;

/// Places of photons in their strata: one for each half of the truth.
const PLACES: [f64; 2] = [0.25, 0.75];
/// By which a surface must lie above a landing to hide it from the map, of the box's height.
const ABOVE: f64 = 1e-6;

/// True map of one receiver under one light, by two estimates that share no photon.
pub struct Truth {
    /// I_c of eq. 4-18, row by row.
    pub halves: [Vec<f64>; 2],
}

/// The water at the time of [`FRAME`], by x and z.
pub enum Surface {
    Waves(Vec<Wave>),
    Map(HeightField),
}

impl Surface {
    pub fn of(parameters: &Parameters, receivers: &[ReceiverInput]) -> Self {
        if let Some(map) = &parameters.water_map {
            let heights = map.heights();
            let places = (0..heights.height()).flat_map(|row| (0..heights.width()).map(move |column| (column, row)));
            let heights_m: Vec<f64> = places.map(|(column, row)| f64::from(heights.height_m(column, row))).collect();
            let center = center_of(receivers);
            let middle = DVec2::new(center.x, center.z);
            let field = HeightField::through(&heights_m, heights.width() as usize, heights.spacing_m(), middle);
            return Surface::Map(field);
        }
        let wave = |wave: &super::super::super::water::Wave| Wave {
            amplitude_m: wave.amplitude_m,
            direction: wave.vector.normalize(),
            wavelength_m: TAU / wave.vector.length(),
            angular_frequency_rad_s: wave.angular_frequency,
            phase_rad: wave.phase_rad,
        };
        Surface::Waves(waves(parameters).iter().map(wave).collect())
    }

    fn at(&self, x: f64, z: f64) -> WaterVertex {
        match self {
            Surface::Waves(waves) => wave_vertex(waves, LEVEL_M, x, z, 0.0),
            Surface::Map(field) => field.vertex(LEVEL_M, x, z),
        }
    }
}

/// The point that point lights aim at: the middle of all receivers.
fn center_of(receivers: &[ReceiverInput]) -> DVec3 {
    Bounds::of_points(receivers.iter().flat_map(|r| r.mesh.positions.iter().copied())).center().as_dvec3()
}

/// Traces `photons` for each texel of a map of `size` texels a side, through the water over `grid`, onto one of the
/// receivers. With `shadows` of the parameters the others stand in the light's way. None for a receiver without a box.
pub fn trace(
    parameters: &Parameters,
    surface: &Surface,
    receivers: &[ReceiverInput],
    (light, receiver): (&Light, usize),
    grid: &Grid,
    (size, photons): (u32, u32),
) -> Option<Truth> {
    let light = match *light {
        Light::Parallel { direction, .. } => ReferenceLight::Parallel { direction: direction.as_dvec3().normalize() },
        Light::Point { position, .. } => ReferenceLight::Point { position: position.as_dvec3() },
    };
    let medium = Medium {
        refraction_index: f64::from(parameters.refraction_index),
        absorption_per_m: f64::from(parameters.absorption_per_m),
    };
    let points: Vec<DVec3> = receivers[receiver].mesh.positions.iter().map(|p| p.as_dvec3()).collect();
    let aligned = align_box(light, &points, center_of(receivers), medium)?;
    let own = triangles(&receivers[receiver], &aligned);
    let own_count = own.len();
    let others = receivers.iter().enumerate().filter(|(index, _)| parameters.shadows && *index != receiver);
    let mut all = own.clone();
    others.for_each(|(_, other)| all.extend(triangles(other, &aligned)));
    let (first, above) = (Tracer::new(&all), Tracer::new(&own));
    let hit = |origin: DVec3, ray: DVec3| {
        let (distance_m, index) = first.first_hit(origin, ray, 0.0).filter(|&(_, index)| index < own_count)?;
        let [a, b, c] = own[index];
        let across = (b - a).cross(c - a);
        let normal = (if across.dot(ray) > 0.0 { -across } else { across }).normalize();
        let place = origin + ray * distance_m;
        // What another part of the receiver hides from the light's box is not in its map.
        let is_hidden = normal.y > 0.0 && above.first_hit(place, DVec3::Y, ABOVE * aligned.height).is_some();
        (!is_hidden).then_some((distance_m, normal))
    };
    let (low, high) = (grid.corner, grid.corner + grid.extent_m());
    let texel_m = (aligned.width * aligned.depth).sqrt() / f64::from(size);
    let strata = ((high - low) / texel_m * f64::from(photons).sqrt()).ceil();
    let strata = [strata.x as u32, strata.y as u32];
    let half = |place: f64| {
        let photons = Photons { low, high, strata, place: DVec2::splat(place), is_reflected: parameters.fresnel };
        photons.landed(|x, z| surface.at(x, z), light, medium, &aligned, hit, size as usize)
    };
    Some(Truth { halves: PLACES.map(half) })
}

/// A receiver's triangles in box space.
fn triangles(receiver: &ReceiverInput, aligned: &ReceiverBox) -> Vec<[DVec3; 3]> {
    let mesh = &receiver.mesh;
    let corner = |index: u32| aligned.to_box(mesh.positions[index as usize].as_dvec3());
    mesh.indices.chunks_exact(3).map(|corners| [0, 1, 2].map(|i| corner(corners[i]))).collect()
}

/// A square map whose side is `times` smaller: the mean of what each of its texels covers.
pub fn shrunk(map: &[f64], times: usize) -> Vec<f64> {
    let size = map.len().isqrt();
    let to = size / times;
    let mut small = vec![0.0; to * to];
    for (texel, value) in map.iter().enumerate() {
        small[texel / size / times * to + texel % size / times] += value / (times * times) as f64;
    }
    small
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::WaveParameters;
    use crate::scene::{Mesh, shapes};
    use glam::{Mat4, UVec2, Vec2, Vec3};

    fn under_water(mesh: Mesh) -> ReceiverInput {
        let place = Mat4::from_translation(Vec3::new(0.0, -2.0, 0.0));
        ReceiverInput { mesh: mesh.transformed(&place), albedo: Vec3::ONE }
    }

    const GRID: Grid = Grid { corner: DVec2::splat(-2.0), cell: DVec2::splat(0.4), columns: 10, rows: 10 };
    const OVERHEAD: Light = Light::Parallel { direction: Vec3::NEG_Y, intensity: Vec3::ONE };

    /// Two squares, one half over the other: the lower one has light beside the upper alone, and by its map alone where
    /// nothing hides it.
    #[test]
    fn what_is_hidden_is_not_in_the_map() {
        let flat = WaveParameters { count: 0, amplitude_m: 0.0, wavelength_m: 1.0 };
        let parameters = Parameters { waves: flat, absorption_per_m: 0.0, ..Parameters::default() };
        let floor = shapes::plane(Vec2::splat(2.0), UVec2::ONE);
        let shelf = shapes::plane(Vec2::new(1.0, 2.0), UVec2::ONE);
        let shelf = shelf.transformed(&Mat4::from_translation(Vec3::new(0.5, 0.5, 0.0)));
        let mut both = floor.clone();
        both.indices.extend(shelf.indices.iter().map(|i| i + floor.positions.len() as u32));
        both.positions.extend(&shelf.positions);
        both.normals.extend(&shelf.normals);
        let one = |receivers: &[ReceiverInput], parameters: &Parameters| {
            let surface = Surface::of(parameters, receivers);
            trace(parameters, &surface, receivers, (&OVERHEAD, 0), &GRID, (16, 100)).unwrap()
        };
        let is_one = |map: &[f64]| map.iter().all(|light| (light - 1.0).abs() < 0.1);
        // As one receiver the shelf's light takes the place of the floor's.
        let joined = one(&[under_water(both)], &parameters);
        assert!(joined.halves.iter().all(|half| is_one(half)));
        let apart = [under_water(floor), under_water(shelf)];
        assert!(is_one(&one(&apart, &parameters).halves[0]));
        let shadowed = one(&apart, &Parameters { shadows: true, ..parameters }).halves;
        // The light's box may lie along any axes: half of the texels are dark.
        let dark = shadowed[0].iter().filter(|light| **light == 0.0).count();
        assert_eq!(dark, 128);
    }

    #[test]
    fn a_map_shrinks_to_means() {
        let map: Vec<f64> = (0..16).map(f64::from).collect();
        assert_eq!(shrunk(&map, 2), [2.5, 4.5, 10.5, 12.5]);
        assert_eq!(shrunk(&map, 4), [7.5]);
        assert_eq!(shrunk(&map, 1), map);
    }
}
