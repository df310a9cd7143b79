//! Tests that need the layer's inside: a barrier left out is reported, and every shader makes a pipeline.

mod limits;
#[cfg(all(feature = "window", unix))]
mod swapchains;

use std::cell::RefCell;
use std::env;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use ash::vk;

use super::access::{Access, AccessInfo, State, derive};
use super::live::Kind;
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

/// Held by each of these tests: the layer (1.3.239) looks its devices up in a table without a lock, so that one that is made
/// or dropped takes the ground from under the calls of all others.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

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

/// Failures that the hooks below answer with on this thread, and the functions that they stand before.
struct Hooks {
    wait: vk::PFN_vkWaitForFences,
    idle: vk::PFN_vkDeviceWaitIdle,
    failing_waits: u32,
    failing_idles: u32,
}

thread_local! {
    static HOOKS: RefCell<Option<Hooks>> = const { RefCell::new(None) };
}

unsafe extern "system" fn wait_hook(
    device: vk::Device,
    count: u32,
    fences: *const vk::Fence,
    all: vk::Bool32,
    timeout_ns: u64,
) -> vk::Result {
    HOOKS.with_borrow_mut(|hooks| {
        let Some(hooks) = hooks else { return vk::Result::ERROR_UNKNOWN };
        if hooks.failing_waits > 0 {
            hooks.failing_waits -= 1;
            return vk::Result::ERROR_OUT_OF_HOST_MEMORY;
        }
        // SAFETY: the caller's arguments go through unchanged.
        unsafe { (hooks.wait)(device, count, fences, all, timeout_ns) }
    })
}

unsafe extern "system" fn idle_hook(device: vk::Device) -> vk::Result {
    HOOKS.with_borrow_mut(|hooks| {
        let Some(hooks) = hooks else { return vk::Result::ERROR_UNKNOWN };
        if hooks.failing_idles > 0 {
            hooks.failing_idles -= 1;
            return vk::Result::ERROR_OUT_OF_HOST_MEMORY;
        }
        // SAFETY: as above.
        unsafe { (hooks.idle)(device) }
    })
}

fn fail(waits: u32, idles: u32) {
    HOOKS.with_borrow_mut(|hooks| {
        let hooks = hooks.as_mut().unwrap();
        (hooks.failing_waits, hooks.failing_idles) = (waits, idles);
    });
}

/// The device, which nobody else has, with waits that fail when [`fail`] says so, as they may when memory runs out.
fn failing(device: Arc<Device>) -> Arc<Device> {
    let mut device = Arc::into_inner(device).unwrap();
    let raw = &device.raw;
    let mut first = raw.fp_v1_0().clone();
    let hooks = Hooks { wait: first.wait_for_fences, idle: first.device_wait_idle, failing_waits: 0, failing_idles: 0 };
    HOOKS.set(Some(hooks));
    first.wait_for_fences = wait_hook;
    first.device_wait_idle = idle_hook;
    device.raw = ash::Device::from_parts_1_3(
        raw.handle(),
        first,
        raw.fp_v1_1().clone(),
        raw.fp_v1_2().clone(),
        raw.fp_v1_3().clone(),
    );
    Arc::new(device)
}

