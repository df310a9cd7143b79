#version 450

// The light of the flames (ours): one workgroup puts a box around the fire particles, cuts it into 3 x 3 x 3 cells and
// makes of each cell's particles one light, at their mean place, as bright as they are together. What a particle gives
// off is what its square shows. Sums are of integers, so that their order does not matter.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/flames.glsl"
#include "burning/billboards.glsl"
#include "burning/fire-light.glsl"
#include "burning/ordered.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(set = 0, binding = 53, std430) buffer FireLights {
    FireLight fire_lights[];
};

// Of a place within its cell, and of a flame's light: a million of either fit into 32 bits.
const float PLACES = 4095.0;
const float UNITS = 4095.0 / 0.066;

shared int lowest[3];
shared int highest[3];
shared uint counts[27];
shared uint sums[162]; // of a cell: place x, y, z, light red, green, blue

// Mean over its square of the light that a flame shows (draw-fire.frag), by its age: quadratics that a test holds
// against the integral.
vec3 shown(float age) {
    vec3 bend = vec3(-0.0325, -0.0046, 0.0110);
    return max(vec3(0.0638, 0.0316, 0.0096) + age * (vec3(0.0019, -0.0247, -0.0206) + age * bend), 0.0);
}

void main() {
    uint thread = gl_LocalInvocationID.x;
    if (thread < 3u) {
        lowest[thread] = 0x7fffffff;
        highest[thread] = -0x7fffffff;
    }
    if (thread < MOST_LIGHTS) {
        counts[thread] = 0u;
    }
    if (thread < 6u * MOST_LIGHTS) {
        sums[thread] = 0u;
    }
    barrier();
    for (uint i = thread; i < constants.fire_pool; i += 256u) {
        Particle p = particles[i];
        if (p.life_ticks > 0.0) {
            for (int axis = 0; axis < 3; axis++) {
                atomicMin(lowest[axis], ordered(p.position[axis]));
                atomicMax(highest[axis], ordered(p.position[axis]));
            }
        }
    }
    barrier();
    vec3 low = vec3(unordered(lowest[0]), unordered(lowest[1]), unordered(lowest[2]));
    vec3 high = vec3(unordered(highest[0]), unordered(highest[1]), unordered(highest[2]));
    vec3 cell_size = max(high - low, vec3(1.0e-6)) / float(LIGHT_CELLS);
    for (uint i = thread; i < constants.fire_pool; i += 256u) {
        Particle p = particles[i];
        if (p.life_ticks > 0.0) {
            vec3 at = (p.position - low) / cell_size;
            ivec3 cell = clamp(ivec3(floor(at)), ivec3(0), ivec3(LIGHT_CELLS - 1));
            uint number = uint((cell.z * LIGHT_CELLS + cell.y) * LIGHT_CELLS + cell.x);
            uvec3 place = uvec3(clamp(at - vec3(cell), 0.0, 1.0) * PLACES + 0.5);
            float age = clamp(p.age_ticks / p.life_ticks, 0.0, 1.0);
            float height = flame_height(age, p.random.y);
            uvec3 light = uvec3(shown(age) * (height * height * UNITS) + 0.5);
            atomicAdd(counts[number], 1u);
            for (int k = 0; k < 3; k++) {
                atomicAdd(sums[6u * number + uint(k)], place[k]);
                atomicAdd(sums[6u * number + 3u + uint(k)], light[k]);
            }
        }
    }
    barrier();
    uint before = 0u;
    uint all = 0u;
    for (uint cell = 0u; cell < MOST_LIGHTS; cell++) {
        uint some = min(counts[cell], 1u);
        before += cell < thread ? some : 0u;
        all += some;
    }
    // Those beyond the last are dark; a radius keeps them from being divided by.
    if (thread >= all && thread < MOST_LIGHTS) {
        fire_lights[thread] = FireLight(vec3(0.0), 1.0, vec3(0.0), float(all));
    }
    if (thread < MOST_LIGHTS) {
        if (counts[thread] > 0u) {
            uint first = 6u * thread;
            vec3 cell = vec3(thread % 3u, (thread / 3u) % 3u, thread / 9u);
            vec3 place = vec3(sums[first], sums[first + 1u], sums[first + 2u]) / (PLACES * float(counts[thread]));
            vec3 light = vec3(sums[first + 3u], sums[first + 4u], sums[first + 5u]) / UNITS;
            float radius = billboards.particle_radius;
            // A square of this area, as far as it is bright; over pi, as the sun's light is.
            float area = 4.0 * FLAME_SIZE.x * FLAME_SIZE.y * radius * radius / 3.14159265;
            // The radius of gyration of an evenly filled cell, and of a flame.
            float spread = sqrt(dot(cell_size, cell_size) / 12.0 + radius * radius);
            vec3 intensity = light * (area * billboards.fire_light);
            fire_lights[before] = FireLight(low + (cell + place) * cell_size, spread, intensity, float(all));
        }
    }
}
