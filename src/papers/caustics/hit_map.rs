//! The variant `hit` (section 6.3): each triangle of the water once, where its light lands.

mod empty_sums;
mod intersect;
mod land;
mod straddle;

use std::sync::Arc;

use ash::vk;
use glam::DVec3;

use self::empty_sums::empty_sums;
use self::intersect::intersect;
use self::land::land;
use self::straddle::straddle;
use super::hidden_surfaces::HiddenSurfaces;
use super::intersections::Scope;
use super::position_pyramid::PositionPyramid;
use super::receiver::LitReceiver;
use super::resources::Context;
use super::water_surface::WaterSurface;
use crate::gpu::pass::PassBuilder;
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
        units: f32,
    }
}

host_block! {
    struct MapConstants {
        map_size: u32,
        layer: u32,
        units: f32,
    }
}

/// Floats of a landing: place in texels, height, weight.
pub const LANDING_FLOATS: u32 = 4;

/// Makes passes of one receiver under one light.
#[derive(Clone, Copy)]
pub struct HitPass<'a> {
    /// Rays and shadows of the light.
    pub scope: Scope<'a>,
    /// Heights of the receiver.
    pub pyramid: &'a PositionPyramid,
    /// Surfaces that the first hides.
    pub hidden: Option<&'a HiddenSurfaces>,
}

impl HitPass<'_> {
    /// Begins a pass over the rays or triangles of the refined water; `shader` goes before the names of its variants.
    pub fn over_rays(&self, name: &'static str, shader: &str) -> PassBuilder {
        let layers = if self.hidden.is_some() { "several" } else { "one" };
        let pass = Pass::compute(name, "6.3", &format!("{shader}-{layers}.comp"))
            .constants::<HitConstants>()
            .with("heights", &self.pyramid.heights)
            .with("pyramid", &self.pyramid.entries)
            .with("rays", &self.scope.volumes.rays);
        match self.hidden {
            None => pass,
            Some(hidden) => pass
                .with("hidden_positions", &hidden.positions)
                .offer("ceilings", &hidden.ceilings)
                .with("nearest", self.scope.context.nearest),
        }
    }

    /// The same for a pass that asks for what other receivers shadow, where they do.
    pub fn shadowed(&self, name: &'static str, shader: &str) -> PassBuilder {
        let Some(shadows) = self.scope.shadows else { return self.over_rays(name, &format!("{shader}-off")) };
        let pass = self.over_rays(name, &format!("{shader}-on")).with("shadow_map", &shadows.map);
        if self.hidden.is_some() { pass } else { pass.with("nearest", self.scope.context.nearest) }
    }
}

/// The rays' landings, one for each vertex of the refined water.
pub struct Landings {
    /// [`LANDING_FLOATS`] each.
    pub places: Arc<Buffer>,
    /// I_c where each lands.
    pub intensities: Arc<Buffer>,
}

/// Light added up on the map's texels.
pub struct Sums {
    /// Two words a texel, surface below surface.
    pub light: Arc<Buffer>,
    /// Number of the triangles that do not land whole, and a list of them.
    pub straddling: Arc<Buffer>,
    /// uint\[3\]: invocations of `intersect`, `land` and `straddle` that left loops early; of the first 1 for any.
    pub unfinished: Arc<Buffer>,
}

impl Sums {
    /// The pass over triangles of the water, adding to the sums.
    pub fn of_triangles(&self, pass: PassBuilder, water: &WaterSurface) -> PassBuilder {
        pass.with("sums", &self.light)
            .with("indices", &water.indices)
            .with("straddling", &self.straddling)
            .with("unfinished", &self.unfinished)
    }
}

/// Passes of one receiver under one light.
pub struct HitMap {
    position_pyramid: PositionPyramid,
    empty_sums: Pass,
    intersect: Pass,
    land: Pass,
    straddle: Pass,
    /// One for each surface.
    caustics_maps: Vec<Pass>,
    constants: HitConstants,
    unfinished: Arc<Buffer>,
    /// Landing points of the rays of the water's vertices.
    pub landings: Arc<Buffer>,
}

