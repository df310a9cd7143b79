#version 450

#pragma variants SPLATS=points,quads

// The splats that stay as one list in their order, in which they are blended: their numbers for points, their places for quads.

layout(local_size_x = 32) in;

#include "common/elements.glsl"
#include "lava/cull.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Kept {
    uvec4 list[]; // of each cluster: a bit for each splat that stays, and those of the clusters before it
} kept;

#ifdef SPLATS_POINTS
layout(set = 0, binding = 1, std430) buffer Drawn {
    uint list[];
} drawn;
#else
layout(set = 0, binding = 1, std430) buffer Drawn {
    vec2 list[];
} drawn;

layout(set = 0, binding = 2, std430) readonly buffer Places {
    vec2 list[];
} places;
#endif

void main() {
    uint cluster = element(32u);
    if (cluster >= cull.clusters) {
        return;
    }
    uvec4 own = kept.list[cluster];
    uint to = own.z;
    for (uint at = 0u; at < CLUSTER; at++) {
        uint bits = at < 32u ? own.x : own.y;
        if (((bits >> (at & 31u)) & 1u) != 0u) {
            uint splat = cluster * CLUSTER + at;
#ifdef SPLATS_POINTS
            drawn.list[to] = splat;
#else
            drawn.list[to] = places.list[splat];
#endif
            to += 1u;
        }
    }
}
