#version 450

// The receiver under an orthographic camera that looks along -V (sections 4.2.2 and 5.2.1).

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

#include "caustics/box.glsl"

layout(push_constant) uniform Map {
    Box bounds;
    vec3 albedo; // diffuse reflectance, linear RGB
    float top; // heights of the near and the far plane, metres of box space
    float bottom;
} map;

layout(location = 0) out float height; // metres of box space
layout(location = 1) out vec3 map_normal;

void main() {
    vec3 point = to_box(map.bounds, position);
    height = point.y;
    map_normal = normal;
    gl_Position = to_map_clip(map.bounds, point, map.top, map.bottom);
}
