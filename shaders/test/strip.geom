#version 450

// Turns each point into a quad.

layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

layout(location = 0) in vec4 colour[];

layout(location = 0) out vec4 quad_colour;

layout(push_constant, std430) uniform Quad {
    vec2 half_extent; // normalised device coordinates
} quad;

void main() {
    for (int corner = 0; corner < 4; corner++) {
        vec2 offset = vec2((corner & 1) == 0 ? -1.0 : 1.0, (corner & 2) == 0 ? -1.0 : 1.0);
        quad_colour = colour[0];
        gl_Position = gl_in[0].gl_Position + vec4(offset * quad.half_extent, 0.0, 0.0);
        EmitVertex();
    }
    EndPrimitive();
}
