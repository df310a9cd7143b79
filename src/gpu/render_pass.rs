//! Classic render passes and framebuffers. Initial, subpass and final layout are one, so no implicit dependency
//! exists: every transition is a barrier of the envelope.

use std::sync::Arc;

use ash::vk;

use super::access::Access;
use super::device::Device;
use super::error::{Context, Error};
use super::format::format_info;
use super::image::ImageView;
use super::live::Kind;
use crate::named;
use crate::shader_build::Scalar;

/// Contents of an attachment when a pass begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Load {
    /// A clear value: four colour components, integers where the format has them, or depth, from 0 to 1, in the first.
    Clear([f32; 4]),
    /// The contents that the passes before left.
    Keep,
    /// Anything: every texel is overwritten.
    Discard,
}

named! {
    /// Blend state of a colour attachment.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum Blend {
        /// The fragment's colour.
        Replace = "replace",
        /// destination + source
        Add = "add",
        /// destination x source; alpha stays.
        Multiply = "multiply",
        /// source alpha over the destination.
        Over = "over",
        /// As `Over`, with a source colour that its alpha was multiplied into: adds where that is 0.
        Premultiplied = "premultiplied over",
        /// Nothing is written: for the floor of a pass.
        Masked = "masked",
    }
}

impl Blend {
    pub(crate) fn state(self) -> vk::PipelineColorBlendAttachmentState {
        use vk::BlendFactor as F;
        let blended = |src, dst, src_alpha, dst_alpha| {
            vk::PipelineColorBlendAttachmentState::default()
                .blend_enable(true)
                .src_color_blend_factor(src)
                .dst_color_blend_factor(dst)
                .color_blend_op(vk::BlendOp::ADD)
                .src_alpha_blend_factor(src_alpha)
                .dst_alpha_blend_factor(dst_alpha)
                .alpha_blend_op(vk::BlendOp::ADD)
                .color_write_mask(vk::ColorComponentFlags::RGBA)
        };
        match self {
            Blend::Replace => {
                vk::PipelineColorBlendAttachmentState::default().color_write_mask(vk::ColorComponentFlags::RGBA)
            }
            Blend::Masked => vk::PipelineColorBlendAttachmentState::default(),
            Blend::Add => blended(F::ONE, F::ONE, F::ONE, F::ONE),
            Blend::Multiply => blended(F::DST_COLOR, F::ZERO, F::ZERO, F::ONE),
            Blend::Over => blended(F::SRC_ALPHA, F::ONE_MINUS_SRC_ALPHA, F::ONE, F::ONE_MINUS_SRC_ALPHA),
            Blend::Premultiplied => blended(F::ONE, F::ONE_MINUS_SRC_ALPHA, F::ONE, F::ONE_MINUS_SRC_ALPHA),
        }
    }
}

named! {
    /// Depth and stencil state of a pass.
    #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
    pub enum DepthTest {
        /// Nearer fragments pass and are written.
        LessWrite = "less, write",
        /// As [`DepthTest::LessWrite`] of a depth that falls with the distance: 0 is farthest. Floats are dense there.
        GreaterWrite = "greater, write",
        /// Nearer fragments pass; nothing is written.
        LessReadOnly = "less, read only",
        /// Fragments of the depth that is there pass; nothing is written.
        EqualReadOnly = "equal, read only",
        /// Nothing but the stencil is written: faces behind what is seen count up when they face away and down when they
        /// face the viewer, wrapping, so that it is not zero where the surface lies inside a closed volume (z-fail).
        CountVolume = "stencil: z-fail, wrapping",
        /// Depth is not tested: fragments pass where the stencil is not zero, and make it zero.
        InsideVolume = "stencil: not zero, to zero",
    }
}

