#version 450

#pragma variants LIGHT=sun,flames

// A surface of several materials.

#include "burning/lit.glsl"
#include "burning/substances.glsl"
#include "burning/wood.glsl"

layout(set = 0, binding = 81, std430) readonly buffer Substances {
    Appearance substances[];
};

layout(location = 4) flat in uint substance;

layout(location = 0) out vec4 shaded;

void main() {
    Appearance own = substances[substance];
    float pattern = 1.0;
    if (own.grain > 0.0) {
        pattern = wood(rest_position);
    }
    shaded = shone(vec3(pattern), own.albedo, own.charring, glow_here() * own.embers);
}
