//! Host structs against the blocks of buffers that hold them; push constants are checked when their pass is built.

use super::blocks::{FrameBlock, LightBlock, ObjectBlock, VertexBlock, VolumeBlock};
use super::capacity::{LINK_BYTES, PIXEL_BYTES, SECTION_BYTES};
use crate::shader_build::{Block, EMBEDDED, HostBlock, Interface};

fn block(shader: &str, name: &str) -> Block {
    let embedded = EMBEDDED.iter().find(|s| s.name == shader).expect("the shader is built in");
    let interface = Interface::reflect(embedded.glslang).expect("it reflects");
    let binding = interface.bindings.into_iter().find(|b| b.name == name).expect("it has the binding");
    binding.block.expect("it is a buffer")
}

fn check_list<T: HostBlock>(shader: &str, name: &str) {
    let block = block(shader, name);
    assert_eq!(block.members[0].check_elements::<T>(), Ok(()), "{shader}: {name}");
}

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in ["gas/fragments.geom", "gas/sort.comp", "gas/volume-table.comp", "gas/resolve.comp"] {
        assert_eq!(block(shader, "frame").check_host::<FrameBlock>(), Ok(()), "{shader}");
    }
    check_list::<VolumeBlock>("gas/volume-traced.comp", "Volumes");
    check_list::<LightBlock>("gas/volume-traced.comp", "Lights");
    check_list::<ObjectBlock>("gas/fragments.geom", "Objects");
    check_list::<VertexBlock>("gas/fragments.geom", "Vertices");
    for (shader, name, bytes) in [
        ("gas/resolve.comp", "Sections", SECTION_BYTES),
        ("gas/sort.comp", "Links", LINK_BYTES),
        ("gas/sort.comp", "Surfaces", LINK_BYTES),
        ("gas/sort.comp", "Pixels", PIXEL_BYTES),
    ] {
        assert_eq!(block(shader, name).members[0].array_stride_bytes.map(u64::from), Some(bytes), "{name}");
    }
}
