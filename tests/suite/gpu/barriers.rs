//! The barriers derived from sequences of declared accesses, against masks and layouts written by hand from the Vulkan
//! specification (chapter "Synchronization and Cache Control": dependencies, access types, layout transitions).

use ash::vk::{AccessFlags2 as A, ImageLayout as L, PipelineStageFlags2 as S};
use fumarole::gpu::access::{Barrier, State, derive};
use fumarole::gpu::{Access, Stages};

const DEPTH_STAGES: S = S::from_raw(S::EARLY_FRAGMENT_TESTS.as_raw() | S::LATE_FRAGMENT_TESTS.as_raw());

/// The barrier before each access of a sequence; `true` discards the contents before it.
fn barriers(start: State, is_image: bool, accesses: &[(Access, bool)]) -> Vec<Option<Barrier>> {
    let mut state = start;
    let mut barriers = Vec::new();
    for &(access, discard) in accesses {
        let (barrier, after) = derive(&state, access.info(), discard, is_image);
        barriers.push(barrier);
        state = after;
    }
    barriers
}

fn image_barriers(accesses: &[(Access, bool)]) -> Vec<Option<Barrier>> {
    barriers(State::NEW, true, accesses)
}

fn buffer_barriers(start: State, accesses: &[Access]) -> Vec<Option<Barrier>> {
    let accesses: Vec<_> = accesses.iter().map(|&a| (a, false)).collect();
    barriers(start, false, &accesses)
}

/// Source stages and accesses, destination stages and accesses, layouts.
fn transition(source: (S, A), destination: (S, A), layouts: (L, L)) -> Option<Barrier> {
    Some(Barrier {
        src_stages: source.0,
        src_access: source.1,
        dst_stages: destination.0,
        dst_access: destination.1,
        old_layout: layouts.0,
        new_layout: layouts.1,
    })
}

fn memory(source: (S, A), destination: (S, A)) -> Option<Barrier> {
    transition(source, destination, (L::UNDEFINED, L::UNDEFINED))
}

const NOTHING: (S, A) = (S::NONE, A::NONE);
const COLOR_WRITE: (S, A) = (S::COLOR_ATTACHMENT_OUTPUT, A::COLOR_ATTACHMENT_WRITE);
const COLOR_USE: (S, A) =
    (S::COLOR_ATTACHMENT_OUTPUT, A::from_raw(A::COLOR_ATTACHMENT_READ.as_raw() | A::COLOR_ATTACHMENT_WRITE.as_raw()));
const DEPTH_WRITE: (S, A) = (DEPTH_STAGES, A::DEPTH_STENCIL_ATTACHMENT_WRITE);
const DEPTH_USE: (S, A) =
    (DEPTH_STAGES, A::from_raw(A::DEPTH_STENCIL_ATTACHMENT_READ.as_raw() | A::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()));
const FRAGMENT_SAMPLES: (S, A) = (S::FRAGMENT_SHADER, A::SHADER_SAMPLED_READ);
const COMPUTE_WRITE: (S, A) = (S::COMPUTE_SHADER, A::SHADER_STORAGE_WRITE);
const COMPUTE_USE: (S, A) =
    (S::COMPUTE_SHADER, A::from_raw(A::SHADER_STORAGE_READ.as_raw() | A::SHADER_STORAGE_WRITE.as_raw()));

const COMPUTE_STORES: Access = Access::StorageWrite(Stages::COMPUTE);
const FRAGMENT_READS: Access = Access::SampledRead(Stages::FRAGMENT);
const FRAGMENT_STORAGE: Access = Access::StorageRead(Stages::FRAGMENT);

#[test]
fn a_new_target_comes_from_undefined_and_its_reader_waits_for_the_write() {
    let (color, read) = (L::COLOR_ATTACHMENT_OPTIMAL, L::SHADER_READ_ONLY_OPTIMAL);
    assert_eq!(
        image_barriers(&[(Access::ColorTarget, true), (FRAGMENT_READS, false)]),
        [
            transition(NOTHING, COLOR_USE, (L::UNDEFINED, color)),
            transition(COLOR_WRITE, FRAGMENT_SAMPLES, (color, read))
        ]
    );
}

