#version 450

// A particle in the hue of the lava, dimmer the lower it is, so that the heap has depth.

#include "lava/scene.glsl"

layout(location = 0) flat in float height_m;

layout(location = 0) out vec4 color;

void main() {
    float fraction = clamp(height_m / scene.space_m.y, 0.0, 1.0);
    float brightest = max(max(scene.glow.r, scene.glow.g), scene.glow.b);
    color = vec4(scene.glow / max(brightest, 1.0e-6) * mix(0.25, 1.0, fraction), 1.0);
}
