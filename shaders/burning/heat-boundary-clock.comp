#version 450

// The clock of the tick. The radius follows from a whole number of ticks, so that it does not drift; the boundary halts
// while more vertices are active than the limit allows (3.7.1).

layout(local_size_x = 1) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

void main() {
    bool halts = clock.active_vertices > constants.active_limit;
    clock.tick += 1u;
    clock.growth_ticks += halts ? 0u : 1u;
    clock.radius = constants.growth_per_tick * float(clock.growth_ticks);
    clock.active_vertices = 0u;
    clock.active_triangles = 0u;
}
