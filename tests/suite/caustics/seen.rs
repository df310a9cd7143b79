//! Points that rays hit first, in double precision: a camera's, straight ones and those refracted by the water.

use fumarole::papers::caustics::{Parameters, ReceiverInput};
use glam::{DMat4, DVec3, Vec3};

/// A point of a receiver that a pixel shows.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    pub position: DVec3,
    pub normal: DVec3,
    pub albedo: DVec3,
}

impl Surface {
    /// I_d of eq. 4-19 for unit light against `v`.
    pub fn diffuse(&self, v: DVec3) -> DVec3 {
        self.albedo * self.normal.normalize().dot(v).max(0.0)
    }
}

/// Row by row; `None` where no receiver is seen. The camera is under water, so that its rays are straight.
pub fn first_hits(parameters: &Parameters, receivers: &[ReceiverInput]) -> Vec<Option<Surface>> {
    let eye = parameters.camera.eye.as_dvec3();
    rays(parameters).map(|ray| first_hit(receivers, eye, ray).map(|(_, surface)| surface)).collect()
}

/// The directions through the middles of the pixels, row by row.
pub fn rays(parameters: &Parameters) -> impl Iterator<Item = DVec3> {
    let camera = parameters.camera;
    let matrix: DMat4 = (camera.projection(parameters.aspect()) * camera.view()).as_dmat4();
    let inverse = matrix.inverse();
    let (width, height) = (parameters.width, parameters.height);
    (0..width * height).map(move |pixel| {
        let fraction = |i: u32, of: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(of) - 1.0;
        let (x, y) = (fraction(pixel % width, width), fraction(pixel / width, height));
        (inverse.project_point3(DVec3::new(x, y, 0.5)) - camera.eye.as_dvec3()).normalize()
    })
}

/// The receiver that a ray hits first, and the point.
pub fn first_hit(receivers: &[ReceiverInput], from: DVec3, ray: DVec3) -> Option<(usize, Surface)> {
    let hits = receivers.iter().enumerate().filter_map(|(index, receiver)| Some((index, hit(receiver, from, ray)?)));
    let nearest = hits.min_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    Some((nearest.0, nearest.1.1))
}

/// The nearest hit on one receiver and its distance, by Möller and Trumbore.
fn hit(receiver: &ReceiverInput, eye: DVec3, ray: DVec3) -> Option<(f64, Surface)> {
    let mesh = &receiver.mesh;
    let at = |list: &[Vec3], i: u32| list[i as usize].as_dvec3();
    let triangle = |corners: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|i| at(&mesh.positions, corners[i]));
        let (ab, ac, from_a) = (b - a, c - a, eye - a);
        let normal = ray.cross(ac);
        let determinant = ab.dot(normal);
        let weight_b = from_a.dot(normal) / determinant;
        // Most triangles are missed by it already.
        if !(0.0..=1.0).contains(&weight_b) {
            return None;
        }
        let turned = from_a.cross(ab);
        let weight_c = ray.dot(turned) / determinant;
        let distance = ac.dot(turned) / determinant;
        let weights = [1.0 - weight_b - weight_c, weight_b, weight_c];
        (distance > 0.0 && weights.iter().all(|&fraction| fraction >= 0.0)).then(|| {
            let normal: DVec3 = (0..3).map(|i| at(&mesh.normals, corners[i]) * weights[i]).sum();
            let surface = Surface {
                position: eye + ray * distance,
                normal: normal.normalize(),
                albedo: receiver.albedo.as_dvec3(),
            };
            (distance, surface)
        })
    };
    mesh.indices.chunks_exact(3).filter_map(triangle).min_by(|a, b| a.0.total_cmp(&b.0))
}
