//! Takes explicit layouts from the types of variables that lie in no buffer.
//!
//! naga gives every structure and array its offsets and strides, wherever it is used. Vulkan allows them in buffers and
//! push constants alone (VUID-StandaloneSpirv-None-10684; naga's own report is gfx-rs/wgpu 7696), and drivers are said
//! to crash on others. A type that no buffer shares loses its layout; one that a buffer shares is doubled, and values
//! cross between the two by `OpCopyLogical`, which SPIR-V 1.4 brought for this. The numbers are the specification's.

use std::collections::{HashMap, HashSet};

const HEADER_WORDS: usize = 5;
/// Word of the header that is one more than the largest id.
const BOUND: usize = 3;

const OP_UNDEF: u32 = 1;
const OP_NAME: u32 = 5;
const OP_MEMBER_NAME: u32 = 6;
const OP_TYPE_ARRAY: u32 = 28;
const OP_TYPE_RUNTIME_ARRAY: u32 = 29;
const OP_TYPE_STRUCT: u32 = 30;
const OP_TYPE_POINTER: u32 = 32;
const OP_CONSTANT_COMPOSITE: u32 = 44;
const OP_CONSTANT_NULL: u32 = 46;
const OP_FUNCTION_PARAMETER: u32 = 55;
const OP_VARIABLE: u32 = 59;
const OP_LOAD: u32 = 61;
const OP_STORE: u32 = 62;
const OP_COPY_MEMORY: u32 = 63;
const OP_ACCESS_CHAIN: u32 = 65;
const OP_IN_BOUNDS_ACCESS_CHAIN: u32 = 66;
const OP_DECORATE: u32 = 71;
const OP_MEMBER_DECORATE: u32 = 72;
const OP_COPY_OBJECT: u32 = 83;
const OP_SELECT: u32 = 169;
const OP_PHI: u32 = 245;
const OP_COPY_LOGICAL: u32 = 400;

/// Uniform, PushConstant and StorageBuffer: the storage classes of laid out memory.
const LAID_OUT_CLASSES: [u32; 3] = [2, 9, 12];
/// Block, BufferBlock, RowMajor, ColMajor, ArrayStride, MatrixStride and Offset.
const LAYOUT_DECORATIONS: [u32; 7] = [2, 3, 4, 5, 6, 7, 35];
/// Instructions of which the result may be a pointer: result type and result are their first two operands.
const POINTER_MAKERS: [u32; 7] =
    [OP_FUNCTION_PARAMETER, OP_VARIABLE, OP_ACCESS_CHAIN, OP_IN_BOUNDS_ACCESS_CHAIN, OP_COPY_OBJECT, OP_SELECT, OP_PHI];

/// The binary with layouts in buffers and push constants alone.
///
/// # Errors
/// The problem with a binary that is cut short, or copies memory as a whole, which naga never does.
pub fn strip(words: &[u32]) -> Result<Vec<u32>, String> {
    let instructions = split(words)?;
    let mut types = Types::read(&instructions);
    let mut next_id = words[BOUND];
    types.double(&instructions, &mut next_id);
    let mut written = words[..HEADER_WORDS].to_vec();
    for &instruction in &instructions {
        types.rewrite(instruction, &mut next_id, &mut written)?;
    }
    written[BOUND] = next_id;
    Ok(written)
}

/// The instructions of a binary, each with its operands.
pub(super) fn split(words: &[u32]) -> Result<Vec<&[u32]>, String> {
    let mut rest = words.get(HEADER_WORDS..).ok_or("naga's binary has no header")?;
    let mut instructions = Vec::new();
    while let Some(first) = rest.first() {
        let (instruction, after) =
            rest.split_at_checked((first >> 16).max(1) as usize).ok_or("naga's binary ends within an instruction")?;
        instructions.push(instruction);
        rest = after;
    }
    Ok(instructions)
}

pub(super) fn opcode(instruction: &[u32]) -> u32 {
    instruction[0] & 0xffff
}

/// Target and decoration of a layout.
fn read_layout(instruction: &[u32]) -> Option<u32> {
    let (target, decoration) = match (opcode(instruction), instruction) {
        (OP_DECORATE, &[_, target, decoration, ..]) | (OP_MEMBER_DECORATE, &[_, target, _, decoration, ..]) => {
            (target, decoration)
        }
        _ => return None,
    };
    LAYOUT_DECORATIONS.contains(&decoration).then_some(target)
}

