//! The pass `geometric-transformation` (section 3, eq. 10 and 11): the maps, the light and the camera as the other passes
//! read them. Of a map only its base's matrix is touched; heights never are.

use std::sync::Arc;

use glam::{DMat4, DVec4};

use super::blocks::{LightBlock, TerrainBlock};
use super::parameters::Parameters;
use super::placement::Rays;
use super::scene::{DeviceScene, Scene};
use crate::gpu::{Error, Frame, PassInfo};
use crate::scene::Camera;

/// The scene as the camera sees it.
pub struct SceneView {
    /// Of each map.
    pub terrains: Vec<TerrainBlock>,
    /// Light and camera in the world.
    pub light: LightBlock,
    /// Of the picture.
    pub rays: Rays,
    /// World to Vulkan clip space for what is rasterised: w is the depth along the view's axis in metres, z / w is near / w,
    /// without a far plane.
    pub to_clip: DMat4,
}

impl SceneView {
    fn new(scene: &Scene, parameters: &Parameters) -> Self {
        let camera = parameters.camera(&scene.extent);
        let rays = Rays::new(&camera, parameters.width, parameters.height);
        SceneView {
            terrains: scene.terrain_blocks(parameters, &rays, camera.near_m).collect(),
            light: LightBlock::new(scene, parameters, &rays, camera.near_m),
            rays,
            to_clip: to_clip(&camera, parameters.aspect()),
        }
    }
}

fn to_clip(camera: &Camera, aspect: f64) -> DMat4 {
    let scale = 1.0 / (f64::from(camera.vertical_fov_rad) / 2.0).tan();
    let projection = DMat4::from_cols(
        DVec4::new(scale / aspect, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -scale, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.0, -1.0),
        DVec4::new(0.0, 0.0, f64::from(camera.near_m), 0.0),
    );
    projection * camera.view().as_dmat4()
}

/// Metres towards the sun that rise by the bound of the triangles' error, for 1 m of depth at a corner of the picture.
fn out_of_the_map(rays: &Rays, parameters: &Parameters) -> f32 {
    let error_m = f64::from(parameters.mesh_error_px) * rays.pixel_m() * rays.corner.length();
    let sine = f64::from(parameters.sun.elevation_rad.sin());
    (error_m / sine.max(LOWEST_SINE)) as f32
}

/// The pass, on the host.
pub struct GeometricTransformation {
    info: Arc<PassInfo>,
    footprint: f32,
    has_coarse_triangles: bool,
}

/// The sine of the sun's elevation below which rays from coarse triangles to it begin no farther away.
const LOWEST_SINE: f64 = 0.1;

impl GeometricTransformation {
    /// Rays end at texels as large as `footprint` pixels; triangles may be coarser than the map.
    pub fn new(footprint: f32, has_coarse_triangles: bool) -> Self {
        let (reads, writes) = (["camera", "placement"], ["land", "light"]);
        let info = PassInfo::host("geometric-transformation", "3, eq. 10", &reads, &writes);
        GeometricTransformation { info, footprint, has_coarse_triangles }
    }

    /// Writes the view's blocks where the device reads them as well, if it holds the maps.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(
        &self,
        frame: &mut Frame<'_>,
        scene: &Scene,
        parameters: &Parameters,
        device_scene: Option<&DeviceScene>,
    ) -> Result<SceneView, Error> {
        frame.host(&self.info, || {
            let mut view = SceneView::new(scene, parameters);
            let error_m = if self.has_coarse_triangles { out_of_the_map(&view.rays, parameters) } else { 0.0 };
            for terrain in &mut view.terrains {
                terrain.pixel_nodes *= self.footprint;
                terrain.error_m = error_m;
            }
            device_scene.map_or(Ok(()), |device_scene| device_scene.write(&view))?;
            Ok(view)
        })
    }
}
