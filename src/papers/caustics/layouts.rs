//! Host structs against the blocks of buffers that hold them.

use super::culled_map::{CellBlock, StepsBlock};
use super::illumination_volumes::Ray;
use super::planes::Fit;
use super::receiver::BoxBlock;
use super::smart_planes::{PlacedBlock, SubBoxBlock};
use super::stencil_volumes::VolumesBlock;
use super::underwater::CameraBlock;
use super::view::ViewBlock;
use super::water_surface::{MapBlock, VERTEX_FLOATS, WaveBlock};
use crate::papers::layout::{block, check_block, check_constants_member, check_list};
use crate::papers::triangle_tree::Node;

#[test]
fn the_buffers_hold_what_the_shaders_read() {
    // Whole vectors, two of which are a wave.
    for shader in ["caustics/water-surface.comp", "caustics/view-above-whole.frag"] {
        assert_eq!(block(shader, "waves").members[0].array_stride_bytes, Some(16), "{shader}");
    }
    assert_eq!(size_of::<WaveBlock>(), 16);
    check_list::<Ray>("caustics/illumination-volumes.comp", "rays");
    for shader in
        ["cull-even.comp", "cull-fitted.comp", "culled.vert", "caustics-map-options-kept.vert", "smart-planes.comp"]
    {
        check_list::<CellBlock>(&format!("caustics/{shader}"), "cells");
    }
    for shader in ["caustics/cull-even.comp", "caustics/cull-fitted.comp", "caustics/culled.vert"] {
        check_list::<Ray>(shader, "rays");
    }
    for shader in ["caustics/cull-even.comp", "caustics/cull-fitted.comp"] {
        check_block::<StepsBlock>(shader, "steps");
    }
    for shader in ["caustics/sub-boxes.comp", "caustics/smart-planes.comp"] {
        check_list::<Fit>(shader, "fits");
        check_list::<SubBoxBlock>(shader, "sub_boxes");
    }
    for shader in ["caustics/sub-boxes.comp", "caustics/smart-planes.comp", "caustics/cull-fitted.comp"] {
        check_block::<PlacedBlock>(shader, "placed");
    }
    // Whole vectors, three of which are a ray.
    for shader in [
        "intersect-off-one.comp",
        "intersect-on-several.comp",
        "land-one.comp",
        "land-several.comp",
        "straddle-on-one.comp",
    ] {
        let rays = block(&format!("caustics/{shader}"), "rays");
        assert_eq!(rays.members[0].array_stride_bytes, Some(16), "{shader}");
    }
    assert_eq!(size_of::<Ray>(), 3 * 16);
    for shader in ["caustics/stencil-volumes.vert", "caustics/stencil-volumes.frag"] {
        check_list::<Ray>(shader, "rays");
        check_block::<VolumesBlock>(shader, "volumes");
    }
    for shader in ["caustics/cast.vert", "caustics/stencil-receivers.vert"] {
        check_block::<CameraBlock>(shader, "camera");
    }
    for shader in ["view-above", "view-above-map", "view-below"] {
        for tree in ["whole", "pieces"] {
            check_block::<ViewBlock>(&format!("caustics/{shader}-{tree}.frag"), "view");
        }
        check_list::<Node>(&format!("caustics/{shader}-whole.frag"), "nodes");
    }
    for shader in ["caustics/receiver-map.vert", "caustics/diffuse-map.frag", "caustics/cast-one.frag"] {
        check_constants_member::<BoxBlock>(shader, "bounds");
    }
    for shader in ["caustics/water-surface-map.comp", "caustics/view-above-map-whole.frag"] {
        check_constants_member::<MapBlock>(shader, "map");
    }
    let water =
        ["caustics/water-surface.comp", "caustics/water-surface-map.comp", "caustics/illumination-volumes.comp"];
    for shader in water {
        let water = block(shader, "water");
        assert_eq!(water.members[0].array_stride_bytes, Some(VERTEX_FLOATS * 4), "{shader}");
    }
}
