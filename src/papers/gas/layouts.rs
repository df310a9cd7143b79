//! Host structs against the blocks of buffers that hold them.

use super::blocks::{CountersBlock, CountsBlock, FrameBlock, GridBlock, LightBlock, ObjectBlock, VolumeBlock};
use super::progress::UnfinishedBlock;
use crate::papers::layout::{check_block, check_list};

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in [
        "gas/fragments.geom",
        "gas/sort-one.comp",
        "gas/volume-table-functions-kept-one.comp",
        "gas/resolve-none-one.comp",
    ] {
        check_block::<FrameBlock>(shader, "frame");
    }
    check_list::<VolumeBlock>("gas/volume-traced-functions-kept-one.comp", "Volumes");
    check_list::<GridBlock>("gas/volume-traced-trilinear-kept-one.comp", "Grids");
    check_list::<LightBlock>("gas/volume-traced-functions-kept-one.comp", "Lights");
    check_list::<ObjectBlock>("gas/fragments.geom", "Objects");
    check_block::<CountsBlock>("gas/resolve-none-one.comp", "counts");
    check_block::<UnfinishedBlock>("gas/sort-one.comp", "Unfinished");
    check_block::<CountersBlock>("gas/sort-one.comp", "Counters");
}
