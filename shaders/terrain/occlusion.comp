#version 450
#pragma variants TREE=whole,pieces

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/occlusion.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, r32f) uniform writeonly image2D occlusion;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= imageSize(occlusion).x || pixel.y >= imageSize(occlusion).y) {
        return;
    }
    imageStore(occlusion, pixel, vec4(lit_at(pixel)));
}
