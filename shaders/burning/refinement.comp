#version 450

#pragma variants STEP=eligible,finest,inner

// Sections 4.4.2 and 4.4.3: which triangles of the refinement pattern are in use. The first dispatch finds the coarse
// triangles that are eligible, by their sets of barycentric points; then one dispatch a level, from the finest parents
// up to the coarse triangles, splits nodes. The level below is finished when a dispatch reads it, and several threads
// only ever write the same value, so that no order matters; nothing is ever taken back.
//
// Readings. A parent is "processed" while one of its children is in use and the others are not yet; since its children
// are all put in use by the thread that finds the first of them, it goes from active to inactive at once (printed, it
// waits for children that are all active at the same time, which never happens once one of them is split itself).
// Beyond the text, leaves differ by one level at most, across coarse edges too: a node is split when a quarter point of
// its edges exists. And a triangle that has begun to burn is in use even where the irregular boundary passes between
// all of the 45 points.

layout(local_size_x = 256) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/tree.glsl"
#include "burning/statuses.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[]; // three vertices a finest triangle
};

#ifdef STEP_ELIGIBLE
layout(set = 0, binding = 36, std430) readonly buffer BarycentricPoints {
    uint barycentric_points[]; // indices in a coarse triangle's section of `triangles`
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[]; // of vertices
};
#else
layout(set = 0, binding = 25, std430) buffer Statuses {
    int statuses[]; // of nodes
};

layout(set = 0, binding = 24, std430) buffer Alive {
    uint alive[]; // of vertices
};
#endif

#ifdef STEP_FINEST
layout(set = 0, binding = 12, std430) readonly buffer TriangleLabels {
    uint triangle_labels[]; // of finest triangles
};
#endif

#ifndef STEP_INNER
layout(set = 0, binding = 37, std430) buffer Eligible {
    uint eligible[]; // of coarse triangles
};
#endif

layout(push_constant, std430) uniform Dispatch {
    uint level; // of the nodes to split
    uint points; // barycentric points a coarse triangle
} dispatch;

#ifdef STEP_ELIGIBLE
// "Returns true if coarse triangle T is eligible."
void main() {
    uint thread = element(256u);
    uint coarse = thread / dispatch.points;
    if (coarse >= constants.coarse_count || eligible[coarse] != 0u) {
        return;
    }
    uint vertex = triangles[3u * finest_at(coarse, 0u, 0u) + barycentric_points[thread % dispatch.points]];
    if (labels[vertex] >= VIRTUAL) {
        eligible[coarse] = 1u;
    }
}

#else

#ifdef STEP_FINEST
bool must_be_split(uint coarse, uint index) {
    uint finest = finest_at(coarse, dispatch.level, index);
    uint near = max(triangle_labels[finest], triangle_labels[finest + 1u]);
    uint far = max(triangle_labels[finest + 2u], triangle_labels[finest + 3u]);
    uint label = max(near, far);
    return label >= INITIAL || (label >= VIRTUAL && eligible[coarse] != 0u);
}
#else
bool midpoint_is_alive(uint coarse, uint level, uint index, uint edge) {
    return alive[triangles[midpoint_at(coarse, level, index, edge)]] != 0u;
}

bool must_be_split(uint coarse, uint index) {
    uint child = 4u * index;
    uint below = dispatch.level + 1u;
    uint at = node_at(coarse, below, child);
    for (uint i = 0u; i < 4u; i++) {
        if (statuses[at + i] == INACTIVE) {
            return true;
        }
    }
    // The quarter points: each outer child has halves of two edges.
    for (uint edge = 0u; edge < 3u; edge++) {
        uint next = edge == 2u ? 0u : edge + 1u;
        if (midpoint_is_alive(coarse, below, child + edge, edge)
                || midpoint_is_alive(coarse, below, child + next, edge)) {
            return true;
        }
    }
    return false;
}
#endif

void main() {
    uint thread = element(256u);
    uint coarse = thread / power_of_four(dispatch.level);
    uint index = thread % power_of_four(dispatch.level);
    if (coarse >= constants.coarse_count) {
        return;
    }
    uint at = node_at(coarse, dispatch.level, index);
    if (statuses[at] == INACTIVE || !must_be_split(coarse, index)) {
        return;
    }
    statuses[at] = INACTIVE;
    uint child = node_at(coarse, dispatch.level + 1u, 4u * index);
    for (uint i = 0u; i < 4u; i++) {
        if (statuses[child + i] == UNUSED) {
            statuses[child + i] = ACTIVE;
        }
    }
    for (uint edge = 0u; edge < 3u; edge++) {
        alive[triangles[midpoint_at(coarse, dispatch.level, index, edge)]] = 1u;
    }
}
#endif
