#version 450

// How far the map is from the bilinear cells of a coarser grid, for the variant mesh-lod: the error measure that CDLOD (F. Strugar,
// Continuous Distance-Dependent Level of Detail for Rendering Heightmaps, 2010) leaves to its user. A cell of twice the step
// differs from the cells of the step by most at the nodes between its own; what those differ from the map was found before. Both
// surfaces are bilinear on each smaller cell, so no place is farther off than a node.

#extension GL_EXT_samplerless_texture_functions : require

layout(set = 0, binding = 0) uniform utexture2DArray levels;
layout(set = 0, binding = 1) uniform texture2D finer; // the error of the cells of the step

layout(push_constant, std430) uniform Cells {
    ivec2 last; // column and row of the map
    ivec2 last_cell; // and of the finer cells
    int step; // nodes from one to the next of those cells
    int is_float;
    int is_first; // the finer cells are the map's own
} cells;

layout(location = 0) out float error;

float height_at(int column, int row) {
    uint bits = texelFetch(levels, ivec3(column, row, 0), 0).x;
    return cells.is_float != 0 ? uintBitsToFloat(bits) : float(int(bits));
}

float error_of(ivec2 cell) {
    return texelFetch(finer, min(cell, cells.last_cell), 0).x;
}

void main() {
    ivec2 cell = ivec2(gl_FragCoord.xy);
    ivec2 a = 2 * cells.step * cell;
    ivec2 b = min(a + cells.step, cells.last);
    ivec2 c = min(a + 2 * cells.step, cells.last);
    vec2 part = vec2(b - a) / vec2(c - a);
    vec2 north = vec2(height_at(a.x, a.y), height_at(c.x, a.y));
    vec2 south = vec2(height_at(a.x, c.y), height_at(c.x, c.y));
    float above = mix(north.x, north.y, part.x);
    float below = mix(south.x, south.y, part.x);
    vec2 beside = mix(north, south, part.y);
    float off = max(abs(height_at(b.x, a.y) - above), abs(height_at(b.x, c.y) - below));
    off = max(off, max(abs(height_at(a.x, b.y) - beside.x), abs(height_at(c.x, b.y) - beside.y)));
    off = max(off, abs(height_at(b.x, b.y) - mix(above, below, part.y)));
    float before = max(max(error_of(2 * cell), error_of(2 * cell + ivec2(1, 0))),
                       max(error_of(2 * cell + ivec2(0, 1)), error_of(2 * cell + 1)));
    error = off + (cells.is_first != 0 ? 0.0 : before);
}
