#version 450

#pragma variants OBJECT=whole,parts

// A tick of the particles (3.6). Each rises, flickers and ends; its index in the pool gives the group that the next one
// in it is born to. A flame whose block has left the combustion-ready area moves: it is born anew in the neighbour with
// most live vertices that is ready, and goes out without one. Smoke is in the air already and stays there. A hash of
// seed, tick and particle decides what is random.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/rotation.glsl"
#include "burning/flames.glsl"
#include "burning/billboards.glsl"
#include "burning/blocks.glsl"
#include "burning/vertices.glsl"
#include "burning/posed.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 15, std430) readonly buffer Blocks {
    Block blocks[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 40, std430) readonly buffer Groups {
    Group groups[];
};

layout(set = 0, binding = 41, std430) readonly buffer Listed {
    uint listed[]; // ready vertices of the block in the list
};

layout(set = 0, binding = 42, std430) readonly buffer Ready {
    uint ready[];
};

layout(set = 0, binding = 43, std430) buffer Particles {
    Particle particles[]; // fire, then smoke
};

const float TICK_S = 1.0 / 60.0;
// A free index of the pool is taken in one of so many ticks, so that a group does not pulse.
const uint BIRTH_TICKS = 8u;
// Lives in ticks, at least and beyond; diagonals a second; diagonals. All ours.
const vec2 FIRE_LIFE = vec2(22.0, 26.0);
const vec2 SMOKE_LIFE = vec2(80.0, 90.0);
const float FIRE_RISE = 0.17;
const float SMOKE_RISE = 0.13;
const float SMOKE_ABOVE = 0.07;
const float FLICKER = 0.05;

shared uint fire_count;
shared uint smoke_count;

// The group that `particle` of the pool belongs to: the last block that begins at or before it.
uint group_of(uint particle, bool is_fire) {
    uint low = 0u;
    uint high = constants.block_count;
    while (high - low > 1u) {
        uint middle = (low + high) / 2u;
        uint first = is_fire ? groups[middle].first_fire : groups[middle].first_smoke;
        if (first <= particle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

bool is_ready(uint block) {
    return blocks[block].ready > 0;
}

// The ready neighbour with most live vertices; NONE without any.
uint next_block(uint block) {
    uint next = NONE;
    int most = 0;
    for (uint direction = 0u; direction < 6u; direction++) {
        uint neighbour = neighbour_of(block, direction);
        if (neighbour != NONE) {
            if (is_ready(neighbour) && blocks[neighbour].live > most) {
                most = blocks[neighbour].live;
                next = neighbour;
            }
        }
    }
    return next;
}

// A listed ready vertex of the block: the one whose hash is the lowest, whatever their order in the list.
uint vertex_of(uint block, uint particle) {
    uint chosen = NONE;
    uint lowest = NONE;
    uint first = groups[block].first_ready;
    for (uint i = 0u; i < listed[block]; i++) {
        uint vertex = ready[first + i];
        uint key = hash(uvec3(vertex, clock.tick, particle ^ constants.seed)).x;
        if (chosen == NONE || key < lowest || (key == lowest && vertex < chosen)) {
            chosen = vertex;
            lowest = key;
        }
    }
    return chosen;
}

Particle born(uint block, uint particle, bool is_fire) {
    uint vertex = vertex_of(block, particle);
    vec3 random = unit(hash(uvec3(particle, clock.tick, constants.seed)));
    vec3 more = unit(hash(uvec3(clock.tick, constants.seed, particle)));
    vec3 position = rotated_with_block(new_state[vertex].position, block, new_rotations[block].xyz);
#ifdef OBJECT_PARTS
    position = posed(vertex, position);
#endif
    float radius = billboards.particle_radius;
    position += radius * vec3(more.x - 0.5, 0.2 + (is_fire ? 0.0 : SMOKE_ABOVE / radius), more.y - 0.5);
    vec2 life = is_fire ? FIRE_LIFE : SMOKE_LIFE;
    return Particle(position, 0.0, floor(life.x + life.y * random.x), float(block), random.yz);
}

vec3 velocity(Particle p, bool is_fire) {
    float time_s = float(clock.tick) * TICK_S;
    float phase = 6.2832 * p.random.x;
    vec2 sway = vec2(sin(31.0 * p.position.y - 7.0 * time_s + phase), cos(27.0 * p.position.y - 6.0 * time_s + 1.7 * phase));
    sway += 0.5 * vec2(sin(73.0 * p.position.x + 11.0 * time_s), cos(67.0 * p.position.z - 13.0 * time_s));
    float rise = (is_fire ? FIRE_RISE : SMOKE_RISE) * (0.6 + 0.8 * p.random.y);
    return vec3(FLICKER * sway.x, rise, FLICKER * sway.y);
}

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        fire_count = 0u;
        smoke_count = 0u;
    }
    barrier();
    uint particle = element(64u);
    uint fire_pool = constants.fire_pool;
    if (particle < fire_pool + constants.smoke_pool) {
        bool is_fire = particle < fire_pool;
        Particle p = particles[particle];
        uint pool_index = is_fire ? particle : particle - fire_pool;
        Group end = groups[constants.block_count];
        bool is_wanted = pool_index < (is_fire ? end.first_fire : end.first_smoke);
        uint birth_block = NONE;
        if (p.life_ticks > 0.0) {
            p.position += velocity(p, is_fire) * TICK_S;
            // By itself: without wind the sum is the same to the last bit.
            p.position += constants.wind * TICK_S;
            p.age_ticks += 1.0;
            uint home = uint(p.block);
            bool has_ended = p.age_ticks >= p.life_ticks;
            bool has_moved = is_fire && !is_ready(home);
            if (has_ended || has_moved) {
                p.life_ticks = 0.0;
            }
            if (has_moved) {
                birth_block = next_block(home);
            } else if (has_ended && is_wanted) {
                birth_block = group_of(pool_index, is_fire);
            }
        } else if (is_wanted && hash(uvec3(constants.seed, particle, clock.tick)).y % BIRTH_TICKS == 0u) {
            birth_block = group_of(pool_index, is_fire);
        }
        if (birth_block != NONE) {
            p = born(birth_block, particle, is_fire);
        }
        particles[particle] = p;
        if (p.life_ticks > 0.0) {
            if (is_fire) {
                atomicAdd(fire_count, 1u);
            } else {
                atomicAdd(smoke_count, 1u);
            }
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u) {
        atomicAdd(clock.fire_particles, fire_count);
        atomicAdd(clock.smoke_particles, smoke_count);
    }
}
