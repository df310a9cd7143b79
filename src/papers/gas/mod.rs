//! `gas`: D. S. Ebert's and R. E. Parent's gaseous phenomena, volume rendering in a scanline A-buffer, 1990.
//!
//! ```text
//! fragments ─► sort ─┬──────────────────────────────► volume ─► light-attenuation ─► resolve (─► view)
//!                    │                                  ▲               ▲
//!                    └─ (table) density-table ─► shadow-table ──────────┘
//!                                                      └─ (froxel) froxel-inject ─► froxel-integrate ─► volume
//! ```
//!
//! A picture whose lists no buffer of the device holds is done in bands of rows, one after the other.

mod a_buffer;
mod alternatives;
mod axes;
mod band;
mod blocks;
mod blue_noise;
mod bricks;
mod capacity;
mod context;
mod densities;
mod density_cache;
mod density_table;
mod empty_lists;
mod estimate;
pub mod experiments;
mod fragments;
mod froxel_inject;
mod froxel_integrate;
pub mod grid;
mod grid_buffers;
#[cfg(test)]
mod layouts;
mod light_attenuation;
pub mod model;
pub mod parameters;
mod pieces;
mod progress;
pub mod reference;
mod resolve;
mod scene_buffers;
pub mod scenes;
pub mod setup;
mod shadow_table;
mod sort;
mod tiles;
mod view;
mod volume;

use std::ops::Range;
use std::sync::Arc;

use self::a_buffer::ABuffer;
use self::band::Band;
use self::blocks::GasUse;
use self::capacity::BufferLimit;
use self::context::Context;
use self::densities::Densities;
use self::density_table::DensityTable;
use self::empty_lists::EmptyLists;
use self::fragments::Fragments;
use self::froxel_inject::FroxelInject;
use self::froxel_integrate::FroxelIntegrate;
use self::light_attenuation::LightAttenuation;
use self::model::Object;
use self::progress::{Calls, Carried};
use self::resolve::Resolve;
use self::scene_buffers::SceneBuffers;
use self::shadow_table::ShadowTable;
use self::sort::Sort;
use self::tiles::Tiles;
use self::view::View;
use self::volume::VolumeMarch;
use crate::gpu::{Error, Feature, Frame, ImageView, ShaderLibrary};
use crate::measure::{Paper, Target};
use crate::scene::Camera;

pub use self::a_buffer::Fragment;
pub use self::capacity::Capacity;
pub use self::parameters::{Lists, March, Parameters, Variant};

/// Features that a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 1] = [Feature::FragmentStores];

/// Parameters that each frame writes into its blocks.
pub const WRITTEN: [&str; 7] =
    ["ambient", "camera", "early-end", "first-frame", "frame-step", "pixel-size", "shadow-threshold"];

/// The paper under one variant.
pub struct Gas {
    label: String,
    variant: Variant,
    parameters: Parameters,
    scene: SceneBuffers,
    passes: Passes,
    /// Those of the picture that are drawn.
    rows: Range<u32>,
    calls: Calls,
    /// Dispatches of `fragments` by tiles.
    tile_calls: u32,
    /// Pixels that a k-buffer shows less of than there is, in the frame that has the most of them.
    lost_pixels: u32,
    buffer_limit: BufferLimit,
    lacks_geometry_stage: bool,
}

/// The passes, and the lists whose capacity all their resources follow.
struct Passes {
    lists: ABuffer,
    empty_lists: EmptyLists,
    surfaces: Surfaces,
    sort: Sort,
    densities: Option<Densities>,
    density_table: Option<DensityTable>,
    shadow_table: Option<ShadowTable>,
    froxels: Option<(FroxelInject, FroxelIntegrate)>,
    volume: Option<VolumeMarch>,
    light_attenuation: Option<LightAttenuation>,
    resolve: Resolve,
    view: View,
}

/// The way to the lists of fragments.
enum Surfaces {
    Linked(Fragments),
    Tiles(Tiles),
}

