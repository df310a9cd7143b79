//! The paper, its parameters, passes and targets, as the window has them.

use ash::vk;

use crate::gpu::bindings::Resource;
use crate::gpu::physical::DeviceType;
use crate::gpu::{PassInfo, PassSample};
use crate::measure::machine::Machine;
use crate::measure::parameter::{self, Parameter};
use crate::measure::study::Study;
use crate::measure::{Kind, Target, Variant};
use crate::window::protocol::{
    self, ChoiceInfo, Cost, ParameterInfo, PresetInfo, Ready, TargetInfo, TargetShape, ValueKind,
};

/// The paper and the machine.
pub fn ready<S: Study>(machine: &Machine, shader_dir: Option<String>, can_capture: bool) -> Ready {
    let preset = |preset: crate::measure::study::Preset<S>| PresetInfo {
        name: preset.name.to_owned(),
        help: preset.help.to_owned(),
        variant: preset.variant.map(|variant| variant.as_str().to_owned()),
    };
    Ready {
        paper: S::PAPER.to_owned(),
        about: S::ABOUT.to_owned(),
        device: machine.description(),
        is_cpu: machine.device.physical().device_type == DeviceType::Cpu,
        validates: machine.device.instance().validates(),
        can_capture,
        shader_dir,
        variants: S::Variant::ALL.iter().map(|variant| variant.as_str().to_owned()).collect(),
        presets: S::presets().into_iter().map(preset).collect(),
        parameters: S::parameters().iter().map(|p| parameter_info(p, &S::default())).collect(),
        warnings: machine.warnings(),
    }
}

fn parameter_info<S: 'static>(parameter: &Parameter<S>, default: &S) -> ParameterInfo {
    let shape = parameter.shape();
    let (low, high) = parameter.range.ends();
    let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    ParameterInfo {
        name: parameter.name.to_owned(),
        group: parameter.group.to_owned(),
        help: parameter.help.to_owned(),
        section: parameter.section.to_owned(),
        unit: parameter.unit.to_owned(),
        low,
        high,
        range: parameter.range.text(),
        placeholder: parameter.placeholder.to_owned(),
        default: parameter.default_of(default),
        cost: match parameter.cost {
            parameter::Cost::Constants => Cost::Constants,
            parameter::Cost::Buffers => Cost::Buffers,
            parameter::Cost::Pipelines => Cost::Pipelines,
        },
        is_flag: shape.is_flag,
        is_list: shape.is_list,
        is_several: shape.is_several,
        is_whole: shape.placeholder == "N",
        is_file: shape.placeholder.contains("FILE"),
        is_everyday: parameter.is_everyday,
        choices: shape
            .choices
            .iter()
            .map(|&(name, help)| ChoiceInfo { name: name.into(), help: help.into() })
            .collect(),
        excludes: owned(parameter.excludes),
        requires: parameter.requires.map(str::to_owned),
    }
}

/// The passes of a frame; resources have the name that is left without `prefix`.
pub fn passes(samples: &[PassSample], targets: &[TargetInfo], prefix: &str) -> Vec<protocol::PassInfo> {
    let own = |names: &[String]| -> Vec<String> {
        names.iter().map(|name| name.strip_prefix(prefix).unwrap_or(name).to_owned()).collect()
    };
    let of = |names: &[String]| -> Vec<usize> {
        let is_one = |target: &TargetInfo| names.contains(&target.resource);
        (0..targets.len()).filter(|&index| is_one(&targets[index])).collect()
    };
    let pass = |sample: &PassSample| {
        let info: &PassInfo = &sample.info;
        let (reads, writes) = (own(&info.reads), own(&info.writes));
        protocol::PassInfo {
            name: info.name.to_owned(),
            section: info.section.to_owned(),
            kind: info.kind.as_str().to_owned(),
            calls: sample.calls,
            shaders: info.shaders.clone(),
            compiler: info.compiler.map(|compiler| compiler.to_string()),
            read_targets: of(&reads),
            written_targets: of(&writes),
            reads,
            writes,
            blend: info.blend.iter().map(|&state| state.to_owned()).collect(),
            depth: info.depth.map(str::to_owned),
        }
    };
    samples.iter().map(pass).collect()
}

/// A target, where it holds values.
pub fn target(target: &Target, prefix: &str) -> Option<TargetInfo> {
    let name = |name: &str| name.strip_prefix(prefix).unwrap_or(name).to_owned();
    let info = match &target.resource {
        Resource::Image(view) => {
            let format = view.image().desc().format;
            let (kind, channels) = texel(format);
            let layers = view.layer_count() * view.depth();
            let shape = TargetShape::Image { width: view.width(), height: view.height(), channels, layers };
            TargetInfo {
                name: target.name.clone(),
                resource: name(view.image().name()),
                kind,
                shape,
                format: format!("{format:?}"),
                planes: target.planes.map(|planes| planes.map(f64::from)),
                is_srgb: format == vk::Format::R8G8B8A8_SRGB,
                holds: target.holds.to_owned(),
            }
        }
        Resource::Buffer(view) => {
            let columns = u64::from(target.columns.max(1));
            TargetInfo {
                name: target.name.clone(),
                resource: name(view.buffer().name()),
                kind: match target.kind {
                    Kind::F32 => ValueKind::F32,
                    Kind::U32 => ValueKind::U32,
                    Kind::I32 => ValueKind::I32,
                },
                shape: TargetShape::Table { rows: view.buffer().size_bytes() / 4 / columns, columns },
                format: String::new(),
                planes: None,
                is_srgb: false,
                holds: target.holds.to_owned(),
            }
        }
        Resource::Sampler(_) => return None,
    };
    Some(info)
}

/// Values and channels as [`read_target`](crate::measure::picture::read_target) reads them.
fn texel(format: vk::Format) -> (ValueKind, u32) {
    match format {
        vk::Format::R32_SFLOAT | vk::Format::D32_SFLOAT | vk::Format::D32_SFLOAT_S8_UINT => (ValueKind::F32, 1),
        vk::Format::R32G32B32A32_SFLOAT | vk::Format::R16G16B16A16_SFLOAT => (ValueKind::F32, 4),
        _ => (ValueKind::U8, 4),
    }
}
