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
//! for a draw that is a few comparisons of integers. Each line names the tests that try it under validation, by their files: of
//! `tests/suite/gpu` and `tests/suite/faults`, and what needs the inside of the layer, as failed waits, devices of lower limits
//! and swapchains, of `src/gpu`. `house` holds that each line has tests and that they are there.
//!
//! | a caller cannot | because | checked by | tried by |
//! | --- | --- | --- | --- |
//! | draw vertices, instances or indices that are not bound | each draw is compared with the bound buffers' lengths | [`Draw`] | `misuse_passes::draws_beyond_what_is_bound_are_refused` |
//! | fetch or store beyond a buffer in a shader, or by an index | every device is opened with `robustBufferAccess` | [`Device::open`] | `misuse_passes::shaders_that_reach_beyond_a_buffer_hit_nothing_else`, `misuse_passes::an_indirect_draw_stays_inside_its_buffers` |
//! | draw indirectly beyond the index buffer, or dispatch indirectly more than the device takes | a kernel before the pass clamps the parameters, which the host never sees | `indirect` | `misuse_passes::an_indirect_draw_stays_inside_its_buffers`, `indirect::an_indirect_dispatch_takes_what_the_last_pass_wrote_within_the_devices_limits` |
//! | use larger indices than the device takes | vertices are counted; without `fullDrawIndexUint32` a kernel before the pass keeps the values, which the host never sees, at the largest | `pass_check`, `indirect` | `misuse_passes::draws_beyond_what_is_bound_are_refused`, `limits::indices_beyond_the_largest_are_not_drawn` |
//! | dispatch more workgroups than the device takes | each count is compared with its limits; elements lie in rows of workgroups where the shader numbers them so | [`Dispatch`] | `misuse_passes::more_workgroups_than_the_device_takes_are_refused` |
//! | give a stage more inputs, outputs, vertices, threads, shared memory, descriptors or attachments than the device takes | the reflected binaries are compared with the device's limits before anything is made of them, alone and in sum | `stage_limits` | `limits::nothing_is_made_beyond_the_limits`, `misuse_shaders::stages_keep_to_the_limits_of_the_device` |
//! | make images, attachments, buffers, samplers or blocks of memory beyond the device's limits, or larger than their heap | each is compared; blocks are of sizes that every heap holds | [`Image::new`], [`Buffer::new`], [`Sampler::new`], `memory` | `limits::nothing_is_made_beyond_the_limits`, `resources::sizes_beyond_the_device_are_refused_before_it_is_asked`, `resources::more_memory_than_there_is_is_refused`, `memory::blocks_are_no_larger_than_the_heaps_that_they_come_from` |
//! | give constants of another type than declared, none, or some to a pass without | types are compared by `TypeId`, a draw wants them set | [`Draw`], [`Dispatch`] | `misuse_passes::constants_are_those_declared_and_are_set_first` |
//! | give a host struct another layout than its block's | fields are compared with the reflected binary | [`pass::PassBuilder::build`] | `pass_desc::constants_that_do_not_fit_are_named`, `pass_desc::vertices_that_do_not_fit_are_named` |
//! | leave a descriptor unwritten, or write one of another kind, shape, format, alignment or size | each is compared with the reflected binding, the resource's usage and the limits | `bindings` | `pass_desc::a_binding_that_does_not_fit_is_named`, `misuse_passes::what_is_bound_was_made_for_it` |
//! | join stages that do not fit, a geometry stage that emits nothing, or attachments that no stage writes | inputs, outputs and formats are compared | `pass_check`, `stage_limits` | `misuse_passes::stages_fit_each_other_and_their_pass`, `misuse_passes::attachments_take_what_the_shaders_write_and_the_device_blends`, `misuse_shaders::geometry_stages_emit_something`, `misuse_shaders::inputs_and_outputs_have_locations_of_their_own` |
//! | draw points without a size | the vertex stage must store one | `pass_check` | `misuse_shaders::points_have_a_size` |
//! | filter a texture whose format the device does not filter, by a comparison, or with a filter that it lacks | the pairs of textures and samplers in the binaries are compared with formats and filters | `pass_check`, [`Sampler::new`] | `misuse_shaders::textures_are_filtered_where_the_device_does`, `misuse_shaders::no_sampler_is_taken_for_one_that_compares`, `misuse_shaders::samplers_filter_in_two_ways` |
//! | sample one image by several stages, some of which do not wait for it | the image's first barrier is one for all of them | `bindings` | `misuse_shaders::two_stages_sample_one_image`, `misuse_shaders::views_of_one_image_are_sampled_by_several_stages` |
//! | let counting draws read what the pass does not bind | their binary is compared with the pass's own descriptors | `pass_check` | `misuse_shaders::counting_draws_filter_what_the_device_does_and_read_what_the_pass_binds` |
//! | draw into an image of three dimensions, fill it from the host, or bind it as one of two | its uses are refused, shapes are compared | [`Image::new`], `bindings` | `misuse_targets::images_of_three_dimensions_have_no_layers_and_are_no_targets` |
//! | want what a device was not opened with: stages, stores, capabilities, extensions of SPIR-V, blending, formats | the features are asked for each | `pass_check`, `program`, `shader`, [`Image::new`] | `misuse_passes::what_a_device_was_not_opened_with_is_refused`, `misuse_passes::resources_are_such_as_the_device_has`, `misuse_passes::attachments_take_what_the_shaders_write_and_the_device_blends` |
//! | touch what a pass writes a second time in that pass | uses are compared with each other | `pass_check` | `misuse_passes::what_is_written_is_touched_once` |
//! | write depth that a pass only tests, or fill it with what lies outside 0 to 1 | loads, clear values and the tests of counting draws are compared; hosts upload none | `render_pass`, `pass_check`, [`transfer`] | `misuse_targets::depth_is_cleared_to_what_it_can_hold`, `misuse_targets::depth_that_is_only_tested_keeps_what_it_holds`, `misuse_targets::counting_draws_write_no_attachment_that_is_read_only`, `misuse_targets::depth_is_not_uploaded` |
//! | clear integers to something else | clear values are compared with the format's range, and given in its type | `render_pass` | `misuse_targets::integers_are_cleared_to_integers` |
//! | read what nothing has written, but for storage that the pass may write itself | each layer and byte range knows if it was | `barrier` | `refusals::a_sampled_image_must_be_written_in_every_layer`, `refusals::a_storage_buffer_that_is_only_read_must_be_written_in_every_byte`, `refusals::a_target_that_keeps_its_contents_must_have_some`, `refusals::vertices_and_copies_must_have_a_source` |
//! | copy more than fits, between formats, or onto itself | sizes, formats and ranges are compared | [`transfer`] | `misuse_passes::copies_fit` |
//! | leave an image's tracked layout wrong by an error, a panic or a failed submission | states are committed when the submission has finished | `tracked` | `misuse::a_frame_that_is_given_up_leaves_no_trace`, `tests::after_a_failed_wait_nothing_is_dropped_that_the_device_may_read` |
//! | go on with a frame after an error in it, that of a wait between two submissions included | the frame refuses, and is not submitted | [`Frame`] | `misuse::an_error_that_is_passed_over_stops_the_frame`, `tests::a_failed_wait_within_a_frame_ends_it` |
//! | use a resource of an unfinished frame in another, on this thread or another | one submission holds it; the second is refused with [`Error::InUse`] | `tracked` | `misuse::what_an_unfinished_frame_uses_is_kept_from_all_others` |
//! | read or write mapped memory that the device uses, or read what was not made visible | the same hold, with readers of its own | [`Buffer::read`], [`Buffer::write`] | `misuse::mapped_memory_is_lent_to_readers_alone_and_only_what_was_written_for_them`, `misuse::a_copy_into_a_longer_buffer_is_read_as_far_as_it_reaches` |
//! | submit from two threads at once | the queue has a lock; command pools belong to one recorder each | [`Device`] | `misuse::two_threads_record_and_submit_at_once` |
//! | free what the device may still read after a failed wait | it is kept until the device is idle or lost, and otherwise leaked on purpose | `commands` | `tests::after_a_failed_wait_nothing_is_dropped_that_the_device_may_read`, `swapchains::after_a_failed_wait_a_swapchain_stays_with_its_surface` |
//! | count with the device's own counters without their lock, or round part of a command buffer | the counting holds the lock, which a device has once, from before the first replay, and the counted pass is a submission of its own | [`Counting`], [`Frame`] | `limits::a_device_has_its_profiling_lock_once`, `lent::counters_of_the_device_are_those_of_the_pass`, `lent::a_count_that_fails_leaves_neither_lock_nor_queries` |
//! | present by an instance without surfaces, have two swapchains on one surface, or make them at once | the device asks for both extensions; a surface knows its swapchain and has a lock | [`Device::open_presenting`](device::Device), `swapchain` | `swapchains::a_device_presents_by_an_instance_with_surfaces`, `swapchains::a_surface_has_one_swapchain_at_a_time`, `swapchains::threads_want_one_surface` |
//! | present what is not drawn, of another format or of several layers | it is compared before an image is acquired | `swapchain` | `swapchains::pictures_fit_their_swapchain` |
//! | mix objects of two devices, or of two instances | each knows its own | [`Error::Foreign`] | `misuse::objects_of_another_device_are_refused`, `misuse::a_device_is_opened_as_it_is_and_where_it_was_found` |
//! | bind to a pass attachments of other formats | formats are compared with the first pass's | [`pass::RebindBuilder::build`] | `misuse_passes::rebinding_keeps_to_what_the_pass_is` |
//! | end a name early by a zero in it, or name what another thread uses | zeros are left out; objects are named when they are made | [`Device`] | `misuse::names_may_hold_anything`, `misuse::passes_are_bound_anew_while_they_are_recorded` |
//! | ask a device of an older Vulkan for what is newer | its version is asked first | `physical` | `masks::a_device_of_an_older_vulkan_is_listed_and_refused` |
//!
//! Two recorders on two threads record at the same time as long as they share no resource; whoever wants to share one
//! waits for the other's `run` to return.
//!
//! Not checked here: the inside of a shader, its loops, what it does with shared memory and built-ins. Shaders are built
//! in, and a test makes every pipeline under validation; run with `--validate` what `--shader-dir` replaces. A texel
//! fetch beyond an image gives undefined values, as Vulkan defines it. Nor are
//!
//! - reads of storage that a pass may write: of every storage image, and of storage buffers that a shader does not declare
//!   `readonly`. Such a pass may be the first to write them, and is recorded whether anything has written them or not; what it
//!   reads of them before it writes is undefined then. Behind it all that was bound so counts as written, also where its
//!   shader wrote a part;
//! - draws and dispatches in one body of a pass that write the same storage. Barriers lie before a recording of a pass and
//!   never inside it: those of one body may run at the same time and in any order, and what one of them is to see of
//!   another's writes wants a recording of its own, such as another call of [`Frame::compute`] with the same pass.

pub mod access;
mod backtraces;
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
mod pipeline_store;
mod portability;
mod profiling_lock;
pub mod program;
mod query;
mod rebind;
mod recorder;
pub mod render_pass;
mod replacements;
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
pub use backtraces::keep_errors_untraced;
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
pub use replacements::{Replacements, built_in_shader_bytes, take_compiled};
pub use sample::{Counts, FrameSample, Mode, PassSample, Span, Track};
pub use shader::{Compiler, ShaderLibrary, warm_up_compilers};
pub use threads::{draw_in_place, for_another_process, pin_software_threads};
pub use work::{Bytes, Kept, Work};
