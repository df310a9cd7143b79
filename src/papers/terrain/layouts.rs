//! Host structs against the blocks of buffers that hold them.

use super::blocks::{LightBlock, TerrainBlock};
use crate::papers::layout::check_block;

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for program in [
        "depth-plane-bilinear-pixel",
        "depth-curved-bicubic-exact",
        "shadow-curved-bilinear",
        "normal-bicubic",
        "depth-dda-plane-packed16-exact",
        "start-packed32",
    ] {
        for stage in ["comp", "frag"] {
            check_block::<TerrainBlock>(&format!("terrain/{program}.{stage}"), "terrain");
        }
    }
    for program in ["depth-tiled-plane-bilinear-pixel", "shadow-tiled-curved-bicubic", "normal-tiled-bilinear"] {
        check_block::<TerrainBlock>(&format!("terrain/{program}.comp"), "terrain");
    }
    for shader in ["mesh.vert", "mesh.frag", "mesh-base-plane.frag", "mesh-base-curved.frag"] {
        check_block::<TerrainBlock>(&format!("terrain/{shader}"), "terrain");
    }
    let lit = [
        "illumination-picture.comp",
        "illumination-contours.frag",
        "object.frag",
        "object-depth.frag",
        "occlusion-whole.comp",
    ];
    for shader in lit {
        check_block::<LightBlock>(&format!("terrain/{shader}"), "light");
    }
}
