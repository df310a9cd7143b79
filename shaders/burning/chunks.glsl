// Chunks of vertices, or of triangles, that the boundary reaches at about the same time. A tick visits those alone that
// the fire can have changed, a workgroup each.

const uint CHUNK = 128u;

layout(set = 0, binding = 90, std430) readonly buffer Order {
    uint order[]; // elements, CHUNK a chunk; NONE beyond the last
};

layout(set = 0, binding = 91, std430) readonly buffer Visited {
    uint visited[]; // how many chunks, then their numbers
};

uint chunk_visited() {
    return visited[1u + gl_WorkGroupID.x];
}

// The vertex or triangle of this thread, NONE without any.
uint element_visited() {
    return order[CHUNK * chunk_visited() + gl_LocalInvocationID.x];
}