impl HitMap {
    /// Draws to `map`, by the heights of `position_map`, and to the maps of hidden surfaces by theirs.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn new(
        scope: Scope<'_>,
        lit: &LitReceiver,
        [position_map, map]: [&Arc<ImageView>; 2],
        hidden: Option<&HiddenSurfaces>,
    ) -> Result<Self, Error> {
        let Scope { context, water, .. } = scope;
        let shaders = context.shaders;
        let (triangles, vertices) = (u64::from(water.grid.triangle_count()), u64::from(water.grid.vertex_count()));
        let words = u64::from(sum_words(context, 1 + hidden.map_or(0, HiddenSurfaces::count))?);
        let buffer = |name: &str, words: u64, by: &'static str| {
            let desc = BufferDesc::new(context.name(name), 4 * words).usage(vk::BufferUsageFlags::STORAGE_BUFFER);
            Buffer::new(context.device(), desc).map_err(|error| error.set_by(by))
        };
        let position_pyramid = PositionPyramid::new(context, position_map)?;
        let light = buffer("landed-light", words, "map-size")?;
        let landings = Landings {
            places: buffer("landings", u64::from(LANDING_FLOATS) * vertices, "water-triangles")?,
            intensities: buffer("landed-intensities", vertices, "water-triangles")?,
        };
        let sums = Sums {
            light,
            straddling: buffer("straddling", 1 + 3 * triangles, "water-triangles")?,
            unfinished: upload(
                context.device(),
                &context.name("unfinished"),
                vk::BufferUsageFlags::STORAGE_BUFFER,
                bytemuck::bytes_of(&[0_u32; 3]),
            )?,
        };
        let hit = HitPass { scope, pyramid: &position_pyramid, hidden };
        let mut surfaces = vec![(position_map.clone(), map.clone())];
        if let Some(hidden) = hidden {
            for layer in 0..hidden.count() {
                surfaces.push((hidden.positions.image().layer(layer)?, hidden.caustics.image().layer(layer)?));
            }
        }
        let caustics_map = |(position_map, map): &(Arc<ImageView>, Arc<ImageView>)| {
            Pass::graphics("caustics-map", "6.3", "common/fullscreen.vert", "caustics/hit-map.frag")
                .constants::<MapConstants>()
                .with("sums", &sums.light)
                .with("position_map", position_map)
                .with("nearest", context.nearest)
                .color(map, Load::Discard, Blend::Replace)
                .build(shaders)
        };
        Ok(HitMap {
            empty_sums: empty_sums(shaders, &sums.light, &sums.straddling)?,
            intersect: intersect(hit, &landings, &sums.unfinished)?,
            land: land(hit, &landings, &sums)?,
            straddle: straddle(hit, &sums)?,
            caustics_maps: surfaces.iter().map(caustics_map).collect::<Result<_, _>>()?,
            constants: constants(scope, lit, position_pyramid.level_count()),
            position_pyramid,
            unfinished: sums.unfinished,
            landings: landings.places,
        })
    }

    /// Fails where light of a frame since the last check is missing, since loops were left before their end.
    ///
    /// # Errors
    /// [`Error::Pass`] for such a loop; errors of the Vulkan layer.
    pub fn check(&self, device: &Arc<Device>) -> Result<(), Error> {
        let invocations: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(device, &self.unfinished)?);
        let Some((pass, count)) =
            ["intersect", "land", "straddle"].into_iter().zip(invocations).find(|&(_, count)| count > 0)
        else {
            return Ok(());
        };
        update(&self.unfinished, bytemuck::bytes_of(&[0_u32; 3]))?;
        let (left, remedy) = match pass {
            "intersect" => ("rays did not end".to_owned(), "a smaller `map-size`, fewer `layers`"),
            _ => (format!("{count} invocations left light out"), "more `water-triangles`, a smaller `map-size`"),
        };
        let problem = format!(
            "{left}: drivers leave a shader's loops early, as after 65,535 iterations together; \
             take {remedy} or variant culled"
        );
        Err(Error::Pass { pass: pass.into(), problem })
    }

    /// Finds where the light lands and adds it up; it has passed water of that absorption.
    ///
    /// # Errors
    /// Errors of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, absorption_per_m: f32) -> Result<(), Error> {
        let constants = HitConstants { absorption_per_m, ..self.constants };
        let HitConstants { map_size, triangles, vertices, units, .. } = constants;
        self.position_pyramid.record(frame)?;
        empty_sums::record(&self.empty_sums, frame, map_size, self.caustics_maps.len() as u32)?;
        let sharing = straddle::threads(triangles);
        // Two triangles a cell, which are landed together.
        for (pass, threads) in [(&self.intersect, vertices), (&self.land, triangles / 2), (&self.straddle, sharing)] {
            frame.compute(pass, |dispatch| dispatch.constants(&constants).elements(threads))?;
        }
        (0..).zip(&self.caustics_maps).try_for_each(|(layer, pass)| {
            frame.graphics(pass, |draw| {
                draw.constants(&MapConstants { map_size, layer, units }).vertices(3);
            })
        })
    }
}

/// Two words a texel of each surface, of an even number of texels, which 32 bits must count.
fn sum_words(context: Context<'_>, surfaces: u32) -> Result<u32, Error> {
    let pairs = (u64::from(context.parameters.map_size).pow(2) * u64::from(surfaces)).div_ceil(2);
    let (wanted, limit) = (4 * pairs, u64::from(u32::MAX));
    u32::try_from(wanted).map_err(|_| {
        let object = context.name("landed-light");
        Error::Limit { object, what: "words of light", wanted, limit }.set_by("map-size")
    })
}

/// Units of light that is added up, to an I_c of 1: more where cells of the water are so small beside a texel, of which they
/// cover `cell_texels`, that the light of one would be rounded too coarsely.
fn units(cell_texels: f64) -> f64 {
    (10.0 - cell_texels.log2()).ceil().clamp(18.0, 56.0).exp2()
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
        units: units(water.grid.cell.element_product() * (texels / extent.x) * (texels / extent.z)) as f32,
        ..bytemuck::Zeroable::zeroed()
    };
    if let Some(shadow) = shadows {
        [constants.shadow_center, constants.shadow_texels_per_m, [constants.shadow_middle, constants.shadow_top]] =
            shadow.place(volumes.reference);
    }
    constants
}
