#version 450

// A square for each flame.

#include "burning/square.glsl"

// Beyond this a flame is dark, whatever its noise.
const float WIDEST = 0.881;

void main() {
    Particle p = particles[gl_InstanceIndex];
    vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
    corner.x *= WIDEST;
    place(p, corner, FLAME_SIZE * flame_height(age_of(p), p.random.y));
}
