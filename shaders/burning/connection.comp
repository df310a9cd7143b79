#version 450

// What the search did without leaves the stream where its corners hang together all the same, or all of its part does
// (3.5.4): nothing can come off. A corner that no other triangle has goes with it; one that those left out have among
// themselves may be what holds them. All of them may leave at once, since what the search went by stays.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/held.glsl"
#include "burning/parting.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 3, std430) readonly buffer IncidenceOffsets {
    uint incidence_offsets[];
};

layout(set = 0, binding = 4, std430) readonly buffer Incidence {
    uint incidence[]; // triangle * 4 + corner
};

layout(set = 0, binding = 13, std430) buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 60, std430) readonly buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) readonly buffer Attached {
    uint attached[]; // 1 of a vertex with a triangle that the search went by
};

layout(set = 0, binding = 63, std430) buffer Searching {
    Progress progress;
};

layout(set = 0, binding = 98, std430) readonly buffer Held {
    uint held[];
};

layout(set = 0, binding = 99, std430) readonly buffer Pieces {
    uint pieces[]; // of the part of the mesh, at its lowest vertex
};

layout(set = 0, binding = 100, std430) readonly buffer Origins {
    uint origins[];
};

layout(set = 0, binding = 113, std430) buffer Touched {
    uint touched[]; // last tick at which a triangle of the vertex changed
};

// True for a corner that several of those left out have.
bool is_shared(uint vertex) {
    uint count = 0u;
    for (uint i = incidence_offsets[vertex]; i < incidence_offsets[vertex + 1u]; i++) {
        count += held[incidence[i] / 4u] == LEFT_OUT ? 1u : 0u;
    }
    return count > 1u;
}

void main() {
    uint triangle = element(64u);
    if (triangle == 0u) {
        progress.is_numbered = 1u - progress.is_unsettled; // the next search begins, or this one goes on
    }
    if (triangle >= constants.triangle_count || progress.is_unsettled != 0u || held[triangle] != LEFT_OUT) {
        return;
    }
    uint root = 0xffffffffu;
    bool is_needed = false;
    bool is_apart = pieces[origins[triangles[3u * triangle]]] > 1u;
    for (uint corner = 0u; corner < 3u && is_apart; corner++) {
        uint vertex = triangles[3u * triangle + corner];
        if ((attached[vertex] & 1u) != 0u) {
            is_needed = is_needed || (root != 0xffffffffu && root != roots[vertex]);
            root = roots[vertex];
        } else {
            is_needed = is_needed || is_shared(vertex);
        }
    }
    if (!is_needed) {
        removed[triangle] = 1u;
        for (uint corner = 0u; corner < 3u; corner++) {
            touched[triangles[3u * triangle + corner]] = clock.tick;
        }
        atomicAdd(clock.removed_triangles, 1u);
    }
}
