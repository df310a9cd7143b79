#version 450

// Places at the end of the step by the velocities alone.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-began.glsl"
#include "lava/bed.glsl"
#include "lava/sph-inside.glsl"

layout(set = 0, binding = 4) uniform texture2D from; // metres per second

layout(set = 0, binding = 5, rgba32f) uniform image2D predicted; // metres

layout(set = 0, binding = 14, std430) buffer Unmet {
    uint any[3]; // of `sph-density`
} unmet;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    if (at == 0u) {
        unmet.any[0] = 0u;
        unmet.any[2] = 1u;
    }
    vec3 velocity = texelFetch(from, texel_of(at), 0).xyz;
    imageStore(predicted, texel_of(at), vec4(inside(began_m(at) + flow.time_step_s * velocity), 0.0));
}
