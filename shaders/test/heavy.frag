#version 450

// As much fragment work as asked; the load differs from pixel to pixel only in its seed.

#include "test/chain.glsl"

layout(push_constant, std430) uniform Load {
    uint iterations; // steps of the chain for each fragment
} load;

layout(location = 0) out vec4 target;

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    uint state = run_chain(pixel.x + 4096u * pixel.y, load.iterations);
    target = vec4(vec3(unit_float(state)), 1.0);
}
