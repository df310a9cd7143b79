//! The underwater scene: what `cast` or the stencil method draws, and `view` looks at through the water's surface.

use std::sync::Arc;

use ash::vk;
use glam::{Mat4, Vec3};

use super::parameters::Parameters;
use super::resources::{COLOR_MAP, Context, LIGHT};
use super::water::LEVEL_M;
use crate::gpu::transfer::update;
use crate::gpu::{Buffer, Error, ImageView};
use crate::host_block;
use crate::scene::{Bounds, Camera};

host_block! {
    pub struct CameraBlock {
        view_projection: [f32; 16],
    }
}

/// Widening of the picture's angle, for the view from above needs to see beyond its edges, where waves turn rays
/// outwards.
const WIDENING: f32 = 1.4;
/// Widening of the angle of what the picture shows through flat water, likewise.
const MARGIN: f32 = 1.2;
/// Tangent of half of the widest angle.
const WIDEST: f32 = 4.0;
/// Sine of the flattest angle at which the picture's middle is looked along.
const FLATTEST: f32 = 0.05;
/// Rays along x and along y that tell what a picture shows.
const RAYS: u32 = 33;

/// The camera of the underwater textures, of receivers within `bounds`. From above it stands where the refracted ray of the
/// picture's middle comes from, so that what hides what under water is, but for the waves, what the viewer sees; farther
/// by the refraction index, as an object under water seems nearer. Where that would miss what a flat look along the water shows, it
/// stands where the mean ray to the receivers comes from, and looks at all that is shown of them.
fn underwater_camera(parameters: &Parameters, bounds: &Bounds) -> Camera {
    let camera = parameters.camera;
    if !parameters.is_seen_from_above() {
        return camera;
    }
    let n = parameters.refraction_index;
    let widened = 2.0 * ((camera.vertical_fov_rad / 2.0).tan() / n * WIDENING).atan();
    let against = |ray: Vec3| {
        let (entry, refracted, distance_m) = through_flat_water(parameters, ray);
        let eye = entry - refracted * distance_m;
        Camera { eye, target: entry + refracted, vertical_fov_rad: widened, far_m: camera.far_m * n, ..camera }
    };
    let (rays, places) = shown(parameters, bounds);
    let widest = |camera: &Camera| {
        let tangents = places.iter().map(|place| tangent_to(camera, parameters.aspect(), *place));
        tangents.fold(0.0, f32::max)
    };
    let forward = (camera.target - camera.eye).normalize();
    let usual = (forward.y <= -FLATTEST).then(|| against(forward));
    if let Some(usual) = usual.filter(|usual| widest(usual) <= (widened / 2.0).tan()) {
        return usual;
    }
    if places.is_empty() {
        return camera;
    }
    let flat = against(rays.iter().sum::<Vec3>().normalize());
    let towards: Vec3 = places.iter().map(|place| (*place - flat.eye).normalize()).sum();
    let flat = Camera { target: flat.eye + towards.normalize(), ..flat };
    Camera { vertical_fov_rad: 2.0 * (MARGIN * widest(&flat)).min(WIDEST).atan(), ..flat }
}

/// Of a ray that comes down to flat water: the place of entry, the direction in the water, and the distance of the place above it that it
/// seems to come from.
fn through_flat_water(parameters: &Parameters, ray: Vec3) -> (Vec3, Vec3, f32) {
    let n = parameters.refraction_index;
    let t = (LEVEL_M as f32 - parameters.camera.eye.y) / ray.y;
    let sin2_refracted = (1.0 - ray.y * ray.y) / (n * n);
    let refracted = (ray / n + Vec3::Y * (-ray.y / n - (1.0 - sin2_refracted).sqrt())).normalize();
    (parameters.camera.eye + ray * t, refracted, t * n)
}

/// Rays of the picture that meet `bounds` through flat water, and where they come in and go out.
fn shown(parameters: &Parameters, bounds: &Bounds) -> (Vec<Vec3>, Vec<Vec3>) {
    let camera = parameters.camera;
    let to_world = (camera.projection(parameters.aspect()) * camera.view()).inverse();
    let at = |i: u32| 2.0 * i as f32 / (RAYS - 1) as f32 - 1.0;
    let (mut rays, mut places) = (Vec::new(), Vec::new());
    for i in 0..RAYS * RAYS {
        let ray = (to_world.project_point3(Vec3::new(at(i % RAYS), at(i / RAYS), 1.0)) - camera.eye).normalize();
        if ray.y >= 0.0 {
            continue;
        }
        let (entry, refracted, _) = through_flat_water(parameters, ray);
        let [low, high] = [bounds.min, bounds.max].map(|corner| (corner - entry) / refracted);
        let (near, far) = (low.min(high).max_element().max(0.0), low.max(high).min_element());
        if near <= far {
            rays.push(ray);
            places.extend([near, far].map(|t| entry + refracted * t));
        }
    }
    (rays, places)
}

