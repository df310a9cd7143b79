#version 450

// The receivers as the viewer's camera sees them, for the stencil method (section 3.2).

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

#include "caustics/stencil-receivers.glsl"

layout(location = 0) out vec3 world;
layout(location = 1) out vec3 world_normal;

void main() {
    world = position;
    world_normal = normal;
    gl_Position = camera.view_projection * vec4(position, 1.0);
}
