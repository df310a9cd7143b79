//! Host structs against the blocks of buffers that hold them; push constants are checked when their pass is built.

use super::drawing::ViewBlock;
use super::flames::{BillboardsBlock, Group, Particle};
use super::state::{Constants, Counts};
use crate::shader_build::{Block, EMBEDDED, Interface};

fn block(shader: &str, name: &str) -> Block {
    let embedded = EMBEDDED.iter().find(|s| s.name == shader).expect("the shader is built in");
    let interface = Interface::reflect(embedded.glslang).expect("it reflects");
    let binding = interface.bindings.into_iter().find(|b| b.name == name).expect("it has the binding");
    binding.block.expect("it is a buffer")
}

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in ["burning/internal-deformation.comp", "burning/normals.comp", "burning/draw.frag"] {
        assert_eq!(block(shader, "constants").check_host::<Constants>(), Ok(()), "{shader}");
    }
    assert_eq!(block("burning/draw.vert", "view").check_host::<ViewBlock>(), Ok(()));
    let clock = block("burning/heat-boundary-clock.comp", "Clock");
    let counts = clock.members[0].block.as_ref().expect("it is a structure");
    assert_eq!(counts.check_host::<Counts>(), Ok(()));
    assert_eq!(block("burning/flames.comp", "billboards").check_host::<BillboardsBlock>(), Ok(()));
    for (name, is_group) in [("Groups", true), ("Particles", false)] {
        let buffer = block("burning/flames.comp", name);
        let element = buffer.members[0].block.as_ref().expect("it is a list of structures");
        let checked = if is_group { element.check_host::<Group>() } else { element.check_host::<Particle>() };
        assert_eq!(checked, Ok(()), "{name}");
    }
}
