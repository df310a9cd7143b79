#version 450

#pragma variants LIGHT=sun,flames

// A surface of wood.

#include "burning/lit.glsl"
#include "burning/wood.glsl"

layout(location = 0) out vec4 shaded;

void main() {
    shaded = lit(vec3(wood(rest_position)));
}
