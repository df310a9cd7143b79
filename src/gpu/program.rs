//! A program: the stages that run together, their merged interface, and the descriptor and pipeline layouts made
//! from it.

use std::sync::Arc;

use ash::vk;

use super::access::Stages;
use super::device::Device;
use super::error::{Context, Error};
use super::live::Kind;
use super::shader::{Compiler, ShaderModule};
use super::stage_limits;
use crate::shader_build::{BindingKind, ImageShape};

/// One descriptor of a program's set 0.
#[derive(Debug, Clone)]
pub struct Slot {
    /// Number of the binding.
    pub binding: u32,
    /// Name in the shaders.
    pub name: String,
    /// Kind of the descriptor.
    pub kind: BindingKind,
    /// The stages that use it.
    pub stages: Stages,
    /// The size of its block, for buffers of fixed size.
    pub block_bytes: Option<u32>,
    /// The shape of its image.
    pub image: Option<ImageShape>,
}

impl Slot {
    pub(crate) fn descriptor_type(&self) -> vk::DescriptorType {
        match self.kind {
            BindingKind::UniformBuffer => vk::DescriptorType::UNIFORM_BUFFER,
            BindingKind::StorageBuffer { .. } => vk::DescriptorType::STORAGE_BUFFER,
            BindingKind::SampledImage => vk::DescriptorType::SAMPLED_IMAGE,
            BindingKind::Sampler => vk::DescriptorType::SAMPLER,
            BindingKind::StorageImage { .. } => vk::DescriptorType::STORAGE_IMAGE,
            BindingKind::CombinedImageSampler => vk::DescriptorType::COMBINED_IMAGE_SAMPLER,
        }
    }

    /// True where the stages may write it: it is not declared `readonly`.
    pub(super) fn is_written_by(&self, stages: Stages) -> bool {
        self.stages.contains(stages) && self.kind.is_written()
    }
}

/// The stages of a pass with their layouts. All descriptors live in set 0.
pub struct Program {
    device: Arc<Device>,
    /// One module a stage.
    pub modules: Vec<Arc<ShaderModule>>,
    /// Descriptors of set 0, by binding.
    pub slots: Vec<Slot>,
    /// Stages that take push constants.
    pub(crate) push_stages: vk::ShaderStageFlags,
    /// Bytes of the largest block of push constants; 0 without one.
    pub(crate) push_bytes: u32,
    /// Layout of descriptor set 0.
    pub(crate) set_layout: vk::DescriptorSetLayout,
    /// Layout of the pipelines: the set and the push constants.
    pub(crate) layout: vk::PipelineLayout,
}

