#version 450

// As much vertex work as asked: draw any number of small triangles, scattered by their number.

#include "test/chain.glsl"

layout(push_constant, std430) uniform Load {
    uint iterations; // steps of the chain for each vertex
} load;

layout(location = 0) out vec3 colour;

void main() {
    uint triangle = uint(gl_VertexIndex) / 3u;
    uint corner = uint(gl_VertexIndex) % 3u;
    vec2 place = vec2(unit_float(run_chain(triangle, 2u)), unit_float(run_chain(triangle + 77u, 2u)));
    vec2 offset = vec2(corner == 1u, corner == 2u) * 0.01;
    colour = vec3(unit_float(run_chain(uint(gl_VertexIndex), load.iterations)));
    gl_Position = vec4(2.0 * (place + offset) - 1.0, 0.5, 1.0);
}
