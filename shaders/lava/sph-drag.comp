#version 450

#pragma variants RHEOLOGY=constant,basalt

// The matrix of the implicit viscosity of Morris et al. (1997), once for all iterations: what each particle near one drags it
// by, and the walls. Two particles of unlike viscosities have their harmonic mean (Cleary 1998).

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-lists.glsl"
#include "lava/sph-drag.glsl"

layout(set = 0, binding = 4, std430) buffer Drags {
    float list[]; // as the lists
} drags;

layout(set = 0, binding = 5, std430) buffer WallDrags {
    float list[];
} wall_drags;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 place_m = began_m(at);
    float viscosity = viscosity_at(at);
    uint listed = reach_of(at).x;
    for (uint n = 0u; n < listed; n++) {
        drags.list[n * flow.listed + at] = drag_by(place_m, viscosity, neighbour_of(at, n));
    }
    // Of a particle's drag without its own discretization's factor.
    wall_drags.list[at] = flow.drag / flow.laplacian * viscosity * wall_drag(walls_at(place_m));
}
