#version 450

// Position map and diffuse map in one pass (section 4.2.2, figure 5-6).

layout(location = 0) in float height;
layout(location = 1) in vec3 map_normal;

#include "caustics/box.glsl"
#include "caustics/diffuse.glsl"

layout(push_constant) uniform Map {
    Box bounds;
    vec3 albedo;
    float top;
    float bottom;
} map;

layout(location = 0) out float position;
layout(location = 1) out vec4 diffuse;

void main() {
    position = height;
    diffuse = diffuse_light(map.albedo, map_normal, map.bounds.v);
}
