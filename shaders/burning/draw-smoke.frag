#version 450

// Smoke covers what lies behind.

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/before-mesh.glsl"
#include "burning/smoke.glsl"
#include "burning/smoke-body.glsl"

void main() {
    float distance_before = before_mesh(ivec2(gl_FragCoord.xy));
    if (distance_before <= 0.0) {
        discard;
    }
    float alpha = smoke_opacity(age_fraction) * smoke_body(square_coordinates, age_fraction, own_random);
    shaded = softness(distance_before) * vec4(smoke_by_itself(age_fraction) * alpha, alpha);
}
