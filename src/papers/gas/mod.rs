//! `gas`: D. S. Ebert's and R. E. Parent's gaseous phenomena, volume rendering in a scanline A-buffer, 1990.
//!
//! ```text
//! fragments ─► sort ─┬──────────────────────────────► volume ─► light-attenuation ─► resolve (─► view)
//!                    │                                  ▲               ▲
//!                    └─ (table) density-table ─► shadow-table ──────────┘
//! ```
//!
//! A picture whose lists no buffer of the device holds is done in bands of rows, one after the other.

mod blocks;
mod capacity;
pub mod experiments;
mod geometry;
#[cfg(test)]
mod layouts;
mod lists;
mod march;
pub mod model;
pub mod parameters;
pub mod reference;
mod resolve;
pub mod scenes;
pub mod setup;
mod tables;

use std::sync::Arc;

use self::blocks::Gases;
use self::capacity::{Band, Most};
use self::geometry::Geometry;
use self::lists::Lists;
use self::march::March;
use self::model::Object;
use self::resolve::Resolve;
use crate::gpu::{Error, Feature, Frame, ImageView, ShaderLibrary};
use crate::measure::{Paper, Target};

pub use self::capacity::Capacity;
pub use self::lists::Fragment;
pub use self::parameters::{Parameters, Variant};

/// What a device must have for this paper, beyond the baseline of the Vulkan layer.
pub const NEEDS: [Feature; 1] = [Feature::FragmentStores];

/// The paper under one variant.
pub struct Gas {
    label: String,
    variant: Variant,
    parameters: Parameters,
    geometry: Geometry,
    passes: Passes,
    most: Most,
    lacks_geometry_stage: bool,
}

/// Everything whose size follows the lists'.
struct Passes {
    lists: Lists,
    march: Option<March>,
    resolve: Resolve,
}

impl Passes {
    fn new(
        shaders: &ShaderLibrary,
        label: &str,
        geometry: &Geometry,
        variant: Variant,
        parameters: &Parameters,
        capacity: Capacity,
    ) -> Result<Self, Error> {
        let lists = Lists::new(shaders, label, geometry, parameters, capacity)?;
        let march = if variant == Variant::NoVolume || parameters.volumes.is_empty() {
            None
        } else {
            Some(March::new(shaders, label, geometry, &lists, variant, parameters)?)
        };
        let resolve = Resolve::new(shaders, label, geometry, &lists, march.as_ref(), parameters)?;
        Ok(Passes { lists, march, resolve })
    }
}

impl Gas {
    /// Makes every resource and pass; `label` goes before the names of the resources. The lists begin with room for four
    /// fragments and two sections a pixel, of as many rows as the device's buffers hold, or for what `capacity` says.
    ///
    /// # Errors
    /// What the Vulkan layer answers. The caller has validated `parameters` and `objects`.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        variant: Variant,
        parameters: &Parameters,
        objects: &[Object],
        capacity: Option<Capacity>,
    ) -> Result<Self, Error> {
        let most = Most::of(shaders.device(), parameters);
        let capacity = capacity.unwrap_or_else(|| Capacity::usual(parameters, most));
        let geometry = Geometry::new(shaders, label, parameters, objects)?;
        let passes = Passes::new(shaders, label, &geometry, variant, parameters, capacity)?;
        let (label, parameters) = (label.to_owned(), parameters.clone());
        let lacks_geometry_stage =
            parameters.geometry_stage && !shaders.device().physical().has(Feature::GeometryShader);
        Ok(Gas { label, variant, parameters, geometry, passes, most, lacks_geometry_stage })
    }

    /// The rows that are done at once, and the most fragments and sections that they have wanted in a frame so far.
    ///
    /// # Errors
    /// What Vulkan answers.
    pub fn demand(&self, shaders: &ShaderLibrary) -> Result<Capacity, Error> {
        self.passes.lists.demand(shaders)
    }

    /// The sorted fragments of each pixel of the last frame, without the sections; of its last band, if there are several.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn fragments(&self, shaders: &ShaderLibrary) -> Result<Vec<Vec<Fragment>>, Error> {
        self.passes.lists.read(shaders, self.passes.march.as_ref().map(|march| &march.sections))
    }

    /// Evaluations of the density along the viewer's rays in the last frame; in its last band, if there are several.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn evaluations(&self, shaders: &ShaderLibrary) -> Result<u64, Error> {
        self.passes.lists.evaluations(shaders)
    }
}

impl Paper for Gas {
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let Passes { lists, march, resolve } = &self.passes;
        let gas = Gases {
            volume_count: if march.is_some() { self.parameters.volumes.len() } else { 0 },
            are_shadowing: march.as_ref().is_some_and(|march| march.attenuations.is_some()),
        };
        let number = self.parameters.scene_frame(number);
        self.geometry.write(&self.parameters, number, gas, lists.capacity)?;
        for band in Band::all(self.parameters.height, lists.capacity.rows) {
            lists.record(frame, band)?;
            if let Some(march) = march {
                march.record(frame, band)?;
            }
            resolve.record(frame, band)?;
        }
        Ok(())
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        self.passes.resolve.draw(frame)
    }

    fn settle(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        let demand = self.passes.lists.demand(shaders)?;
        let Some(capacity) = self.passes.lists.capacity.grown(demand, self.most)? else { return Ok(true) };
        self.passes = Passes::new(shaders, &self.label, &self.geometry, self.variant, &self.parameters, capacity)?;
        Ok(false)
    }

    /// The device has no geometry stage.
    fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.lacks_geometry_stage {
            warnings.push(
                "the device has no geometry stage: `fragments` makes each triangle's footprint six times in its vertex \
                 stage, so that its time is not that of the other devices' method"
                    .to_owned(),
            );
        }
        warnings
    }

    fn picture(&self) -> &Arc<ImageView> {
        &self.passes.resolve.picture
    }

    fn targets(&self) -> Vec<Target> {
        let mut targets = Vec::new();
        if let Some(march) = &self.passes.march {
            if let Some(tables) = &march.tables {
                let row = self.parameters.table_size;
                targets.push(Target::table("density-table", &tables.densities, row));
                targets.push(Target::table("shadow-table", &tables.shadows, row));
            }
            targets.push(Target::table("sections", &march.sections, 8));
            if let Some(attenuations) = &march.attenuations {
                let lights = self.parameters.lights.len() as u32;
                targets.push(Target::table("light-attenuations", attenuations, lights));
            }
        }
        targets.push(Target::image("radiance", &self.passes.resolve.radiance));
        targets.push(Target::image("picture", &self.passes.resolve.picture));
        targets
    }
}
