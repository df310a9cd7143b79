#version 450

#pragma variants CHANGED=burning,parts,melting,ready

// The chunks that a tick visits, in order: one workgroup lists them, a run of chunks a thread. In the others nothing is
// left to do: the tick would make of each number what it is already.
//
// `burning` are those that a border of the areas passes through, where labels change, and those of the deformed area in
// which something is left to burn. `parts` are the same, and all of them while there are parts beyond the most, which are
// ash at once. In `melting` all flows that is inside of the combustion-ready boundary. `ready` are those of the
// combustion-ready area.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/areas.glsl"
#include "burning/parting.glsl"
#include "burning/parts.glsl"
#include "burning/scan.glsl"

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 92, std430) readonly buffer Spans {
    vec2 spans[]; // least and greatest R at which an element of a chunk changes
};

#ifndef CHANGED_READY
layout(set = 0, binding = 93, std430) readonly buffer Finished {
    uint finished[]; // 1 of a chunk in which nothing is left to burn
};
#endif

layout(set = 0, binding = 91, std430) buffer Visited {
    uint visited[];
};

layout(set = 0, binding = 94, std430) buffer Groups {
    uint groups[3];
};

#ifdef CHANGED_PARTS
layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
};
#endif

layout(push_constant, std430) uniform Chunks {
    uint count;
    uint row; // workgroups that the device takes in one
} chunks;

bool is_visited(uint chunk) {
    vec2 span = spans[chunk];
    uint highest = area_of(span.x, clock.radius);
#ifdef CHANGED_READY
    return highest >= READY && area_of(span.y, clock.radius) <= READY;
#else
    // At the last tick, or earlier where the boundary halts.
    float radius_before = constants.growth_per_tick * float(max(clock.growth_ticks, 1u) - 1u);
    uint lowest = area_of(span.y, radius_before);
    bool changes = clock.tick <= 1u || highest != lowest;
#ifdef CHANGED_MELTING
    return changes || highest >= READY;
#else
    changes = changes || (highest == DEFORMED && finished[chunk] == 0u);
#ifdef CHANGED_PARTS
    changes = changes || progress.part_count > MOST_PARTS;
#endif
    return changes;
#endif
#endif
}

void main() {
    uint thread = gl_LocalInvocationID.x;
    uint run = (chunks.count + GROUP - 1u) / GROUP;
    uint from = min(thread * run, chunks.count);
    uint to = min(from + run, chunks.count);
    uint own = 0u;
    for (uint chunk = from; chunk < to; chunk++) {
        own += is_visited(chunk) ? 1u : 0u;
    }
    uint at = 1u + sum_before(thread, own);
    for (uint chunk = from; chunk < to; chunk++) {
        if (is_visited(chunk)) {
            visited[at] = chunk;
            at++;
        }
    }
    if (thread == 0u) {
        uint total = sums[GROUP - 1u];
        visited[0] = total;
        uint rows = max((total + chunks.row - 1u) / chunks.row, 1u);
        groups[0] = (total + rows - 1u) / rows;
        groups[1] = rows;
        groups[2] = 1u;
    }
}
