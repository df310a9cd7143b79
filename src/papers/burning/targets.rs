//! What `--dump` writes: all that a second program needs to follow the object.

use super::Burning;
use super::puddle::PUDDLE_CELLS;
use crate::measure::Target;

/// The buffers of the newest state, and the picture with its depth.
pub fn targets(paper: &Burning) -> Vec<Target> {
    let (state, rotations) = paper.state();
    let buffers = &paper.buffers;
    let mut targets = vec![
        Target::table("rest", &buffers.rest, 4),
        Target::table("flammabilities", &buffers.flammabilities, 1),
        Target::table("meltabilities", &buffers.meltabilities, 1),
        Target::table("block-levels", &buffers.block_levels, 4),
        Target::words("triangles", &buffers.triangles, 3),
        Target::words("corners", &buffers.corners, 3),
        Target::words("welds", &buffers.welds, 1),
        Target::table("state", state, 4),
        Target::words("labels", &buffers.labels, 1),
        Target::words("triangle-labels", &buffers.triangle_labels, 1),
        Target::words("alive", &buffers.alive, 1),
        Target::words("removed", &buffers.removed, 1),
        Target::words("cells", &buffers.cells, 1),
        Target::integers("blocks", &buffers.blocks, 8),
        Target::table("rotations", rotations, 4),
        Target::words("clock", &buffers.clock, 11),
        Target::words("stream", &buffers.stream, 3),
        Target::table("mapped", &buffers.mapped, 4),
        Target::table("normals", &buffers.normals, 4),
        Target::table("colors", &buffers.colors, 4),
        Target::image("depth", &paper.draw.depth),
        Target::image("picture", &paper.draw.picture),
    ];
    if let Some(refinement) = &paper.refinement {
        targets.push(Target::integers("statuses", &refinement.statuses, 1));
    }
    if let Some(puddle) = &paper.puddle {
        targets.push(Target::words("puddle", &puddle.heights[paper.newest()], PUDDLE_CELLS));
        targets.push(Target::words("film", &puddle.film, 8));
    }
    if let Some(parts) = &paper.parts {
        targets.push(Target::words("part-of", &parts.part_of, 1));
        targets.push(Target::words("vertex-weights", &parts.weights, 1));
        targets.push(Target::table("parts", &parts.parts, 24));
    }
    if let Some(surface) = &paper.draw.surface {
        targets.push(Target::table("texture-coordinates", &surface.coordinates, 2));
    }
    if let Some(flames) = &paper.flames {
        targets.push(Target::words("flame-groups", &flames.groups, 4));
        targets.push(Target::table("particles", &flames.particles, 8));
    }
    targets
}
