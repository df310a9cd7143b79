//! Host structs against the blocks of buffers that hold them.

use super::bending::{Hinge, Load};
use super::buffers::{BlockCounts, Constants, Counts, RestVertex, VertexState};
use super::draw::ViewBlock;
use super::flame_lights::FireLight;
use super::flames::{BillboardsBlock, Group, Particle};
use super::materials::{Appearance, BlockLevels};
use super::model::{Cut, Hold, Joint, Section};
use super::parts::{Bend, Part, Progress};
use super::puddle::Film;
use super::smoke_volume::SmokeGrid;
use super::texture::TextureLevel;
use crate::papers::layout::{block, check_block, check_list};

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in ["burning/internal-deformation.comp", "burning/normals-one.comp", "burning/draw-sun.frag"] {
        check_block::<Constants>(shader, "constants");
    }
    check_block::<ViewBlock>("burning/draw-surface.vert", "view");
    let clock = block("burning/heat-boundary-clock.comp", "Clock");
    let counts = clock.members[0].block.as_ref().expect("it is a structure");
    assert_eq!(counts.check_host::<Counts>(), Ok(()));
    check_block::<BillboardsBlock>("burning/flames-whole.comp", "billboards");
    check_list::<RestVertex>("burning/heat-boundary-vertices.comp", "Rest");
    check_list::<VertexState>("burning/internal-deformation.comp", "NewState");
    check_list::<BlockCounts>("burning/block-weights-placed.comp", "Blocks");
    check_list::<TextureLevel>("burning/draw-textured-sun.frag", "TextureLevels");
    check_list::<BlockLevels>("burning/block-rotation-shell.comp", "BlockConstants");
    check_list::<Appearance>("burning/draw-several-sun.frag", "Substances");
    check_list::<FireLight>("burning/flame-lights.comp", "FireLights");
    check_list::<Group>("burning/flames-whole.comp", "Groups");
    check_list::<Particle>("burning/flames-whole.comp", "Particles");
    check_list::<Part>("burning/falling.comp", "Parts");
    check_list::<Bend>("burning/bending-vertices.comp", "Bends");
    check_list::<Hold>("burning/bending-vertices.comp", "Holds");
    check_list::<Load>("burning/bending-loads.comp", "Loads");
    check_list::<Cut>("burning/bending-loads.comp", "Cuts");
    check_list::<Section>("burning/bending.comp", "Sections");
    check_list::<Joint>("burning/bending.comp", "Joints");
    check_list::<Hinge>("burning/bending.comp", "Hinges");
    let films = block("burning/puddle.comp", "Films");
    assert_eq!(films.members[0].block.as_ref().expect("it is a structure").check_host::<Film>(), Ok(()));
    let grids = block("burning/smoke-box.comp", "SmokeGrid");
    assert_eq!(grids.members[0].block.as_ref().expect("it is a structure").check_host::<SmokeGrid>(), Ok(()));
    let searching = block("burning/parts-number.comp", "Searching");
    let progress = searching.members[0].block.as_ref().expect("it is a structure");
    assert_eq!(progress.check_host::<Progress>(), Ok(()));
}
