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
    Particle p = particles[uint(gl_InstanceIndex) + constants.fire_pool];
    vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
    place(p, corner, vec2(smoke_size(age_of(p), p.random.y)));
#ifdef LIGHT_FLAMES
    smoke_light = scattered(p.position);
#endif
}
