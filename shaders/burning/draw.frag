#version 450

#pragma variants LIGHT=sun,flames

// A surface of one albedo, or of the colours of areas or blocks.

#include "burning/lit.glsl"

layout(location = 0) out vec4 shaded;

void main() {
    shaded = lit(vec3(1.0));
}
