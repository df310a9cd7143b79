//! The stencil method (section 3.2, Iwasaki et al.; the thesis has one sentence on it): each illumination volume is held by
//! a closed prism, counted in the stencil buffer against the depth of what is seen, then drawn where the count is not zero,
//! adding its light. It knows no occlusion: a surface in the shadow of another is lit as if nothing stood before it.

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use super::cast::DEEP_WATER;
use super::illumination::{self, IlluminationVolumes};
use super::maps::{self, BLACK, FAR};
use super::planar::{Shared, numbered};
use super::receiver::{Receiver, Vertex};
use super::water::Water;
use crate::gpu::transfer::upload;
use crate::gpu::{Blend, DepthTest, Error, Frame, Image, ImageDesc, ImageView, Load, Pass};
use crate::host_block;
use crate::measure::Target;
use crate::scene::Light;

/// Vertices of a volume: a prism's eight triangles.
const VOLUME_VERTICES: u32 = 24;
/// How far below every receiver the volumes end, as a share of their depth.
const BELOW: f64 = 0.1;

/// Depth and stencil; 32 bits of depth, since some devices lack 24.
pub const DEPTH_STENCIL: vk::Format = vk::Format::D32_SFLOAT_S8_UINT;

host_block! {
    struct ReceiverConstants {
        albedo: [f32; 4],
        ambient: [f32; 4],
    }
}

host_block! {
    pub struct VolumesBlock {
        view_projection: [f32; 16],
        u: [f32; 4],
        v: [f32; 4],
        w: [f32; 4],
        intensity: [f32; 4],
        bottom: f32,
        _pad: [f32; 3],
    }
}

/// The method with everything that it draws.
pub struct Stencil {
    receivers: Vec<(Pass, Arc<Receiver>)>,
    ambient: [f32; 4],
    lights: Vec<LightVolumes>,
    surface: Surface,
}

/// The volumes of one light.
struct LightVolumes {
    volumes: IlluminationVolumes,
    pass: Pass,
}

/// What is seen in each pixel: position, normal and albedo.
struct Surface {
    position: Arc<ImageView>,
    normal: Arc<ImageView>,
    albedo: Arc<ImageView>,
}

impl Stencil {
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(shared: Shared<'_>) -> Result<Self, Error> {
        let Shared { shaders, label, underwater, parameters, .. } = shared;
        let image = |name: &str, format| {
            let desc = ImageDesc::new_2d(format!("{label}/{name}"), format, parameters.width, parameters.height);
            let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::SAMPLED;
            let image = Image::new(shaders.device(), desc.usage(usage));
            image.map_err(|error| error.set_by("--size"))?.view()
        };
        let surface = Surface {
            position: image("surface-position", vk::Format::R32G32B32A32_SFLOAT)?,
            normal: image("surface-normal", maps::LIGHT)?,
            albedo: image("surface-albedo", maps::LIGHT)?,
        };
        let mut receivers: Vec<(Pass, Arc<Receiver>)> = Vec::new();
        for receiver in shared.receivers {
            let load = |clear| if receivers.is_empty() { clear } else { Load::Keep };
            let pass = Pass::graphics(
                "receivers",
                "3.2",
                "caustics/stencil-receivers.vert",
                "caustics/stencil-receivers.frag",
            )
            .vertices::<Vertex>(&receiver.vertices)
            .indices(&receiver.indices)
            .constants::<ReceiverConstants>()
            .with("camera", &underwater.camera)
            .color(&underwater.color, load(DEEP_WATER), Blend::Replace)
            .color(&surface.position, load(BLACK), Blend::Replace)
            .color(&surface.normal, load(BLACK), Blend::Replace)
            .color(&surface.albedo, load(BLACK), Blend::Replace)
            .depth(&underwater.depth, load(FAR), DepthTest::LessWrite)
            .build(shaders)?;
            receivers.push((pass, receiver.clone()));
        }
        let lights = (0..parameters.lights.len())
            .map(|index| LightVolumes::new(shared, &surface, index))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Stencil { receivers, ambient: parameters.ambient.extend(0.0).to_array(), lights, surface })
    }

    /// What is seen, the water's rays, and the volumes one after the other: a draw that counts, a draw that lights.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&mut self, frame: &mut Frame<'_>, water: &Water, time_s: f64) -> Result<(), Error> {
        for (pass, receiver) in &self.receivers {
            let constants = ReceiverConstants { albedo: receiver.albedo.extend(0.0).to_array(), ambient: self.ambient };
            frame.graphics(pass, |draw| {
                draw.constants(&constants).indices(receiver.index_count);
            })?;
        }
        water.animate(frame, time_s)?;
        for light in &self.lights {
            light.volumes.refract(frame)?;
            frame.graphics(&light.pass, |draw| {
                for volume in 0..light.volumes.index_count / 3 {
                    let first = volume * VOLUME_VERTICES;
                    draw.counting(true).vertices_from(first, VOLUME_VERTICES);
                    draw.counting(false).vertices_from(first, VOLUME_VERTICES);
                }
            })?;
        }
        Ok(())
    }

    pub fn targets(&self) -> Vec<Target> {
        let rays = self.lights.iter().enumerate().map(|(l, light)| {
            Target::table(numbered("illumination-volumes", &[l]), &light.volumes.rays, illumination::RAY_FLOATS)
        });
        let surface = [
            Target::image("surface-position", &self.surface.position),
            Target::image("surface-normal", &self.surface.normal),
            Target::image("surface-albedo", &self.surface.albedo),
        ];
        rays.chain(surface).collect()
    }
}