/// Result and parts of a structure or array type.
fn read_composite(instruction: &[u32]) -> Option<(u32, &[u32])> {
    match (opcode(instruction), instruction) {
        (OP_TYPE_STRUCT, [_, result, members @ ..]) => Some((*result, members)),
        (OP_TYPE_ARRAY | OP_TYPE_RUNTIME_ARRAY, [_, result, element, ..]) => {
            Some((*result, std::slice::from_ref(element)))
        }
        _ => None,
    }
}

/// Type, result and parts of a constant of a structure or array type.
fn read_constant(instruction: &[u32]) -> Option<(u32, u32, &[u32])> {
    match (opcode(instruction), instruction) {
        (OP_CONSTANT_COMPOSITE | OP_CONSTANT_NULL | OP_UNDEF, [_, ty, result, parts @ ..]) => {
            Some((*ty, *result, parts))
        }
        _ => None,
    }
}

/// The type of a pointer: storage class and pointee.
struct Pointer {
    class: u32,
    pointee: u32,
}

#[derive(Default)]
struct Types {
    pointers: HashMap<u32, Pointer>,
    /// Structures and arrays that a buffer or push constants hold.
    laid_out: HashSet<u32>,
    /// Those of them that have a layout, and every type that contains one.
    with_layout: HashSet<u32>,
    /// Types, and initial values, without their layouts.
    doubles: HashMap<u32, u32>,
    /// The pointer type of every value that is a pointer to a doubled type.
    pointer_types: HashMap<u32, u32>,
}

impl Types {
    fn read(instructions: &[&[u32]]) -> Self {
        let mut types = Types::default();
        let composites: HashMap<u32, &[u32]> = instructions.iter().filter_map(|i| read_composite(i)).collect();
        for &instruction in instructions {
            if let (OP_TYPE_POINTER, &[_, result, class, pointee]) = (opcode(instruction), instruction) {
                types.pointers.insert(result, Pointer { class, pointee });
            }
        }
        let in_buffers = types.pointers.values().filter(|pointer| LAID_OUT_CLASSES.contains(&pointer.class));
        let mut found: Vec<u32> = in_buffers.map(|pointer| pointer.pointee).collect();
        while let Some(ty) = found.pop() {
            if let Some(parts) = composites.get(&ty).filter(|_| types.laid_out.insert(ty)) {
                found.extend(*parts);
            }
        }
        let decorated = instructions.iter().filter_map(|instruction| read_layout(instruction));
        types.with_layout = decorated.filter(|ty| types.laid_out.contains(ty)).collect();
        // A type stands after its parts.
        for (ty, parts) in instructions.iter().filter_map(|instruction| read_composite(instruction)) {
            if parts.iter().any(|part| types.with_layout.contains(part)) {
                types.with_layout.insert(ty);
            }
        }
        types
    }

    /// The pointee that loses its layout, if this is the type of a pointer to one.
    fn stripped_pointee(&self, pointer_type: u32) -> Option<u32> {
        let pointer = self.pointers.get(&pointer_type)?;
        let loses = !LAID_OUT_CLASSES.contains(&pointer.class) && self.with_layout.contains(&pointer.pointee);
        loses.then_some(pointer.pointee)
    }

    /// Gives ids to the doubles of types and initial values.
    fn double(&mut self, instructions: &[&[u32]], next_id: &mut u32) {
        let mut wanted: HashSet<u32> = self.pointers.keys().filter_map(|&ty| self.stripped_pointee(ty)).collect();
        for instruction in instructions {
            if let (OP_VARIABLE, &[_, ty, _, _, initial]) = (opcode(instruction), *instruction) {
                wanted.extend(self.stripped_pointee(ty).map(|_| initial));
            }
        }
        // What a type or a value consists of stands before it.
        for instruction in instructions.iter().rev() {
            let (id, parts) = match (read_composite(instruction), read_constant(instruction)) {
                (Some((ty, parts)), _) if self.with_layout.contains(&ty) => (ty, parts),
                (_, Some((ty, value, parts))) if self.with_layout.contains(&ty) => (value, parts),
                _ => continue,
            };
            if wanted.contains(&id) {
                wanted.extend(parts);
                self.doubles.insert(id, *next_id);
                *next_id += 1;
            }
        }
    }

