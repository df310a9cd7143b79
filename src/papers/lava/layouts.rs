//! The uniform block against the shaders that read it.

use super::scene::SceneBlock;
use crate::papers::layout::check_block;

#[test]
fn the_scene_holds_what_the_shaders_read() {
    for shader in [
        "lava/splat.geom",
        "lava/splat-quad.vert",
        "lava/visibility.frag",
        "lava/blending-height.frag",
        "lava/blending-carried.frag",
        "lava/march-height.frag",
        "lava/march-carried.frag",
        "lava/particles.vert",
        "lava/object.vert",
        "lava/object.frag",
    ] {
        check_block::<SceneBlock>(shader, "scene");
    }
}
