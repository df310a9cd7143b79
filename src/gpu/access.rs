//! Accesses and the one table of their stages, access masks and layouts; and the derivation of a barrier from the
//! accesses before and after it.

use std::ops::BitOr;

use ash::vk;

/// The shader stages that touch a resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stages(u8);

impl Stages {
    /// No stage.
    pub const NONE: Stages = Stages(0);
    /// The vertex stage.
    pub const VERTEX: Stages = Stages(1);
    /// The geometry stage.
    pub const GEOMETRY: Stages = Stages(2);
    /// The fragment stage.
    pub const FRAGMENT: Stages = Stages(4);
    /// The compute stage.
    pub const COMPUTE: Stages = Stages(8);

    /// Every stage.
    pub(crate) const EACH: [Stages; 4] = [Stages::VERTEX, Stages::GEOMETRY, Stages::FRAGMENT, Stages::COMPUTE];

    /// True when all of `other` is among them.
    pub fn contains(self, other: Stages) -> bool {
        self.0 & other.0 == other.0
    }

    pub(crate) fn pipeline_stages(self) -> vk::PipelineStageFlags2 {
        let table = [
            (Stages::VERTEX, vk::PipelineStageFlags2::VERTEX_SHADER),
            (Stages::GEOMETRY, vk::PipelineStageFlags2::GEOMETRY_SHADER),
            (Stages::FRAGMENT, vk::PipelineStageFlags2::FRAGMENT_SHADER),
            (Stages::COMPUTE, vk::PipelineStageFlags2::COMPUTE_SHADER),
        ];
        table.into_iter().filter(|&(s, _)| self.contains(s)).fold(vk::PipelineStageFlags2::NONE, |all, (_, p)| all | p)
    }

    pub(crate) fn shader_stages(self) -> vk::ShaderStageFlags {
        let table = [
            (Stages::VERTEX, vk::ShaderStageFlags::VERTEX),
            (Stages::GEOMETRY, vk::ShaderStageFlags::GEOMETRY),
            (Stages::FRAGMENT, vk::ShaderStageFlags::FRAGMENT),
            (Stages::COMPUTE, vk::ShaderStageFlags::COMPUTE),
        ];
        table.into_iter().filter(|&(s, _)| self.contains(s)).fold(vk::ShaderStageFlags::empty(), |all, (_, p)| all | p)
    }
}

impl BitOr for Stages {
    type Output = Stages;
    fn bitor(self, other: Stages) -> Stages {
        Stages(self.0 | other.0)
    }
}

/// The use of a view of a resource by a pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Written, and with blending or a loaded content read, as a colour attachment.
    ColorTarget,
    /// Tested and written as the depth (and stencil) attachment.
    DepthTarget,
    /// Tested as the depth attachment, never written.
    DepthReadOnly,
    /// Fetched or sampled by the stages.
    SampledRead(Stages),
    /// Read as a uniform block.
    UniformRead(Stages),
    /// Read as a storage buffer or image.
    StorageRead(Stages),
    /// Written, and perhaps read, as a storage buffer or image.
    StorageWrite(Stages),
    /// Fetched as vertex attributes.
    VertexRead,
    /// Fetched as indices.
    IndexRead,
    /// Read as the parameters of an indirect draw or dispatch.
    IndirectRead,
    /// Read by a copy.
    CopySource,
    /// Written by a copy.
    CopyDestination,
    /// Read by the host after the submission's fence.
    HostRead,
}

/// Stages, access mask and layout of an [`Access`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AccessInfo {
    /// Pipeline stages that access the resource.
    pub stages: vk::PipelineStageFlags2,
    /// Kinds of access that those stages make.
    pub access: vk::AccessFlags2,
    /// The layout an image must be in; buffers ignore it.
    pub layout: vk::ImageLayout,
    /// Set for an access that writes.
    pub writes: bool,
}

impl Access {
    /// The total table.
    pub fn info(self) -> AccessInfo {
        use vk::{AccessFlags2 as A, ImageLayout as L, PipelineStageFlags2 as S};
        let depth_stages = S::EARLY_FRAGMENT_TESTS | S::LATE_FRAGMENT_TESTS;
        let (stages, access, layout, writes) = match self {
            Access::ColorTarget => (
                S::COLOR_ATTACHMENT_OUTPUT,
                A::COLOR_ATTACHMENT_READ | A::COLOR_ATTACHMENT_WRITE,
                L::COLOR_ATTACHMENT_OPTIMAL,
                true,
            ),
            Access::DepthTarget => (
                depth_stages,
                A::DEPTH_STENCIL_ATTACHMENT_READ | A::DEPTH_STENCIL_ATTACHMENT_WRITE,
                L::DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
                true,
            ),
            Access::DepthReadOnly => {
                (depth_stages, A::DEPTH_STENCIL_ATTACHMENT_READ, L::DEPTH_STENCIL_READ_ONLY_OPTIMAL, false)
            }
            Access::SampledRead(s) => (s.pipeline_stages(), A::SHADER_SAMPLED_READ, L::SHADER_READ_ONLY_OPTIMAL, false),
            Access::UniformRead(s) => (s.pipeline_stages(), A::UNIFORM_READ, L::UNDEFINED, false),
            Access::StorageRead(s) => (s.pipeline_stages(), A::SHADER_STORAGE_READ, L::GENERAL, false),
            Access::StorageWrite(s) => {
                (s.pipeline_stages(), A::SHADER_STORAGE_READ | A::SHADER_STORAGE_WRITE, L::GENERAL, true)
            }
            Access::VertexRead => (S::VERTEX_ATTRIBUTE_INPUT, A::VERTEX_ATTRIBUTE_READ, L::UNDEFINED, false),
            Access::IndexRead => (S::INDEX_INPUT, A::INDEX_READ, L::UNDEFINED, false),
            Access::IndirectRead => (S::DRAW_INDIRECT, A::INDIRECT_COMMAND_READ, L::UNDEFINED, false),
            Access::CopySource => (S::COPY, A::TRANSFER_READ, L::TRANSFER_SRC_OPTIMAL, false),
            Access::CopyDestination => (S::COPY, A::TRANSFER_WRITE, L::TRANSFER_DST_OPTIMAL, true),
            Access::HostRead => (S::HOST, A::HOST_READ, L::GENERAL, false),
        };
        AccessInfo { stages, access, layout, writes }
    }
}