/// Tangent of half of the angle that a camera sees a place with; that of the widest for what lies beside it or behind.
fn tangent_to(camera: &Camera, aspect: f32, place: Vec3) -> f32 {
    let seen = camera.view().transform_point3(place);
    let tangent = seen.y.abs().max(seen.x.abs() / aspect) / -seen.z;
    if seen.z < 0.0 { tangent.min(WIDEST) } else { WIDEST }
}

/// Colour and depth of the underwater scene as a camera sees it that stands for the viewer's without the surface.
pub struct Underwater {
    /// Linear RGB.
    pub color: Arc<ImageView>,
    /// Depth, and the stencil where there is one.
    pub depth: Arc<ImageView>,
    /// The depth alone, without a stencil.
    pub fetched_depth: Arc<ImageView>,
    /// World to clip space.
    pub view_projection: Mat4,
    /// Of the camera, metres.
    pub eye: Vec3,
    /// Near and far plane of the camera.
    pub planes_m: [f32; 2],
    /// A [`CameraBlock`].
    pub camera: Arc<Buffer>,
    /// Of the receivers, world space, metres.
    pub bounds: Bounds,
}

impl Underwater {
    /// Of receivers within `bounds`.
    ///
    /// # Errors
    /// [`Error::Limit`] for a size that the device does not allow.
    pub fn new(context: Context<'_>, depth_format: vk::Format, bounds: Bounds) -> Result<Self, Error> {
        let depth_usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
        let depth = context.image("underwater-depth", depth_format, depth_usage)?;
        let (eye, view_projection, planes_m) = seen(context.parameters, &bounds);
        let block = CameraBlock { view_projection: view_projection.to_cols_array() };
        Ok(Underwater {
            color: context.image("underwater-color", LIGHT, COLOR_MAP)?.view()?,
            depth: depth.view()?,
            fetched_depth: depth.depth_view()?,
            view_projection,
            eye,
            planes_m,
            camera: context.upload("camera", vk::BufferUsageFlags::UNIFORM_BUFFER, bytemuck::bytes_of(&block))?,
            bounds,
        })
    }

    /// Stands for the camera of `parameters` in the next frames.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn set_camera(&mut self, parameters: &Parameters) -> Result<(), Error> {
        (self.eye, self.view_projection, self.planes_m) = seen(parameters, &self.bounds);
        let block = CameraBlock { view_projection: self.view_projection.to_cols_array() };
        update(&self.camera, bytemuck::bytes_of(&block))
    }
}

/// Eye, matrix and planes of the underwater camera.
fn seen(parameters: &Parameters, bounds: &Bounds) -> (Vec3, Mat4, [f32; 2]) {
    let camera = underwater_camera(parameters, bounds);
    (camera.eye, camera.projection(parameters.aspect()) * camera.view(), [camera.near_m, camera.far_m])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a floor of 4 x 4 m, 3 m down, with what stands on it.
    const BOUNDS: Bounds = Bounds { min: Vec3::new(-2.0, -3.0, -2.0), max: Vec3::new(2.0, -1.5, 2.0) };

    fn looking(eye: [f32; 3], target: [f32; 3]) -> Parameters {
        let camera = Parameters::default().camera;
        let camera = Camera { eye: eye.into(), target: target.into(), ..camera };
        Parameters { camera, ..Parameters::default() }
    }

    #[test]
    fn all_that_the_picture_shows_lies_in_the_textures() {
        let flat = [([6.0, 0.3, 0.0], [0.0; 3]), ([4.0, 1.0, 0.0], [0.0, 0.4, 0.0]), ([2.5, 0.4, 0.0], [0.0; 3])];
        let steep = [([0.0, 6.0, 0.01], [0.0, -3.0, 0.0]), ([1.5, 0.2, 1.5], [0.0, -2.0, 0.0])];
        for (eye, target) in flat.into_iter().chain(steep) {
            let parameters = looking(eye, target);
            let (_, places) = shown(&parameters, &BOUNDS);
            let (_, to_clip, _) = seen(&parameters, &BOUNDS);
            let outside =
                places.iter().filter(|place| to_clip.project_point3(**place).truncate().abs().max_element() > 1.0);
            assert!(places.len() > 200, "{eye:?}: {}", places.len());
            assert_eq!(outside.count(), 0, "{eye:?}");
        }
    }

    #[test]
    fn without_receivers_in_the_picture_the_viewers_camera_does() {
        let along_the_water = looking([3.0, 1.0, 3.0], [6.0, 1.0, 6.0]);
        assert_eq!(underwater_camera(&along_the_water, &BOUNDS), along_the_water.camera);
        let below = looking([3.0, -1.0, 3.0], [0.0, -2.0, 0.0]);
        assert_eq!(underwater_camera(&below, &BOUNDS), below.camera);
    }
}