impl DepthTest {
    pub(crate) fn state(self) -> vk::PipelineDepthStencilStateCreateInfo<'static> {
        use vk::StencilOp as Op;
        let depth = |compare| {
            vk::PipelineDepthStencilStateCreateInfo::default().depth_test_enable(true).depth_compare_op(compare)
        };
        let stencil = |compare, pass, depth_fail| vk::StencilOpState {
            fail_op: Op::KEEP,
            pass_op: pass,
            depth_fail_op: depth_fail,
            compare_op: compare,
            compare_mask: 0xff,
            write_mask: 0xff,
            reference: 0,
        };
        match self {
            DepthTest::LessWrite => depth(vk::CompareOp::LESS).depth_write_enable(true),
            DepthTest::GreaterWrite => depth(vk::CompareOp::GREATER).depth_write_enable(true),
            DepthTest::LessReadOnly => depth(vk::CompareOp::LESS),
            DepthTest::EqualReadOnly => depth(vk::CompareOp::EQUAL),
            DepthTest::CountVolume => depth(vk::CompareOp::LESS)
                .stencil_test_enable(true)
                .front(stencil(vk::CompareOp::ALWAYS, Op::KEEP, Op::DECREMENT_AND_WRAP))
                .back(stencil(vk::CompareOp::ALWAYS, Op::KEEP, Op::INCREMENT_AND_WRAP)),
            DepthTest::InsideVolume => {
                let inside = stencil(vk::CompareOp::NOT_EQUAL, Op::ZERO, Op::ZERO);
                vk::PipelineDepthStencilStateCreateInfo::default().stencil_test_enable(true).front(inside).back(inside)
            }
        }
    }

    /// True where depth is written.
    pub(crate) fn writes(self) -> bool {
        matches!(self, DepthTest::LessWrite | DepthTest::GreaterWrite)
    }

    /// True where the stencil is tested.
    pub(crate) fn has_stencil(self) -> bool {
        matches!(self, DepthTest::CountVolume | DepthTest::InsideVolume)
    }

    pub(crate) fn access(self) -> Access {
        match self {
            DepthTest::LessWrite | DepthTest::GreaterWrite | DepthTest::CountVolume | DepthTest::InsideVolume => {
                Access::DepthTarget
            }
            DepthTest::LessReadOnly | DepthTest::EqualReadOnly => Access::DepthReadOnly,
        }
    }
}

/// One attachment of a pass.
#[derive(Clone)]
pub struct Target {
    /// The view drawn into.
    pub view: Arc<ImageView>,
    /// Its contents when the pass begins.
    pub load: Load,
}

/// The attachments of a pass: colours with their blend state, and depth.
#[derive(Clone, Default)]
pub struct Targets {
    /// Colour attachments by location.
    pub colors: Vec<(Target, Blend)>,
    /// Depth (and stencil) attachment.
    pub depth: Option<(Target, DepthTest)>,
    /// The extent of a pass without attachments.
    pub extent: Option<(u32, u32)>,
    /// Sides of triangles that are not drawn; the front is the one that corners come round counter-clockwise on.
    pub culled: vk::CullModeFlags,
}

impl Targets {
    pub(crate) fn extent(&self) -> Option<vk::Extent2D> {
        let view = self.colors.first().map(|c| &c.0.view).or(self.depth.as_ref().map(|d| &d.0.view));
        let (width, height) = view.map(|v| (v.width(), v.height())).or(self.extent)?;
        Some(vk::Extent2D { width, height })
    }

    /// The same attachments with masked colours and another depth state.
    pub(crate) fn for_counting(&self, test: DepthTest) -> Self {
        Targets {
            colors: self.colors.iter().map(|(target, _)| (target.clone(), Blend::Masked)).collect(),
            depth: self.depth.as_ref().map(|(target, _)| (target.clone(), test)),
            extent: self.extent,
            culled: self.culled,
        }
    }