impl Passes {
    fn new(context: &Context<'_>, scene: &SceneBuffers, variant: Variant, capacity: Capacity) -> Result<Self, Error> {
        let has_volume = variant != Variant::NoVolume && !context.parameters.volumes.is_empty();
        let has_tables = has_volume && variant.has_table();
        let shadows_surfaces = has_volume && variant != Variant::None;

        let lists = ABuffer::new(context, capacity)?;
        let empty_lists = EmptyLists::new(context, scene, &lists)?;
        let surfaces = match context.parameters.lists {
            Lists::Linked => Surfaces::Linked(Fragments::new(context, scene, &lists)?),
            Lists::Tiles | Lists::Nearest(_) => Surfaces::Tiles(Tiles::new(context, scene, &lists)?),
        };
        let sort = Sort::new(context, scene, &lists, if has_volume { context.parameters.volumes.len() } else { 0 })?;
        let densities = has_volume.then(|| Densities::new(context, scene, variant)).transpose()?;
        let density_table = densities
            .as_ref()
            .filter(|_| has_tables)
            .map(|densities| DensityTable::new(context, scene, densities))
            .transpose()?;
        let table = density_table.as_ref().map(|table| &table.densities);
        let shadow_table = table.map(|table| ShadowTable::new(context, scene, table)).transpose()?;
        let shadow_sums = shadow_table.as_ref().map(|table| &table.sums);
        let froxels = densities
            .as_ref()
            .zip(shadow_sums)
            .filter(|_| variant == Variant::Froxel)
            .map(|(densities, sums)| {
                let inject = FroxelInject::new(context, scene, &lists, densities, sums)?;
                let integrate = FroxelIntegrate::new(context, scene, &inject.light)?;
                Ok::<_, Error>((inject, integrate))
            })
            .transpose()?;
        let volume = match (&froxels, &densities) {
            (Some((_, integrate)), _) => Some(VolumeMarch::of_froxels(context, scene, &lists, &integrate.sums)?),
            (None, Some(densities)) => Some(VolumeMarch::new(context, scene, &lists, variant, densities, shadow_sums)?),
            (None, None) => None,
        };
        let sections = volume.as_ref().map(|volume| &volume.sections);
        let light_attenuation = densities
            .as_ref()
            .zip(sections)
            .filter(|_| shadows_surfaces)
            .map(|(densities, sections)| {
                LightAttenuation::new(context, scene, &lists, sections, densities, shadow_sums)
            })
            .transpose()?;
        let attenuations = light_attenuation.as_ref().map(|pass| &pass.attenuations);
        let resolve = Resolve::new(context, scene, &lists, sections, attenuations)?;
        let view = View::new(context, &resolve.radiance)?;
        Ok(Passes {
            lists,
            empty_lists,
            surfaces,
            sort,
            densities,
            density_table,
            shadow_table,
            froxels,
            volume,
            light_attenuation,
            resolve,
            view,
        })
    }
}

