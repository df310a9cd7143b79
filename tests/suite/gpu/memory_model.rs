//! Random sequences of accesses run through a small model of Vulkan's memory dependencies: with the derived barriers
//! every read sees the last write and no hazard is left.

use ash::vk::{AccessFlags2, ImageLayout, PipelineStageFlags2};
use fumarole::gpu::access::{AccessInfo, Barrier, State, derive};
use fumarole::gpu::{Access, Stages};
use proptest::prelude::*;

const WRITES: AccessFlags2 = AccessFlags2::from_raw(
    AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw()
        | AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()
        | AccessFlags2::SHADER_STORAGE_WRITE.as_raw()
        | AccessFlags2::TRANSFER_WRITE.as_raw(),
);

/// One access by one stage.
#[derive(Clone, Debug)]
struct Event {
    stage: PipelineStageFlags2,
    access: AccessFlags2,
    /// The stages whose later work runs after it.
    before: PipelineStageFlags2,
}

impl Event {
    /// Extends the execution dependency when the barrier waits for the event or for something that runs after it.
    fn pass(&mut self, barrier: &Barrier) -> bool {
        let chained = barrier.src_stages.intersects(self.stage | self.before);
        if chained {
            self.before |= barrier.dst_stages;
        }
        chained
    }
}

/// True when the barrier waits for all of the events, each of which it passes.
fn wait_for(events: &mut [Event], barrier: &Barrier) -> bool {
    let mut all = true;
    for event in events {
        all &= event.pass(barrier);
    }
    all
}

/// One piece of memory.
#[derive(Clone, Debug, Default)]
struct Memory {
    /// The last write, one event for each stage that wrote.
    writes: Vec<Event>,
    /// Set once the last write has left the caches of its stages.
    available: bool,
    /// Stages and accesses that see it.
    visible: Vec<(PipelineStageFlags2, AccessFlags2)>,
    /// Reads since the last write.
    reads: Vec<Event>,
    layout: ImageLayout,
    /// Set while the last contents are still there.
    intact: bool,
}

impl Memory {
    fn barrier(&mut self, barrier: &Barrier, is_image: bool) -> Result<(), String> {
        let waited = wait_for(&mut self.writes, barrier);
        let waited_reads = wait_for(&mut self.reads, barrier);
        self.available |= self
            .writes
            .iter()
            .all(|w| barrier.src_stages.contains(w.stage) && barrier.src_access.contains(w.access & WRITES));
        if waited && self.available {
            self.visible.push((barrier.dst_stages, barrier.dst_access));
        }
        let transition = is_image && (barrier.old_layout != barrier.new_layout);
        if !transition {
            return Ok(());
        }
        if !(waited && waited_reads && self.available) {
            return Err(format!("a transition that runs into {self:?}"));
        }
        match barrier.old_layout {
            ImageLayout::UNDEFINED => self.intact = false,
            old if old == self.layout => {}
            old => return Err(format!("a transition from {old:?} of an image in {:?}", self.layout)),
        }
        // A transition is a write that is available at once and visible to what the barrier names.
        *self = Memory {
            writes: vec![Event {
                stage: PipelineStageFlags2::NONE,
                access: AccessFlags2::NONE,
                before: barrier.dst_stages,
            }],
            available: true,
            visible: vec![(barrier.dst_stages, barrier.dst_access)],
            reads: Vec::new(),
            layout: barrier.new_layout,
            intact: self.intact,
        };
        Ok(())
    }

    fn sees(&self, stage: PipelineStageFlags2, access: AccessFlags2) -> bool {
        self.writes.is_empty() || self.visible.iter().any(|(s, a)| s.contains(stage) && a.contains(access))
    }

    /// Makes an access, or says what is wrong with it now.
    fn access(&mut self, info: AccessInfo, discard: bool, is_image: bool) -> Result<(), String> {
        if is_image && self.layout != info.layout {
            return Err(format!("in layout {:?} instead of {:?}", self.layout, info.layout));
        }
        if !discard && !self.intact {
            return Err("the contents are lost".into());
        }
        for stage in bits(info.stages) {
            // A discarding access still writes, and its load operation reads what it must not: only the write counts.
            let wanted = if discard { info.access & WRITES } else { info.access };
            for access in access_bits(wanted) {
                if !self.sees(stage, access) {
                    return Err(format!("{stage:?} {access:?} does not see {:?}", self.writes));
                }
            }
            if info.writes {
                let unordered = self.writes.iter().chain(&self.reads).find(|e| !e.before.contains(stage));
                if let Some(event) = unordered {
                    return Err(format!("{stage:?} writes without waiting for {event:?}"));
                }
            }
        }
        let event = |stage| Event { stage, access: info.access, before: PipelineStageFlags2::NONE };
        let events = bits(info.stages).map(event);
        if info.writes {
            self.writes = events.collect();
            self.reads.clear();
            self.visible.clear();
            self.available = false;
            self.intact = true;
        } else {
            self.reads.extend(events);
        }
        Ok(())
    }
}

fn bits(stages: PipelineStageFlags2) -> impl Iterator<Item = PipelineStageFlags2> {
    (0..64).map(|i| PipelineStageFlags2::from_raw(1 << i)).filter(move |&s| stages.contains(s))
}

fn access_bits(access: AccessFlags2) -> impl Iterator<Item = AccessFlags2> {
    (0..64).map(|i| AccessFlags2::from_raw(1 << i)).filter(move |&a| access.contains(a))
}

