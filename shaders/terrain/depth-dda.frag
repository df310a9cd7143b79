#version 450

#pragma variants BASE=plane,curved INTERPOLATION=bilinear,packed16,packed32,bicubic LOD=pixel,exact

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/base-{BASE}.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/leaf-{LOD}.glsl"
#include "terrain/traversal-dda-{BASE}.glsl"
#include "terrain/start-{BASE}.glsl"
#include "terrain/depth.glsl"

layout(location = 0) out vec4 depth;

void main() {
    read_map();
    known = start_of(ivec2(gl_FragCoord.xy));
    depth = find_hit(ivec2(gl_FragCoord.xy));
}
