//! The blocks that shaders read and write, as bytes.

use glam::Vec3;

use super::capacity::Capacity;
use super::grid::Grid;
use super::model::{DensityFunction, Object, Shape, SolidTexture, Swirl, Volume};
use super::parameters::Parameters;
use crate::host_block;
use crate::scene::Light;
use crate::scene::random::Random;

host_block! {
    /// The frame and its camera, as `frame.glsl` describes them.
    pub struct FrameBlock {
        eye: [f32; 3],
        hither_m: f32,
        forward: [f32; 3],
        yon_m: f32,
        ray_per_column: [f32; 3],
        number: f32,
        ray_per_row: [f32; 3],
        shadow_threshold: f32,
        to_column: [f32; 3],
        early_end: f32,
        to_row: [f32; 3],
        fragment_capacity: u32,
        ambient: [f32; 3],
        section_capacity: u32,
        background: [f32; 3],
        table_size: u32,
        size: [u32; 2],
        noise_seed: u32,
    }
}

host_block! {
    /// Bounds of loops, as `counts.glsl` describes them.
    pub struct CountsBlock {
        volumes: u32,
        lights: u32,
        octaves: u32,
        attenuations: u32,
        samples: u32,
        jitter: u32,
        nearest: u32,
        chunks: u32,
        cache: u32,
        bricks: u32,
        froxel_columns: u32,
        froxel_rows: u32,
        froxel_slices: u32,
        froxels_first_m: f32,
        froxels_last_m: f32,
        glow: u32,
        volume_scale: u32,
    }
}

host_block! {
    /// A volume, or the solid texture of a surface, as `volume.glsl` describes it.
    pub struct VolumeBlock {
        center: [f32; 3],
        shape: u32,
        half_extent_m: [f32; 3],
        falloff: f32,
        texture_offset: [f32; 3],
        texture_scale_per_m: f32,
        albedo: [f32; 3],
        tau_per_m: f32,
        radii: [f32; 2],
        is_solid: u32,
        step_m: f32,
        density_function: u32,
        opaque: f32,
        power: f32,
        frequency: f32,
        ellipse: [f32; 2],
        along_per_frame: f32,
        swirl_frames: f32,
        front_x_m: f32,
        front_per_frame_m: f32,
        front_depth_m: f32,
        front_full_frames: f32,
        front_turbulence_m: f32,
        front_table_m: f32,
        hypertexture_amplitude: f32,
        hypertexture_softness: f32,
        phase_weights: [f32; 2],
        phase_g: [f32; 2],
    }
}

host_block! {
    /// The grid of a volume, as `density-grid.glsl` describes it.
    pub struct GridBlock {
        to_column: [f32; 3],
        columns: u32,
        to_row: [f32; 3],
        rows: u32,
        to_layer: [f32; 3],
        layers: u32,
        middle: [f32; 3],
        first: u32,
    }
}

host_block! {
    /// A light, as `light.glsl` describes it.
    pub struct LightBlock {
        source: [f32; 3],
        is_point: u32,
        intensity: [f32; 3],
        _pad: f32,
    }
}

host_block! {
    /// The surface properties of an object, as `object.glsl` describes them.
    pub struct ObjectBlock {
        color: [f32; 3],
        opacity: f32,
        checker_color: [f32; 3],
        checker_edge_m: f32,
        offset_m: [f32; 3],
        highlight_strength: f32,
        highlight_exponent: f32,
        is_two_sided: u32,
        solid_texture: i32,
        fade_m: f32,
        ends_m: [f32; 2],
        rim: f32,
        _pad: f32,
        vein_color: [f32; 3],
        veins: i32,
    }
}

host_block! {
    /// A vertex of all meshes in one, two texels: metres, and a unit normal.
    pub struct VertexBlock {
        position: [f32; 3],
        _after_position: f32,
        normal: [f32; 3],
        _after_normal: f32,
    }
}

host_block! {
    /// Three vertices and the object that they belong to, a texel.
    pub struct TriangleBlock {
        /// Indices of its corners.
        pub vertices: [u32; 3],
        /// Index of the object.
        pub object: u32,
    }
}

host_block! {
    /// The part of a fragment by which its list is walked, as `lists.glsl` describes it.
    pub struct LinkBlock {
        /// The fragment or section after it.
        pub next: u32,
        /// Bit 4 row + column of a sub-pixel, rows from the top.
        pub mask: u32,
        /// Depth of its nearest corner.
        pub near_m: f32,
        /// Depth of its farthest corner.
        pub far_m: f32,
    }
}

host_block! {
    /// The part of a fragment that is the surface's.
    pub struct SurfaceBlock {
        /// Octahedral, 16 bits each way.
        pub normal: u32,
        /// Index of the object.
        pub object: u32,
        /// Index among the triangles of all objects.
        pub triangle: u32,
        /// Area of the triangle inside the pixel, pixels.
        pub coverage: f32,
    }
}

