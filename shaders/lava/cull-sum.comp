#version 450

#pragma variants SPLATS=points,quads

// The splats that stay of the clusters before each, in place of its own count, and the parameters of the draw. One workgroup.

layout(local_size_x = 256) in;

#include "lava/cull.glsl"

layout(set = 0, binding = 0, std430) buffer Kept {
    uvec4 list[]; // in z the count, then the sum before it
} kept;

layout(set = 0, binding = 1, std430) buffer Arguments {
    uint index_count;
    uint instance_count;
    uint first_index;
    int vertex_offset;
    uint first_instance;
    uint clusters; // of which any splat was looked at
} arguments;

shared uvec2 sums[256];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint each = (cull.clusters + 255u) / 256u;
    uint from = min(lane * each, cull.clusters);
    uint to = min(from + each, cull.clusters);
    uvec2 own = uvec2(0u);
    for (uint cluster = from; cluster < to; cluster++) {
        own += kept.list[cluster].zw;
    }
    sums[lane] = own;
    barrier();
    for (uint reach = 1u; reach < 256u; reach *= 2u) {
        uvec2 add = uvec2(0u);
        if (lane >= reach) {
            add = sums[lane - reach];
        }
        barrier();
        sums[lane] += add;
        barrier();
    }
    uint before = sums[lane].x - own.x;
    for (uint cluster = from; cluster < to; cluster++) {
        uvec4 found = kept.list[cluster];
        kept.list[cluster] = uvec4(found.xy, before, found.w);
        before += found.z;
    }
    if (lane == 255u) {
#ifdef SPLATS_POINTS
        arguments.index_count = sums[255].x;
        arguments.instance_count = 1u;
#else
        arguments.index_count = 4u;
        arguments.instance_count = sums[255].x;
#endif
        arguments.first_index = 0u;
        arguments.vertex_offset = 0;
        arguments.first_instance = 0u;
        arguments.clusters = sums[255].y;
    }
}
