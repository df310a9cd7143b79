#version 450

#pragma variants RHEOLOGY=constant,basalt

// One step of Chebyshev's semi-iteration (Golub and Varga 1961) on the implicit viscosity of Morris et al. (1997):
// (1 + sum of a_ij + a_wall) v_i - sum of a_ij v_j = what gravity left. The matrix is symmetric and its rows add up to 1, so
// no step changes the momentum of lava that touches no wall; no sum over all particles is needed. Two particles of unlike
// viscosities have their harmonic mean (Cleary 1998), which is as symmetric.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second
} pushed;

layout(set = 0, binding = 5, std430) readonly buffer From {
    vec4 list[];
} from;

layout(set = 0, binding = 6, std430) buffer To {
    vec4 list[];
} to;

layout(set = 0, binding = 7, std430) buffer Change {
    vec4 list[];
} change;

#ifdef RHEOLOGY_BASALT
layout(set = 0, binding = 8, std430) readonly buffer Viscosities {
    float list[]; // over the melt's
} viscosities;

float viscosity_at(uint at) {
    return viscosities.list[at];
}

float mean_of(float a, float b) {
    return 2.0 * a * b / (a + b);
}
#else
float viscosity_at(uint at) {
    return 1.0;
}

float mean_of(float a, float b) {
    return 1.0;
}
#endif

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 place_m = began_m(at);
    vec3 velocity = from.list[at].xyz;
    float viscosity = viscosity_at(at);
    vec3 dragged = vec3(0.0);
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_at(place_m, x, z);
            uint end = min(stretch.y, stretch.x + MOST);
            for (uint i = stretch.x; i < end; i++) {
                float q = length(apart(place_m - began_m(i))) / flow.support_m;
                dragged -= mean_of(viscosity, viscosity_at(i)) * slope(q) * (velocity - from.list[i].xyz);
            }
        }
    }
    float wall = flow.wall_drag * viscosity * wall_drag(walls_at(place_m));
    vec3 braked = velocity + flow.drag * dragged + wall * velocity;
    vec3 changed = flow.kept * change.list[at].xyz + flow.gained * (pushed.list[at].xyz - braked);
    change.list[at] = vec4(changed, 0.0);
    to.list[at] = vec4(velocity + changed, 0.0);
}
