//! Proves that naga's binary fits the layouts that are built from glslang's.

use std::fmt::Debug;

use super::error::InterfaceMismatch;
use super::interface::{Binding, Block, Interface, Location, Member};

/// Compares two binaries of one shader: stage, workgroup, resources by set and binding, push constants and
/// located inputs and outputs. Blocks are compared by offset, size and stride without their wrappers, and
/// names not at all. naga drops what a shader declares and never uses, so it may have less, never more.
///
/// # Errors
/// The first difference.
pub fn check_same_interface(glslang: &Interface, naga: &Interface) -> Result<(), InterfaceMismatch> {
    check_equal("the stage", &glslang.stage, &naga.stage)?;
    check_equal("the workgroup size", &glslang.local_size, &naga.local_size)?;
    for theirs in &naga.bindings {
        let at = format!("set {} binding {}", theirs.set, theirs.binding);
        let ours = glslang.binding(theirs.set, theirs.binding);
        let shape = |binding: &Binding| (binding.kind, binding.count);
        check_equal(&at, &ours.map(shape), &Some(shape(theirs)))?;
        let block = ours.and_then(|binding| binding.block.as_ref());
        check_optional_blocks(&at, block, theirs.block.as_ref())?;
    }
    if naga.push_constants.is_some() {
        check_optional_blocks("the push constants", glslang.push_constants.as_ref(), naga.push_constants.as_ref())?;
    }
    check_locations("input", &glslang.inputs, &naga.inputs)?;
    check_locations("output", &glslang.outputs, &naga.outputs)
}

fn check_optional_blocks(what: &str, glslang: Option<&Block>, naga: Option<&Block>) -> Result<(), InterfaceMismatch> {
    match (glslang, naga) {
        (Some(glslang), Some(naga)) => check_blocks(what, glslang, naga),
        _ => check_equal(what, &glslang.is_some(), &naga.is_some()),
    }
}

fn check_blocks(what: &str, glslang: &Block, naga: &Block) -> Result<(), InterfaceMismatch> {
    let (glslang, naga) = (glslang.unwrapped(), naga.unwrapped());
    check_equal(&format!("the member count of {what}"), &glslang.members.len(), &naga.members.len())?;
    for (index, (ours, theirs)) in glslang.members.iter().zip(&naga.members).enumerate() {
        let what = format!("member {index} (`{}`) of {what}", ours.name);
        let place = |member: &Member| (member.offset_bytes, member.size_bytes, member.array_stride_bytes);
        check_equal(&what, &place(ours), &place(theirs))?;
        check_optional_blocks(&what, ours.block.as_ref(), theirs.block.as_ref())?;
    }
    Ok(())
}

fn check_locations(direction: &str, glslang: &[Location], naga: &[Location]) -> Result<(), InterfaceMismatch> {
    let formats = |locations: &[Location]| {
        // naga writes an array as one variable for each location that it takes.
        let spread = |place: &Location| {
            let format = place.format;
            (place.location..place.location.saturating_add(place.count)).map(move |location| (location, format))
        };
        locations.iter().flat_map(spread).collect::<Vec<_>>()
    };
    check_equal(&format!("the {direction} locations"), &formats(glslang), &formats(naga))
}

fn check_equal<T: PartialEq + Debug>(what: &str, glslang: &T, naga: &T) -> Result<(), InterfaceMismatch> {
    if glslang == naga {
        return Ok(());
    }
    Err(InterfaceMismatch { what: what.to_owned(), glslang: format!("{glslang:?}"), naga: format!("{naga:?}") })
}
