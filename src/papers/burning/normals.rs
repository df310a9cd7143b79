//! `normals` (appendix B), with the colour of charring, of what has changed since the last picture.

use super::buffers::Buffers;
use super::materials::Appearances;
use super::model::Model;
use super::vertex_mapping::Shown;
use crate::gpu::{Error, Frame, Pass, ShaderLibrary};

/// The pass.
pub struct Normals {
    pass: Pass,
    draw_vertices: u32,
}

impl Normals {
    /// # Errors
    /// Those of the Vulkan layer.
    pub fn new(
        shaders: &ShaderLibrary,
        buffers: &Buffers,
        appearances: Option<&Appearances>,
        model: &Model,
    ) -> Result<Self, Error> {
        let pass = |shader: &str| Pass::compute("normals", "B", shader);
        let pass = match appearances {
            None => pass("burning/normals-one.comp"),
            Some(appearances) => pass("burning/normals-several.comp")
                .with("Substances", &appearances.substances)
                .with("SubstanceOf", &appearances.substance_of),
        };
        let pass = pass
            .constants::<Shown>()
            .with("constants", &buffers.constants)
            .with("Rest", &buffers.rest)
            .with("Triangles", &buffers.triangles)
            .with("Welds", &buffers.welds)
            .with("CornerIncidenceOffsets", &buffers.corner_incidence_offsets)
            .with("CornerIncidence", &buffers.corner_incidence)
            .with("Removed", &buffers.removed)
            .with("Clock", &buffers.clock)
            .with("Alive", &buffers.alive)
            .with("Mapped", &buffers.mapped)
            .with("Normals", &buffers.normals)
            .with("Colors", &buffers.colors)
            .with("Touched", &buffers.touched)
            .build(shaders)?;
        Ok(Normals { pass, draw_vertices: model.draw_vertex_count() })
    }

    /// # Errors
    /// Those of the Vulkan layer.
    pub fn record(&self, frame: &mut Frame<'_>, shown: Shown) -> Result<(), Error> {
        frame.compute(&self.pass, |dispatch| dispatch.constants(&shown).elements(self.draw_vertices))
    }
}
