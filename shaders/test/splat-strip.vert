#version 450

// A quad as a strip of four vertices, one instance each.

layout(location = 0) in vec2 place; // normalised device coordinates
layout(location = 1) in vec4 paint;

layout(location = 0) out vec4 colour;

layout(push_constant, std430) uniform Quad {
    vec2 half_extent; // normalised device coordinates
} quad;

void main() {
    vec2 corner = vec2(float(gl_VertexIndex & 1), float(gl_VertexIndex >> 1)) * 2.0 - 1.0;
    colour = paint;
    gl_Position = vec4(place + corner * quad.half_extent, 0.5, 1.0);
}
