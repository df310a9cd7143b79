#version 450

// What the method is compared with: the map as a grid of triangles, heights fetched from the same image. Walls close the map's
// sides down to the base.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/mesh.glsl"
#include "terrain/geodesy.glsl"

void main() {
    read_map();
    int index = int(gl_VertexIndex);
    ivec2 last = terrain.size - 1;
    ivec2 node = ivec2(index % terrain.size.x, index / terrain.size.x + mesh.first_row);
    bool is_low = false;
    if (!is_kind(mesh.surface, TERRAIN, float(index))) {
        // Six vertices for each piece of a wall: near top, near foot, far top; far top, near foot, far foot.
        int corner = index % 6;
        int along = index / 6 + (corner == 2 || corner == 3 || corner == 5 ? 1 : 0);
        is_low = corner == 1 || corner == 4 || corner == 5;
        node = ivec2(mesh.surface == WALL_EAST ? last.x : 0, along);
        if (mesh.surface == WALL_NORTH || mesh.surface == WALL_SOUTH) {
            node = ivec2(along, mesh.surface == WALL_SOUTH ? last.y : 0);
        }
    }
    float height = highest_at(0, min(node, last));
    if (is_low) {
        height = min(terrain.base_height, height);
    }
    gl_Position = mesh.to_clip * vec4(frame_point(vec2(node), height), 1.0);
}