impl Program {
    /// Merges the interfaces of `modules` and makes the layouts.
    ///
    /// # Errors
    /// [`Error::Pass`] when two stages disagree about a binding or use a set other than 0; [`Error::Limit`] when stages,
    /// descriptors or push constants are beyond what the device allows.
    pub fn new(device: &Arc<Device>, pass: &str, modules: Vec<Arc<ShaderModule>>) -> Result<Arc<Self>, Error> {
        let slots = merge(pass, &modules)?;
        stage_limits::descriptors(device, pass, &slots)?;
        for module in &modules {
            stage_limits::stage(device, pass, module)?;
        }
        let mut push_stages = Stages::NONE;
        let mut push_bytes = 0;
        for module in &modules {
            if let Some(block) = &module.interface.push_constants {
                push_stages = push_stages | module.stage();
                push_bytes = push_bytes.max(block.size_bytes);
            }
        }
        if push_bytes % 4 != 0 {
            let problem = format!("its push constants take {push_bytes} bytes, no multiple of 4");
            return Err(Error::Pass { pass: pass.to_owned(), problem });
        }
        let limit = device.physical().limits.max_push_constants_size;
        if push_bytes > limit {
            return Err(Error::Limit {
                object: format!("pass {pass}"),
                what: "size in bytes of the push constants",
                wanted: push_bytes.into(),
                limit: limit.into(),
            });
        }
        let bindings: Vec<_> = slots
            .iter()
            .map(|slot| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(slot.binding)
                    .descriptor_type(slot.descriptor_type())
                    .descriptor_count(1)
                    .stage_flags(slot.stages.shader_stages())
            })
            .collect();
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the device is alive and `bindings` outlives the call.
        let set_layout = unsafe { device.raw.create_descriptor_set_layout(&info, None) }
            .context("creating the descriptor set layout of pass", pass)?;
        device.live().add(Kind::DescriptorSetLayout);
        // The guard exists from here on, so the layout is freed on every path.
        let mut program = Program {
            device: device.clone(),
            modules,
            slots,
            push_stages: push_stages.shader_stages(),
            push_bytes,
            set_layout,
            layout: vk::PipelineLayout::null(),
        };
        device.name(set_layout, pass);
        let ranges = [vk::PushConstantRange { stage_flags: program.push_stages, offset: 0, size: push_bytes }];
        let layouts = [set_layout];
        let mut info = vk::PipelineLayoutCreateInfo::default().set_layouts(&layouts);
        if push_bytes > 0 {
            info = info.push_constant_ranges(&ranges);
        }
        // SAFETY: the set layout is alive; the arrays outlive the call.
        program.layout = unsafe { device.raw.create_pipeline_layout(&info, None) }
            .context("creating the pipeline layout of pass", pass)?;
        device.live().add(Kind::PipelineLayout);
        device.name(program.layout, pass);
        Ok(Arc::new(program))
    }

    /// The compiler that made the program's binaries: naga only when it made all of them.
    pub fn compiler(&self) -> Compiler {
        if self.modules.iter().all(|m| m.compiler == Compiler::Naga) { Compiler::Naga } else { Compiler::Glslang }
    }
}

pub(crate) fn stage_infos(modules: &[Arc<ShaderModule>]) -> Vec<vk::PipelineShaderStageCreateInfo<'_>> {
    modules
        .iter()
        .map(|m| {
            vk::PipelineShaderStageCreateInfo::default().stage(m.stage().shader_stages()).module(m.raw).name(c"main")
        })
        .collect()
}

fn merge(pass: &str, modules: &[Arc<ShaderModule>]) -> Result<Vec<Slot>, Error> {
    let mut slots: Vec<Slot> = Vec::new();
    for module in modules {
        for binding in &module.interface.bindings {
            let problem = |text: &str| Error::Pass {
                pass: pass.to_owned(),
                problem: format!("{} of shader {}: {text}", binding.name, module.name),
            };
            if binding.set != 0 {
                return Err(problem("lies outside descriptor set 0"));
            }
            if binding.count != 1 {
                return Err(problem("is an array of descriptors; this layer binds one each"));
            }
            let block_bytes = binding.block.as_ref().map(|b| b.size_bytes);
            match slots.iter_mut().find(|s| s.binding == binding.binding) {
                None => slots.push(Slot {
                    binding: binding.binding,
                    name: binding.name.clone(),
                    kind: binding.kind,
                    stages: module.stage(),
                    block_bytes,
                    image: binding.image,
                }),
                Some(slot) if (&slot.name, slot.kind, slot.image) == (&binding.name, binding.kind, binding.image) => {
                    slot.block_bytes = slot.block_bytes.max(block_bytes);
                    slot.stages = slot.stages | module.stage();
                }
                Some(slot) => {
                    let text = format!("shares binding {} with {}, which differs", slot.binding, slot.name);
                    return Err(problem(&text));
                }
            }
        }
    }
    slots.sort_by_key(|s| s.binding);
    Ok(slots)
}

impl Drop for Program {
    fn drop(&mut self) {
        // SAFETY: pipelines and bindings hold an `Arc` of this program.
        unsafe {
            if self.layout != vk::PipelineLayout::null() {
                self.device.raw.destroy_pipeline_layout(self.layout, None);
                self.device.live().remove(Kind::PipelineLayout);
            }
            self.device.raw.destroy_descriptor_set_layout(self.set_layout, None);
        }
        self.device.live().remove(Kind::DescriptorSetLayout);
    }
}
