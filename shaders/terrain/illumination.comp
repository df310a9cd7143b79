#version 450

#pragma variants DRAPE=picture,contours,slope,hypsometric

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/light.glsl"
#include "terrain/drape-{DRAPE}.glsl"
#include "terrain/illumination.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, rgba8) uniform writeonly image2D illumination;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= imageSize(illumination).x || pixel.y >= imageSize(illumination).y) {
        return;
    }
    imageStore(illumination, pixel, color_of(pixel));
}