    /// One extent for all, each cleared to what it can hold, and nothing cleared or discarded that is not written: both
    /// write, which no barrier of a reader waits for.
    pub(super) fn check(&self, pass: &str) -> Result<(), Error> {
        let problem = |problem: String| Err(Error::Pass { pass: pass.to_owned(), problem });
        for (target, _) in &self.colors {
            let (image, format) = (target.view.image(), target.view.image().desc().format);
            if let Load::Clear(color) = target.load
                && !is_held(format, color)
            {
                return problem(format!("clears {} to {color:?}, which {format:?} does not hold", image.name()));
            }
        }
        if let Some((target, test)) = &self.depth {
            let name = target.view.image().name();
            let writes = match target.load {
                // Not a number lies in no range.
                Load::Clear([value, ..]) if !(0.0..=1.0).contains(&value) => {
                    return problem(format!("clears depth {name} to {value}, which lies outside 0 to 1"));
                }
                Load::Clear(_) => Some("clears"),
                Load::Discard => Some("discards"),
                Load::Keep => None,
            };
            if let (Some(writes), Access::DepthReadOnly) = (writes, test.access()) {
                return problem(format!("{writes} depth {name}, which it declares read only"));
            }
        }
        let mut views = self.views().map(|t| &t.view);
        let Some(first) = views.next() else { return Ok(()) };
        match views.find(|v| (v.width(), v.height()) != (first.width(), first.height())) {
            None => Ok(()),
            Some(other) => problem(format!(
                "its target {} has {} x {} texels and {} has {} x {}",
                other.image().name(),
                other.width(),
                other.height(),
                first.image().name(),
                first.width(),
                first.height()
            )),
        }
    }

    /// Formats of the attachments, colours first.
    pub(crate) fn formats(&self) -> impl Iterator<Item = vk::Format> {
        self.views().map(|target| target.view.image().desc().format)
    }

    fn views(&self) -> impl Iterator<Item = &Target> {
        self.colors.iter().map(|c| &c.0).chain(self.depth.iter().map(|d| &d.0))
    }

    pub(crate) fn clear_values(&self) -> Vec<vk::ClearValue> {
        self.views()
            .map(|target| {
                let value = match target.load {
                    Load::Clear(value) => value,
                    Load::Keep | Load::Discard => [0.0; 4],
                };
                if target.view.image().aspect().contains(vk::ImageAspectFlags::DEPTH) {
                    vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: value[0], stencil: 0 } }
                } else {
                    vk::ClearValue { color: clear_color(target.view.image().desc().format, value) }
                }
            })
            .collect()
    }
}

/// True for a colour that a texel of the format holds: integers take integers of their range.
fn is_held(format: vk::Format, color: [f32; 4]) -> bool {
    let Some(info) = format_info(format) else { return false };
    let bits = if info.texel_bytes == 2 { 16 } else { 32 };
    let range = match info.scalar {
        Scalar::Float => return true,
        Scalar::Uint => 0.0..f32::powi(2.0, bits),
        Scalar::Int => -f32::powi(2.0, bits - 1)..f32::powi(2.0, bits - 1),
    };
    color.iter().all(|value| value.fract() == 0.0 && range.contains(value))
}

/// The colour in the type of the format's values.
fn clear_color(format: vk::Format, color: [f32; 4]) -> vk::ClearColorValue {
    match format_info(format).map(|info| info.scalar) {
        Some(Scalar::Uint) => vk::ClearColorValue { uint32: color.map(|value| value as u32) },
        Some(Scalar::Int) => vk::ClearColorValue { int32: color.map(|value| value as i32) },
        Some(Scalar::Float) | None => vk::ClearColorValue { float32: color },
    }
}

/// A render pass of one subpass.
pub struct RenderPass {
    /// Handle.
    pub(crate) raw: vk::RenderPass,
    device: Arc<Device>,
}