/// Runs the accesses with the derived barriers; says what went wrong, and which barrier did nothing.
fn run(start: State, is_image: bool, accesses: &[(Access, bool)]) -> Result<(), String> {
    let mut state = start;
    let mut memory = Memory { available: true, intact: state.is_written(), ..Memory::default() };
    for (i, &(access, discard)) in accesses.iter().enumerate() {
        let info = access.info();
        let (barrier, after) = derive(&state, info, discard, is_image);
        state = after;
        let at = |problem| format!("access {i} ({access:?}): {problem}");
        if let Some(barrier) = barrier {
            if memory.clone().access(info, discard, is_image).is_ok() {
                return Err(at(format!("needs no barrier and gets {barrier:?}")));
            }
            memory.barrier(&barrier, is_image).map_err(at)?;
        }
        memory.access(info, discard, is_image).map_err(at)?;
    }
    Ok(())
}

fn stages() -> impl Strategy<Value = Stages> {
    let table = [Stages::VERTEX, Stages::GEOMETRY, Stages::FRAGMENT, Stages::COMPUTE];
    let several = [Stages::VERTEX | Stages::FRAGMENT, Stages::VERTEX | Stages::GEOMETRY | Stages::FRAGMENT];
    prop::sample::select([table.as_slice(), several.as_slice()].concat())
}

fn image_access() -> impl Strategy<Value = (Access, bool)> {
    prop_oneof![
        any::<bool>().prop_map(|discard| (Access::ColorTarget, discard)),
        any::<bool>().prop_map(|discard| (Access::DepthTarget, discard)),
        any::<bool>().prop_map(|discard| (Access::CopyDestination, discard)),
        (stages(), any::<bool>()).prop_map(|(s, discard)| (Access::StorageWrite(s), discard)),
        Just((Access::DepthReadOnly, false)),
        Just((Access::CopySource, false)),
        stages().prop_map(|s| (Access::SampledRead(s), false)),
        stages().prop_map(|s| (Access::SampledRead(s), false)),
        stages().prop_map(|s| (Access::StorageRead(s), false)),
    ]
}

fn buffer_access() -> impl Strategy<Value = (Access, bool)> {
    prop_oneof![
        Just(Access::CopyDestination),
        stages().prop_map(Access::StorageWrite),
        stages().prop_map(Access::StorageRead),
        stages().prop_map(Access::UniformRead),
        Just(Access::VertexRead),
        Just(Access::IndexRead),
        Just(Access::IndirectRead),
        Just(Access::CopySource),
        Just(Access::HostRead),
    ]
    .prop_map(|access| (access, false))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2_000, ..ProptestConfig::default() })]

    #[test]
    fn an_image_is_never_in_a_hazard(accesses in prop::collection::vec(image_access(), 1..12)) {
        // The first access gives the contents, as every frame that is recorded makes sure.
        let mut accesses = accesses;
        accesses.insert(0, (Access::ColorTarget, true));
        prop_assert_eq!(run(State::NEW, true, &accesses), Ok(()));
    }

    #[test]
    fn a_buffer_written_by_the_host_is_never_in_a_hazard(accesses in prop::collection::vec(buffer_access(), 1..12)) {
        prop_assert_eq!(run(State::HOST_WRITTEN, false, &accesses), Ok(()));
    }

    #[test]
    fn a_buffer_written_by_a_pass_is_never_in_a_hazard(accesses in prop::collection::vec(buffer_access(), 1..12)) {
        let mut accesses = accesses;
        accesses.insert(0, (Access::CopyDestination, true));
        prop_assert_eq!(run(State::NEW, false, &accesses), Ok(()));
    }
}

#[test]
fn the_model_itself_finds_every_kind_of_missing_barrier() {
    let fragment = Access::SampledRead(Stages::FRAGMENT).info();
    let color = Access::ColorTarget.info();
    let (_, written) = derive(&State::NEW, color, true, true);
    let new = || Memory { available: true, ..Memory::default() };
    let mut memory = new();
    memory.barrier(&derive(&State::NEW, color, true, true).0.unwrap(), true).unwrap();
    memory.access(color, true, true).unwrap();

    assert!(memory.clone().access(color, false, true).is_err(), "write after write");
    assert!(memory.clone().access(fragment, false, true).is_err(), "the wrong layout");
    let barrier = derive(&written, fragment, false, true).0.unwrap();
    let early = Barrier { src_stages: PipelineStageFlags2::VERTEX_SHADER, ..barrier };
    assert!(memory.clone().barrier(&early, true).is_err(), "a transition that does not wait");
    let unflushed = Barrier { src_access: AccessFlags2::NONE, ..barrier };
    assert!(memory.clone().barrier(&unflushed, true).is_err(), "a transition of what is not available");
    let blind = Barrier { dst_access: AccessFlags2::NONE, ..barrier };
    let mut unseen = memory.clone();
    unseen.barrier(&blind, true).unwrap();
    assert!(unseen.access(fragment, false, true).is_err(), "a read of what is not visible");
    let lost = Barrier { old_layout: ImageLayout::UNDEFINED, ..barrier };
    let mut discarded = memory.clone();
    discarded.barrier(&lost, true).unwrap();
    assert!(discarded.access(fragment, false, true).is_err(), "lost contents");
    memory.barrier(&barrier, true).unwrap();
    memory.access(fragment, false, true).unwrap();
    memory.layout = color.layout;
    assert!(memory.access(color, true, true).is_err(), "a write that does not wait for a read");
}
