//! The variant `hit` (section 6.3): each triangle of the water once, where its light lands.

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use super::intersections::Scope;
use super::position_pyramid::PositionPyramid;
use super::receiver::LitReceiver;
use super::resources::Context;
use super::shadow_map::ShadowMap;
use crate::gpu::transfer::{read_buffer, update, upload};
use crate::gpu::{Blend, Buffer, BufferDesc, Device, Error, Frame, ImageView, Load, Pass};
use crate::host_block;

host_block! {
    struct HitConstants {
        center: [f32; 2],
        texels_per_m: [f32; 2],
        middle: f32,
        half_height: f32,
        texel_area_m2: f32,
        absorption_per_m: f32,
        map_size: u32,
        levels: u32,
        triangles: u32,
        vertices: u32,
        up: [f32; 3],
        receiver: f32,
        shadow_center: [f32; 2],
        shadow_texels_per_m: [f32; 2],
        shadow_middle: f32,
        shadow_top: f32,
        columns: u32,
    }
}

host_block! {
    struct EmptyConstants {
        pairs: u32,
        threads: u32,
    }
}

host_block! {
    struct MapConstants {
        map_size: u32,
    }
}

/// Invocations that empty the sums, at the most: fewer workgroups than any device allows.
const EMPTYING: u32 = 1 << 18;
/// Invocations that share the texels of a straddling triangle.
const SHARING: u32 = 8;
/// Triangles that they take one after the other, at the most.
const IN_TURN: u32 = 16;

/// Floats of a landing: place in texels, height, weight.
pub const LANDING_FLOATS: u32 = 4;

/// Passes of one receiver under one light.
pub struct HitMap {
    position_pyramid: PositionPyramid,
    empty_sums: Pass,
    intersect: Pass,
    land: Pass,
    straddle: Pass,
    caustics_map: Pass,
    constants: HitConstants,
    /// uint\[2\]: invocations of `land` and of `straddle` whose loops the driver left early.
    unfinished: Arc<Buffer>,
    /// Landing points of the rays of the water's vertices.
    pub landings: Arc<Buffer>,
}

impl HitMap {
    /// Draws to `map`, by the heights of `position_map`.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        scope: Scope<'_>,
        lit: &LitReceiver,
        position_map: &Arc<ImageView>,
        map: &Arc<ImageView>,
    ) -> Result<Self, Error> {
        let Scope { context, volumes, water, shadows, .. } = scope;
        let shaders = context.shaders;
        let (triangles, vertices) = (water.grid.triangle_count(), water.grid.vertex_count());
        let words = sum_words(context)?;
        let buffer = |name: &str, bytes: u64, by: &'static str| {
            let desc = BufferDesc::new(context.name(name), bytes).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
            Buffer::new(context.device(), desc).map_err(|error| error.set_by(by))
        };
        let position_pyramid = PositionPyramid::new(context, position_map)?;
        let sums = buffer("landed-light", 4 * u64::from(words), "map-size")?;
        let bytes = 4 * u64::from(LANDING_FLOATS) * u64::from(vertices);
        let landings = buffer("landings", bytes, "water-triangles")?;
        let intensities = buffer("landed-intensities", 4 * u64::from(vertices), "water-triangles")?;
        let straddling = buffer("straddling", 4 * (1 + 3 * u64::from(triangles)), "water-triangles")?;

        let unfinished = upload(
            context.device(),
            &context.name("unfinished"),
            vk::BufferUsageFlags::STORAGE_BUFFER,
            bytemuck::bytes_of(&[0_u32; 2]),
        )?;

        let kernel = |name, shader: &str| {
            Pass::compute(name, "6.3", shader)
                .constants::<HitConstants>()
                .with("heights", &position_pyramid.heights)
                .with("pyramid", &position_pyramid.entries)
                .with("rays", &volumes.rays)
        };
        let (intersect, straddle) = match shadows {
            None => ("caustics/intersect-off.comp", "caustics/straddle-off.comp"),
            Some(_) => ("caustics/intersect-on.comp", "caustics/straddle-on.comp"),
        };
        let mut intersect =
            kernel("intersect", intersect).with("landings", &landings).with("intensities", &intensities);
        let mut straddle = kernel("straddle", straddle)
            .with("sums", &sums)
            .with("indices", &water.indices)
            .with("straddling", &straddling)
            .with("unfinished", &unfinished);
        if let Some(shadows) = shadows {
            intersect = intersect.with("shadow_map", &shadows.map).with("nearest", context.nearest);
            straddle = straddle.with("shadow_map", &shadows.map).with("nearest", context.nearest);
        }
        Ok(HitMap {
            empty_sums: Pass::compute("empty-sums", "6.3", "caustics/empty-sums.comp")
                .constants::<EmptyConstants>()
                .with("sums", &sums)
                .with("straddling", &straddling)
                .build(shaders)?,
            intersect: intersect.build(shaders)?,
            land: kernel("land", "caustics/land.comp")
                .with("sums", &sums)
                .with("indices", &water.indices)
                .with("straddling", &straddling)
                .with("landings", &landings)
                .with("intensities", &intensities)
                .with("unfinished", &unfinished)
                .build(shaders)?,
            straddle: straddle.build(shaders)?,
            caustics_map: Pass::graphics("caustics-map", "6.3", "common/fullscreen.vert", "caustics/hit-map.frag")
                .constants::<MapConstants>()
                .with("sums", &sums)
                .with("position_map", position_map)
                .with("nearest", context.nearest)
                .color(map, Load::Discard, Blend::Replace)
                .build(shaders)?,
            constants: constants(scope, lit, position_pyramid.level_count()),
            position_pyramid,
            unfinished,
            landings,
        })
    }

    /// Fails where light of a frame since the last check is missing, since the driver left loops before their end.
    ///
    /// # Errors
    /// [`Error::Pass`] for such a loop; errors of the Vulkan layer.
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        let invocations: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(device, &self.unfinished)?);
        let Some((pass, count)) = ["land", "straddle"].into_iter().zip(invocations).find(|&(_, count)| count > 0)
        else {
            return Ok(());
        };
        update(&self.unfinished, bytemuck::bytes_of(&[0_u32; 2]))?;
        let problem = format!(
            "{} invocations left light out: this driver leaves a shader's loops early, as after 65,535 iterations together; \
             take more `water-triangles`, a smaller `map-size` or variant culled",
            count
        );
        Err(Error::Pass { pass: pass.into(), problem })
    }

    /// Finds where the light lands and adds it up; it has passed water of that absorption.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, absorption_per_m: f32) -> Result<(), Error> {
        let constants = HitConstants { absorption_per_m, ..self.constants };
        let HitConstants { map_size, triangles, vertices, .. } = constants;
        // Four words together.
        let pairs = (map_size * map_size).div_ceil(2);
        self.position_pyramid.record(frame)?;
        frame.compute(&self.empty_sums, |dispatch| {
            let threads = pairs.min(EMPTYING);
            dispatch.constants(&EmptyConstants { pairs, threads }).threads(threads, 1, 1);
        })?;
        let sharing = triangles.div_ceil(IN_TURN) * SHARING;
        // Two triangles a cell, which are landed together.
        for (pass, threads) in [(&self.intersect, vertices), (&self.land, triangles / 2), (&self.straddle, sharing)] {
            frame.compute(pass, |dispatch| {
                dispatch.constants(&constants).elements(threads);
            })?;
        }
        frame.graphics(&self.caustics_map, |draw| {
            draw.constants(&MapConstants { map_size }).vertices(3);
        })
    }
}

