#version 450

#pragma variants DRAPE=picture,contours,slope,hypsometric

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/light.glsl"
#include "terrain/drape-{DRAPE}.glsl"
#include "terrain/illumination.glsl"

layout(location = 0) out vec4 picture;

void main() {
    picture = color_of(ivec2(gl_FragCoord.xy));
}
