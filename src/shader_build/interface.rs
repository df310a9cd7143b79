//! Interface of a shader stage, reflected from its SPIR-V binary.

use super::Stage;

pub use spirq::ty::ImageFormat;

/// The interface of one entry point.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// Stage of the entry point.
    pub stage: Stage,
    /// Threads of a workgroup along x, y and z; compute shaders only.
    pub local_size: Option<[u32; 3]>,
    /// The shader numbers its threads by the workgroups in a row, as `common/elements.glsl` does: it declares
    /// `gl_NumWorkGroups`, and not `gl_GlobalInvocationID`, which knows no rows.
    pub lies_in_rows: bool,
    /// Bytes that the threads of a workgroup share.
    pub shared_bytes: u64,
    /// Vertices of a primitive that a geometry stage takes: 1 for points, 2 for lines, 3 for triangles.
    pub primitive_vertices: Option<u32>,
    /// Vertices that an invocation of a geometry stage gives at most.
    pub emitted_vertices: Option<u32>,
    /// Invocations of a geometry stage for each primitive.
    pub invocations: Option<u32>,
    /// Components of the built-ins that the stage takes, and of those that it gives. Of a block of them all members count, as Vulkan
    /// counts them, and of an array of blocks one.
    pub built_in_components: [u64; 2],
    /// A vertex or geometry stage says how large its points are.
    pub writes_point_size: bool,
    /// Every resource that the binary declares, by ascending set and binding.
    pub bindings: Vec<Binding>,
    /// Textures that are joined with samplers; fetches need none.
    pub samplings: Vec<Sampling>,
    /// Block of push constants, if there is one.
    pub push_constants: Option<Block>,
    /// Located inputs by ascending location; built-ins are not listed.
    pub inputs: Vec<Location>,
    /// Located outputs by ascending location; built-ins are not listed.
    pub outputs: Vec<Location>,
}

/// One descriptor binding.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// Number of the descriptor set.
    pub set: u32,
    /// Number within the set.
    pub binding: u32,
    /// Name of the variable, or of its block when the block has no instance name.
    pub name: String,
    /// Type of the descriptors.
    pub kind: BindingKind,
    /// Number of descriptors: 1, or the length of an array of them.
    pub count: u32,
    /// Contents of a uniform or storage buffer.
    pub block: Option<Block>,
    /// Shape of a sampled or storage image.
    pub image: Option<ImageShape>,
}

/// A texture joined with a sampler: their bindings in set 0, or `None` for a function's argument, which may be any of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// Binding of the texture.
    pub texture: Option<u32>,
    /// Binding of the sampler.
    pub sampler: Option<u32>,
    /// A read gives the outcome of a comparison with texels.
    pub compares: bool,
}

/// Shape of an image as a shader declares it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageShape {
    /// Two-dimensional, with one sample a texel.
    pub is_plain_2d: bool,
    /// Three-dimensional.
    pub is_3d: bool,
    /// An array of layers.
    pub is_array: bool,
    /// Type of a texel of a sampled image; a storage image has a format.
    pub scalar: Option<Scalar>,
}

/// Type of a binding's descriptors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingKind {
    UniformBuffer,
    StorageBuffer {
        /// No stage writes it.
        readonly: bool,
    },
    SampledImage,
    Sampler,
    StorageImage {
        /// Format of a texel, as the shader declares it.
        format: ImageFormat,
        /// No stage writes it.
        readonly: bool,
    },
    CombinedImageSampler,
}

impl BindingKind {
    /// True where a stage may write it.
    pub fn is_written(self) -> bool {
        matches!(
            self,
            BindingKind::StorageBuffer { readonly: false } | BindingKind::StorageImage { readonly: false, .. }
        )
    }
}

/// A block of memory shared with the host.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// Name of the GLSL block or structure.
    pub name: String,
    /// End of the last member; without a trailing run-time array. Of an array's element: its stride.
    pub size_bytes: u32,
    /// In the order of declaration.
    pub members: Vec<Member>,
}

/// One member of a block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name in GLSL.
    pub name: String,
    /// Bytes from the start of the block.
    pub offset_bytes: u32,
    /// Size of the whole member, arrays included; 0 for a run-time array.
    pub size_bytes: u32,
    /// Distance of neighbours, for an array.
    pub array_stride_bytes: Option<u32>,
    /// Layout of the structure that the member, or each element of it, is.
    pub block: Option<Block>,
}

/// One located input or output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// First location taken.
    pub location: u32,
    /// Name of the variable.
    pub name: String,
    /// Type of each location.
    pub format: Format,
    /// Consecutive locations taken: 1, or more for arrays and matrices.
    pub count: u32,
}

/// Scalar or vector type of an input or output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Type of each component.
    pub scalar: Scalar,
    /// 1 to 4.
    pub components: u32,
}

/// 32-bit scalar type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    Float,
    Int,
    Uint,
}

impl Interface {
    /// The resource at a set and binding.
    pub fn binding(&self, set: u32, binding: u32) -> Option<&Binding> {
        let matches = |known: &&Binding| (known.set, known.binding) == (set, binding);
        self.bindings.iter().find(matches)
    }
}

impl Block {
    /// The member of that name.
    pub fn member(&self, name: &str) -> Option<&Member> {
        self.members.iter().find(|member| member.name == name)
    }

    /// The block within blocks that hold nothing else: naga wraps each block in one more structure.
    pub(super) fn unwrapped(&self) -> &Block {
        match self.members.as_slice() {
            [member] if member.offset_bytes == 0 && member.array_stride_bytes.is_none() => {
                member.block.as_ref().map_or(self, Block::unwrapped)
            }
            _ => self,
        }
    }
}
