#version 450

#pragma variants LIGHT=sun,flames

// A square for each particle of smoke.

#include "burning/constants.glsl"
#include "burning/smoke.glsl"
#include "burning/square.glsl"
#include "burning/light-{LIGHT}.glsl"

#ifdef LIGHT_FLAMES
layout(location = 4) flat out vec3 smoke_light; // of the flames, linear RGB
#endif

void main() {
    Particle p = particles[square_of_vertex() + constants.fire_pool];
    place(p, corner_of_vertex(), vec2(smoke_size(age_of(p), p.random.y)));
#ifdef LIGHT_FLAMES
    smoke_light = scattered(p.position);
#endif
}
