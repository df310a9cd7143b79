#version 450

// The surface of the puddle: a corner of four cells, at their mean height.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/puddle.glsl"

layout(set = 0, binding = 75, std430) readonly buffer Heights {
    uint heights[];
};

layout(location = 0) out vec3 position;
layout(location = 1) out vec3 normal; // not of unit length
layout(location = 2) out float thickness; // diagonals

float height_of(ivec2 cell) {
    bool is_inside = all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, ivec2(PUDDLE_CELLS)));
    ivec2 at = clamp(cell, ivec2(0), ivec2(PUDDLE_CELLS - 1));
    return is_inside ? float(heights[at.y * PUDDLE_CELLS + at.x]) * HEIGHT_OF_UNIT : 0.0;
}

void main() {
    ivec2 corner = ivec2(gl_VertexIndex % (PUDDLE_CELLS + 1), gl_VertexIndex / (PUDDLE_CELLS + 1));
    float low = height_of(corner - 1);
    float right = height_of(corner + ivec2(0, -1));
    float far = height_of(corner + ivec2(-1, 0));
    float both = height_of(corner);
    thickness = 0.25 * (low + right + far + both);
    vec2 slope = 0.5 * vec2(right + both - low - far, far + both - low - right) / CELL_WIDTH;
    normal = vec3(-slope.x, 1.0, -slope.y);
    vec2 xz = vec2(corner) * CELL_WIDTH - PUDDLE_HALF_WIDTH;
    position = vec3(xz.x, constants.floor_y + thickness, xz.y);
    gl_Position = view.view_projection * vec4(position, 1.0);
}
