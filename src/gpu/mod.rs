//! The explicit Vulkan layer. It knows no paper.
//!
//! - **Synchronisation**: [`Frame`] alone. Each pass declares its reads and writes; barriers are derived from them
//!   ([`access`]) and recorded by the one envelope. Passes run in the order they are written.
//! - **Lifetimes**: every object is an `Arc` with `Drop` and holds its parents; a frame holds its passes
//!   until its fence, and each recorder has one frame in flight.
//! - **Errors**: [`Error`], one line each. An error of a pass ends its frame, which is not submitted.
//!
//! # Misuse that no caller can commit
//!
//! No safe call of this layer breaks a rule of Vulkan. What the types do not rule out is checked before it is recorded;
//! for a draw that is a few comparisons of integers. Every line is tried under validation: in `tests/suite/gpu` by
//! `misuse.rs`, `misuse_passes.rs`, `misuse_targets.rs` and `misuse_shaders.rs`, what a build refuses also by
//! `pass_desc.rs`, reads of nothing by `refusals.rs`; failed waits, devices of lower limits and swapchains in
//! `src/gpu/tests.rs`.
//!
//! | a caller cannot | because | checked by |
//! | --- | --- | --- |
//! | draw vertices, instances or indices that are not bound | each draw is compared with the bound buffers' lengths | [`Draw`] |
//! | fetch or store beyond a buffer in a shader, or by an index | every device is opened with `robustBufferAccess` | [`Device::open`] |
//! | draw indirectly beyond the index buffer, or dispatch indirectly more than the device takes | a kernel before the pass clamps the parameters, which the host never sees | `indirect` |
//! | use larger indices than the device takes | vertices are counted; without `fullDrawIndexUint32` a kernel before the pass keeps the values, which the host never sees, at the largest | `pass_check`, `indirect` |
//! | dispatch more workgroups than the device takes | each count is compared with its limits; elements lie in rows of workgroups where the shader numbers them so | [`Dispatch`] |
//! | give a stage more inputs, outputs, vertices, threads, shared memory, descriptors or attachments than the device takes | the reflected binaries are compared with the device's limits before anything is made of them, alone and in sum | `stage_limits` |
//! | make images, attachments, buffers, samplers or blocks of memory beyond the device's limits, or larger than their heap | each is compared; blocks are of sizes that every heap holds | [`Image::new`], [`Buffer::new`], [`Sampler::new`], `memory` |
//! | give constants of another type than declared, none, or some to a pass without | types are compared by `TypeId`, a draw wants them set | [`Draw`], [`Dispatch`] |
//! | give a host struct another layout than its block's | fields are compared with the reflected binary | [`pass::PassBuilder::build`] |
//! | leave a descriptor unwritten, or write one of another kind, shape, format, alignment or size | each is compared with the reflected binding, the resource's usage and the limits | `bindings` |
//! | join stages that do not fit, a geometry stage that emits nothing, or attachments that no stage writes | inputs, outputs and formats are compared | `pass_check`, `stage_limits` |
//! | draw points without a size | the vertex stage must store one | `pass_check` |
//! | filter a texture whose format the device does not filter, by a comparison, or with a filter that it lacks | the pairs of textures and samplers in the binaries are compared with formats and filters | `pass_check`, [`Sampler::new`] |
//! | sample one image by several stages, some of which do not wait for it | the image's first barrier is one for all of them | `bindings` |
//! | let counting draws read what the pass does not bind | their binary is compared with the pass's own descriptors | `pass_check` |
//! | draw into an image of three dimensions, fill it from the host, or bind it as one of two | its uses are refused, shapes are compared | [`Image::new`], `bindings` |
//! | want what a device was not opened with: stages, stores, capabilities, extensions of SPIR-V, blending, formats | the features are asked for each | `pass_check`, `program`, `shader`, [`Image::new`] |
//! | touch what a pass writes a second time in that pass | uses are compared with each other | `pass_check` |
//! | write depth that a pass only tests, or fill it with what lies outside 0 to 1 | loads, clear values and the tests of counting draws are compared; hosts upload none | `render_pass`, `pass_check`, [`transfer`] |
//! | clear integers to something else | clear values are compared with the format's range, and given in its type | `render_pass` |
//! | read what nothing has written | each layer and byte range knows if it was | `barrier` |
//! | copy more than fits, between formats, or onto itself | sizes, formats and ranges are compared | [`transfer`] |
//! | leave an image's tracked layout wrong by an error, a panic or a failed submission | states are committed when the submission has finished | `tracked` |
//! | go on with a frame after an error in it, that of a wait between two submissions included | the frame refuses, and is not submitted | [`Frame`] |
//! | use a resource of an unfinished frame in another, on this thread or another | one submission holds it; the second is refused with [`Error::InUse`] | `tracked` |
//! | read or write mapped memory that the device uses, or read what was not made visible | the same hold, with readers of its own | [`Buffer::read`], [`Buffer::write`] |
//! | submit from two threads at once | the queue has a lock; command pools belong to one recorder each | [`Device`] |
//! | free what the device may still read after a failed wait | it is kept until the device is idle or lost, and otherwise leaked on purpose | `commands` |
//! | count with the device's own counters without their lock, or round part of a command buffer | the counting holds the lock, which a device has once, from before the first replay, and the counted pass is a submission of its own | [`Counting`], [`Frame`] |
//! | present by an instance without surfaces, have two swapchains on one surface, or make them at once | the device asks for both extensions; a surface knows its swapchain and has a lock | [`Device::open_presenting`](device::Device), `swapchain` |
//! | present what is not drawn, of another format or of several layers | it is compared before an image is acquired | `swapchain` |
//! | mix objects of two devices, or of two instances | each knows its own | [`Error::Foreign`] |
//! | bind to a pass attachments of other formats | formats are compared with the first pass's | [`pass::RebindBuilder::build`] |
//! | end a name early by a zero in it, or name what another thread uses | zeros are left out; objects are named when they are made | [`Device`] |
//! | ask a device of an older Vulkan for what is newer | its version is asked first | `physical` |
//!
//! Two recorders on two threads record at the same time as long as they share no resource; whoever wants to share one
//! waits for the other's `run` to return.
//!
//! Not checked here: the inside of a shader, its loops, what it does with shared memory and built-ins. Shaders are built
//! in, and a test makes every pipeline under validation; run with `--validate` what `--shader-dir` replaces. A texel
//! fetch beyond an image gives undefined values, as Vulkan defines it.

