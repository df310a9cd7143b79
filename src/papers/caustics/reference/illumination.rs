//! Illumination volumes, their intersection triangles and their intensity (sections 4.3 to 4.5).

use crate::papers::caustics::reference::{AIR, Medium, ReceiverBox, ReferenceLight, Water, refract};
use glam::DVec3;

/// The light that passes one water triangle, IL_j = {T_l, T_m, T_n} (eq. 4-14).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IlluminationVolume {
    /// Corners of the water triangle in the world, in metres.
    pub vertices: [DVec3; 3],
    /// Unit directions T of the refracted rays.
    pub refracted: [DVec3; 3],
    /// cos θ_i: each corner's incident ray against the normal of the face, above 0.
    pub cos_incident: [f64; 3],
    /// A_w, the area of the water triangle in m², above 0.
    pub area_m2: f64,
}

/// Intersection of an illumination volume with a plane of a receiver's box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Corners in box space, in metres; y is the plane's.
    pub corners: [DVec3; 3],
    /// d, how far each ray has travelled through water, in metres, above 0.
    pub distances_m: [f64; 3],
    /// cos θ_t: each refracted ray against the plane's normal V, above 0.
    pub cos_refracted: [f64; 3],
}

/// The illumination volumes of all water triangles in their order (4.3). Each vertex refracts its own incident ray at
/// its own normal (eq. 2-8). Left out are triangles without area and those that turn away from the light: where the
/// face or a vertex normal does not face the incident ray nothing passes.
///
/// # Panics
/// On an index beyond the water's vertices.
pub fn illumination_volumes(water: Water<'_>, light: ReferenceLight, medium: Medium) -> Vec<IlluminationVolume> {
    let volume = |triangle: &[u32; 3]| {
        let corners = triangle.map(|i| water.vertices[i as usize]);
        let vertices = corners.map(|corner| corner.position);
        let across = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
        let face_normal = across.try_normalize()? * across.y.signum();
        let cos_incident = vertices.map(|p| -face_normal.dot(light.direction_at(p)));
        let refracted = corners.map(|corner| {
            let incident = light.direction_at(corner.position);
            refract(incident, corner.normal, AIR, medium.refraction_index)
        });
        let [Some(a), Some(b), Some(c)] = refracted else {
            return None;
        };
        cos_incident.iter().all(|&cos| cos > 0.0).then_some(IlluminationVolume {
            vertices,
            refracted: [a, b, c],
            cos_incident,
            area_m2: across.length() / 2.0,
        })
    };
    water.triangles.iter().filter_map(volume).collect()
}

/// The points where the three rays of `volume` pierce the plane y = `plane` of box space (4.4). `None` where a ray runs
/// away from the plane or meets it behind the water.
pub fn intersection_triangle(volume: &IlluminationVolume, receiver: &ReceiverBox, plane: f64) -> Option<Intersection> {
    let origins = volume.vertices.map(|p| receiver.to_box(p));
    let rays = volume.refracted.map(|t| receiver.direction_to_box(t));
    let distances_m: [f64; 3] = std::array::from_fn(|i| (plane - origins[i].y) / rays[i].y);
    let cos_refracted = rays.map(|ray| -ray.y);
    let meets = distances_m.iter().all(|&d| d > 0.0 && d.is_finite());
    (meets && cos_refracted.iter().all(|&cos| cos > 0.0)).then(|| Intersection {
        corners: std::array::from_fn(|i| {
            let point = origins[i] + rays[i] * distances_m[i];
            DVec3::new(point.x, plane, point.z)
        }),
        distances_m,
        cos_refracted,
    })
}

