#version 450

// The receivers under the viewer's camera (section 4.6, step 1).

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

#include "caustics/box.glsl"
#include "caustics/cast.glsl"

// Each light adds to what the first one found in front.
invariant gl_Position;

layout(location = 0) out vec3 world;
layout(location = 1) out vec3 world_normal;

void main() {
    world = position;
    world_normal = normal;
    gl_Position = camera.view_projection * vec4(position, 1.0);
}
