//! Rebinding a pass: the same shaders, state and pipeline with other resources.

use std::sync::Arc;

use super::bindings::Resource;
use super::buffer::Buffer;
use super::error::Error;
use super::image::ImageView;
use super::pass::{Body, Pass};
use super::pass_builder::{PassDesc, Pipelines, finish};
use super::pass_check;
use super::render_pass::{Load, RenderPass, Target};
use super::shader::ShaderLibrary;

/// Rebinds a pass to other resources: same shaders, state and formats.
pub struct RebindBuilder {
    pass: Pass,
    desc: PassDesc,
    /// The first replacement that the pass has nothing to replace with.
    missing: Option<String>,
}

impl RebindBuilder {
    pub(super) fn new(pass: &Pass) -> Self {
        RebindBuilder { pass: pass.clone(), desc: pass.inner.desc.clone(), missing: None }
    }

    fn miss(&mut self, what: impl Into<String>) {
        self.missing.get_or_insert_with(|| what.into());
    }

    /// Replaces the resource of that name.
    pub fn with(mut self, name: &'static str, resource: impl Into<Resource>) -> Self {
        let resource = resource.into();
        match self.desc.resources.iter_mut().find(|(n, _)| *n == name) {
            Some(slot) => slot.1 = resource,
            None => self.desc.resources.push((name, resource)),
        }
        self
    }

    /// Replaces the colour attachment at `index`; its format is the old one's.
    pub fn color(mut self, index: usize, view: &Arc<ImageView>, load: Load) -> Self {
        match self.desc.targets.colors.get_mut(index) {
            Some((target, _)) => *target = Target { view: view.clone(), load },
            None => self.miss(format!("colour attachment {index}")),
        }
        self
    }

    /// Replaces the depth attachment; its format is the old one's.
    pub fn depth(mut self, view: &Arc<ImageView>, load: Load) -> Self {
        match &mut self.desc.targets.depth {
            Some((target, _)) => *target = Target { view: view.clone(), load },
            None => self.miss("depth attachment"),
        }
        self
    }

    /// Replaces the vertex buffer by another of the same structs.
    pub fn vertices(mut self, buffer: &Arc<Buffer>) -> Self {
        if self.desc.vertices.replace(buffer.view()).is_none() {
            self.miss("vertex buffer");
        }
        self
    }

    /// Replaces the index buffer.
    pub fn indices(mut self, buffer: &Arc<Buffer>) -> Self {
        if self.desc.indices.replace(buffer.view()).is_none() {
            self.miss("index buffer");
        }
        self
    }

    /// Makes the pass, sharing the pipeline of the first.
    ///
    /// # Errors
    /// [`Error::Pass`] for a replacement of what the pass does not have, or by another format; otherwise as
    /// [`PassBuilder::build`](super::pass::PassBuilder::build).
    pub fn build(self, shaders: &ShaderLibrary) -> Result<Pass, Error> {
        let RebindBuilder { pass, desc, missing } = self;
        let device = shaders.device();
        let old = &pass.inner;
        device.check_own(&old.device, desc.name, desc.name)?;
        if let Some(missing) = missing {
            return Err(desc.problem(format!("it has no {missing} to replace")));
        }
        let render_pass = match &old.body {
            Body::Compute { .. } | Body::Copy { .. } => None,
            // Load operations alone may differ, which keeps the new render pass compatible with the pipeline.
            Body::Graphics { .. } => {
                if desc.targets.formats().ne(old.desc.targets.formats()) {
                    return Err(desc.problem("an attachment is replaced by one of another format"));
                }
                pass_check::attachments(device, &desc)?;
                Some(RenderPass::new(device, desc.name, &desc.targets)?)
            }
        };
        let Some(own) = old.pipeline.clone() else {
            return Err(desc.problem("a copy has no descriptors to rebind"));
        };
        let pipelines = Pipelines {
            own,
            counting: old.counting.clone(),
            stride_bytes: old.stride_bytes,
            element_bytes: old.element_bytes,
        };
        finish(shaders, desc, pipelines, render_pass)
    }
}
