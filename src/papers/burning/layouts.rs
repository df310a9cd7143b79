//! Host structs against the blocks of buffers that hold them.

use super::buffers::{BlockCounts, Constants, Counts, RestVertex, VertexState};
use super::draw::ViewBlock;
use super::flames::{BillboardsBlock, Group, Particle};
use super::texture::TextureLevel;
use crate::papers::layout::{block, check_block, check_list};

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in ["burning/internal-deformation.comp", "burning/normals.comp", "burning/draw.frag"] {
        check_block::<Constants>(shader, "constants");
    }
    check_block::<ViewBlock>("burning/draw-surface.vert", "view");
    let clock = block("burning/heat-boundary-clock.comp", "Clock");
    let counts = clock.members[0].block.as_ref().expect("it is a structure");
    assert_eq!(counts.check_host::<Counts>(), Ok(()));
    check_block::<BillboardsBlock>("burning/flames.comp", "billboards");
    check_list::<RestVertex>("burning/heat-boundary-vertices.comp", "Rest");
    check_list::<VertexState>("burning/internal-deformation.comp", "NewState");
    check_list::<BlockCounts>("burning/block-weights.comp", "Blocks");
    check_list::<TextureLevel>("burning/draw-textured.frag", "TextureLevels");
    check_list::<Group>("burning/flames.comp", "Groups");
    check_list::<Particle>("burning/flames.comp", "Particles");
}