impl RenderPass {
    pub(crate) fn new(device: &Arc<Device>, pass: &str, targets: &Targets) -> Result<Arc<Self>, Error> {
        let attachment = |target: &Target, access: Access| {
            let layout = access.info().layout;
            // Storing is a write even of what was only tested, and no barrier waits for the write of a reader.
            let store = if access.info().writes { vk::AttachmentStoreOp::STORE } else { vk::AttachmentStoreOp::NONE };
            let load = match target.load {
                Load::Clear(_) => vk::AttachmentLoadOp::CLEAR,
                Load::Keep => vk::AttachmentLoadOp::LOAD,
                Load::Discard => vk::AttachmentLoadOp::DONT_CARE,
            };
            let has_stencil = target.view.image().aspect().contains(vk::ImageAspectFlags::STENCIL);
            vk::AttachmentDescription::default()
                .format(target.view.image().desc().format)
                .samples(vk::SampleCountFlags::TYPE_1)
                .load_op(load)
                .store_op(store)
                .stencil_load_op(if has_stencil { load } else { vk::AttachmentLoadOp::DONT_CARE })
                .stencil_store_op(if has_stencil { store } else { vk::AttachmentStoreOp::DONT_CARE })
                .initial_layout(layout)
                .final_layout(layout)
        };
        let mut attachments: Vec<_> = targets.colors.iter().map(|(t, _)| attachment(t, Access::ColorTarget)).collect();
        let colors: Vec<_> = (0..attachments.len() as u32)
            .map(|i| vk::AttachmentReference { attachment: i, layout: Access::ColorTarget.info().layout })
            .collect();
        let mut depth = vk::AttachmentReference::default();
        if let Some((target, test)) = &targets.depth {
            depth =
                vk::AttachmentReference { attachment: attachments.len() as u32, layout: test.access().info().layout };
            attachments.push(attachment(target, test.access()));
        }
        let mut subpass = vk::SubpassDescription::default()
            .pipeline_bind_point(vk::PipelineBindPoint::GRAPHICS)
            .color_attachments(&colors);
        if targets.depth.is_some() {
            subpass = subpass.depth_stencil_attachment(&depth);
        }
        let subpasses = [subpass];
        let info = vk::RenderPassCreateInfo::default().attachments(&attachments).subpasses(&subpasses);
        // SAFETY: the arrays outlive the call; references point into `attachments`.
        let raw =
            unsafe { device.raw.create_render_pass(&info, None) }.context("creating the render pass of pass", pass)?;
        device.live().add(Kind::RenderPass);
        device.name(raw, pass);
        Ok(Arc::new(RenderPass { raw, device: device.clone() }))
    }
}

impl Drop for RenderPass {
    fn drop(&mut self) {
        // SAFETY: framebuffers and passes hold an `Arc` of this render pass; pipelines do not need it once created.
        unsafe { self.device.raw.destroy_render_pass(self.raw, None) };
        self.device.live().remove(Kind::RenderPass);
    }
}

/// A framebuffer: the views that a render pass draws into.
pub struct Framebuffer {
    /// Handle.
    pub(crate) raw: vk::Framebuffer,
    device: Arc<Device>,
    _targets: Targets,
    _render_pass: Arc<RenderPass>,
}

impl Framebuffer {
    pub(crate) fn new(
        device: &Arc<Device>,
        pass: &str,
        render_pass: &Arc<RenderPass>,
        targets: &Targets,
        extent: vk::Extent2D,
    ) -> Result<Self, Error> {
        let views: Vec<_> = targets.views().map(|t| t.view.raw).collect();
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(render_pass.raw)
            .attachments(&views)
            .width(extent.width)
            .height(extent.height)
            .layers(1);
        // SAFETY: views and render pass are alive and kept so by the framebuffer.
        let raw =
            unsafe { device.raw.create_framebuffer(&info, None) }.context("creating the framebuffer of pass", pass)?;
        device.live().add(Kind::Framebuffer);
        device.name(raw, pass);
        Ok(Framebuffer { raw, device: device.clone(), _targets: targets.clone(), _render_pass: render_pass.clone() })
    }
}

impl Drop for Framebuffer {
    fn drop(&mut self) {
        // SAFETY: a frame keeps the pass that owns this framebuffer until its fence.
        unsafe { self.device.raw.destroy_framebuffer(self.raw, None) };
        self.device.live().remove(Kind::Framebuffer);
    }
}
