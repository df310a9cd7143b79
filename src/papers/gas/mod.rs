//! `gas`: D. S. Ebert's and R. E. Parent's gaseous phenomena, volume rendering in a scanline A-buffer, 1990.
//!
//! ```text
//! fragments ─► sort ─┬──────────────────────────────► volume ─► light-attenuation ─► resolve (─► view)
//!                    │                                  ▲               ▲
//!                    └─ (table) density-table ─► shadow-table ──────────┘
//! ```

mod blocks;
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
mod tables;

use std::sync::Arc;

use self::geometry::Geometry;
use self::lists::Lists;
use self::march::March;
use self::model::Object;
use self::resolve::Resolve;
use super::{Paper, Target};
use crate::gpu::{Error, Feature, Frame, ImageView, ShaderLibrary};

pub use self::blocks::Capacity;
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
    /// fragments and two sections a pixel, or for what `capacity` says.
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
        let pixels = parameters.width.saturating_mul(parameters.height).max(1);
        let usual = Capacity { fragments: pixels.saturating_mul(4), sections: pixels.saturating_mul(2) };
        let geometry = Geometry::new(shaders, label, parameters, objects)?;
        let passes = Passes::new(shaders, label, &geometry, variant, parameters, capacity.unwrap_or(usual))?;
        Ok(Gas { label: label.to_owned(), variant, parameters: parameters.clone(), geometry, passes })
    }

    /// The most fragments and sections that a frame has wanted so far.
    ///
    /// # Errors
    /// What Vulkan answers.
    pub fn demand(&self, shaders: &ShaderLibrary) -> Result<Capacity, Error> {
        self.passes.lists.demand(shaders)
    }

    /// The sorted fragments of each pixel of the last frame, without the sections.
    ///
    /// # Errors
    /// [`Error::ReadBeforeWrite`] before the first frame; what Vulkan answers.
    pub fn fragments(&self, shaders: &ShaderLibrary) -> Result<Vec<Vec<Fragment>>, Error> {
        self.passes.lists.read(shaders)
    }

    /// What the run should tell: the device has no geometry stage.
    pub fn warnings(&self, shaders: &ShaderLibrary) -> Vec<String> {
        if shaders.device().physical().has(Feature::GeometryShader) {
            return Vec::new();
        }
        vec!["the device has no geometry stage: `fragments` makes each triangle's footprint six times in its vertex stage".into()]
    }
}

impl Paper for Gas {
    fn record(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        let Passes { lists, march, resolve } = &self.passes;
        let volume_count = if march.is_some() { self.parameters.volumes.len() } else { 0 };
        let number = self.parameters.scene_frame(number);
        self.geometry.write(&self.parameters, number, volume_count, lists.capacity)?;
        lists.record(frame)?;
        if let Some(march) = march {
            march.record(frame)?;
        }
        resolve.record(frame)
    }

    fn record_picture(&mut self, frame: &mut Frame<'_>, number: u32) -> Result<(), Error> {
        self.record(frame, number)?;
        self.passes.resolve.draw(frame)
    }

    fn settle(&mut self, shaders: &ShaderLibrary) -> Result<bool, Error> {
        let demand = self.passes.lists.demand(shaders)?;
        let capacity = self.passes.lists.capacity;
        if demand.fragments <= capacity.fragments && demand.sections <= capacity.sections {
            return Ok(true);
        }
        // An eighth more: the frames to come may want a little more. What is enough stays as it is.
        let grown = |demand: u32, capacity: u32| {
            if demand > capacity { demand.saturating_add(demand / 8) } else { capacity }
        };
        let capacity = Capacity {
            fragments: grown(demand.fragments, capacity.fragments),
            sections: grown(demand.sections, capacity.sections),
        };
        self.passes = Passes::new(shaders, &self.label, &self.geometry, self.variant, &self.parameters, capacity)?;
        Ok(false)
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
