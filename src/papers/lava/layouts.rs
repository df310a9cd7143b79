//! The uniform block against the shaders that read it.

use super::scene::SceneBlock;
use crate::papers::layout::check_block;

#[test]
fn the_scene_holds_what_the_shaders_read() {
    for shader in [
        "lava/splat.geom",
        "lava/splat-quad.vert",
        "lava/visibility-free.frag",
        "lava/visibility-sph.frag",
        "lava/blending-free.frag",
        "lava/blending-sph.frag",
        "lava/deferred-blending-free.frag",
        "lava/deferred-blending-sph.frag",
        "lava/deferred-free.frag",
        "lava/deferred-sph.frag",
        "lava/march-free.frag",
        "lava/march-sph.frag",
        "lava/particles.vert",
        "lava/object-free.vert",
        "lava/object-sph.vert",
        "lava/object-free.frag",
        "lava/object-sph.frag",
        "lava/lava-light.comp",
        "lava/cull-kept.comp",
        "lava/cull-culled.comp",
    ] {
        check_block::<SceneBlock>(shader, "scene");
    }
}