/// I_c at the three corners of an intersection triangle under a light of unit intensity:
/// I_c = (A_w cos θ_i) / (A_d cos θ_t) e^(-K d) (eq. 4-16 to 4-18), flux per area perpendicular to the beam. Cosines
/// and d are per corner, A_w and A_d (m², in the plane) per triangle; between the corners it is interpolated linearly.
/// It is not clamped. `None` where the triangle has no area, or so little that the quotient is not finite.
pub fn intensity(volume: &IlluminationVolume, hit: &Intersection, absorption_per_m: f64) -> Option<[f64; 3]> {
    let [a, b, c] = hit.corners;
    let area_m2 = (b - a).cross(c - a).length() / 2.0;
    let corners: [f64; 3] = std::array::from_fn(|i| {
        let incident_flux = volume.area_m2 * volume.cos_incident[i];
        let transmitted = (-absorption_per_m * hit.distances_m[i]).exp();
        incident_flux * transmitted / (area_m2 * hit.cos_refracted[i])
    });
    (area_m2 > 0.0 && corners.iter().all(|i| i.is_finite())).then_some(corners)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::caustics::reference::WaterVertex;
    use crate::papers::caustics::reference::fixtures::{OVERHEAD, WATER, horizontal};

    fn volume(vertices: [DVec3; 3], normals: [DVec3; 3], light: ReferenceLight) -> Option<IlluminationVolume> {
        let corners: Vec<WaterVertex> =
            vertices.into_iter().zip(normals).map(|(position, normal)| WaterVertex { position, normal }).collect();
        let water = Water { vertices: &corners, triangles: &[[0, 1, 2]] };
        illumination_volumes(water, light, WATER).pop()
    }

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Z];

    #[test]
    fn the_same_triangle_wound_either_way_lets_the_same_light_through() {
        let up = volume(CORNERS, [DVec3::Y; 3], OVERHEAD).unwrap();
        let [a, b, c] = CORNERS;
        let down = volume([a, c, b], [DVec3::Y; 3], OVERHEAD).unwrap();
        assert_eq!(up.cos_incident, [1.0; 3]);
        assert_eq!(up.cos_incident, down.cos_incident);
        assert_eq!((up.area_m2, down.area_m2), (0.5, 0.5));
    }

    #[test]
    fn a_converging_beam_gains_what_its_area_loses() {
        // Normals lean outward by the same slope about the centroid: rays converge towards it.
        let centroid = (CORNERS[0] + CORNERS[1] + CORNERS[2]) / 3.0;
        let normals = CORNERS.map(|p| (DVec3::Y + (p - centroid) * 0.5).normalize());
        let beam = volume(CORNERS, normals, OVERHEAD).unwrap();
        let receiver = horizontal(2.0, -3.0).aligned(OVERHEAD);
        let hit = intersection_triangle(&beam, &receiver, 0.0).unwrap();
        let [a, b, c] = hit.corners;
        let shrunk = (b - a).cross(c - a).length() / 2.0;
        assert!(shrunk < 0.5 * beam.area_m2);
        let clear = intensity(&beam, &hit, 0.0).unwrap();
        let murky = intensity(&beam, &hit, 0.4).unwrap();
        for i in 0..3 {
            let flux = clear[i] * hit.cos_refracted[i] * shrunk;
            assert!((flux - beam.area_m2).abs() < 1e-12);
            assert!((hit.distances_m[i] * hit.cos_refracted[i] - 3.0).abs() < 1e-12);
            let absorbed = (-0.4 * hit.distances_m[i]).exp();
            assert!((murky[i] - clear[i] * absorbed).abs() < 1e-12);
        }
    }

    #[test]
    fn a_point_lights_rays_have_their_own_angles() {
        let light = ReferenceLight::Point { position: DVec3::Y };
        let beam = volume(CORNERS, [DVec3::Y; 3], light).unwrap();
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((beam.cos_incident[0] - 1.0).abs() < 1e-12);
        assert!((beam.cos_incident[1] - half).abs() < 1e-12);
        assert!((beam.refracted[1].x - 0.75 * half).abs() < 1e-12);
    }

    #[test]
    fn planes_behind_the_water_and_triangles_without_area_receive_nothing() {
        let beam = volume(CORNERS, [DVec3::Y; 3], OVERHEAD).unwrap();
        let receiver = horizontal(2.0, -3.0).aligned(OVERHEAD);
        assert!(intersection_triangle(&beam, &receiver, 2.9).is_some());
        assert_eq!(intersection_triangle(&beam, &receiver, 3.0), None);
        assert_eq!(intersection_triangle(&beam, &receiver, 3.1), None);
        let hit = intersection_triangle(&beam, &receiver, 0.0).unwrap();
        let flat = Intersection { corners: [hit.corners[0], hit.corners[1], hit.corners[1]], ..hit };
        assert_eq!(intensity(&beam, &flat, 0.0), None);
        let [a, b, _] = CORNERS;
        assert_eq!(volume([a, b, b * 2.0], [DVec3::Y; 3], OVERHEAD), None);
    }

    #[test]
    fn water_that_turns_away_from_the_light_passes_nothing() {
        let light = ReferenceLight::Parallel { direction: DVec3::new(0.995, -0.0998749, 0.0) };
        let steep = [DVec3::ZERO, DVec3::new(1.0, -1.0, 0.0), DVec3::Z];
        assert_eq!(volume(steep, [DVec3::Y; 3], light), None);
        let away = DVec3::new(1.0, 1.0, 0.0).normalize();
        assert_eq!(volume(CORNERS, [DVec3::Y, away, DVec3::Y], light), None);
    }
}
