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
#include "lava/sph-began.glsl"
#include "lava/sph-drag.glsl"

layout(set = 0, binding = 4, rgba32f) uniform image2D drags; // as the lists, 0 for what only fills up the last four

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
    for (uint first = 0u; first < listed; first += 4u) {
        uvec4 four = neighbours_of(at, first);
        vec4 drag = vec4(0.0);
        for (uint n = 0u; n < 4u; n++) {
            drag = vec4(drag.yzw, drag_by(place_m, viscosity, four.x));
            four = four.yzwx;
        }
        imageStore(drags, four_of(at, first), weights_of(listed - first) * drag);
    }
    // Of a particle's drag without its own discretization's factor.
    wall_drags.list[at] = flow.drag / flow.laplacian * viscosity * wall_drag(walls_at(place_m));
}
