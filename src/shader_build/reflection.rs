//! Reads an [`Interface`] out of SPIR-V.

use spirq::ReflectConfig;
use spirq::constant::ConstantValue;
use spirq::entry_point::EntryPoint;
use spirq::spirv::{BuiltIn, Dim, ExecutionMode, ExecutionModel};
use spirq::ty::{AccessType, DescriptorType, ScalarType, StructType, Type};
use spirq::var::Variable;

use super::interface::{Binding, BindingKind, Block, Format, ImageShape, Interface, Location, Member, Scalar};
use super::spirv::{self, HEADER_WORDS};
use super::{ReflectError, Stage};

/// First word of every binary.
pub(super) const SPIRV_MAGIC: u32 = 0x0723_0203;

impl Interface {
    /// Reflects a binary with one entry point.
    ///
    /// # Errors
    /// A binary that is not SPIR-V, has not exactly one entry point, or declares what no shader here
    /// may: 64-bit inputs, input attachments, texel buffers, acceleration structures.
    pub fn reflect(words: &[u32]) -> Result<Interface, ReflectError> {
        if words.len() < HEADER_WORDS || words[0] != SPIRV_MAGIC {
            return Err(refuse("it does not begin as SPIR-V; compile the shader again"));
        }
        let entry_points =
            ReflectConfig::new().spv(words).ref_all_rscs(true).reflect().map_err(|error| refuse(&error.to_string()))?;
        match entry_points.as_slice() {
            [entry_point] => Ok(Interface {
                lies_in_rows: lies_in_rows(words),
                shared_bytes: spirv::shared_bytes(words),
                built_in_components: spirv::built_in_components(words),
                writes_point_size: spirv::writes_point_size(words),
                samplings: spirv::samplings(words),
                ..read_entry_point(entry_point)?
            }),
            other => Err(refuse(&format!("it has {} entry points; compile one stage a binary", other.len()))),
        }
    }
}

fn refuse(problem: &str) -> ReflectError {
    ReflectError(problem.to_owned())
}

fn read_entry_point(entry_point: &EntryPoint) -> Result<Interface, ReflectError> {
    let stage = match entry_point.exec_model {
        ExecutionModel::Vertex => Stage::Vertex,
        ExecutionModel::Geometry => Stage::Geometry,
        ExecutionModel::Fragment => Stage::Fragment,
        ExecutionModel::GLCompute => Stage::Compute,
        other => return Err(refuse(&format!("unsupported stage {other:?}"))),
    };
    let mut interface = Interface {
        stage,
        local_size: read_operands(entry_point, ExecutionMode::LocalSize),
        lies_in_rows: false,
        shared_bytes: 0,
        primitive_vertices: read_primitive(entry_point),
        emitted_vertices: read_operands(entry_point, ExecutionMode::OutputVertices).map(|[vertices]| vertices),
        invocations: read_operands(entry_point, ExecutionMode::Invocations).map(|[invocations]| invocations),
        built_in_components: [0; 2],
        writes_point_size: false,
        bindings: Vec::new(),
        samplings: Vec::new(),
        push_constants: None,
        inputs: Vec::new(),
        outputs: Vec::new(),
    };
    for variable in &entry_point.vars {
        let name = variable.name().unwrap_or_default();
        match variable {
            // Two in one location are told apart by nothing that the layer compares.
            Variable::Input { location, .. } | Variable::Output { location, .. } if location.comp() != 0 => {
                return Err(refuse(&format!("`{name}` takes a component; give it a location of its own")));
            }
            Variable::Input { location, ty, .. } => {
                // A geometry stage sees one element for each vertex of its primitive.
                let ty = match ty {
                    Type::Array(array) if stage == Stage::Geometry => &array.element_ty,
                    other => other,
                };
                interface.inputs.push(read_location(location.loc(), name, ty)?);
            }
            Variable::Output { location, ty, .. } => {
                interface.outputs.push(read_location(location.loc(), name, ty)?);
            }
            Variable::Descriptor { .. } => {
                interface.bindings.push(read_binding(variable)?);
            }
            Variable::PushConstant { ty, .. } => {
                interface.push_constants = read_block(ty)?;
            }
            Variable::SpecConstant { .. } => {}
        }
    }
    interface.bindings.sort_by_key(|binding| (binding.set, binding.binding));
    interface.inputs.sort_by_key(|input| input.location);
    interface.outputs.sort_by_key(|output| output.location);
    Ok(interface)
}

/// Built-ins are no resources: their decorations tell.
fn lies_in_rows(words: &[u32]) -> bool {
    let declared = spirv::declared_built_ins(words);
    let declares = |built_in: BuiltIn| declared.contains(&(built_in as u32));
    declares(BuiltIn::NumWorkgroups) && !declares(BuiltIn::GlobalInvocationId)
}

/// The numbers of an execution mode.
fn read_operands<const N: usize>(entry_point: &EntryPoint, wanted: ExecutionMode) -> Option<[u32; N]> {
    let mode = entry_point.exec_modes.iter().find(|mode| mode.exec_mode == wanted)?;
    let numbers = mode.operands.iter().map_while(|operand| match operand.value {
        ConstantValue::U32(number) => Some(number),
        _ => None,
    });
    numbers.collect::<Vec<_>>().try_into().ok()
}