#[test]
fn a_write_after_a_read_waits_for_the_reader_without_flushing_it() {
    let (color, read) = (L::COLOR_ATTACHMENT_OPTIMAL, L::SHADER_READ_ONLY_OPTIMAL);
    let last = |discard| {
        let sequence = [(Access::ColorTarget, true), (FRAGMENT_READS, false), (Access::ColorTarget, discard)];
        image_barriers(&sequence)[2]
    };
    // A read has nothing to make available; the transition to the read layout was made by the barrier before it.
    let source = (S::FRAGMENT_SHADER, A::NONE);
    assert_eq!(last(false), transition(source, COLOR_USE, (read, color)));
    assert_eq!(last(true), transition(source, COLOR_USE, (L::UNDEFINED, color)));

    let buffer = buffer_barriers(State::NEW, &[COMPUTE_STORES, Access::VertexRead, COMPUTE_STORES]);
    let write = COMPUTE_WRITE;
    assert_eq!(buffer[1], memory(write, (S::VERTEX_ATTRIBUTE_INPUT, A::VERTEX_ATTRIBUTE_READ)));
    // Order after the reader, and memory after the first write, which the reader's barrier made available already.
    assert_eq!(buffer[2], memory((S::COMPUTE_SHADER | S::VERTEX_ATTRIBUTE_INPUT, write.1), COMPUTE_USE));
}

#[test]
fn a_write_after_a_write_is_ordered_and_keeps_or_discards() {
    let color = L::COLOR_ATTACHMENT_OPTIMAL;
    let kept = image_barriers(&[(Access::ColorTarget, true), (Access::ColorTarget, false)]);
    assert_eq!(kept[1], transition(COLOR_WRITE, COLOR_USE, (color, color)));
    let cleared = image_barriers(&[(Access::ColorTarget, true), (Access::ColorTarget, true)]);
    assert_eq!(cleared[1], transition(COLOR_WRITE, COLOR_USE, (L::UNDEFINED, color)));
    let stored = buffer_barriers(State::NEW, &[COMPUTE_STORES, COMPUTE_STORES]);
    assert_eq!(stored, [None, memory(COMPUTE_WRITE, COMPUTE_USE)]);
}

#[test]
fn the_same_reader_again_needs_no_barrier() {
    let image = image_barriers(&[(Access::ColorTarget, true), (FRAGMENT_READS, false), (FRAGMENT_READS, false)]);
    assert_eq!(image[2], None);
    let both = Access::StorageRead(Stages::VERTEX | Stages::FRAGMENT);
    let buffer = buffer_barriers(State::NEW, &[COMPUTE_STORES, both, Access::StorageRead(Stages::FRAGMENT)]);
    assert_eq!(buffer[2], None, "a part of the stages that see the write already");
}

#[test]
fn a_reader_in_another_stage_waits_for_the_write_too() {
    let in_vertex = Access::StorageRead(Stages::VERTEX);
    let buffer = buffer_barriers(State::NEW, &[COMPUTE_STORES, in_vertex, FRAGMENT_STORAGE, in_vertex]);
    assert_eq!(buffer[1], memory(COMPUTE_WRITE, (S::VERTEX_SHADER, A::SHADER_STORAGE_READ)));
    let second = buffer[2].unwrap();
    assert_eq!((second.src_stages, second.src_access), COMPUTE_WRITE);
    assert!(second.dst_stages.contains(S::FRAGMENT_SHADER) && second.dst_access.contains(A::SHADER_STORAGE_READ));
    assert_eq!(buffer[3], None, "both readers see the write by now");
}

#[test]
fn a_reader_with_another_access_in_a_known_stage_waits_for_the_write_too() {
    let accesses = [COMPUTE_STORES, Access::UniformRead(Stages::VERTEX), Access::StorageRead(Stages::VERTEX)];
    let last = buffer_barriers(State::NEW, &accesses)[2].unwrap();
    assert_eq!((last.src_stages, last.src_access), COMPUTE_WRITE);
    assert!(last.dst_stages.contains(S::VERTEX_SHADER) && last.dst_access.contains(A::SHADER_STORAGE_READ));
}

#[test]
fn a_transition_between_two_readers_waits_for_the_first() {
    let read = L::SHADER_READ_ONLY_OPTIMAL;
    let accesses = [(Access::ColorTarget, true), (FRAGMENT_READS, false), (Access::CopySource, false)];
    let copied = image_barriers(&accesses)[2];
    // The transition writes the image, so the sampling must be over; the colour was made available before.
    assert_eq!(
        copied,
        transition((S::FRAGMENT_SHADER, A::NONE), (S::COPY, A::TRANSFER_READ), (read, L::TRANSFER_SRC_OPTIMAL))
    );
}

