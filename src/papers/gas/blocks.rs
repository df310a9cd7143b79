//! What the shaders read of the scene and of the frame, as bytes.

use glam::{Vec3, Vec4};

use super::capacity::Capacity;
use super::model::{DensityFunction, Object, Shape, SolidTexture, Volume};
use super::parameters::Parameters;
use crate::host_block;
use crate::scene::Light;
use crate::scene::random::Random;

host_block! {
    pub struct FrameBlock {
        eye: [f32; 4],
        forward: [f32; 4],
        column: [f32; 4],
        row: [f32; 4],
        to_column: [f32; 4],
        to_row: [f32; 4],
        ambient: [f32; 4],
        background: [f32; 4],
        sampling: [f32; 4],
        counts: [u32; 4],
        limits: [u32; 4],
    }
}

host_block! {
    pub struct VolumeBlock {
        center: [f32; 4],
        half_extent: [f32; 4],
        profile: [f32; 4],
        placement: [f32; 4],
        gas: [f32; 4],
        motion: [f32; 4],
        front: [f32; 4],
        detail: [f32; 4],
        optics: [f32; 4],
        phase: [f32; 4],
    }
}

host_block! {
    pub struct LightBlock {
        source: [f32; 4],
        intensity: [f32; 4],
    }
}

host_block! {
    pub struct ObjectBlock {
        color: [f32; 4],
        second: [f32; 4],
        offset: [f32; 4],
        detail: [f32; 4],
    }
}

host_block! {
    pub struct VertexBlock {
        pub position: [f32; 4],
        pub normal: [f32; 4],
    }
}

/// Random numbers of the fog's front (OFFSET_SIZE).
pub const OFFSET_SIZE: usize = 64;

/// What a variant makes of the scene's volumes.
#[derive(Debug, Clone, Copy)]
pub struct Gases {
    pub volume_count: usize,
    /// Whether `light-attenuation` runs.
    pub are_shadowing: bool,
}

fn four(v: Vec3, w: f32) -> [f32; 4] {
    v.extend(w).to_array()
}

impl FrameBlock {
    /// Of scene frame `number`.
    pub fn new(parameters: &Parameters, number: u32, gas: Gases, capacity: Capacity) -> Self {
        let camera = &parameters.camera;
        let view = camera.view();
        let [right, up, back] = [0, 1, 2].map(|i| view.row(i).truncate());
        // Half the picture's height at depth 1, over half its rows.
        let pixel = (camera.vertical_fov_rad / 2.0).tan() / (parameters.height as f32 / 2.0);
        FrameBlock {
            eye: four(camera.eye, camera.near_m),
            forward: four(-back, camera.far_m),
            column: four(right * pixel, 0.0),
            row: four(-up * pixel, 0.0),
            to_column: four(right / pixel, 0.0),
            to_row: four(-up / pixel, 0.0),
            ambient: four(parameters.ambient, if gas.are_shadowing { 1.0 } else { 0.0 }),
            background: four(parameters.background, 0.0),
            sampling: [number as f32, parameters.pixel_size, parameters.shadow_threshold, parameters.early_end],
            counts: [parameters.width, parameters.height, parameters.lights.len() as u32, gas.volume_count as u32],
            limits: [capacity.fragments, capacity.sections, parameters.table_size, parameters.noise_seed()],
        }
    }
}

impl VolumeBlock {
    /// A volume marched in `steps` increments of its longest side.
    pub fn of_volume(volume: &Volume, steps: u32) -> Self {
        let (shape, bottom, top) = match volume.shape {
            Shape::Box => (0.0, 1.0, 1.0),
            Shape::Sphere => (1.0, 1.0, 1.0),
            Shape::Cylinder => (2.0, 1.0, 1.0),
            Shape::Frustum { bottom, top } => (2.0, bottom, top),
        };
        let [first, second] = volume.phase;
        let is_solid = if volume.is_solid { 1.0 } else { 0.0 };
        VolumeBlock {
            center: four(volume.center, shape),
            half_extent: four(volume.half_extent_m, volume.falloff),
            profile: [bottom, top, is_solid, volume.step_m(steps)],
            optics: Vec4::from((volume.tau_per_m, volume.albedo)).to_array(),
            phase: [first.weight, first.g, second.weight, second.g],
            ..Self::of_texture(&volume.texture)
        }
    }

    /// A solid texture alone, for a surface.
    pub fn of_texture(texture: &SolidTexture) -> Self {
        let mut block: VolumeBlock = bytemuck::Zeroable::zeroed();
        // The middle and the size stand for the solid that a surface does not have.
        block.half_extent = [1.0, 1.0, 1.0, 0.0];
        block.placement = four(texture.offset, texture.scale_per_m);
        let mut swirled = |swirl: super::model::Swirl| {
            let [first, second] = swirl.ellipse;
            block.motion = [swirl.along_per_frame, swirl.frames, first, second];
        };
        let (kind, frequency) = match texture.function {
            DensityFunction::Constant => (0.0, 0.0),
            DensityFunction::Turbulence => (1.0, 0.0),
            DensityFunction::Clouds { frequency } => (2.0, frequency),
            DensityFunction::Fog { swirl, front } => {
                swirled(swirl);
                block.front = [front.x_m, front.per_frame_m, front.depth_m, front.full_frames];
                block.detail = [front.turbulence_m, front.table_m, 0.0, 0.0];
                (3.0, 0.0)
            }
            DensityFunction::Steam { swirl } => {
                swirled(swirl);
                (4.0, 0.0)
            }
            DensityFunction::Hypertexture { amplitude, softness } => {
                block.detail = [amplitude, softness, 0.0, 0.0];
                (5.0, 0.0)
            }
        };
        block.gas = [kind, texture.opaque, texture.power, frequency];
        block
    }
}

impl From<&Light> for LightBlock {
    fn from(light: &Light) -> Self {
        match *light {
            Light::Parallel { direction, intensity } => {
                LightBlock { source: four(-direction.normalize_or(Vec3::NEG_Y), 0.0), intensity: four(intensity, 0.0) }
            }
            Light::Point { position, intensity } => {
                LightBlock { source: four(position, 1.0), intensity: four(intensity, 0.0) }
            }
        }
    }
}

impl ObjectBlock {
    /// At scene frame `number`; `texture` is the entry of its solid texture in the list of volumes.
    pub fn new(object: &Object, number: u32, texture: Option<usize>) -> Self {
        let (second, edge_m) = object.checker.map_or((Vec3::ZERO, 0.0), |c| (c.color, c.edge_m));
        let is_two_sided = if object.is_two_sided { 1.0 } else { 0.0 };
        ObjectBlock {
            color: four(object.color, object.opacity),
            second: four(second, edge_m),
            offset: four(object.per_frame_m * number as f32, object.highlight.strength),
            detail: [object.highlight.exponent, is_two_sided, texture.map_or(-1.0, |t| t as f32), 0.0],
        }
    }
}

/// The random table of the fog's front, each number in [0, 1).
pub fn offsets(seed: u64) -> [f32; OFFSET_SIZE] {
    let mut random = Random::with_stream(seed, 2);
    [(); OFFSET_SIZE].map(|()| random.unit())
}
