//! The uniform block against the shaders that read it. Push constants and vertices are checked whenever their pass is
//! built; buffers are made of bytes, so they are checked here.

use super::splatting::SceneBlock;
use crate::shader_build::{EMBEDDED, Interface};

#[test]
fn the_scene_holds_what_the_shaders_read() {
    for shader in [
        "lava/splat.geom",
        "lava/splat-quad.vert",
        "lava/visibility.frag",
        "lava/blending.frag",
        "lava/particles.vert",
        "lava/object.vert",
        "lava/object.frag",
    ] {
        let embedded = EMBEDDED.iter().find(|s| s.name == shader).expect("the shader is built in");
        let interface = Interface::reflect(embedded.glslang).expect("it reflects");
        let binding = interface.bindings.iter().find(|b| b.name == "scene").expect("it has the binding");
        let block = binding.block.as_ref().expect("it is a buffer");
        assert_eq!(block.check_host::<SceneBlock>(), Ok(()), "{shader}");
    }
}
