//! Instructions of a binary, for what the reflection of variables leaves out: capabilities, built-ins, textures with the
//! samplers that filter them, shared memory.

use std::collections::{HashMap, HashSet};

use spirq::spirv::{BuiltIn, Decoration, Op, StorageClass};

use super::interface::Sampling;

/// Words of a binary before its first instruction.
pub(super) const HEADER_WORDS: usize = 5;

/// Each instruction of a binary: its opcode, and its operands.
pub(super) fn instructions(words: &[u32]) -> impl Iterator<Item = (u32, &[u32])> {
    let mut rest = words.get(HEADER_WORDS..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (&first, _) = rest.split_first()?;
        // The length includes the first word; of a broken binary no more than there is.
        let (instruction, after) = rest.split_at(((first >> 16) as usize).clamp(1, rest.len()));
        rest = after;
        Some((first & 0xffff, &instruction[1..]))
    })
}

/// Number of instructions of a binary.
pub fn instruction_count(words: &[u32]) -> u64 {
    instructions(words).count() as u64
}

/// The capabilities that a binary wants, by their numbers in the SPIR-V specification.
pub fn capabilities(words: &[u32]) -> impl Iterator<Item = u32> {
    instructions(words)
        .filter(|(op, _)| *op == Op::Capability as u32)
        .filter_map(|(_, operands)| operands.first().copied())
}

/// The extensions of SPIR-V that a binary declares, by name.
pub fn extensions(words: &[u32]) -> impl Iterator<Item = String> {
    instructions(words).filter(|(op, _)| *op == Op::Extension as u32).map(|(_, operands)| {
        let bytes = operands.iter().flat_map(|word| word.to_le_bytes()).take_while(|&byte| byte != 0);
        String::from_utf8_lossy(&bytes.collect::<Vec<_>>()).into_owned()
    })
}

/// The built-ins that variables are declared as.
pub(super) fn declared_built_ins(words: &[u32]) -> HashSet<u32> {
    let built_in = |(op, operands): (u32, &[u32])| match *operands {
        [_, decoration, built_in] if op == Op::Decorate as u32 && decoration == Decoration::BuiltIn as u32 => {
            Some(built_in)
        }
        _ => None,
    };
    instructions(words).filter_map(built_in).collect()
}

/// Components of the built-in variables that the entry point takes, and of those that it gives.
pub(super) fn built_in_components(words: &[u32]) -> [u64; 2] {
    let mut built_ins = HashSet::new();
    // Components of a type, and whether it is a block of built-ins; pointers have those of what they point to.
    let mut types: HashMap<u32, (u64, bool)> = HashMap::new();
    let mut constants = HashMap::new();
    let mut components = [0_u64; 2];
    for (op, operands) in instructions(words) {
        let of = |id: u32| types.get(&id).copied().unwrap_or_default();
        let (id, found) = match *operands {
            [variable, decoration, _] if op == Op::Decorate as u32 && decoration == Decoration::BuiltIn as u32 => {
                built_ins.insert(variable);
                continue;
            }
            [block, _, decoration, _]
                if op == Op::MemberDecorate as u32 && decoration == Decoration::BuiltIn as u32 =>
            {
                built_ins.insert(block);
                continue;
            }
            [pointer, variable, class, ..] if op == Op::Variable as u32 => {
                let (count, is_block) = of(pointer);
                let classes = [StorageClass::Input as u32, StorageClass::Output as u32];
                let of_class = components.iter_mut().zip(classes).find(|(_, known)| *known == class);
                if let Some((sum, _)) = of_class.filter(|_| is_block || built_ins.contains(&variable)) {
                    *sum = sum.saturating_add(count);
                }
                continue;
            }
            [_, constant, value] if op == Op::Constant as u32 || op == Op::SpecConstant as u32 => {
                constants.insert(constant, value);
                continue;
            }
            [id, ..] if [Op::TypeBool, Op::TypeInt, Op::TypeFloat].iter().any(|&scalar| op == scalar as u32) => {
                (id, (1, false))
            }
            [id, part, count] if op == Op::TypeVector as u32 || op == Op::TypeMatrix as u32 => {
                (id, (of(part).0.saturating_mul(count.into()), false))
            }
            [id, element, length] if op == Op::TypeArray as u32 => {
                let (count, is_block) = of(element);
                let times = if is_block { 1 } else { constants.get(&length).copied().unwrap_or(u32::MAX) };
                (id, (count.saturating_mul(times.into()), is_block))
            }
            [id, ref members @ ..] if op == Op::TypeStruct as u32 => {
                let sum = members.iter().map(|&member| of(member).0).fold(0, u64::saturating_add);
                (id, (sum, built_ins.contains(&id)))
            }
            [id, _, pointee] if op == Op::TypePointer as u32 => (id, of(pointee)),
            _ => continue,
        };
        types.insert(id, found);
    }
    components
}