impl Gas {
    /// Makes every resource and pass; `label` goes before the names of the resources. The lists begin with slots for
    /// four fragments and two sections a pixel, of as many rows as the device's buffers hold, or with those of
    /// `capacity`.
    ///
    /// # Errors
    /// Those of the Vulkan layer. The caller has validated `parameters` and `objects`.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        objects: &[Object],
        capacity: Option<Capacity>,
    ) -> Result<Self, Error> {
        let buffer_limit = BufferLimit::new(shaders.device(), parameters);
        let triangles = objects.iter().map(|object| object.mesh.triangle_count()).sum();
        let capacity = capacity.unwrap_or_else(|| Capacity::initial(parameters, triangles, buffer_limit));
        let context = Context { shaders, label, parameters };
        let scene = SceneBuffers::new(&context, objects)?;
        let passes = Passes::new(&context, &scene, variant, capacity)?;
        let (label, parameters) = (label.to_owned(), parameters.clone());
        let lacks_geometry_stage = parameters.lists == Lists::Linked
            && parameters.geometry_stage
            && !shaders.device().physical().has(Feature::GeometryShader);
        let (rows, calls) = (0..parameters.height, Calls::ONCE);
        Ok(Gas {
            label,
            variant,
            parameters,
            scene,
            passes,
            rows,
            calls,
            tile_calls: 1,
            lost_pixels: 0,
            buffer_limit,
            lacks_geometry_stage,
        })
    }

    /// Sets the numbers of [`WRITTEN`] of the next frames; all others are those that it was made with. The caller has
    /// validated them.
    pub fn set_written(&mut self, parameters: &Parameters) {
        self.parameters = parameters.clone();
    }

    /// The rows that are done at once, and the most fragments and sections that they have wanted in a frame so far.
    ///
    /// # Errors
    /// Those of Vulkan.
    pub fn demand(&self, shaders: &ShaderLibrary) -> Result<Capacity, Error> {
        self.passes.lists.demand(shaders)
    }

    /// Fragments that the lists of the last frame hold, in all its bands. Linked lists fill every slot that they want;
    /// the others reserve more slots than they fill, and the lists themselves are counted: nothing is known of them where
    /// a band has replaced those of another.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn kept_fragments(&self, shaders: &ShaderLibrary) -> Result<Option<u64>, Error> {
        match self.parameters.lists {
            Lists::Linked => Ok(Some(self.passes.lists.wanted_fragments(shaders)?)),
            Lists::Tiles | Lists::Nearest(_) if !self.is_one_band() => Ok(None),
            Lists::Tiles | Lists::Nearest(_) => {
                Ok(Some(self.fragments(shaders)?.iter().map(|list| list.len() as u64).sum()))
            }
        }
    }

    /// The sorted fragments of each pixel of the last frame, without the sections; of its last band, if there are
    /// several.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn fragments(&self, shaders: &ShaderLibrary) -> Result<Vec<Vec<Fragment>>, Error> {
        self.passes.lists.read(shaders, self.passes.volume.as_ref().map(|volume| &volume.sections))
    }

    /// The numbers of the triangles that touch each tile of 8 x 8 pixels, row by row, in the last frame; nothing without
    /// tiles.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn tiles(&self, shaders: &ShaderLibrary) -> Result<Vec<Vec<u32>>, Error> {
        match &self.passes.surfaces {
            Surfaces::Linked(_) => Ok(Vec::new()),
            Surfaces::Tiles(tiles) => tiles.read(shaders),
        }
    }

    /// Pixels that lack fragments which linked lists may show, in the frame that has the most of them; of complete frames
    /// before the last [`Gas::settle`], nothing without a k-buffer.
    #[must_use]
    pub fn lost_pixels(&self) -> Option<u32> {
        self.parameters.lists.nearest().map(|_| self.lost_pixels)
    }

    /// Evaluations of the density along the viewer's rays in the last frame; nothing is known of them where a band has
    /// replaced those of another.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn evaluations(&self, shaders: &ShaderLibrary) -> Result<Option<u64>, Error> {
        let pixel_count = self.parameters.width as usize * self.rows.len();
        self.is_one_band().then(|| self.passes.lists.evaluations(shaders, pixel_count)).transpose()
    }

    /// The lists hold all rows that are drawn.
    fn is_one_band(&self) -> bool {
        self.rows.len() <= self.passes.lists.capacity.rows as usize
    }
}

