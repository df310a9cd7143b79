#version 450

// The splat of depth-splat.geom where there is no geometry stage: four vertices for each instance.

#include "lava/depth-splat.glsl"

layout(location = 0) in vec3 position;

layout(location = 0) flat out vec3 center_m;

void main() {
    center_m = position;
    gl_Position = corner_of(position, vec2(float(gl_VertexIndex & 1), float(gl_VertexIndex >> 1)) * 2.0 - 1.0);
}
