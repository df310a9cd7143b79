#version 450

// The corners of a triangle that is there hang together, and so do the vertices at which parts of the mesh touch,
// until one of them has burnt out.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/vertices.glsl"
#include "burning/roots.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 62, std430) readonly buffer Touching {
    uvec2 touching[]; // pairs of vertices, one at least
};

layout(push_constant, std430) uniform Touches {
    uint count;
} touches;

void main() {
    uint thread = element(64u);
    if (thread < constants.triangle_count) {
        if (removed[thread] == 0u) {
            uint first = triangles[3u * thread];
            unite(first, triangles[3u * thread + 1u]);
            unite(first, triangles[3u * thread + 2u]);
        }
        return;
    }
    uint pair = thread - constants.triangle_count;
    if (pair < touches.count) {
        uvec2 ends = touching[pair];
        if (new_state[ends.x].left > 0.0 && new_state[ends.y].left > 0.0) {
            unite(ends.x, ends.y);
        }
    }
}