    fn doubled(&self, id: u32) -> u32 {
        self.doubles.get(&id).copied().unwrap_or(id)
    }

    fn rewrite(&mut self, instruction: &[u32], next_id: &mut u32, written: &mut Vec<u32>) -> Result<(), String> {
        if read_layout(instruction).is_some_and(|target| !self.laid_out.contains(&target)) {
            return Ok(());
        }
        let mut fresh = || {
            *next_id += 1;
            *next_id - 1
        };
        match (opcode(instruction), instruction) {
            (OP_TYPE_POINTER, &[first, result, class, pointee]) if self.stripped_pointee(result).is_some() => {
                written.extend([first, result, class, self.doubled(pointee)]);
                return Ok(());
            }
            (OP_VARIABLE, &[first, ty, result, class, initial]) if self.stripped_pointee(ty).is_some() => {
                self.pointer_types.insert(result, ty);
                written.extend([first, ty, result, class, self.doubled(initial)]);
                return Ok(());
            }
            (OP_LOAD, &[first, ty, result, pointer, ref access @ ..]) if self.pointer_types.contains_key(&pointer) => {
                let loaded = fresh();
                written.extend([first, self.doubled(ty), loaded, pointer]);
                written.extend(access);
                written.extend([4 << 16 | OP_COPY_LOGICAL, ty, result, loaded]);
                return Ok(());
            }
            (OP_STORE, &[first, pointer, value, ref access @ ..]) => {
                let pointee = self.pointer_types.get(&pointer).and_then(|&ty| self.stripped_pointee(ty));
                if let Some(ty) = pointee {
                    let stored = fresh();
                    written.extend([4 << 16 | OP_COPY_LOGICAL, self.doubled(ty), stored, value]);
                    written.extend([first, pointer, stored]);
                    written.extend(access);
                    return Ok(());
                }
            }
            (OP_COPY_MEMORY, &[_, to, from, ..]) if [to, from].iter().any(|id| self.pointer_types.contains_key(id)) => {
                return Err("naga copies memory as a whole, of which the layout cannot be taken".to_owned());
            }
            (op, &[_, ty, result, ..]) if POINTER_MAKERS.contains(&op) && self.stripped_pointee(ty).is_some() => {
                self.pointer_types.insert(result, ty);
            }
            _ => {}
        }
        written.extend(instruction);
        self.write_double(instruction, written);
        Ok(())
    }

