#version 450

// The caustics map of a surface from the light that landed on its texels (section 6.3).

layout(std430, set = 0, binding = 0) readonly buffer Sums {
    uint list[]; // low and high word of each texel, see hit-sums.glsl
} sums;

layout(set = 0, binding = 1) uniform texture2D position_map;
layout(set = 0, binding = 2) uniform sampler nearest;

layout(push_constant) uniform HitMap {
    uint map_size; // texels a side
    uint layer; // of the surfaces above one another
    float units; // of an I_c of 1
} map;

layout(location = 0) out float caustics;

void main() {
    // A triangle's corner may hang over the receiver's edge.
    float height = texelFetch(sampler2D(position_map, nearest), ivec2(gl_FragCoord.xy), 0).r;
    uint at = 2u * ((map.layer * map.map_size + uint(gl_FragCoord.y)) * map.map_size + uint(gl_FragCoord.x));
    float light = float(sums.list[at]) / map.units + float(sums.list[at + 1u]) * (4294967296.0 / map.units);
    caustics = height > -1.0e29 ? light : 0.0;
}