host_block! {
    /// The colour and the opacity of a fragment.
    pub struct ColorBlock {
        /// Half floats, linear RGB.
        pub red_green: u32,
        /// A half float, and the opacity in steps of 1/65535.
        pub blue_opacity: u32,
    }
}

host_block! {
    /// A section of gas in a pixel's list; while `volume` is at it, its first four words are of the way in hand (`march-delta.glsl`).
    pub struct SectionBlock {
        near_m: f32,
        far_m: f32,
        increments: f32,
        /// The fragment after it.
        pub next: u32,
        color: [f32; 3],
        transparency: f32,
    }
}

host_block! {
    /// A pixel's slots for sections, and the evaluations that `volume` counted.
    pub struct PixelBlock {
        first_section: u32,
        section_count: u32,
        end_m: f32,
        /// Of the density, along the pixel's ray.
        pub evaluations: u32,
    }
}

host_block! {
    /// The fragments and sections that the last band wanted, and the most that any band before it did.
    pub struct CountersBlock {
        /// Fragments that the last band wanted.
        pub fragment_count: u32,
        /// Sections that it wanted.
        pub section_count: u32,
        /// Most fragments that a band before it wanted.
        pub most_fragments: u32,
        /// Most sections that a band before it wanted.
        pub most_sections: u32,
        /// Chunks of the triangles of tiles that the last piece of them wanted.
        pub chunk_count: u32,
        /// Most chunks that a piece wanted.
        pub most_chunks: u32,
        /// Most triangles of a tile.
        pub most_of_tile: u32,
        /// 1 where the device ended a loop over them.
        pub is_ended: u32,
        /// Pixels of the last frame that a k-buffer shows less of than there is.
        pub lost_pixels: u32,
        /// Most such pixels of a frame before it.
        pub most_lost_pixels: u32,
        /// Fragments that the last frame's bands before the last wanted, the lower 32 bits.
        pub earlier_fragments: u32,
        /// The upper 32 bits.
        pub earlier_fragments_high: u32,
    }
}

/// Random numbers of the fog's front (OFFSET_SIZE).
pub const OFFSET_SIZE: usize = 64;

/// The use that a variant makes of the scene's volumes.
#[derive(Debug, Clone, Copy)]
pub struct GasUse {
    /// Volumes that are marched; 0 without gas.
    pub volume_count: usize,
    /// `light-attenuation` runs.
    pub has_attenuations: bool,
}

impl FrameBlock {
    /// The block of scene frame `number`.
    pub fn new(parameters: &Parameters, number: u32, capacity: Capacity) -> Self {
        let camera = &parameters.camera;
        let view = camera.view();
        let [right, up, back] = [0, 1, 2].map(|i| view.row(i).truncate());
        // Half the picture's height at depth 1, over half its rows.
        let pixel = (camera.vertical_fov_rad / 2.0).tan() / (parameters.height as f32 / 2.0);
        FrameBlock {
            eye: camera.eye.to_array(),
            hither_m: camera.near_m,
            forward: (-back).to_array(),
            yon_m: camera.far_m,
            ray_per_column: (right * pixel).to_array(),
            number: number as f32,
            ray_per_row: (-up * pixel).to_array(),
            shadow_threshold: parameters.shadow_threshold,
            to_column: (right / pixel).to_array(),
            early_end: parameters.early_end,
            to_row: (-up / pixel).to_array(),
            fragment_capacity: capacity.fragments,
            ambient: parameters.ambient.to_array(),
            section_capacity: capacity.sections,
            background: parameters.background.to_array(),
            table_size: parameters.table_size,
            size: [parameters.width, parameters.height],
            noise_seed: parameters.noise_seed(),
        }
    }
}

impl CountsBlock {
    /// Of a variant that makes that use of the scene's volumes.
    pub fn new(parameters: &Parameters, gas: GasUse, capacity: Capacity) -> Self {
        let [froxel_columns, froxel_rows, froxel_slices] = parameters.froxels;
        let [froxels_first_m, froxels_last_m] = parameters.gas_depths();
        CountsBlock {
            volumes: gas.volume_count as u32,
            lights: parameters.lights.len() as u32,
            octaves: parameters.octaves(),
            attenuations: gas.has_attenuations.into(),
            samples: parameters.samples,
            jitter: parameters.jitter as u32,
            nearest: parameters.lists.nearest().unwrap_or(0),
            chunks: capacity.chunks,
            cache: parameters.density_cache.unwrap_or(0),
            bricks: parameters.bricks,
            froxel_columns,
            froxel_rows,
            froxel_slices,
            froxels_first_m,
            froxels_last_m,
            glow: parameters.glows().into(),
            volume_scale: parameters.volume_scale,
        }
    }
}