impl LightVolumes {
    fn new(shared: Shared<'_>, surface: &Surface, index: usize) -> Result<Self, Error> {
        let Shared { shaders, label, water, underwater, parameters, .. } = shared;
        let (light, axes) = (&parameters.lights[index], &shared.axes[index]);
        let volumes = IlluminationVolumes::new(shaders, label, water, light, axes, parameters)?;
        let (Light::Parallel { intensity, .. } | Light::Point { intensity, .. }) = light;
        let points = shared.receivers.iter().flat_map(|r| &r.positions);
        let lowest = points.map(|p| axes.along(p.as_dvec3()).y).fold(f64::INFINITY, f64::min) - volumes.reference.y;
        let axis = |axis: DVec3, at: f64| axis.as_vec3().extend(at as f32).to_array();
        let block = VolumesBlock {
            view_projection: underwater.view_projection.to_cols_array(),
            u: axis(axes.u, volumes.reference.x),
            v: axis(axes.v, volumes.reference.y),
            w: axis(axes.w, volumes.reference.z),
            intensity: intensity.extend(parameters.absorption_per_m).to_array(),
            bottom: (lowest - BELOW * lowest.abs()) as f32,
            _pad: [0.0; 3],
        };
        let uniform = upload(
            shaders.device(),
            &format!("{label}/volumes"),
            vk::BufferUsageFlags::UNIFORM_BUFFER,
            bytemuck::bytes_of(&block),
        )?;
        let pass =
            Pass::graphics("stencil-volumes", "3.2", "caustics/stencil-volumes.vert", "caustics/stencil-volumes.frag")
                .with("rays", &volumes.rays)
                .with("indices", &water.indices)
                .with("volumes", &uniform)
                .with("surface_position", &surface.position)
                .with("surface_normal", &surface.normal)
                .with("surface_albedo", &surface.albedo)
                .with("nearest", shared.nearest)
                .counting("common/empty.frag", DepthTest::CountVolume)
                .color(&underwater.color, Load::Keep, Blend::Add)
                .depth(&underwater.depth, Load::Keep, DepthTest::InsideVolume)
                .build(shaders)?;
        Ok(LightVolumes { volumes, pass })
    }
}
