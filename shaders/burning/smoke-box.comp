#version 450

// The grid around the particles of smoke: cells of a particle's radius, or of twice that, four times and so on where
// those do not reach, at whole places of the world, so that they stay in place from frame to frame. One workgroup.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/flames.glsl"
#include "burning/billboards.glsl"
#include "burning/ordered.glsl"
#include "burning/smoke-volume.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(set = 0, binding = 57, std430) buffer SmokeGrid {
    SmokeBox grid;
};

// Before the first particle and behind the last: an empty one and the particle's own; and those that a place between
// two cells, and a grid at whole places, may add.
const int BESIDE = 5;

shared int lowest[3];
shared int highest[3];

void main() {
    uint thread = gl_LocalInvocationID.x;
    if (thread < 3u) {
        lowest[thread] = 0x7fffffff;
        highest[thread] = -0x7fffffff;
    }
    barrier();
    for (uint i = thread; i < constants.smoke_pool; i += 256u) {
        Particle p = particles[constants.fire_pool + i];
        if (p.life_ticks > 0.0) {
            for (int axis = 0; axis < 3; axis++) {
                atomicMin(lowest[axis], ordered(p.position[axis]));
                atomicMax(highest[axis], ordered(p.position[axis]));
            }
        }
    }
    barrier();
    if (thread == 0u) {
        grid = SmokeBox(vec3(0.0), 0.0);
        if (lowest[0] <= highest[0]) {
            vec3 low = vec3(unordered(lowest[0]), unordered(lowest[1]), unordered(lowest[2]));
            vec3 high = vec3(unordered(highest[0]), unordered(highest[1]), unordered(highest[2]));
            float extent = max(high.x - low.x, max(high.y - low.y, high.z - low.z));
            float width = billboards.particle_radius;
            for (int doubled = 0; doubled < 32 && extent > width * float(SMOKE_CELLS - BESIDE); doubled++) {
                width *= 2.0;
            }
            grid = SmokeBox((floor(low / width) - 2.0) * width, width);
        }
    }
}
