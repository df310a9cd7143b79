#version 450

// An accepted grid point into a splat of the particle's radius (section 6.3).

layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

#include "lava/depth-splat.glsl"

layout(location = 0) in vec3 point_m[];

layout(location = 0) flat out vec3 center_m;

void main() {
    for (int i = 0; i < 4; i++) {
        center_m = point_m[0];
        gl_Position = corner_of(point_m[0], vec2(float(i & 1), float(i >> 1)) * 2.0 - 1.0);
        EmitVertex();
    }
    EndPrimitive();
}
