#version 450

#pragma variants INTERPOLATION=bilinear,packed16,packed32,bicubic

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/start.glsl"

layout(location = 0) out float start;

void main() {
    start = free_depth(ivec2(gl_FragCoord.xy));
}