#[test]
fn after_a_failed_wait_nothing_is_dropped_that_the_device_may_read() {
    let _alone = alone();
    let device = failing(open_device());
    let live = device.live().clone();
    let count = |kind| live.alive().iter().find(|(k, _)| *k == kind).map_or(0, |(_, n)| *n);
    let shaders = ShaderLibrary::new(&device, Compiler::Glslang, None).unwrap();
    let clear = |recorder: &mut Recorder, value: f32| {
        let target = color_target(&device, "target", vk::Format::R8G8B8A8_UNORM);
        let pass = Pass::graphics("clear", "", "test/asymmetric.vert", "test/asymmetric.frag")
            .color(&target, Load::Clear([value; 4]), Blend::Replace)
            .build(&shaders)
            .unwrap();
        let outcome = recorder.run(Mode::Timestamped, |frame| frame.graphics(&pass, |_| {}));
        (target, outcome.map(|_| ()).map_err(|error: Error| error.to_string()))
    };
    let failure = "a submission (waiting for)";
    let mut recorder = Recorder::new(&device).unwrap();

    // The wait fails, and the device turns out to be idle: what was submitted is done.
    fail(1, 0);
    let (target, outcome) = clear(&mut recorder, 1.0);
    assert!(outcome.clone().is_err_and(|text| text.contains(failure)), "{outcome:?}");
    assert_eq!(transfer::read_image(&device, &target).unwrap(), [255; 256]);
    drop(target);

    // Nobody knows that it is idle: its target lives on, in use.
    fail(1, 1);
    let (target, outcome) = clear(&mut recorder, 1.0);
    assert!(outcome.is_err());
    let refused = transfer::read_image(&device, &target).unwrap_err().to_string();
    assert!(refused.contains("target is in use"), "{refused}");
    drop(target);
    assert_eq!((count(Kind::Image), count(Kind::Framebuffer)), (1, 1));
    // The next frame asks again, in vain and then with success.
    fail(0, 1);
    let (_, outcome) = clear(&mut recorder, 1.0);
    assert!(outcome.is_err_and(|text| text.contains("earlier submission")));
    let (target, outcome) = clear(&mut recorder, 1.0);
    assert_eq!(outcome, Ok(()));
    assert_eq!((count(Kind::Image), count(Kind::Framebuffer)), (1, 0));
    drop(target);

    // The recorder goes before anybody knows: all of it is leaked on purpose.
    // By the submission, by the recorder's drop and by its command buffer's.
    fail(1, 3);
    let (target, outcome) = clear(&mut recorder, 1.0);
    assert!(outcome.is_err());
    drop((target, recorder, shaders));
    let leaked = [Kind::Image, Kind::Framebuffer, Kind::Pipeline, Kind::CommandPool, Kind::Fence, Kind::Device];
    assert_eq!(leaked.map(count), [1; 6]);
    assert!(count(Kind::QueryPool) > 0);
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{messages:#?}");
}

#[test]
fn a_failed_wait_within_a_frame_ends_it() {
    let _alone = alone();
    let device = failing(open_device());
    let shaders = ShaderLibrary::new(&device, Compiler::Glslang, None).unwrap();
    let target = color_target(&device, "target", vk::Format::R8G8B8A8_UNORM);
    let clear = Pass::graphics("clear", "", "test/asymmetric.vert", "test/asymmetric.frag")
        .color(&target, Load::Clear([1.0; 4]), Blend::Replace)
        .build(&shaders)
        .unwrap();
    let mut recorder = Recorder::new(&device).unwrap();
    let outcome = recorder.run(Mode::Plain, |frame| {
        frame.graphics(&clear, |_| {})?;
        fail(1, 0);
        assert!(frame.wait_for(&clear).is_err());
        // Its command buffer is not recorded into any more.
        let refused = frame.graphics(&clear, |_| {}).unwrap_err().to_string();
        assert!(refused.contains("goes no further"), "{refused}");
        Ok::<(), Error>(())
    });
    assert!(outcome.is_err_and(|error| error.to_string().contains("goes no further")));
    recorder.run(Mode::Plain, |frame| frame.graphics(&clear, |_| {})).unwrap();
    let messages: Vec<String> = device.instance().take_messages().iter().map(ToString::to_string).collect();
    assert!(messages.is_empty(), "{messages:#?}");
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
            let submission = frame.recorder.commands.submission;
            let forget = |state: &mut State| *state = State::HOST_WRITTEN;
            assert!(sums.with_states(submission, 0..sums.size_bytes(), forget).is_ok());
        }
        record(frame, &second)
    });
    outcome.map(|_| ()).unwrap_or_else(|error: Error| panic!("{error}"));
    device.instance().take_messages()
}

#[test]
fn a_missing_barrier_between_kernels_is_reported() {
    let _alone = alone();
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
        frame.graphics(&draw, |draw| draw.vertices(3))?;
        if forget {
            let submission = frame.recorder.commands.submission;
            assert!(target.image().with_states(submission, 0..1, |states| states.fill(forgotten)).is_ok());
        }
        frame.copy(&copy)
    });
    outcome.map(|_| ()).unwrap_or_else(|error: Error| panic!("{error}"));
    device.instance().take_messages()
}

#[test]
fn a_transition_that_waits_for_nothing_is_reported() {
    let _alone = alone();
    let device = open_device();
    assert!(draw_and_copy(&device, false).is_empty(), "with its barrier");
    let messages = draw_and_copy(&device, true);
    let names_canvas = |m: &Message| m.objects.contains(&"canvas".to_owned());
    assert!(messages.iter().any(|m| m.id == "SYNC-HAZARD-WRITE-AFTER-WRITE" && names_canvas(m)), "{messages:?}");
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
        bytes: 16,
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
    let _alone = alone();
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
