//! Stage three (chapter 7): the surface as splats, blended and normalised.

use std::sync::Arc;

use ash::vk;

use super::floors::{EMPTY, FLOORS};
use super::parameters::{Parameters, Shading};
use super::rock::Rock;
use super::targets::{DEPTH, FAR, FLOATS, ZERO, target};
use crate::gpu::transfer::upload;
use crate::gpu::{
    Blend, Buffer, DepthTest, Draw, Error, Frame, Image, ImageDesc, ImageView, Load, Pass, Sampler, ShaderLibrary,
    Topology,
};
use crate::host_block;

host_block! {
    /// A splat's place along x and z, metres.
    struct Place {
        place: [f32; 2],
    }
}

host_block! {
    pub(super) struct SceneBlock {
        view_projection: [f32; 16],
        glow: [f32; 4],
        space_m: [f32; 3],
        splat_radius_m: f32,
        columns: [f32; 2],
        rock_texels: [f32; 2],
        epsilon_m: f32,
        depth_per_m: f32,
        rock_tile_m: f32,
        _pad: f32,
    }
}

host_block! {
    struct ShadingConstants {
        drift_m: [f32; 2],
        mode: u32,
    }
}

/// The passes and resources of stage three.
pub struct Splatting {
    visibility_pass: Pass,
    blending: Pass,
    splats_floor: Pass,
    normalisation: Pass,
    splats: u32,
    instanced: bool,
    shading: Shading,
    scene: Arc<Buffer>,
    visibility: Arc<ImageView>,
    accumulated: Arc<ImageView>,
    picture: Arc<ImageView>,
}

