//! Host structs against the blocks of buffers that hold them. Push constants and vertices are checked whenever their
//! pass is built; buffers are made of bytes, so they are checked here.

use super::cast::CameraBlock;
use super::illumination::Ray;
use super::stencil::VolumesBlock;
use super::view::ViewBlock;
use super::water::{VERTEX_FLOATS, WaveBlock};
use crate::shader_build::{Block, EMBEDDED, HostBlock, Interface};

fn block(shader: &str, name: &str) -> Block {
    let embedded = EMBEDDED.iter().find(|s| s.name == shader).expect("the shader is built in");
    let interface = Interface::reflect(embedded.glslang).expect("it reflects");
    let binding = interface.bindings.into_iter().find(|b| b.name == name).expect("it has the binding");
    binding.block.expect("it is a buffer")
}

fn check_uniform<T: HostBlock>(shader: &str, name: &str) {
    assert_eq!(block(shader, name).check_host::<T>(), Ok(()), "{shader}: {name}");
}

fn check_list<T: HostBlock>(shader: &str, name: &str) {
    let block = block(shader, name);
    assert_eq!(block.members[0].check_elements::<T>(), Ok(()), "{shader}: {name}");
}

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in ["caustics/water-surface.comp", "caustics/view-above.frag"] {
        check_list::<WaveBlock>(shader, "waves");
    }
    check_list::<Ray>("caustics/illumination-volumes.comp", "rays");
    for shader in ["caustics/stencil-volumes.vert", "caustics/stencil-volumes.frag"] {
        check_list::<Ray>(shader, "rays");
        check_uniform::<VolumesBlock>(shader, "volumes");
    }
    for shader in ["caustics/cast.vert", "caustics/stencil-receivers.vert"] {
        check_uniform::<CameraBlock>(shader, "camera");
    }
    for shader in ["caustics/view-above.frag", "caustics/view-above-map.frag"] {
        check_uniform::<ViewBlock>(shader, "view");
    }
    let water =
        ["caustics/water-surface.comp", "caustics/water-surface-map.comp", "caustics/illumination-volumes.comp"];
    for shader in water {
        let water = block(shader, "water");
        assert_eq!(water.members[0].array_stride_bytes, Some(VERTEX_FLOATS * 4), "{shader}");
    }
}
