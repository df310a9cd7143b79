#version 450

// Particles that come out of the vent in this step: their place, at rest, and their temperature.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"

layout(push_constant, std430) uniform Inflow {
    uint first; // particle
    uint count;
    uint width; // of the particles' textures
} inflow;

layout(set = 0, binding = 0) uniform texture2D places;
layout(set = 0, binding = 1) uniform texture2D motions;
layout(set = 0, binding = 2, rgba32f) uniform image2D positions;
layout(set = 0, binding = 3, rgba32f) uniform image2D velocities;
layout(set = 0, binding = 4, rgba32f) uniform image2D carried;
layout(set = 0, binding = 5, std430) buffer Lasting {
    vec4 list[]; // of the last step, by particles
} lasting;

void main() {
    uint at = element(64u);
    if (at >= inflow.count) {
        return;
    }
    uint particle = inflow.first + at;
    ivec2 texel = ivec2(particle % inflow.width, particle / inflow.width);
    imageStore(positions, texel, texelFetch(places, texel, 0));
    imageStore(velocities, texel, texelFetch(motions, texel, 0));
    imageStore(carried, texel, vec4(0.0));
    lasting.list[particle] = vec4(0.0);
}
