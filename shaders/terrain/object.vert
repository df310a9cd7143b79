#version 450

layout(location = 0) in vec3 position; // world, metres
layout(location = 1) in vec3 normal;

#include "terrain/object.glsl"

layout(location = 0) out vec3 facing;

// Two passes draw the objects, and the second finds the depths of the first.
invariant gl_Position;

void main() {
    facing = normal;
    gl_Position = object.to_clip * vec4(position, 1.0);
}
