#version 450

// A square for each flame.

#include "burning/square.glsl"

void main() {
    Particle p = particles[square_of_vertex()];
    vec2 corner = corner_of_vertex();
    corner.x *= WIDEST;
    place(p, corner, FLAME_SIZE * flame_height(age_of(p), p.random.y));
}