#[test]
fn a_reader_after_a_transition_chains_on_it() {
    let read = L::SHADER_READ_ONLY_OPTIMAL;
    let in_compute = Access::SampledRead(Stages::COMPUTE);
    let last = image_barriers(&[(Access::ColorTarget, true), (FRAGMENT_READS, false), (in_compute, false)])[2].unwrap();
    // The transition finished before the fragment stage of the first reader: through it, compute comes after both.
    assert!(last.src_stages.contains(S::FRAGMENT_SHADER));
    assert!(last.dst_stages.contains(S::COMPUTE_SHADER) && last.dst_access.contains(A::SHADER_SAMPLED_READ));
    assert_eq!((last.old_layout, last.new_layout), (read, read));
}

#[test]
fn what_the_host_wrote_before_the_submission_is_read_without_a_barrier() {
    let reads = [Access::CopySource, Access::UniformRead(Stages::FRAGMENT), Access::VertexRead];
    assert_eq!(buffer_barriers(State::HOST_WRITTEN, &reads), [None, None, None]);
    let overwritten = buffer_barriers(State::HOST_WRITTEN, &[Access::VertexRead, COMPUTE_STORES]);
    assert_eq!(overwritten[1], memory((S::VERTEX_ATTRIBUTE_INPUT, A::NONE), COMPUTE_USE));
}

#[test]
fn depth_is_written_then_sampled_then_tested_read_only_then_written() {
    let (write, read_only) = (L::DEPTH_STENCIL_ATTACHMENT_OPTIMAL, L::DEPTH_STENCIL_READ_ONLY_OPTIMAL);
    let sampled = L::SHADER_READ_ONLY_OPTIMAL;
    let accesses = [
        (Access::DepthTarget, true),
        (FRAGMENT_READS, false),
        (Access::DepthReadOnly, false),
        (Access::DepthReadOnly, false),
        (Access::DepthTarget, false),
    ];
    let tests = (DEPTH_STAGES, A::DEPTH_STENCIL_ATTACHMENT_READ);
    assert_eq!(
        image_barriers(&accesses),
        [
            transition(NOTHING, DEPTH_USE, (L::UNDEFINED, write)),
            transition(DEPTH_WRITE, FRAGMENT_SAMPLES, (write, sampled)),
            transition((S::FRAGMENT_SHADER, A::NONE), tests, (sampled, read_only)),
            None,
            transition((DEPTH_STAGES, A::NONE), DEPTH_USE, (read_only, write)),
        ]
    );
}

#[test]
fn a_storage_write_is_fetched_by_vertices_and_written_again() {
    let accesses = [COMPUTE_STORES, Access::VertexRead, Access::IndexRead, COMPUTE_STORES];
    let derived = buffer_barriers(State::NEW, &accesses);
    assert_eq!(derived[0], None);
    assert_eq!(derived[1], memory(COMPUTE_WRITE, (S::VERTEX_ATTRIBUTE_INPUT, A::VERTEX_ATTRIBUTE_READ)));
    let indices = derived[2].unwrap();
    assert!(indices.dst_stages.contains(S::INDEX_INPUT) && indices.dst_access.contains(A::INDEX_READ));
    let again = derived[3].unwrap();
    let readers = S::COMPUTE_SHADER | S::VERTEX_ATTRIBUTE_INPUT | S::INDEX_INPUT;
    assert_eq!((again.src_stages, again.dst_stages, again.dst_access), (readers, COMPUTE_USE.0, COMPUTE_USE.1));
}

#[test]
fn a_copy_is_made_visible_to_the_host_and_to_indirect_draws() {
    let copy = (S::COPY, A::TRANSFER_WRITE);
    let host = buffer_barriers(State::NEW, &[Access::CopyDestination, Access::HostRead]);
    assert_eq!(host, [None, memory(copy, (S::HOST, A::HOST_READ))]);
    let indirect = buffer_barriers(State::NEW, &[Access::CopyDestination, Access::IndirectRead]);
    assert_eq!(indirect[1], memory(copy, (S::DRAW_INDIRECT, A::INDIRECT_COMMAND_READ)));
}

#[test]
fn a_storage_image_is_general_and_stays_so_between_writer_and_reader() {
    let accesses = [(COMPUTE_STORES, true), (Access::StorageRead(Stages::FRAGMENT), false)];
    assert_eq!(
        image_barriers(&accesses),
        [
            transition(NOTHING, COMPUTE_USE, (L::UNDEFINED, L::GENERAL)),
            transition(COMPUTE_WRITE, (S::FRAGMENT_SHADER, A::SHADER_STORAGE_READ), (L::GENERAL, L::GENERAL)),
        ]
    );
}
