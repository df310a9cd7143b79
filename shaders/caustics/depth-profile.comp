#version 450

// The depth levels that hold the receiver (section 4.7.2, figure 5-9), found where its heights are: of the profile smart slicing
// wants no more (section 6.1).

layout(local_size_x = 64) in;

#include "caustics/levels.glsl"

layout(set = 0, binding = 0) uniform texture2D position_map;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(std430, set = 0, binding = 2) buffer Held {
    uint list[]; // 1 for each level that holds a texel
} held;

layout(push_constant) uniform Profile {
    float top; // of the box along V, from its centre, metres
    float levels_per_m;
    uint levels;
    uint map_size; // texels a side
    uint threads; // which take the rows in turn
} profile;

void main() {
    uint column = gl_GlobalInvocationID.x;
    if (column >= profile.map_size) {
        return;
    }
    uint last = profile.levels;
    for (uint row = gl_GlobalInvocationID.y; row < profile.map_size; row += profile.threads) {
        float height = texelFetch(sampler2D(position_map, nearest), ivec2(column, row), 0).r;
        if (height > -1.0e29) {
            uint level = level_of(height, (profile.top - height) * profile.levels_per_m, profile.levels);
            if (level != last) {
                atomicOr(held.list[level], 1u);
                last = level;
            }
        }
    }
}
