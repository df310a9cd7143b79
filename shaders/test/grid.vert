#version 450

layout(location = 0) in vec2 place; // normalised device coordinates
layout(location = 1) in vec3 paint;

layout(location = 0) out vec3 colour;

void main() {
    colour = paint;
    gl_Position = vec4(place, 0.5, 1.0);
}
