#version 450

// A square for each particle of smoke.

#include "burning/constants.glsl"
#include "burning/smoke.glsl"
#include "burning/square.glsl"

void main() {
    Particle p = particles[square_of_vertex() + constants.fire_pool];
    place(p, corner_of_vertex(), vec2(smoke_size(age_of(p), p.random.y)));
}