impl Splatting {
    /// The stage on a texture of normals (RGB) and heights in metres (alpha) over the whole space. `instanced` splats are
    /// quads without a geometry stage.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        parameters: &Parameters,
        normal_height: &Arc<ImageView>,
        rock: &Rock,
        instanced: bool,
    ) -> Result<Self, Error> {
        let device = shaders.device();
        let name = |what: &str| format!("{label}/{what}");
        let (width, height) = (parameters.width, parameters.height);
        let visibility = target(shaders, name("visibility"), DEPTH, width, height)?;
        let accumulated = target(shaders, name("accumulated-colors"), FLOATS, width, height)?;
        // The values are those of the display already.
        let format = vk::Format::R8G8B8A8_UNORM;
        let picture = ImageDesc::new_2d(name("picture"), format, width, height);
        let picture = Image::new(device, picture.usage(vk::ImageUsageFlags::COLOR_ATTACHMENT))?.view()?;

        let places = places(parameters);
        let vertices =
            upload(device, &name("splats"), vk::BufferUsageFlags::VERTEX_BUFFER, bytemuck::cast_slice(&places))?;
        let block = scene(parameters, normal_height, rock);
        let usage = vk::BufferUsageFlags::UNIFORM_BUFFER;
        let scene = upload(device, &name("scene"), usage, bytemuck::bytes_of(&block))?;
        let rock = rock.load(shaders, label)?;
        let linear = Sampler::new(device, "linear", vk::Filter::LINEAR)?;

        let splats = |pass, section, fragment| {
            let splats = if instanced {
                Pass::graphics(pass, section, "lava/splat-quad.vert", fragment)
                    .instances::<Place>(&vertices)
                    .topology(Topology::TriangleStrip)
            } else {
                Pass::graphics(pass, section, "lava/splat.vert", fragment)
                    .geometry("lava/splat.geom")
                    .vertices::<Place>(&vertices)
                    .topology(Topology::Points)
            };
            splats.with("scene", &scene).with("normal_height", normal_height)
        };
        let visibility_pass = splats("visibility", "7.1", "lava/visibility.frag")
            .depth(&visibility, FAR, DepthTest::LessWrite)
            .build(shaders)?;
        let blending = splats("blending", "7.2", "lava/blending.frag")
            .constants::<ShadingConstants>()
            .with("visibility", &visibility)
            .with("rock", &rock)
            .with("linear", &linear)
            .color(&accumulated, ZERO, Blend::Add)
            .build(shaders)?;
        let splats_floor =
            splats(FLOORS[2].1, "7.1", EMPTY).color(&accumulated, Load::Keep, Blend::Masked).build(shaders)?;
        let normalisation = Pass::graphics("normalisation", "7.3", "common/fullscreen.vert", "lava/normalisation.frag")
            .with("accumulated_colors", &accumulated)
            .color(&picture, Load::Discard, Blend::Replace)
            .build(shaders)?;
        Ok(Splatting {
            visibility_pass,
            blending,
            splats_floor,
            normalisation,
            splats: places.len() as u32,
            instanced,
            shading: parameters.shading,
            scene,
            visibility,
            accumulated,
            picture,
        })
    }

    /// Draws the surface; the rock has drifted `drift_m` along x.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record(&self, frame: &mut Frame<'_>, drift_m: f32) -> Result<(), Error> {
        let constants = ShadingConstants { drift_m: [drift_m, 0.0], mode: self.shading.mode() };
        frame.graphics(&self.visibility_pass, |draw| self.draw_splats(draw))?;
        frame.graphics(&self.blending, |draw| {
            draw.constants(&constants);
            self.draw_splats(draw);
        })?;
        frame.graphics(&self.normalisation, |draw| {
            draw.vertices(3);
        })
    }

    /// Draws the splats with an empty fragment stage, as the last pass of [`FLOORS`]. It changes no texture.
    ///
    /// # Errors
    /// What the Vulkan layer answers.
    pub fn record_floor(&self, frame: &mut Frame<'_>) -> Result<(), Error> {
        frame.graphics(&self.splats_floor, |draw| self.draw_splats(draw))
    }

    fn draw_splats(&self, draw: &mut Draw<'_>) {
        if self.instanced {
            draw.instances(4, self.splats)
        } else {
            draw.vertices(self.splats)
        };
    }

    /// Eye-space depth of the nearest splat plus epsilon (eq. 7.1), as a share of [`depth_range_m`].
    pub fn visibility(&self) -> &Arc<ImageView> {
        &self.visibility
    }

    /// Weighted colours, sum of weights in alpha.
    pub fn accumulated_colors(&self) -> &Arc<ImageView> {
        &self.accumulated
    }

    /// The uniform block of the stage.
    pub(super) fn scene(&self) -> &Arc<Buffer> {
        &self.scene
    }

    /// 8-bit sRGB, though its format does not say so.
    pub fn picture(&self) -> &Arc<ImageView> {
        &self.picture
    }
}

/// The eye-space depth in metres that the depth texture stores as 1.
pub fn depth_range_m(parameters: &Parameters) -> f32 {
    parameters.camera.far_m + parameters.epsilon_m
}

/// The splats, spread out evenly (chapter 7).
fn places(parameters: &Parameters) -> Vec<Place> {
    let [columns, rows] = parameters.splats;
    let at = |i: u32, count: u32, side_m: f32| (i as f32 + 0.5) / count as f32 * side_m;
    let row = |j: u32| {
        let z = at(j, rows, parameters.space_m.z);
        (0..columns).map(move |i| Place { place: [at(i, columns, parameters.space_m.x), z] })
    };
    (0..rows).flat_map(row).collect()
}

fn scene(parameters: &Parameters, normal_height: &Arc<ImageView>, rock: &Rock) -> SceneBlock {
    let camera = &parameters.camera;
    let view_projection = camera.projection(parameters.aspect()) * camera.view();
    SceneBlock {
        view_projection: view_projection.to_cols_array(),
        glow: parameters.color.extend(0.0).to_array(),
        space_m: parameters.space_m.to_array(),
        splat_radius_m: parameters.splat_radius_m,
        columns: [normal_height.width() as f32, normal_height.height() as f32],
        rock_texels: [rock.width as f32, rock.height as f32],
        epsilon_m: parameters.epsilon_m,
        depth_per_m: 1.0 / depth_range_m(parameters),
        rock_tile_m: parameters.rock_tile_m,
        _pad: 0.0,
    }
}
