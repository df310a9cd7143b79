#version 450

// A square for each flame.

#include "burning/square.glsl"

// Beyond this a flame is dark, whatever its noise.
const float WIDEST = 0.881;

void main() {
    Particle p = particles[square_of_vertex()];
    vec2 corner = corner_of_vertex();
    corner.x *= WIDEST;
    place(p, corner, FLAME_SIZE * flame_height(age_of(p), p.random.y));
}