fn read_primitive(entry_point: &EntryPoint) -> Option<u32> {
    entry_point.exec_modes.iter().find_map(|mode| match mode.exec_mode {
        ExecutionMode::InputPoints => Some(1),
        ExecutionMode::InputLines => Some(2),
        ExecutionMode::Triangles => Some(3),
        _ => None,
    })
}

fn read_image(ty: &Type) -> Option<ImageShape> {
    match ty {
        Type::SampledImage(image) => Some(ImageShape {
            is_plain_2d: image.dim == Dim::Dim2D && !image.is_multisampled,
            is_3d: image.dim == Dim::Dim3D,
            is_array: image.is_array,
            scalar: read_scalar(&image.scalar_ty, 1).map(|format| format.scalar),
        }),
        Type::StorageImage(image) => Some(ImageShape {
            is_plain_2d: image.dim == Dim::Dim2D && !image.is_multisampled,
            is_3d: image.dim == Dim::Dim3D,
            is_array: image.is_array,
            scalar: None,
        }),
        _ => None,
    }
}

fn read_binding(variable: &Variable) -> Result<Binding, ReflectError> {
    let Variable::Descriptor { name, desc_bind, desc_ty, ty, nbind } = variable else {
        return Err(refuse("a variable that is no descriptor was read as one"));
    };
    let (set, binding) = desc_bind.into_inner();
    let kind = match (desc_ty, ty) {
        (DescriptorType::UniformBuffer(), _) => BindingKind::UniformBuffer,
        (DescriptorType::StorageBuffer(access), _) => {
            BindingKind::StorageBuffer { readonly: *access == AccessType::ReadOnly }
        }
        (DescriptorType::SampledImage(), _) => BindingKind::SampledImage,
        (DescriptorType::Sampler(), _) => BindingKind::Sampler,
        (DescriptorType::CombinedImageSampler(), _) => BindingKind::CombinedImageSampler,
        (DescriptorType::StorageImage(access), Type::StorageImage(image)) => {
            BindingKind::StorageImage { format: image.fmt, readonly: *access == AccessType::ReadOnly }
        }
        (other, _) => {
            return Err(refuse(&format!(
                "set {set} binding {binding} is an unsupported {other:?}; use a buffer, texture, sampler or image"
            )));
        }
    };
    let (block, image) = (read_block(ty)?, read_image(ty));
    let block_name = block.as_ref().map(|block| block.name.clone());
    Ok(Binding {
        set,
        binding,
        name: name.clone().or(block_name).unwrap_or_default(),
        kind,
        count: *nbind,
        block,
        image,
    })
}

fn read_location(location: u32, name: &str, ty: &Type) -> Result<Location, ReflectError> {
    let Some((format, count)) = read_format(ty) else {
        return Err(refuse(&format!(
            "`{name}` at location {location} is a block or a 64-bit value; \
             declare a variable for each 32-bit scalar or vector"
        )));
    };
    Ok(Location { location, name: name.to_owned(), format, count })
}

/// The format of a type and the number of locations it takes.
fn read_format(ty: &Type) -> Option<(Format, u32)> {
    match ty {
        Type::Scalar(scalar) => Some((read_scalar(scalar, 1)?, 1)),
        Type::Vector(vector) => Some((read_scalar(&vector.scalar_ty, vector.nscalar)?, 1)),
        Type::Matrix(matrix) => {
            let column = &matrix.vector_ty;
            Some((read_scalar(&column.scalar_ty, column.nscalar)?, matrix.nvector))
        }
        Type::Array(array) => {
            let (format, count) = read_format(&array.element_ty)?;
            Some((format, count.checked_mul(array.nelement?)?))
        }
        _ => None,
    }
}

fn read_scalar(ty: &ScalarType, components: u32) -> Option<Format> {
    let scalar = match ty {
        ScalarType::Float { bits: 32 } => Scalar::Float,
        ScalarType::Integer { bits: 32, is_signed: true } => Scalar::Int,
        ScalarType::Integer { bits: 32, is_signed: false } => Scalar::Uint,
        _ => return None,
    };
    Some(Format { scalar, components })
}

fn read_block(ty: &Type) -> Result<Option<Block>, ReflectError> {
    match ty {
        Type::Struct(structure) => read_structure(structure).map(Some),
        _ => Ok(None),
    }
}

fn read_structure(structure: &StructType) -> Result<Block, ReflectError> {
    let members = structure.members.iter().map(|member| {
        let (array_stride, element) = match &member.ty {
            Type::Array(array) => (array.stride, &*array.element_ty),
            other => (None, other),
        };
        let array_stride_bytes = array_stride.map(bytes).transpose()?;
        let mut block = read_block(element)?;
        if let (Some(block), Some(stride)) = (&mut block, array_stride_bytes) {
            block.size_bytes = stride;
        }
        Ok(Member {
            name: member.name.clone().unwrap_or_default(),
            offset_bytes: bytes(member.offset.unwrap_or_default())?,
            size_bytes: bytes(member.ty.nbyte().unwrap_or_default())?,
            array_stride_bytes,
            block,
        })
    });
    let members = members.collect::<Result<Vec<_>, ReflectError>>()?;
    let end = |member: &Member| member.offset_bytes.saturating_add(member.size_bytes);
    Ok(Block {
        name: structure.name.clone().unwrap_or_default(),
        size_bytes: members.iter().map(end).max().unwrap_or_default(),
        members,
    })
}

fn bytes(size: usize) -> Result<u32, ReflectError> {
    u32::try_from(size).map_err(|_| refuse("a block is larger than 4 GiB"))
}
