#version 450

#pragma variants INTERPOLATION=bilinear,bicubic

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/tiles.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/normal.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, rgba32f) uniform writeonly image2D normal;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= imageSize(normal).x || pixel.y >= imageSize(normal).y) {
        return;
    }
    vec4 hit = texelFetch(depth, pixel, 0);
    if (is_ours(hit)) {
        imageStore(normal, pixel, normal_of(pixel, hit));
    }
}
