#version 450

#include "test/corners.glsl"

layout(location = 0) out vec3 colour;

void main() {
    colour = corner_colour(uint(gl_VertexIndex));
    gl_Position = vec4(CORNERS[gl_VertexIndex], 0.5, 1.0);
}