pub mod access;
mod barrier;
pub mod bindings;
pub mod buffer;
mod capture;
mod commands;
pub mod device;
mod draw;
pub mod error;
mod executable;
mod extensions;
mod format;
pub mod frame;
pub mod image;
mod indirect;
pub mod instance;
pub mod live;
mod memory;
pub mod messages;
pub mod pass;
mod pass_builder;
mod pass_check;
mod pass_info;
mod performance;
pub mod physical;
pub mod pipeline;
mod portability;
mod profiling_lock;
pub mod program;
mod query;
mod rebind;
mod recorder;
pub mod render_pass;
mod sample;
pub mod shader;
mod stage_limits;
#[cfg(feature = "window")]
pub mod surface;
#[cfg(feature = "window")]
pub mod swapchain;
#[cfg(test)]
mod tests;
mod threads;
mod tracked;
pub mod transfer;
mod work;

pub use access::{Access, Stages};
pub use buffer::{Buffer, BufferDesc, BufferView, Location};
pub use capture::RenderDoc;
pub use device::Device;
pub use draw::{Dispatch, Draw};
pub use error::Error;
pub use executable::{Executable, ExecutableStatistic};
pub use extensions::Extension;
pub use frame::Frame;
pub use image::{Image, ImageDesc, ImageView, Sampler};
pub use instance::Instance;
pub use pass::Pass;
pub use pass_info::{Binary, PassInfo, PassKind};
pub use performance::{CounterValue, Counting, PerformanceCounter, PerformanceReadings};
pub use physical::{Feature, PhysicalDevice};
pub use pipeline::Topology;
pub use recorder::Recorder;
pub use render_pass::{Blend, DepthTest, Load};
pub use sample::{Counts, FrameSample, Mode, PassSample, Span, Track};
pub use shader::{Compiler, ShaderLibrary};
pub use threads::{draw_in_place, for_another_process, pin_software_threads};
pub use work::{Bytes, Kept, Work};
