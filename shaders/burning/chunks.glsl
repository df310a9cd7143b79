// Chunks of vertices, or of triangles, that the boundary reaches at about the same time. A tick visits those alone that
// the fire can have changed, a workgroup each.

#include "common/elements.glsl"

const uint CHUNK = 128u;

layout(set = 0, binding = 90, std430) readonly buffer Order {
    uint order[]; // elements, CHUNK a chunk; NONE beyond the last
};

layout(set = 0, binding = 91, std430) readonly buffer Visited {
    uint visited[]; // how many chunks, then their numbers
};

// The chunk of this workgroup, NONE of one that the last row has beyond the list.
uint chunk_visited() {
    uint place = workgroup();
    if (place >= visited[0]) {
        return NONE;
    }
    return visited[1u + place];
}

// The vertex or triangle of this thread, NONE without any.
uint element_visited() {
    uint chunk = chunk_visited();
    if (chunk == NONE) {
        return NONE;
    }
    return order[CHUNK * chunk + gl_LocalInvocationID.x];
}
