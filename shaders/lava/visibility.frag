#version 450

// Eq. 7.1: o(x, y) = d(f(x, y)) + epsilon, in eye-space metres scaled to the depth buffer's range.

#include "lava/scene.glsl"
#include "lava/splat-in.glsl"

void main() {
    if (dot(disc, disc) > 1.0 || center_m.y <= scene.bare_m) {
        discard;
    }
    gl_FragDepth = (eye_depth_m + scene.epsilon_m) * scene.depth_per_m;
}
