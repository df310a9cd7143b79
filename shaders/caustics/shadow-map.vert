#version 450

// A receiver under an orthographic camera that looks along -V at all of them, for shadows between receivers.

layout(location = 0) in vec3 position;

#include "caustics/box.glsl"
#include "caustics/shadow-map.glsl"

layout(location = 0) out float height; // metres of box space

void main() {
    vec3 point = to_box(map.bounds, position);
    height = point.y;
    gl_Position = to_map_clip(map.bounds, point, 0.5 * map.bounds.extent.y, -0.5 * map.bounds.extent.y);
}
