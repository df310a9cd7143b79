//! Energy and closed forms that the maps must meet.

use crate::papers::caustics::reference::{
    AIR, IlluminationVolume, Medium, ReceiverBox, intersection_triangle, refract,
};
use glam::{DVec2, DVec3};

/// Intensity by eq. 4-18 under flat water for parallel light of unit `direction` at a point `distance_m` below the
/// water along the refracted ray; `None` for light that does not come from above.
///
/// All refracted rays are parallel to T = -V, so cos θ_t = 1 and every intersection triangle is its water triangle
/// projected along T onto a plane perpendicular to it: A_d = A_w cos θ_T, with θ_T the angle of refraction at the
/// water. Hence I_c = (cos θ_i / cos θ_T) e^(-K d), the same everywhere for K = 0 whatever the receiver's shape or
/// slope. For K > 0 a map interpolates the exponential between a triangle's corners and takes d at the reference plane:
/// if d varies by Δ within a triangle it lies at most a fraction e^(KΔ)(KΔ)²/8 above the value at the plane.
pub fn flat_water_intensity(direction: DVec3, medium: Medium, distance_m: f64) -> Option<f64> {
    let refracted = refract(direction, DVec3::Y, AIR, medium.refraction_index)?;
    Some(direction.y / refracted.y * (-medium.absorption_per_m * distance_m).exp())
}

/// Intensity by eq. 4-18 at `point` for a point light at `position` over flat water at y = 0, and where the ray that reaches
/// the point enters the water; `None` for a point or a light on the wrong side of it.
///
/// A ring of water of radius ρ around the light's foot lights a ring of radius R = ρ + D tan θ_t of the plane D below
/// it: A_w = 2π ρ dρ and A_d = 2π R dR, so that I_c = (ρ dρ / R dR) (cos θ_i / cos θ_t) e^(-K d).
pub fn flat_water_point_intensity(position: DVec3, point: DVec3, medium: Medium) -> Option<(f64, DVec3)> {
    let (height, depth) = (position.y, -point.y);
    if height <= 0.0 || depth <= 0.0 {
        return None;
    }
    let across = DVec2::new(point.x - position.x, point.z - position.z);
    let reach = across.length().max(1e-9);
    let sine = |rho: f64| rho / rho.hypot(height) / medium.refraction_index;
    let tangent = |rho: f64| sine(rho) / (1.0 - sine(rho).powi(2)).sqrt();
    let (mut low, mut high) = (0.0, reach);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if middle + depth * tangent(middle) < reach { low = middle } else { high = middle }
    }
    let rho = (low + high) / 2.0;
    let step = 1e-6 * height;
    let widening = 1.0 + depth * (tangent(rho + step) - tangent(rho - step)) / (2.0 * step);
    let (cos_incident, cos_refracted) = (height / rho.hypot(height), (1.0 - sine(rho).powi(2)).sqrt());
    let transmitted = (-medium.absorption_per_m * depth / cos_refracted).exp();
    let entry = DVec2::new(position.x, position.z) + across * (rho / reach);
    let intensity = rho / (reach * widening) * cos_incident / cos_refracted * transmitted;
    Some((intensity, DVec3::new(entry.x, 0.0, entry.y)))
}

/// The flux that passes the water under unit intensity, Σ A_w cos θ_i (Φ_i of eq. 4-17), in m²; cos θ_i is the mean of
/// a triangle's corners.
pub fn flux_through_water(volumes: &[IlluminationVolume]) -> f64 {
    volumes.iter().map(flux).sum()
}

/// The part of that flux that falls within the box's width and depth at the plane y = `plane` of box space, before
/// absorption: each volume's flux times the fraction of its intersection triangle inside.
pub fn flux_reaching_box(volumes: &[IlluminationVolume], receiver: &ReceiverBox, plane: f64) -> f64 {
    let half = DVec2::new(receiver.width, receiver.depth) / 2.0;
    let reaching = |volume| {
        let hit = intersection_triangle(volume, receiver, plane)?;
        let corners = hit.corners.map(|p| DVec2::new(p.x, p.z));
        let fraction = area(&clip(&corners, half)) / area(&corners);
        fraction.is_finite().then(|| flux(volume) * fraction)
    };
    volumes.iter().filter_map(reaching).sum()
}

