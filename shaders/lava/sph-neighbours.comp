#version 450

#pragma variants PLACES=began,predicted

// The particles near each one, once for all passes that sum over them (Verlet 1967), in the order of the cells. At the predicted
// places a list reaches farther than the kernel, since corrections move particles. More than a list holds, and particles
// that none was made for, are left to walks over all of 27 cells.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-began.glsl"

layout(set = 0, binding = 12, rgba32f) uniform image2D neighbours; // four numbers by cells in a texel

layout(set = 0, binding = 13, std430) buffer NeighbourCounts {
    uint list[]; // of each particle's, or WALKS
} neighbour_counts;

#ifdef PLACES_BEGAN
layout(set = 0, binding = 5, std430) buffer Crowded {
    uint by_neighbours; // 1 where a stretch has more particles than a loop may; others follow, in crowded.glsl
} crowded;

const float REACH = 1.0; // in radii of the kernel

vec3 place_of(uint at) {
    return began_m(at);
}
#else
layout(set = 0, binding = 4, rgba32f) uniform readonly image2D predicted; // metres

const float REACH = 1.1;

vec3 place_of(uint at) {
    return imageLoad(predicted, texel_of(at)).xyz;
}
#endif

// The last of four that are there come first.
vec4 begun(vec4 four, uint count) {
    uint rest = count & 3u;
    return rest == 1u ? four.wxyz : rest == 2u ? four.zwxy : four.yzwx;
}

vec3 place_m;
float reach_m;
uint count = 0u;
vec4 four = vec4(0.0); // the last that are near
vec4 full; // four of the list, once it has as many more

void look_at(uint i, uint end) {
    vec3 way_m = apart(place_m - place_of(min(i, end - 1u)));
    bool is_near = i < end && dot(way_m, way_m) < reach_m * reach_m;
    four = is_near ? vec4(four.yzw, float(int(i))) : four;
    count += is_near ? 1u : 0u;
    full = (count & 3u) == 0u ? four : full;
}

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 began = began_m(at);
    place_m = place_of(at);
    reach_m = REACH * flow.support_m;
    uint most = at < flow.listed ? LISTED : 0u;
    bool is_crowded = false;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_at(began, x, z);
            uint end = min(stretch.y, stretch.x + MOST);
            is_crowded = is_crowded || end < stretch.y;
            for (uint first = stretch.x; first < end; first += 4u) {
                uint before = count;
                look_at(first, end);
                look_at(first + 1u, end);
                look_at(first + 2u, end);
                look_at(first + 3u, end);
                // One of them at most makes four of the list full.
                if (before / 4u < count / 4u && count / 4u * 4u <= most) {
                    imageStore(neighbours, four_of(at, before), full);
                }
            }
        }
    }
    if ((count & 3u) != 0u && count <= most) {
        imageStore(neighbours, four_of(at, count), begun(four, count));
    }
    neighbour_counts.list[at] = count <= most ? count : WALKS;
#ifdef PLACES_BEGAN
    if (is_crowded) {
        crowded.by_neighbours = 1u;
    }
#endif
}