/// Two words a texel, of an even number of texels, which 32 bits must count.
fn sum_words(context: Context<'_>) -> Result<u32, Error> {
    let pairs = u64::from(context.parameters.map_size).pow(2).div_ceil(2);
    let (wanted, limit) = (4 * pairs, u64::from(u32::MAX));
    u32::try_from(wanted).map_err(|_| {
        let object = context.name("landed-light");
        Error::Limit { object, what: "words of light", wanted, limit }.set_by("map-size")
    })
}

fn constants(
    Scope { context, volumes, water, shadows, .. }: Scope<'_>,
    lit: &LitReceiver,
    levels: u32,
) -> HitConstants {
    let offset = lit.aligned.center - volumes.reference;
    let extent = lit.aligned.extent;
    let texels = f64::from(context.parameters.map_size);
    let mut constants = HitConstants {
        center: [offset.x as f32, offset.z as f32],
        texels_per_m: [(texels / extent.x) as f32, (texels / extent.z) as f32],
        middle: offset.y as f32,
        half_height: (extent.y / 2.0) as f32,
        texel_area_m2: (extent.x * extent.z / texels.powi(2)) as f32,
        absorption_per_m: lit.absorption_per_m,
        map_size: context.parameters.map_size,
        levels,
        triangles: water.grid.triangle_count(),
        vertices: water.grid.vertex_count(),
        up: volumes.axes.along(DVec3::Y).as_vec3().to_array(),
        receiver: lit.index as f32,
        columns: water.grid.columns + 1,
        ..bytemuck::Zeroable::zeroed()
    };
    if let Some(ShadowMap { bounds, map, .. }) = shadows {
        let offset = bounds.center - volumes.reference;
        let texels = f64::from(map.width());
        constants.shadow_center = [offset.x as f32, offset.z as f32];
        constants.shadow_texels_per_m = [(texels / bounds.extent.x) as f32, (texels / bounds.extent.z) as f32];
        constants.shadow_middle = offset.y as f32;
        constants.shadow_top = (offset.y + bounds.extent.y / 2.0) as f32;
    }
    constants
}
