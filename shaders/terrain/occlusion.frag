#version 450
#pragma variants TREE=whole,pieces

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/occlusion.glsl"

layout(location = 0) out float occlusion;

void main() {
    occlusion = lit_at(ivec2(gl_FragCoord.xy));
}
