#version 450

// The receiver's diffuse light: the diffuse map in a pass of its own (section 4.2.2, figure 5-5), and the slice image of one sample
// plane, where the camera's near and far planes lie half way to the neighbouring ones (section 5.2.1, figures 5-2 and 5-3).

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

layout(location = 0) out vec4 diffuse;

void main() {
    diffuse = diffuse_light(map.albedo, map_normal, map.bounds.v);
}