/// The accesses to a piece of a resource so far, as far as a later access must know of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct State {
    /// The last write, or layout transition.
    write_stages: vk::PipelineStageFlags2,
    write_access: vk::AccessFlags2,
    /// Reads since that write, and to which of them a barrier has made it visible.
    read_stages: vk::PipelineStageFlags2,
    read_access: vk::AccessFlags2,
    layout: vk::ImageLayout,
    /// Set once it holds anything that may be read.
    written: bool,
}

impl State {
    /// Nothing was done yet and nothing may be read.
    pub const NEW: State = State {
        write_stages: vk::PipelineStageFlags2::NONE,
        write_access: vk::AccessFlags2::NONE,
        read_stages: vk::PipelineStageFlags2::NONE,
        read_access: vk::AccessFlags2::NONE,
        layout: vk::ImageLayout::UNDEFINED,
        written: false,
    };

    /// Contents written by the host before any submission: visible to all of it without a barrier.
    pub const HOST_WRITTEN: State = State { written: true, ..State::NEW };

    /// True when the host wrote it last, or when a barrier has made the last write visible to it.
    pub(crate) fn is_for_host(&self) -> bool {
        self.written && (self.write_stages.is_empty() || self.read_access.contains(vk::AccessFlags2::HOST_READ))
    }

    /// True once a pass, a copy or the host has written it.
    pub fn is_written(&self) -> bool {
        self.written
    }
}

/// The masks and layouts of one barrier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Barrier {
    /// Stages that must have finished.
    pub src_stages: vk::PipelineStageFlags2,
    /// Writes of those stages that are made available.
    pub src_access: vk::AccessFlags2,
    /// Stages that wait.
    pub dst_stages: vk::PipelineStageFlags2,
    /// Accesses of those stages that see the writes.
    pub dst_access: vk::AccessFlags2,
    /// Layout of the image before; `UNDEFINED` discards its contents and stands for a buffer's.
    pub old_layout: vk::ImageLayout,
    /// Layout of the image after.
    pub new_layout: vk::ImageLayout,
}

/// The barrier that must stand between what `state` remembers and `next`, if any, and the state after `next`.
///
/// `discard` says that `next` does not need the old contents (a cleared attachment, a whole overwrite): an image then
/// comes from `UNDEFINED`. `is_image` decides whether layouts count.
pub fn derive(state: &State, next: AccessInfo, discard: bool, is_image: bool) -> (Option<Barrier>, State) {
    let layout = if is_image { next.layout } else { vk::ImageLayout::UNDEFINED };
    let changes_layout = is_image && (state.layout != layout);
    let nothing_before = state.write_stages.is_empty() && state.read_stages.is_empty();

    if next.writes || changes_layout {
        // Write after write and write after read; a transition is both a read and a write of the image.
        let barrier = Barrier {
            src_stages: state.write_stages | state.read_stages,
            // Writes must be made available; earlier reads need execution order alone.
            src_access: state.write_access,
            dst_stages: next.stages,
            dst_access: next.access,
            old_layout: if discard { vk::ImageLayout::UNDEFINED } else { state.layout },
            new_layout: layout,
        };
        let after = if next.writes {
            State {
                write_stages: next.stages,
                write_access: next.access & WRITES,
                read_stages: vk::PipelineStageFlags2::NONE,
                read_access: vk::AccessFlags2::NONE,
                layout,
                written: true,
            }
        } else {
            // A later access in another stage chains on the transition through these stages; the transition itself
            // left nothing to make available.
            State {
                write_stages: next.stages,
                write_access: vk::AccessFlags2::NONE,
                read_stages: next.stages,
                read_access: next.access,
                layout,
                written: state.written,
            }
        };
        let needed = changes_layout || !nothing_before;
        return (needed.then_some(barrier), after);
    }

    let visible = state.read_stages.contains(next.stages) && state.read_access.contains(next.access);
    let after =
        State { read_stages: state.read_stages | next.stages, read_access: state.read_access | next.access, ..*state };
    let needed = !state.write_stages.is_empty() && !visible;
    // To all readers so far, not to the new one alone: what the state remembers is then the product of its stages and
    // its accesses, and no pair is taken for visible that no barrier named.
    let barrier = Barrier {
        src_stages: state.write_stages,
        src_access: state.write_access,
        dst_stages: after.read_stages,
        dst_access: after.read_access,
        old_layout: state.layout,
        new_layout: state.layout,
    };
    (needed.then_some(barrier), after)
}

const WRITES: vk::AccessFlags2 = vk::AccessFlags2::from_raw(
    vk::AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw()
        | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw()
        | vk::AccessFlags2::SHADER_STORAGE_WRITE.as_raw()
        | vk::AccessFlags2::TRANSFER_WRITE.as_raw(),
);
