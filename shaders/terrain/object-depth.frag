#version 450

// What the rays found, as depth for the polygons that are drawn into the picture: `does support traditional objects`.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/light.glsl"

layout(set = 0, binding = 1) uniform texture2D depth;

void main() {
    float depth_m = texelFetch(depth, ivec2(gl_FragCoord.xy), 0).x;
    gl_FragDepth = light.near_m / max(depth_m, light.near_m);
}
