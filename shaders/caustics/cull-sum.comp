#version 450

// The pairs before each block, in place of those in it, and the parameters of the draw (section 6.1). One workgroup.

layout(local_size_x = 256) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) buffer Blocks {
    uint list[];
} blocks;

layout(std430, set = 0, binding = 1) buffer Arguments {
    uint index_count;
    uint instance_count;
    uint first_index;
    int vertex_offset;
    uint first_instance;
} arguments;

shared uint sums[256];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint each = (cull.blocks + 255u) / 256u;
    uint from = min(lane * each, cull.blocks);
    uint to = min(from + each, cull.blocks);
    uint own = 0u;
    for (uint block = from; block < to; block++) {
        own += blocks.list[block];
    }
    sums[lane] = own;
    barrier();
    for (uint reach = 1u; reach < 256u; reach *= 2u) {
        uint add = 0u;
        if (lane >= reach) {
            add = sums[lane - reach];
        }
        barrier();
        sums[lane] += add;
        barrier();
    }
    uint before = sums[lane] - own;
    for (uint block = from; block < to; block++) {
        uint count = blocks.list[block];
        blocks.list[block] = before;
        before += count;
    }
    if (lane == 255u) {
        arguments.index_count = 3u * sums[255];
        arguments.instance_count = 1u;
        arguments.first_index = 0u;
        arguments.vertex_offset = 0;
        arguments.first_instance = 0u;
    }
}