impl Paper for Gas {
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let (passes, capacity) = (&self.passes, self.passes.lists.capacity);
        let gas = GasUse {
            volume_count: if passes.volume.is_some() { self.parameters.volumes.len() } else { 0 },
            has_attenuations: passes.light_attenuation.is_some(),
        };
        self.scene.write(&self.parameters, self.parameters.scene_frame(number), gas, capacity)?;
        for band in Band::all(self.parameters.width, &self.rows, capacity.rows) {
            passes.empty_lists.record(frame, band)?;
            match &passes.surfaces {
                Surfaces::Linked(fragments) => fragments.record(frame, band)?,
                Surfaces::Tiles(tiles) => tiles.record(frame, band, self.tile_calls)?,
            }
            passes.sort.record(frame, band, self.calls.of(Carried::Sort))?;
            // All bands look up the same tables.
            if let (Some(densities), true) = (&passes.densities, band.is_first()) {
                densities.record(frame)?;
            }
            if let (Some(densities), Some(shadows), true) =
                (&passes.density_table, &passes.shadow_table, band.is_first())
            {
                densities.record(frame)?;
                shadows.record(frame)?;
            }
            if let (Some((inject, integrate)), true) = (&passes.froxels, band.is_first()) {
                inject.record(frame)?;
                integrate.record(frame)?;
            }
            if let Some(volume) = &passes.volume {
                volume.record(frame, band, self.calls.of(Carried::Volume))?;
            }
            if let Some(light_attenuation) = &passes.light_attenuation {
                light_attenuation.record(frame, band, self.calls.of(Carried::LightAttenuation))?;
            }
            passes.resolve.record(frame, band, self.calls.of(Carried::Resolve))?;
        }
        Ok(())
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        self.passes.view.record(frame)
    }

    fn keep_rows(&mut self, rows: Range<u32>) {
        self.rows = rows;
    }

    fn settle(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        let lists = &self.passes.lists;
        let tile_calls = tiles::calls(lists.most_of_tile(shaders)?, self.scene.has_surface_gas())?;
        let capacity = lists.capacity.grown(lists.demand(shaders)?, self.buffer_limit)?;
        if capacity.is_none() && tile_calls <= self.tile_calls {
            self.lost_pixels = lists.lost_pixels(shaders)?;
            let raised = self.calls.raised(shaders, &lists.progress)?;
            self.calls = raised.unwrap_or(self.calls);
            return Ok(raised.is_none());
        }
        // Counts of frames with gaps are forgotten.
        self.tile_calls = self.tile_calls.max(tile_calls);
        let capacity = capacity.unwrap_or(lists.capacity);
        let context = Context { shaders, label: &self.label, parameters: &self.parameters };
        self.passes = Passes::new(&context, &self.scene, self.variant, capacity)?;
        Ok(false)
    }

    /// The device has no geometry stage; a k-buffer was too small.
    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.lacks_geometry_stage {
            warnings.push(
                "the device has no geometry stage: `fragments` makes each triangle's footprint six times in its vertex \
                 stage, so that its time is not that of the other devices' method"
                    .to_owned(),
            );
        }
        if let (Some(nearest), Some(lost @ 1..)) = (self.parameters.lists.nearest(), self.lost_pixels()) {
            let pixels = u64::from(self.parameters.width) * u64::from(self.parameters.height);
            warnings.push(format!(
                "`lists` k:{nearest}: {lost} of {pixels} pixels lose fragments that may show, behind their {nearest} \
                 nearest"
            ));
        }
        warnings
    }

    fn camera(&self) -> Option<Camera> {
        Some(self.parameters.camera)
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.passes.view.picture
    }

    fn targets(&self) -> Vec<Target> {
        let Passes {
            densities, density_table, shadow_table, froxels, volume, light_attenuation, resolve, view, ..
        } = &self.passes;
        let cache = densities.as_ref().and_then(|densities| densities.cache.as_ref());
        let bricks = densities.as_ref().and_then(|densities| densities.bricks.as_ref());
        let lights = self.parameters.lights.len() as u32;
        let buffers = [
            cache.map(|pass| Target::table("density-cache", &pass.densities, 4).of("densities before they fade, a table of each volume, x fastest: an entry, and those after it in x, in y, in both")),
            bricks.map(|pass| Target::table("bricks", &pass.bounds, pass.size).of("greatest density of a brick, 0 where it is skipped, a table of each volume, x fastest")),
            density_table.as_ref().map(|pass| Target::table("density-table", &pass.densities, 2).of("density, a table of each volume, x fastest: an entry, and the one after it in x")),
            shadow_table.as_ref().map(|pass| Target::table("shadow-table", &pass.sums, 2).of("density times metres towards the light, a table of each volume and light, x fastest: an entry, and the one after it in x")),
            volume.as_ref().map(|pass| Target::table("sections", &pass.sections, 8)
                .of("a section: near and far in metres, increments, the next one, light in red, green, blue, transparency")),
            light_attenuation.as_ref().map(|pass| Target::table("light-attenuations", &pass.attenuations, lights).of("share of each light that the gas takes, 0 to 1")),
        ];
        let of_froxels = froxels.iter().flat_map(|(inject, integrate)| {
            [
                Target::image("froxel-light", &inject.light)
                    .of("light that a froxel's gas sends to the eye a metre, red, green, blue, linear, and its extinction a metre"),
                Target::image("froxel-sums", &integrate.sums)
                    .of("light of all gas before a froxel's far border, red, green, blue, linear, and its transparency"),
            ]
        });
        let images = [
            Target::image("radiance", &resolve.radiance)
                .of("light in red, green, blue, linear, and the opacity, 0 to 1"),
            Target::image("picture", &view.picture).of("red, green, blue, alpha as sRGB encodes them, 0 to 255"),
        ];
        buffers.into_iter().flatten().chain(of_froxels).chain(images).collect()
    }
}
