#version 450

#pragma variants BASE=plane,curved INTERPOLATION=bilinear,packed16,packed32,bicubic

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/base-{BASE}.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/leaf-shadow.glsl"
#include "terrain/traversal-dda-{BASE}.glsl"
#include "terrain/shadow.glsl"

layout(location = 0) out float shadow;

void main() {
    read_map();
    known = nothing_known();
    shadow = lit_at(ivec2(gl_FragCoord.xy));
}
