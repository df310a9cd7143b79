#version 450

// Surface that is seen, as the illumination volumes need it, and its ambient light (eq. 4-19).

layout(location = 0) in vec3 world;
layout(location = 1) in vec3 world_normal;

#include "caustics/stencil-receivers.glsl"

layout(location = 0) out vec4 color;
layout(location = 1) out vec4 surface_position;
layout(location = 2) out vec4 surface_normal;
layout(location = 3) out vec4 surface_albedo;

void main() {
    color = vec4(receiver.albedo * receiver.ambient, 1.0);
    surface_position = vec4(world, 1.0);
    surface_normal = vec4(normalize(world_normal), 0.0);
    surface_albedo = vec4(receiver.albedo, 1.0);
}
