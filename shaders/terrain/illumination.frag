#version 450

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/illumination.glsl"

layout(location = 0) out vec4 picture;

void main() {
    picture = color_of(ivec2(gl_FragCoord.xy));
}
