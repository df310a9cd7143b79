//! Tests that need the layer's inside: a barrier left out is reported, and every shader makes a pipeline.

use std::env;
use std::sync::Arc;

use ash::vk;

use super::access::{Access, AccessInfo, State, derive};
use super::physical::choose;
use super::pipeline::{Attribute, Pipeline, Topology, VertexLayout};
use super::program::Program;
use super::render_pass::{Blend, Load, RenderPass, Target, Targets};
use super::shader::{Compiler, ShaderLibrary, ShaderModule};
use super::{
    Buffer, BufferDesc, Device, Error, Image, ImageDesc, ImageView, Instance, Location, Mode, Pass, PhysicalDevice,
    Recorder,
};
use super::{messages::Message, transfer};
use crate::shader_build::{self, EMBEDDED, Format, Interface, Scalar, Stage};

/// A device of this test's own under validation, chosen as the integration tests choose theirs.
fn open_device() -> Arc<Device> {
    let wanted = env::var("FUMAROLE_TEST_DEVICE").unwrap_or_else(|_| "llvmpipe".to_owned());
    let instance = Instance::new(true).unwrap();
    let physical = choose(PhysicalDevice::enumerate(&instance).unwrap(), Some(&wanted), &[]).unwrap();
    Device::open(&instance, physical).unwrap()
}

fn color_target(device: &Arc<Device>, name: &str, format: vk::Format) -> Arc<ImageView> {
    let desc = ImageDesc::new_2d(name, format, 8, 8).usage(vk::ImageUsageFlags::COLOR_ATTACHMENT);
    Image::new(device, desc).unwrap().view().unwrap()
}

crate::host_block! {
    struct Range {
        value_count: u32,
    }
}

/// Messages of the layer about a kernel that reads the sums of the one before; `forget` makes the tracked state
/// forget the write between them.
fn sum_of_sums(device: &Arc<Device>, forget: bool) -> Vec<Message> {
    let shaders = ShaderLibrary::new(device, Compiler::Glslang, None).unwrap();
    let buffer = |name: &str| -> Arc<Buffer> {
        transfer::upload(device, name, vk::BufferUsageFlags::STORAGE_BUFFER, &[0; 256]).unwrap()
    };
    let (values, sums, total) = (buffer("values"), buffer("partial sums"), buffer("total"));
    let sum = |name, from, to| {
        let pass = Pass::compute(name, "", "test/sum.comp").constants::<Range>();
        pass.with("Values", from).with("Sums", to).build(&shaders).unwrap()
    };
    let (first, second) = (sum("sum-values", &values, &sums), sum("sum-sums", &sums, &total));
    let record = |frame: &mut super::Frame<'_>, pass| {
        frame.compute(pass, |dispatch| {
            dispatch.constants(&Range { value_count: 64 }).threads(64, 1, 1);
        })
    };
    let mut recorder = Recorder::new(device).unwrap();
    let outcome = recorder.run(Mode::Plain, |frame| {
        record(frame, &first)?;
        if forget {
            sums.with_states(0..sums.size_bytes(), |state| *state = State::HOST_WRITTEN);
        }
        record(frame, &second)
    });
    outcome.map(|_| ()).unwrap_or_else(|error: Error| panic!("{error}"));
    device.instance().take_messages()
}

#[test]
fn a_missing_barrier_between_kernels_is_reported() {
    let device = open_device();
    assert!(sum_of_sums(&device, false).is_empty(), "with its barrier");
    let messages = sum_of_sums(&device, true);
    let hazard = messages.iter().find(|m| m.id == "SYNC-HAZARD-READ-AFTER-WRITE");
    let hazard = hazard.unwrap_or_else(|| panic!("no hazard in {messages:?}"));
    assert!(hazard.objects.contains(&"partial sums".to_owned()), "{hazard}");
    assert!(hazard.text.contains("sum-sums"), "the pass is named: {hazard}");
}

/// Messages of the layer about a copy of the target that a pass drew; `forget` makes the tracked state forget who drew it.
fn draw_and_copy(device: &Arc<Device>, forget: bool) -> Vec<Message> {
    let shaders = ShaderLibrary::new(device, Compiler::Glslang, None).unwrap();
    let target = color_target(device, "canvas", vk::Format::R8G8B8A8_UNORM);
    let draw = Pass::graphics("draw", "", "test/asymmetric.vert", "test/asymmetric.frag")
        .color(&target, Load::Clear([0.0; 4]), Blend::Replace)
        .build(&shaders)
        .unwrap();
    let readback = Buffer::new(device, BufferDesc::new("copy", 256).location(Location::Readback)).unwrap();
    let copy = Pass::copy("copy-out", "", &target, &readback);
    // In the layout that the pass left it in, but written by no stage.
    let nobody = AccessInfo {
        stages: vk::PipelineStageFlags2::NONE,
        access: vk::AccessFlags2::NONE,
        ..Access::ColorTarget.info()
    };
    let (_, forgotten) = derive(&State::NEW, nobody, true, true);
    let mut recorder = Recorder::new(device).unwrap();
    let outcome = recorder.run(Mode::Plain, |frame| {
        frame.graphics(&draw, |draw| {
            draw.vertices(3);
        })?;
        if forget {
            target.image().with_states(0..1, |states| states.fill(forgotten));
        }
        frame.copy(&copy)
    });
    outcome.map(|_| ()).unwrap_or_else(|error: Error| panic!("{error}"));
    device.instance().take_messages()
}

