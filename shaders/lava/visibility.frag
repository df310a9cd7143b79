#version 450

#pragma variants SIMULATION=free,sph

// Eq. 7.1: o(x, y) = d(f(x, y)) + epsilon, in eye-space metres scaled to the depth buffer's range.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/ground.glsl"
#include "lava/splat-in.glsl"

void main() {
    if (dot(disc, disc) > 1.0 || is_bare(center_m)) {
        discard;
    }
    gl_FragDepth = (eye_depth_m + scene.epsilon_m) * scene.depth_per_m;
}
