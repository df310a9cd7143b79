#version 450

// The map as patches of one grid of triangles, each at its level of a quadtree, after F. Strugar, Continuous Distance-Dependent
// Level of Detail for Rendering Heightmaps (2010), section 3. There every vertex is morphed towards the coarser grid as its
// distance grows; here those on a side that a patch of the next coarser level shares lie on that patch's vertices, all others
// where the map has them: no crack in a picture, and no morph between two. Walls close the map's sides as those of mesh.vert do.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/mesh.glsl"
#include "terrain/geodesy.glsl"
#include "terrain/patch.glsl"

layout(location = 0) in ivec2 corner; // the patch's first node
layout(location = 1) in int shift; // its level
layout(location = 2) in int coarser; // sides beside a coarser patch: 1 west, 2 east, 4 north, 8 south

void main() {
    read_map();
    int index = int(gl_VertexIndex);
    ivec2 last = terrain.size - 1;
    ivec2 vertex = ivec2(index % (PATCH_SIDE + 1), index / (PATCH_SIDE + 1));
    bool is_low = false;
    bool is_here = true;
    if (!is_kind(mesh.surface, TERRAIN, float(index))) {
        // Six vertices for each piece of a wall: near top, near foot, far top; far top, near foot, far foot.
        int of_piece = index % 6;
        int along = index / 6 + (of_piece == 2 || of_piece == 3 || of_piece == 5 ? 1 : 0);
        is_low = of_piece == 1 || of_piece == 4 || of_piece == 5;
        bool is_high = mesh.surface == WALL_EAST || mesh.surface == WALL_SOUTH;
        bool is_column = mesh.surface == WALL_WEST || mesh.surface == WALL_EAST;
        int across = is_high ? PATCH_SIDE : 0;
        vertex = is_column ? ivec2(across, along) : ivec2(along, across);
        ivec2 far = min(corner + (PATCH_SIDE << shift), last);
        ivec2 reached = is_high ? last - far : corner;
        is_here = (is_column ? reached.x : reached.y) == 0;
    }
    // To the vertex before on the north and west sides and to the one after on the others: then the corner of two such sides
    // keeps its inner vertex.
    ivec2 odd = vertex & 1;
    if ((vertex.y == 0 && (coarser & 4) != 0) || (vertex.y == PATCH_SIDE && (coarser & 8) != 0)) {
        vertex.x += vertex.y == 0 ? -odd.x : odd.x;
    }
    if ((vertex.x == 0 && (coarser & 1) != 0) || (vertex.x == PATCH_SIDE && (coarser & 2) != 0)) {
        vertex.y += vertex.x == 0 ? -odd.y : odd.y;
    }
    ivec2 node = min(corner + (vertex << shift), last);
    float height = highest_at(0, node);
    if (is_low) {
        height = min(terrain.base_height, height);
    }
    // A side of a patch that is none of the map's has no wall: all of its vertices lie in one place.
    gl_Position = mesh.to_clip * vec4(frame_point(vec2(is_here ? node : corner), is_here ? height : 0.0), 1.0);
}
