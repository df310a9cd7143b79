#version 450

#pragma variants INTERPOLATION=bilinear,bicubic

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/normal.glsl"

layout(location = 0) out vec4 normal;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 hit = texelFetch(depth, pixel, 0);
    if (!is_ours(hit)) {
        discard;
    }
    normal = normal_of(pixel, hit);
}