#[test]
fn a_transition_that_waits_for_nothing_is_reported() {
    let device = open_device();
    assert!(draw_and_copy(&device, false).is_empty(), "with its barrier");
    let text: Vec<String> = draw_and_copy(&device, true).iter().map(ToString::to_string).collect();
    assert!(text.iter().any(|t| t.contains("SYNC-HAZARD-WRITE-AFTER-WRITE [canvas]")), "{text:?}");
}

/// Bound to other sets than the layer's one: they are for the tests of reflection.
const OTHER_SETS: [&str; 2] = ["test/filter.comp", "test/sprites.frag"];

fn vector_format(format: Format) -> vk::Format {
    match format.scalar {
        Scalar::Float => vk::Format::R32G32B32A32_SFLOAT,
        Scalar::Int => vk::Format::R32G32B32A32_SINT,
        Scalar::Uint => vk::Format::R32G32B32A32_UINT,
    }
}

/// Makes the pipeline of a vertex and a fragment shader, with targets and vertices as they want them.
fn draw_pipeline(device: &Arc<Device>, modules: [Arc<ShaderModule>; 2]) -> Result<Arc<Pipeline>, Error> {
    let [vertex, fragment] = &modules;
    let (name, inputs) = (fragment.name.clone(), &vertex.interface.inputs);
    let attributes = inputs.iter().zip(0..).map(|(input, i)| Attribute {
        location: input.location,
        format: vector_format(input.format),
        offset_bytes: 16 * i,
    });
    let layout = VertexLayout {
        stride_bytes: 16 * inputs.len() as u32,
        rate: vk::VertexInputRate::VERTEX,
        attributes: attributes.collect(),
    };
    let target = |output: &shader_build::Location| Target {
        view: color_target(device, &output.name, vector_format(output.format)),
        load: Load::Discard,
    };
    let colors = fragment.interface.outputs.iter().map(|output| (target(output), Blend::Replace)).collect();
    let targets = Targets { colors, ..Targets::default() };
    let program = Program::new(device, &name, modules.into())?;
    let render_pass = RenderPass::new(device, &name, &targets)?;
    let modules = &program.modules;
    Pipeline::graphics(device, &name, &program, modules, &render_pass, &targets, &layout, Topology::Triangles)
}

#[test]
fn every_shader_makes_a_pipeline_with_both_compilers() {
    let device = open_device();
    let interface = |name: &str| {
        let shader = EMBEDDED.iter().find(|s| s.name == name).unwrap();
        Interface::reflect(shader.glslang).unwrap()
    };
    let folder = |name: &str| name.split('/').next().map(str::to_owned).unwrap_or_default();
    let takes = |l: &shader_build::Location| (l.location, l.format, l.count);
    let of_stage = |stage| EMBEDDED.iter().filter(move |s| s.stage == stage).map(|s| s.name);
    for compiler in [Compiler::Glslang, Compiler::Naga] {
        let library = ShaderLibrary::new(&device, compiler, None).unwrap();
        let mut made: Vec<&str> = OTHER_SETS.to_vec();
        for name in of_stage(Stage::Compute).filter(|name| !OTHER_SETS.contains(name)) {
            let program = Program::new(&device, name, vec![library.module(name).unwrap()]).unwrap();
            Pipeline::compute(&device, name, &program).unwrap();
            made.push(name);
        }
        for fragment in of_stage(Stage::Fragment).filter(|name| !OTHER_SETS.contains(name)) {
            let inputs: Vec<_> = interface(fragment).inputs.iter().map(takes).collect();
            // Every vertex shader of its folder, or of all papers, that feeds it.
            let near = |name: &&str| folder(name) == folder(fragment) || folder(name) == "common";
            let feeds = |name: &&str| {
                let outputs: Vec<_> = interface(name).outputs.iter().map(takes).collect();
                inputs.iter().all(|input| outputs.contains(input))
            };
            for vertex in of_stage(Stage::Vertex).filter(near).filter(feeds) {
                let modules = [vertex, fragment].map(|name| library.module(name).unwrap());
                // Two that are never used together may disagree about a binding.
                if draw_pipeline(&device, modules).is_ok() {
                    made.extend([vertex, fragment]);
                }
            }
        }
        let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
        assert!(messages.is_empty(), "{compiler}: {messages:#?}");
        let left = EMBEDDED.iter().filter(|s| s.stage != Stage::Geometry && !made.contains(&s.name));
        assert_eq!(left.map(|s| s.name).collect::<Vec<_>>(), [""; 0], "{compiler}");
    }
}
