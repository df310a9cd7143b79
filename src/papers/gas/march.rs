//! The gas of every pixel, and what it takes of the light on surfaces.

use std::sync::Arc;

use ash::vk;

use super::blocks::SectionBlock;
use super::capacity::Band;
use super::geometry::Geometry;
use super::lists::Lists;
use super::parameters::{Parameters, Variant};
use super::tables::Tables;
use crate::gpu::{Buffer, BufferDesc, Error, Frame, Pass, ShaderLibrary};

/// The passes that evaluate or look up the gas.
pub struct March {
    pub sections: Arc<Buffer>,
    /// Floats: for each fragment, each light's.
    pub attenuations: Option<Arc<Buffer>>,
    pub tables: Option<Tables>,
    volume: Pass,
    attenuation: Option<Pass>,
    width: u32,
}

impl March {
    /// For a variant with volumes.
    ///
    /// # Errors
    /// [`Error::Limit`] for a capacity or tables beyond what the device binds.
    pub fn new(
        shaders: &ShaderLibrary,
        label: &str,
        geometry: &Geometry,
        lists: &Lists,
        variant: Variant,
        parameters: &Parameters,
    ) -> Result<Self, Error> {
        let buffer = |name: &str, bytes: u64| {
            let desc = BufferDesc::new(format!("{label}/{name}"), bytes);
            Buffer::new(shaders.device(), desc.usage(vk::BufferUsageFlags::STORAGE_BUFFER))
        };
        let tables = match variant {
            Variant::Table => Some(Tables::new(shaders, label, geometry, parameters)?),
            _ => None,
        };
        let sections = buffer("sections", u64::from(lists.capacity.sections) * size_of::<SectionBlock>() as u64)?;
        let shader = match variant {
            Variant::NoVolume | Variant::None | Variant::Surfaces => "gas/volume-none.comp",
            Variant::Traced => "gas/volume-traced.comp",
            Variant::Table => "gas/volume-table.comp",
        };
        let mut volume = Pass::compute("volume", "Volume rendering", shader)
            .with("frame", &geometry.frame)
            .with("Volumes", &geometry.volumes)
            .with("Lights", &geometry.lights)
            .with("Offsets", &geometry.offsets)
            .with("Heads", &lists.heads)
            .with("Links", &lists.links)
            .with("Pixels", &lists.pixels)
            .with("Sections", &sections)
            .constants::<Band>();
        if let Some(tables) = &tables {
            volume = volume.with("ShadowTables", &tables.shadows);
        }
        let is_shadowed = matches!(variant, Variant::Surfaces | Variant::Traced | Variant::Table);
        let (mut attenuations, mut attenuation) = (None, None);
        if is_shadowed {
            let bytes = 4 * u64::from(lists.capacity.fragments) * parameters.lights.len() as u64;
            let values = buffer("light-attenuations", bytes)?;
            let shader =
                if tables.is_some() { "gas/light-attenuation-table.comp" } else { "gas/light-attenuation-traced.comp" };
            let mut pass = Pass::compute("light-attenuation", "Shadowing of the gas", shader)
                .with("frame", &geometry.frame)
                .with("Volumes", &geometry.volumes)
                .with("Lights", &geometry.lights)
                .with("Heads", &lists.heads)
                .with("Links", &lists.links)
                .with("Surfaces", &lists.surfaces)
                .with("Colors", &lists.colors)
                .with("Sections", &sections)
                .with("Attenuations", &values)
                .constants::<Band>();
            pass = match &tables {
                Some(tables) => pass.with("ShadowTables", &tables.shadows),
                None => pass.with("Offsets", &geometry.offsets),
            };
            attenuation = Some(pass.build(shaders)?);
            attenuations = Some(values);
        }
        Ok(March {
            sections,
            attenuations,
            tables,
            volume: volume.build(shaders)?,
            attenuation,
            width: parameters.width,
        })
    }

    /// Sections and attenuations of a band; the tables before the first one.
    pub fn record(&self, frame: &mut Frame<'_>, band: Band) -> Result<(), Error> {
        if let Some(tables) = self.tables.as_ref().filter(|_| band.first_row == 0) {
            tables.record(frame)?;
        }
        for pass in std::iter::once(&self.volume).chain(&self.attenuation) {
            frame.compute(pass, |dispatch| {
                for part in band.parts() {
                    dispatch.constants(&part).threads(self.width, part.rows(), 1);
                }
            })?;
        }
        Ok(())
    }
}