    /// Writes the double of a type or an initial value, if it has one, after it, and of their names: Mesa takes structures
    /// of other names for different ones and refuses the copy between them.
    fn write_double(&self, instruction: &[u32], written: &mut Vec<u32>) {
        if let (OP_NAME | OP_MEMBER_NAME, &[first, target, ref name @ ..]) = (opcode(instruction), instruction) {
            if let Some(&double) = self.doubles.get(&target) {
                written.extend([first, double]);
                written.extend(name);
            }
        } else if let Some((ty, parts)) = read_composite(instruction) {
            if let Some(&double) = self.doubles.get(&ty) {
                written.extend([instruction[0], double]);
                written.extend(parts.iter().map(|&part| self.doubled(part)));
                // The length of an array.
                written.extend(&instruction[2 + parts.len()..]);
            }
        } else if let Some((ty, value, parts)) = read_constant(instruction)
            && let Some(&double) = self.doubles.get(&value)
        {
            written.extend([instruction[0], self.doubled(ty), double]);
            written.extend(parts.iter().map(|&part| self.doubled(part)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shader_build::{EMBEDDED, Stage, naga};

    /// Types with a layout that a variable outside of buffers holds, and whether any type has one.
    fn misplaced_layouts(words: &[u32]) -> (Vec<u32>, bool) {
        let instructions = split(words).unwrap();
        let decorated: HashSet<u32> = instructions.iter().filter_map(|i| read_layout(i)).collect();
        let composites: HashMap<u32, &[u32]> = instructions.iter().filter_map(|i| read_composite(i)).collect();
        let outside = |i: &&&[u32]| opcode(i) == OP_TYPE_POINTER && !LAID_OUT_CLASSES.contains(&i[2]);
        let mut left: Vec<u32> = instructions.iter().filter(outside).map(|i| i[3]).collect();
        let mut misplaced = Vec::new();
        while let Some(ty) = left.pop() {
            misplaced.extend(decorated.contains(&ty).then_some(ty));
            left.extend(composites.get(&ty).copied().unwrap_or_default());
        }
        (misplaced, !decorated.is_empty())
    }

    #[test]
    fn layouts_stand_in_buffers_alone() {
        let mut with_layouts = 0;
        for shader in EMBEDDED {
            let Ok(words) = shader.naga else { continue };
            assert_eq!(words[1], 0x0001_0400, "{}", shader.name);
            let (misplaced, any) = misplaced_layouts(words);
            assert_eq!(misplaced, [0; 0], "{}", shader.name);
            with_layouts += usize::from(any);
        }
        assert!(with_layouts > 50);
    }

    fn count(words: &[u32], op: u32) -> usize {
        split(words).unwrap().iter().filter(|i| opcode(i) == op).count()
    }

    #[test]
    fn what_a_buffer_shares_is_doubled() {
        let text = "#version 450
            struct Ball { vec3 centre; float radius; };
            layout(set = 0, binding = 0, std430) buffer Balls { Ball balls[4]; };
            layout(local_size_x = 1) in;
            shared Ball seen;
            const float WEIGHTS[3] = float[3](1.0, 2.0, 3.0);
            void main() {
                Ball ball = balls[gl_GlobalInvocationID.x];
                ball.radius *= WEIGHTS[gl_GlobalInvocationID.x];
                seen = ball;
                barrier();
                balls[1] = seen;
            }";
        let words = naga::compile(Stage::Compute, text).unwrap_or_else(|error| panic!("{}", error.message));
        assert_eq!(misplaced_layouts(&words), (vec![], true));
        // The block, naga's wrapper of it is none, the ball and its double.
        assert!(count(&words, OP_TYPE_STRUCT) >= 2);
        // Into the local ball, out of it into the shared one, and out of that.
        assert!(count(&words, OP_COPY_LOGICAL) >= 3, "{}", count(&words, OP_COPY_LOGICAL));
        // A second pass finds nothing to do.
        assert_eq!(strip(&words), Ok(words));
    }

    #[test]
    fn initial_values_are_doubled_with_their_type() {
        // %1 = float, %2 = constant 1.0, %3 = struct { float } with an offset, %4 = composite, %5 and %6 pointers to it in a
        // buffer and in private memory, %7 = a private variable that begins as %4.
        let header = [0x0723_0203, 0x0001_0400, 0, 8, 0];
        let name = |id: u32| [3 << 16 | OP_NAME, id, u32::from_le_bytes(*b"One\0")];
        let decorations = [5 << 16 | OP_MEMBER_DECORATE, 3, 0, 35, 0];
        let types = [3 << 16 | 22, 1, 32, 4 << 16 | 43, 1, 2, 0x3f80_0000, 3 << 16 | OP_TYPE_STRUCT, 3, 1];
        let constant = [4 << 16 | OP_CONSTANT_COMPOSITE, 3, 4, 2];
        let pointer = |id: u32, class: u32, ty: u32| [4 << 16 | OP_TYPE_POINTER, id, class, ty];
        let variable = |initial: u32| [5 << 16 | OP_VARIABLE, 6, 7, 6, initial];
        let plain = [
            &header[..],
            &name(3),
            &decorations,
            &types,
            &constant,
            &pointer(5, 12, 3),
            &pointer(6, 6, 3),
            &variable(4),
        ];
        let mut doubled = header;
        doubled[BOUND] = 10;
        let struct_double = [3 << 16 | OP_TYPE_STRUCT, 9, 1];
        let constant_double = [4 << 16 | OP_CONSTANT_COMPOSITE, 9, 8, 2];
        let expected = [
            &doubled[..],
            &name(3),
            &name(9),
            &decorations,
            &types,
            &struct_double,
            &constant,
            &constant_double,
            &pointer(5, 12, 3),
            &pointer(6, 6, 9),
            &variable(8),
        ];
        assert_eq!(strip(&plain.concat()), Ok(expected.concat()));
    }

    #[test]
    fn a_binary_that_is_cut_short_is_refused() {
        assert!(strip(&[]).is_err());
        assert!(strip(&[0x0723_0203, 0x0001_0400, 0, 8, 0, 5 << 16 | OP_VARIABLE, 6]).is_err());
    }
}
