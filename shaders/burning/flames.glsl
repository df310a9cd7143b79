// Flame groups (3.6): one a block. Of the pools of fire and smoke particles, which are maxima, a group gets a number in
// proportion to the block's live vertices, while the block is in the combustion-ready area.

#include "burning/hash.glsl"

// The group of a block; one more beyond the last ends them.
struct Group {
    uint first_fire; // particle
    uint first_smoke; // particle
    uint first_ready; // entry in the list of ready vertices
    uint weight; // live vertices, 0 outside the combustion-ready area
};

struct Particle {
    vec3 position; // diagonals
    float age_ticks;
    float life_ticks; // 0 when it is not there
    float block; // that it was born in
    vec2 random; // two numbers of its own, 0 to 1
};

vec3 unit(uvec3 h) {
    return vec3(h >> 8u) / 16777216.0;
}

// Half the square of a flame, times its height and the particle's radius.
const vec2 FLAME_SIZE = vec2(0.75, 1.15);
// Beyond this share of it to its sides a flame is dark, whatever its noise.
const float WIDEST = 0.881;

// A flame is tall, swells at once and tapers; `own` is a random number of its own.
float flame_height(float age, float own) {
    return smoothstep(0.0, 0.15, age) * (1.0 - 0.5 * age) * (0.75 + 0.25 * own);
}
