#version 450

// The layer of fire and smoke over the picture, once, by the text's look (ours).

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/over-layer.glsl"

layout(location = 0) out vec4 shaded;

void main() {
    shaded = fire_at(ivec2(gl_FragCoord.xy));
}
