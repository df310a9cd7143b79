#version 450

#pragma variants INTERPOLATION=bilinear,packed16,packed32,bicubic

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/start.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, r32f) uniform writeonly image2D start;

void main() {
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (tile.x >= imageSize(start).x || tile.y >= imageSize(start).y) {
        return;
    }
    imageStore(start, tile, vec4(free_depth(tile), 0.0, 0.0, 0.0));
}
