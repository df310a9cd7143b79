#version 450

// Fire adds light: its alpha is 0.

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/before-mesh.glsl"
#include "burning/flame-color.glsl"

void main() {
    float distance_before = before_mesh(ivec2(gl_FragCoord.xy));
    if (distance_before <= 0.0) {
        discard;
    }
    shaded = vec4(softness(distance_before) * fire(square_coordinates, age_fraction, own_random), 0.0);
}