impl VolumeBlock {
    /// A volume marched in `steps` increments of its longest side.
    pub fn of_volume(volume: &Volume, steps: u32) -> Self {
        let (shape, radii) = match volume.shape {
            Shape::Box => (0, [1.0; 2]),
            Shape::Sphere => (1, [1.0; 2]),
            Shape::Cylinder => (2, [1.0; 2]),
            Shape::Frustum { bottom, top } => (2, [bottom, top]),
        };
        VolumeBlock {
            center: volume.center.to_array(),
            shape,
            half_extent_m: volume.half_extent_m.to_array(),
            falloff: volume.falloff,
            albedo: volume.albedo.to_array(),
            tau_per_m: volume.tau_per_m,
            radii,
            is_solid: volume.is_solid.into(),
            step_m: volume.step_m(steps),
            phase_weights: volume.phase.map(|f| f.weight),
            phase_g: volume.phase.map(|f| f.g),
            ..Self::of_texture(&volume.texture)
        }
    }

    /// A solid texture alone, for a surface.
    pub fn of_texture(texture: &SolidTexture) -> Self {
        let block = VolumeBlock {
            // Stands for the size of the solid that a surface does not have.
            half_extent_m: [1.0; 3],
            texture_offset: texture.offset.to_array(),
            texture_scale_per_m: texture.scale_per_m,
            opaque: texture.opaque,
            power: texture.power,
            ..bytemuck::Zeroable::zeroed()
        };
        let swirled = |density_function: u32, swirl: Swirl| VolumeBlock {
            density_function,
            ellipse: swirl.ellipse,
            along_per_frame: swirl.along_per_frame,
            swirl_frames: swirl.frames,
            ..block
        };
        match texture.function {
            DensityFunction::Constant => VolumeBlock { density_function: 0, ..block },
            DensityFunction::Turbulence => VolumeBlock { density_function: 1, ..block },
            DensityFunction::Clouds { frequency } => VolumeBlock { density_function: 2, frequency, ..block },
            DensityFunction::Fog { swirl, front } => VolumeBlock {
                front_x_m: front.x_m,
                front_per_frame_m: front.per_frame_m,
                front_depth_m: front.depth_m,
                front_full_frames: front.full_frames,
                front_turbulence_m: front.turbulence_m,
                front_table_m: front.table_m,
                ..swirled(3, swirl)
            },
            DensityFunction::Steam { swirl } => swirled(4, swirl),
            // A shader of its own reads grids.
            DensityFunction::Grid(_) => block,
            DensityFunction::Hypertexture { amplitude, softness } => VolumeBlock {
                density_function: 5,
                hypertexture_amplitude: amplitude,
                hypertexture_softness: softness,
                ..block
            },
        }
    }
}

impl GridBlock {
    /// A grid whose samples stand from `first` on.
    pub fn new(grid: &Grid, first: u32) -> Self {
        let rows = grid.samples_per_metre().transpose();
        let [to_column, to_row, to_layer] = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.as_vec3().to_array());
        let [columns, rows, layers] = grid.size;
        let middle = grid.size.map(|count| (count - 1) as f32 / 2.0);
        GridBlock { to_column, columns, to_row, rows, to_layer, layers, middle, first }
    }
}

impl From<&Light> for LightBlock {
    fn from(light: &Light) -> Self {
        let (source, is_point, intensity) = match *light {
            Light::Parallel { direction, intensity } => (-direction.normalize_or(Vec3::NEG_Y), 0, intensity),
            Light::Point { position, intensity } => (position, 1, intensity),
        };
        LightBlock { source: source.to_array(), is_point, intensity: intensity.to_array(), _pad: 0.0 }
    }
}

impl ObjectBlock {
    /// At scene frame `number`; its solid textures are the next ones in the list of volumes.
    pub fn new(object: &Object, number: u32, textures: &mut impl Iterator<Item = usize>) -> Self {
        let mut entry = |is_there: bool| is_there.then(|| textures.next()).flatten().map_or(-1, |entry| entry as i32);
        let [solid_texture, veins] = [object.gas.is_some(), object.veins.is_some()].map(&mut entry);
        let (checker_color, checker_edge_m) = object.checker.map_or((Vec3::ZERO, 0.0), |c| (c.color, c.edge_m));
        ObjectBlock {
            color: object.color.to_array(),
            opacity: object.opacity,
            checker_color: checker_color.to_array(),
            checker_edge_m,
            offset_m: (object.per_frame_m * number as f32).to_array(),
            highlight_strength: object.highlight.strength,
            highlight_exponent: object.highlight.exponent,
            is_two_sided: object.is_two_sided.into(),
            solid_texture,
            fade_m: object.fade_m,
            ends_m: object.ends_m.to_array(),
            rim: object.rim,
            _pad: 0.0,
            vein_color: object.veins.map_or(Vec3::ZERO, |veins| veins.color).to_array(),
            veins,
        }
    }
}

impl VertexBlock {
    pub fn new(position: Vec3, normal: Vec3) -> Self {
        let (position, normal) = (position.to_array(), normal.to_array());
        VertexBlock { position, _after_position: 0.0, normal, _after_normal: 0.0 }
    }
}

/// The random table of the fog's front, each number in [0, 1).
pub fn offsets(seed: u64) -> [f32; OFFSET_SIZE] {
    let mut random = Random::with_stream(seed, 2);
    [(); OFFSET_SIZE].map(|()| random.unit())
}
