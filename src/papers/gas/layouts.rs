//! Host structs against the blocks of buffers that hold them.

use super::blocks::{FrameBlock, LightBlock, ObjectBlock, VertexBlock, VolumeBlock};
use super::capacity::{LINK_BYTES, PIXEL_BYTES, SECTION_BYTES};
use crate::papers::layout::{block, check_block, check_list};

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    for shader in ["gas/fragments.geom", "gas/sort.comp", "gas/volume-table.comp", "gas/resolve.comp"] {
        check_block::<FrameBlock>(shader, "frame");
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