/// The flux that a map records, Σ I_c cos θ_t A_texel, in m²; `cos_refracted` is the caustics map's.
pub fn flux_in_map(intensity: &[f64], cos_refracted: &[f64], receiver: &ReceiverBox) -> f64 {
    let normal_flux: f64 = intensity.iter().zip(cos_refracted).map(|(i, c)| i * c).sum();
    normal_flux * receiver.texel_area_m2(intensity.len())
}

fn flux(volume: &IlluminationVolume) -> f64 {
    volume.area_m2 * volume.cos_incident.iter().sum::<f64>() / 3.0
}

/// The part of a convex polygon inside |x| <= half.x, |y| <= half.y.
pub(super) fn clip(polygon: &[DVec2], half: DVec2) -> Vec<DVec2> {
    let sides = [(DVec2::X, half.x), (DVec2::NEG_X, half.x), (DVec2::Y, half.y), (DVec2::NEG_Y, half.y)];
    sides.iter().fold(polygon.to_vec(), |kept, &(axis, limit)| {
        let mut inside = Vec::with_capacity(kept.len() + 1);
        for (i, &p) in kept.iter().enumerate() {
            let q = kept[(i + 1) % kept.len()];
            let (beyond_p, beyond_q) = (p.dot(axis) - limit, q.dot(axis) - limit);
            if beyond_p <= 0.0 {
                inside.push(p);
            }
            if (beyond_p < 0.0 && beyond_q > 0.0) || (beyond_p > 0.0 && beyond_q < 0.0) {
                inside.push(p + (q - p) * (beyond_p / (beyond_p - beyond_q)));
            }
        }
        inside
    })
}

