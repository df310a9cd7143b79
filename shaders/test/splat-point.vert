#version 450

// A point of four texels a side, or the middle of a quad that a geometry stage makes.

layout(location = 0) in vec2 place; // normalised device coordinates
layout(location = 1) in vec4 paint;

layout(location = 0) out vec4 colour;

void main() {
    colour = paint;
    gl_PointSize = 4.0;
    gl_Position = vec4(place, 0.5, 1.0);
}
