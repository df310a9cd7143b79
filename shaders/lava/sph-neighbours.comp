#version 450

#pragma variants PLACES=began,predicted

// The particles near each one, once for all passes that sum over them (Verlet 1967), in the order of the cells. At the predicted
// places a list reaches farther than the kernel, since corrections move particles. More than a list holds, and particles
// that none was made for, are left to walks over all of 27 cells.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"

layout(set = 0, binding = 12, std430) buffer Neighbours {
    uint list[]; // by cells, the first of all particles, then the second of all
} neighbours;

layout(set = 0, binding = 13, std430) buffer NeighbourCounts {
    uint list[]; // of each particle's, or WALKS
} neighbour_counts;

#ifdef PLACES_BEGAN
layout(set = 0, binding = 4, std430) buffer Crowded {
    uint any; // 1 where a stretch has more particles than a loop may
} crowded;

const float REACH = 1.0; // in radii of the kernel

vec3 place_of(uint at) {
    return began_m(at);
}
#else
layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

const float REACH = 1.0833;

vec3 place_of(uint at) {
    return predicted.list[at].xyz;
}
#endif

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 began = began_m(at);
    vec3 place_m = place_of(at);
    float reach_m = REACH * flow.support_m;
    uint most = at < flow.listed ? LISTED : 0u;
    uint count = 0u;
    bool is_crowded = false;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_at(began, x, z);
            uint end = min(stretch.y, stretch.x + MOST);
            is_crowded = is_crowded || end < stretch.y;
            for (uint i = stretch.x; i < end; i++) {
                vec3 way_m = apart(place_m - place_of(i));
                bool is_near = dot(way_m, way_m) < reach_m * reach_m;
                if (is_near && count < most) {
                    neighbours.list[count * flow.listed + at] = i;
                }
                count += is_near ? 1u : 0u;
            }
        }
    }
    neighbour_counts.list[at] = count <= most ? count : WALKS;
#ifdef PLACES_BEGAN
    if (is_crowded) {
        crowded.any = 1u;
    }
#endif
}