/// True when a value is stored into `gl_PointSize`, a variable or a member of the block of built-ins.
pub(super) fn writes_point_size(words: &[u32]) -> bool {
    let point_size = [Decoration::BuiltIn as u32, BuiltIn::PointSize as u32];
    let mut members = HashSet::new();
    let mut pointees = HashMap::new();
    let mut variables = HashMap::new();
    let mut constants = HashMap::new();
    let mut places = HashSet::new();
    for (op, operands) in instructions(words) {
        match *operands {
            [variable, a, b] if op == Op::Decorate as u32 && [a, b] == point_size => _ = places.insert(variable),
            [block, member, a, b] if op == Op::MemberDecorate as u32 && [a, b] == point_size => {
                members.insert((block, member));
            }
            [pointer, _, pointee] if op == Op::TypePointer as u32 => _ = pointees.insert(pointer, pointee),
            [pointer, variable, ..] if op == Op::Variable as u32 => _ = variables.insert(variable, pointer),
            [_, constant, value] if op == Op::Constant as u32 => _ = constants.insert(constant, value),
            [_, place, base, member] if op == Op::AccessChain as u32 => {
                let block = variables.get(&base).and_then(|pointer| pointees.get(pointer));
                let member = constants.get(&member);
                if block.zip(member).is_some_and(|(&block, &member)| members.contains(&(block, member))) {
                    places.insert(place);
                }
            }
            [place, ..] if op == Op::Store as u32 && places.contains(&place) => return true,
            _ => {}
        }
    }
    false
}

/// Textures that are joined with samplers, by their bindings in set 0.
pub(super) fn samplings(words: &[u32]) -> Vec<Sampling> {
    const COMPARES: [Op; 5] = [
        Op::ImageSampleDrefImplicitLod,
        Op::ImageSampleDrefExplicitLod,
        Op::ImageSampleProjDrefImplicitLod,
        Op::ImageSampleProjDrefExplicitLod,
        Op::ImageDrefGather,
    ];
    let mut bindings = HashMap::new();
    let mut loads = HashMap::new();
    let mut joined: Vec<(u32, Sampling)> = Vec::new();
    for (op, operands) in instructions(words) {
        match *operands {
            [variable, decoration, binding]
                if op == Op::Decorate as u32 && decoration == Decoration::Binding as u32 =>
            {
                bindings.insert(variable, binding);
            }
            [_, value, variable, ..] if op == Op::Load as u32 => _ = loads.insert(value, variable),
            [_, value, texture, sampler] if op == Op::SampledImage as u32 => {
                let binding = |value| loads.get(&value).and_then(|variable| bindings.get(variable)).copied();
                let (texture, sampler) = (binding(texture), binding(sampler));
                joined.push((value, Sampling { texture, sampler, compares: false }));
            }
            [_, _, value, ..] if COMPARES.iter().any(|&compares| op == compares as u32) => {
                joined.iter_mut().filter(|(id, _)| *id == value).for_each(|(_, one)| one.compares = true);
            }
            _ => {}
        }
    }
    let mut different = Vec::new();
    for (_, one) in joined {
        if !different.contains(&one) {
            different.push(one);
        }
    }
    different
}

/// Bytes of the variables that a workgroup shares, laid out by std430 as Vulkan counts them: the largest alignment first.
pub(super) fn shared_bytes(words: &[u32]) -> u64 {
    // Pointers have the layout of what they point to.
    let mut types: HashMap<u32, Layout> = HashMap::new();
    let mut constants = HashMap::new();
    let mut shared = Vec::new();
    for (op, operands) in instructions(words) {
        let of = |id: u32| types.get(&id).copied().unwrap_or_default();
        let (id, layout) = match *operands {
            [_, constant, value] if op == Op::Constant as u32 || op == Op::SpecConstant as u32 => {
                constants.insert(constant, value);
                continue;
            }
            [pointer, _, class, ..] if op == Op::Variable as u32 && class == StorageClass::Workgroup as u32 => {
                shared.push(of(pointer));
                continue;
            }
            [id] if op == Op::TypeBool as u32 => (id, Layout { bytes: 4, alignment: 4 }),
            [id, bits, ..] if op == Op::TypeInt as u32 || op == Op::TypeFloat as u32 => {
                let bytes = u64::from(bits / 8);
                (id, Layout { bytes, alignment: bytes })
            }
            [id, component, count] if op == Op::TypeVector as u32 => {
                let bytes = of(component).bytes;
                let aligned = if count == 2 { 2 } else { 4 };
                (id, Layout { bytes: bytes * u64::from(count), alignment: bytes * aligned })
            }
            [id, column, count] if op == Op::TypeMatrix as u32 => (id, of(column).times(count)),
            [id, element, length] if op == Op::TypeArray as u32 => {
                (id, of(element).times(constants.get(&length).copied().unwrap_or(u32::MAX)))
            }
            [id, ref members @ ..] if op == Op::TypeStruct as u32 => {
                let whole = members.iter().map(|&member| of(member)).fold(Layout::default(), Layout::then);
                (id, whole.times(1))
            }
            [id, _, pointee] if op == Op::TypePointer as u32 => (id, of(pointee)),
            _ => continue,
        };
        types.insert(id, layout);
    }
    shared.sort_by_key(|one| std::cmp::Reverse(one.alignment));
    shared.into_iter().fold(Layout::default(), Layout::then).bytes
}

/// Size and alignment of a type in bytes.
#[derive(Clone, Copy)]
struct Layout {
    bytes: u64,
    alignment: u64,
}

impl Default for Layout {
    fn default() -> Self {
        Layout { bytes: 0, alignment: 1 }
    }
}

impl Layout {
    /// An array of it.
    fn times(self, count: u32) -> Layout {
        Layout { bytes: self.bytes.next_multiple_of(self.alignment).saturating_mul(count.into()), ..self }
    }

    /// Both, the other one behind it.
    fn then(self, next: Layout) -> Layout {
        let start = self.bytes.next_multiple_of(next.alignment);
        Layout { bytes: start.saturating_add(next.bytes), alignment: self.alignment.max(next.alignment) }
    }
}
