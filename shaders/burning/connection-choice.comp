#version 450

// Which of the consumed triangles the search of what hangs together (3.5.4) does without: every other time all of them, for
// what is not consumed may well hang together by itself. Where it does not, half of them at random, so that the others join
// what no strand has to hold; and every fourth time few, so that of two strands where one is enough one stays whole, and
// the other is cut.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/consumed.glsl"
#include "burning/hash.glsl"
#include "burning/held.glsl"
#include "burning/parting.glsl"

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
};

layout(set = 0, binding = 98, std430) buffer Held {
    uint held[];
};

layout(set = 0, binding = 99, std430) buffer Pieces {
    uint pieces[];
};

const uint SEARCH_TICKS = 4u;
const uint ALL = 0xffffffffu;
const uint HALF = 0x7fffffffu;
const uint FEW = 0x07ffffffu; // a 32nd

void main() {
    uint triangle = element(64u);
    if (progress.is_numbered == 0u) {
        return;
    }
    if (triangle < constants.vertex_count) {
        pieces[triangle] = 0u;
    }
    if (triangle >= constants.triangle_count) {
        return;
    }
    uint search = clock.tick / SEARCH_TICKS;
    uint share = search % 2u == 0u ? ALL : (search % 4u == 1u ? HALF : FEW);
    uint state = removed[triangle] != 0u ? GONE : THERE;
    if (state == THERE && is_consumed(triangle) && hash(uvec3(triangle, search, constants.seed)).x <= share) {
        state = LEFT_OUT;
    }
    held[triangle] = state;
}
