#version 450

// Height and index of the receiver nearest to the light.

layout(location = 0) in float height;

#include "caustics/box.glsl"
#include "caustics/shadow-map.glsl"

layout(location = 0) out vec2 nearest_receiver;

void main() {
    nearest_receiver = vec2(height, map.receiver);
}
