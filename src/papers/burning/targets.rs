//! Targets that can be dumped: all that a second program needs to follow the object.

use super::Burning;
use super::puddle::PUDDLE_CELLS;
use crate::measure::Target;

/// The buffers of the newest state, and the picture with its depth.
pub fn targets(paper: &Burning) -> Vec<Target> {
    let (state, rotations) = paper.state();
    let buffers = &paper.buffers;
    let mut targets = vec![
        Target::table("rest", &buffers.rest, 4)
            .of("a vertex at rest: x, y, z and the radius at which the boundary reaches it, diagonals"),
        Target::table("flammabilities", &buffers.flammabilities, 1).of("L of a vertex"),
        Target::table("meltabilities", &buffers.meltabilities, 1)
            .of("epsilon of the edge after each corner of a triangle"),
        Target::table("block-levels", &buffers.block_levels, 4).of("beta, rho, phi and mean L of a block"),
        Target::words("triangles", &buffers.triangles, 3).of("vertices of a triangle"),
        Target::words("corners", &buffers.corners, 3).of("draw vertices of a triangle"),
        Target::words("welds", &buffers.welds, 1).of("the vertex of a draw vertex"),
        Target::table("state", state, 4).of("a vertex: x, y, z in diagonals, L"),
        Target::words("labels", &buffers.labels, 1).of("area of the boundary that a vertex is in"),
        Target::words("triangle-labels", &buffers.triangle_labels, 1).of("area of the boundary that a triangle is in"),
        Target::words("alive", &buffers.alive, 1).of("1 where the vertex exists"),
        Target::words("removed", &buffers.removed, 1).of("1 where the triangle has left"),
        Target::words("cells", &buffers.cells, 1).of("the block of a vertex"),
        Target::integers("blocks", &buffers.blocks, 8).of("counts of a block"),
        Target::table("rotations", rotations, 4).of("pitch, yaw, roll of a block in radians"),
        Target::words("clock", &buffers.clock, 11)
            .of("counts: ticks, boundary, active, live, removed, drawn, particles"),
        Target::words("stream", &buffers.stream, 3).of("draw vertices of a drawn triangle"),
        Target::table("mapped", &buffers.mapped, 4)
            .of("a vertex: x, y, z in diagonals with the block's rotation, L over L0"),
        Target::table("normals", &buffers.normals, 4).of("normal x, y, z, share that is charred, 0 to 1"),
        Target::table("colors", &buffers.colors, 4).of("light in red, green, blue, linear, and the glow"),
        Target::image("depth", &paper.draw.depth)
            .of("depth, 0 at the near plane to 1 at the far one")
            .between(paper.draw.camera.near_m, paper.draw.camera.far_m),
        Target::image("picture", &paper.draw.picture).of("red, green, blue, alpha as sRGB encodes them, 0 to 255"),
    ];
    if let Some(fire_lights) = &paper.fire_lights {
        targets.push(Target::image("radiance", &paper.draw.target).of("linear light before fire and smoke, alpha"));
        targets.push(
            Target::table("fire-lights", fire_lights, 8).of(
                "a light of the flames: x, y, z, radius in diagonals, linear red, green, blue, count of the lights",
            ),
        );
        if let Some(volume) = paper.smoke_volume() {
            targets.push(
                Target::table("smoke-grid", &volume.grid, 4).of("corner x, y, z and width of a cell of the smoke"),
            );
            targets.push(
                Target::table("smoke-volume", &volume.cells, 4)
                    .of("a cell of the smoke: light in red, green, blue times extinction, extinction"),
            );
        }
    }
    if let Some(draw_fire) = paper.draw_fire.as_ref().filter(|_| paper.parameters.has_fire_layer()) {
        targets.push(Target::image("fire-layer", &draw_fire.target).of("linear light of fire and smoke, alpha"));
    }
    if let Some(refinement) = &paper.refinement {
        targets.push(
            Target::integers("statuses", &refinement.statuses, 1)
                .of("a node of the refinement: -1 split, 0 unused, 1 drawn"),
        );
    }
    if let Some(puddle) = &paper.puddle {
        targets.push(
            Target::words("puddle", &puddle.heights[paper.newest()], PUDDLE_CELLS)
                .of("volume over a cell, 2^-32 cubed diagonals"),
        );
        targets.push(Target::words("film", &puddle.film, 8).of("volumes of mesh and puddle, 2^-32 cubed diagonals"));
    }
    if let Some(parts) = &paper.parts {
        targets.push(Target::words("part-of", &parts.part_of, 1).of("the part of a vertex"));
        targets.push(
            Target::table("bends", &parts.bends, 8)
                .of("a vertex: quaternion x, y, z, w and offset x, y, z that bend its place, diagonals"),
        );
        targets.push(Target::words("vertex-weights", &parts.weights, 1).of("weight of a vertex"));
        targets.push(
            Target::table("parts", &parts.parts, 24)
                .of("a part: rotation, offset, velocity, spin, weight, middle and extent in diagonals and ticks"),
        );
    }
    if let Some(surface) = &paper.draw.surface {
        targets.push(
            Target::table("texture-coordinates", &surface.coordinates, 2).of("u, v of a draw vertex in texture units"),
        );
    }
    if let Some(flames) = &paper.flames {
        targets.push(
            Target::words("flame-groups", &flames.groups, 4)
                .of("a block: its first fire and smoke particle, ready vertices before it, live vertices"),
        );
        targets.push(
            Target::table("particles", &flames.particles, 8)
                .of("a particle: place in diagonals, age and life in ticks, its block, two numbers of its own"),
        );
    }
    targets
}
