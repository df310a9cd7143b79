#version 450

// A patch of the variant mesh-lod, one for each pixel: how far its triangles are from the map at most, and the lowest and the
// highest of its vertices. Two triangles leave the bilinear cell whose corners they have by a quarter of its twist.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/patch.glsl"

layout(set = 0, binding = 0) uniform utexture2DArray levels;
layout(set = 0, binding = 1) uniform texture2D errors; // of the cells

layout(push_constant, std430) uniform Cells {
    ivec2 last; // column and row of the map
    ivec2 last_cell;
    int step; // nodes from one to the next of the cells
    int is_float;
    int is_first; // the cells are the map's own
} cells;

layout(location = 0) out vec4 bounds; // error, lowest, highest

float height_at(int column, int row) {
    uint bits = texelFetch(levels, ivec3(column, row, 0), 0).x;
    return cells.is_float != 0 ? uintBitsToFloat(bits) : float(int(bits));
}

void main() {
    ivec2 first = PATCH_SIDE * ivec2(gl_FragCoord.xy);
    ivec2 end = min(first + PATCH_SIDE - 1, cells.last_cell);
    bounds = vec4(0.0, height_at(cells.step * first.x, cells.step * first.y), 0.0, 0.0);
    bounds.z = bounds.y;
    for (int row = first.y; row <= end.y; row++) {
        for (int column = first.x; column <= end.x; column++) {
            ivec2 a = cells.step * ivec2(column, row);
            ivec2 b = min(a + cells.step, cells.last);
            vec4 corners = vec4(height_at(a.x, a.y), height_at(b.x, a.y), height_at(a.x, b.y), height_at(b.x, b.y));
            vec2 lowest = min(corners.xy, corners.zw);
            vec2 highest = max(corners.xy, corners.zw);
            float twist = abs(corners.x - corners.y - corners.z + corners.w);
            float error = cells.is_first != 0 ? 0.0 : texelFetch(errors, ivec2(column, row), 0).x;
            bounds = vec4(max(bounds.x, error + 0.25 * twist), min(bounds.y, min(lowest.x, lowest.y)),
                          max(bounds.z, max(highest.x, highest.y)), 0.0);
        }
    }
}