pub(super) fn area(polygon: &[DVec2]) -> f64 {
    let next = polygon.iter().cycle().skip(1);
    let double_area: f64 = polygon.iter().zip(next).map(|(p, q)| p.perp_dot(*q)).sum();
    double_area.abs() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::fixtures::{
        Mesh, OBLIQUE, OVERHEAD, Receiver, WATER, gentle_waves, horizontal, sphere, tilted,
    };
    use crate::papers::caustics::reference::{
        CausticsMap, ReferenceLight, caustics_map, illumination_volumes, place_planes, position_map, wave_vertex,
    };

    fn draw(
        floor: &Receiver,
        water: &Mesh,
        light: ReferenceLight,
        planes: usize,
        medium: Medium,
    ) -> (ReceiverBox, CausticsMap) {
        let receiver = floor.aligned(light);
        let surface = position_map(&receiver, &floor.triangles, 96);
        let volumes = illumination_volumes(water.water(), light, medium);
        let cells = place_planes(receiver.height, planes);
        let map = caustics_map(&receiver, &cells, &volumes, medium, &surface);
        (receiver, map)
    }

    #[test]
    fn flat_water_gives_its_closed_form_everywhere() {
        let water = Mesh::grid(22, 8.0, |x, z| wave_vertex(&[], 0.0, x, z, 0.0));
        for light in [OVERHEAD, OBLIQUE] {
            let direction = light.direction_at(DVec3::ZERO);
            let expected = flat_water_intensity(direction, WATER, 0.0).unwrap();
            for floor in [horizontal(1.5, -2.0), tilted(), sphere(24, 0.8)] {
                let (receiver, map) = draw(&floor, &water, light, 9, WATER);
                let surface = position_map(&receiver, &floor.triangles, 96);
                for (texel, &found) in map.intensity.iter().enumerate() {
                    let expected = surface.y[texel].map_or(0.0, |_| expected);
                    assert!((found - expected).abs() < 1e-10, "texel {texel}: {found}");
                }
            }
        }
        assert_eq!(flat_water_intensity(-DVec3::Y, WATER, 3.0), Some(1.0));
        assert_eq!(flat_water_intensity(DVec3::Y, WATER, 3.0), None);
    }

    #[test]
    fn murky_flat_water_absorbs_along_the_refracted_ray() {
        let murky = Medium { absorption_per_m: 0.3, ..WATER };
        let water = Mesh::grid(40, 8.0, |x, z| wave_vertex(&[], 0.0, x, z, 0.0));
        let (floor, planes) = (horizontal(1.5, -2.0), 61);
        for light in [OVERHEAD, OBLIQUE] {
            let (receiver, map) = draw(&floor, &water, light, planes, murky);
            let surface = position_map(&receiver, &floor.triangles, 96);
            let direction = light.direction_at(DVec3::ZERO);
            let along_ray = 2.0 / receiver.v.y;
            let expected = flat_water_intensity(direction, murky, along_ray).unwrap();
            // The plane lies up to half a cell from the surface; within a triangle d varies by less than 0.4 m.
            let tolerance = 0.3 * receiver.height / planes as f64 / 2.0 + 0.12_f64.powi(2) / 8.0 * 1.2;
            for (texel, &found) in map.intensity.iter().enumerate() {
                if surface.y[texel].is_some() {
                    assert!((found / expected - 1.0).abs() < tolerance, "{found} {expected}");
                }
            }
        }
    }

    #[test]
    fn the_map_holds_the_flux_through_the_water() {
        let waves = gentle_waves();
        let water = Mesh::grid(23, 1.5, |x, z| wave_vertex(&waves, 0.0, x, z, 0.4));
        let (receiver, map) = draw(&horizontal(1.8, -2.0), &water, OVERHEAD, 3, WATER);
        let volumes = illumination_volumes(water.water(), OVERHEAD, WATER);
        let through = flux_through_water(&volumes);
        assert!((through / 9.0 - 1.0).abs() < 1e-12);
        let recorded = flux_in_map(&map.intensity, &map.cos_refracted, &receiver);
        assert!((recorded / through - 1.0).abs() < 0.01, "{recorded} of {through}");
        assert!((flux_reaching_box(&volumes, &receiver, 0.0) - through).abs() < 1e-12);
    }

    #[test]
    fn a_map_narrower_than_the_water_holds_the_flux_that_reaches_it() {
        let waves = gentle_waves();
        let water = Mesh::grid(23, 2.0, |x, z| wave_vertex(&waves, 0.0, x, z, 0.4));
        let (receiver, map) = draw(&horizontal(1.2, -2.0), &water, OVERHEAD, 3, WATER);
        let volumes = illumination_volumes(water.water(), OVERHEAD, WATER);
        let reaching = flux_reaching_box(&volumes, &receiver, 0.0);
        assert!(reaching < 0.5 * flux_through_water(&volumes));
        let recorded = flux_in_map(&map.intensity, &map.cos_refracted, &receiver);
        assert!((recorded / reaching - 1.0).abs() < 0.01, "{recorded} of {reaching}");
    }

    #[test]
    fn a_near_point_light_keeps_its_flux_at_steep_angles_to_the_map() {
        let light = ReferenceLight::Point { position: DVec3::new(0.0, 0.5, 0.0) };
        let water = Mesh::grid(40, 3.0, |x, z| wave_vertex(&[], 0.0, x, z, 0.0));
        let (receiver, map) = draw(&horizontal(1.5, -1.0), &water, light, 3, WATER);
        let volumes = illumination_volumes(water.water(), light, WATER);
        let reaching = flux_reaching_box(&volumes, &receiver, 0.0);
        let recorded = flux_in_map(&map.intensity, &map.cos_refracted, &receiver);
        assert!((recorded / reaching - 1.0).abs() < 0.01);
        let lowest = map.cos_refracted.iter().copied().fold(1.0, f64::min);
        assert!(lowest < 0.8, "{lowest}");
    }

    #[test]
    fn clipping_keeps_the_part_inside() {
        let triangle = [(-1.0, -3.0), (3.0, -3.0), (-1.0, 3.0)].map(DVec2::from);
        // Inside the square the hypotenuse cuts the corner (1, 1) - (1/3, 1) - (1, 0).
        let inside = clip(&triangle, DVec2::ONE);
        assert!((area(&inside) - (4.0 - 1.0 / 3.0)).abs() < 1e-12);
        assert!(clip(&triangle.map(|p| p + 9.0), DVec2::ONE).is_empty());
    }
}
