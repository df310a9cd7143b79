#version 450

// A vertex of a polygon object.

#include "lava/scene.glsl"

layout(location = 0) in vec3 position; // metres, in the simulation space
layout(location = 1) in vec3 normal;

layout(location = 0) out vec3 facing;
layout(location = 1) out vec3 world_m;
layout(location = 2) out float eye_depth_m;

void main() {
    facing = normal;
    world_m = position;
    gl_Position = scene.view_projection * vec4(position, 1.0);
    eye_depth_m = gl_Position.w;
}
