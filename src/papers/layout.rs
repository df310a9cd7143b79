//! Checks that the papers' tests of layouts share: host structs against the blocks of buffers that hold them. Push constants and
//! vertices are checked whenever their pass is built; buffers are made of bytes, so tests check them.

use crate::shader_build::{Block, EMBEDDED, HostBlock, Interface};

/// The block that `shader` knows as `name`.
pub fn block(shader: &str, name: &str) -> Block {
    let embedded = EMBEDDED.iter().find(|s| s.name == shader).expect("the shader is built in");
    let interface = Interface::reflect(embedded.glslang).expect("it reflects");
    let binding = interface.bindings.into_iter().find(|b| b.name == name).expect("it has the binding");
    binding.block.expect("it is a buffer")
}

/// Fails unless the block is a `T`.
pub fn check_block<T: HostBlock>(shader: &str, name: &str) {
    assert_eq!(block(shader, name).check_host::<T>(), Ok(()), "{shader}: {name}");
}

/// Fails unless the block's one member is a list of `T`s.
pub fn check_list<T: HostBlock>(shader: &str, name: &str) {
    assert_eq!(block(shader, name).members[0].check_elements::<T>(), Ok(()), "{shader}: {name}");
}

/// Fails unless the member of that name in the push constants of `shader` is a `T`.
pub fn check_constants_member<T: HostBlock>(shader: &str, name: &str) {
    let embedded = EMBEDDED.iter().find(|s| s.name == shader).expect("the shader is built in");
    let constants =
        Interface::reflect(embedded.glslang).expect("it reflects").push_constants.expect("it has constants");
    let member = constants.members.into_iter().find(|m| m.name == name).expect("it has the member");
    assert_eq!(member.block.expect("it is a structure").check_host::<T>(), Ok(()), "{shader}: {name}");
}
