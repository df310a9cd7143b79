#version 450

#pragma variants BASE=plane,curved INTERPOLATION=bilinear,packed16,packed32,bicubic LOD=pixel,exact

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/base-{BASE}.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/leaf-{LOD}.glsl"
#include "terrain/traversal-dda-{BASE}.glsl"
#include "terrain/start-{BASE}.glsl"
#include "terrain/depth.glsl"
#include "terrain/tile.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, rgba32f) uniform writeonly image2D depth;

void main() {
    ivec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (pixel.x >= imageSize(depth).x || pixel.y >= imageSize(depth).y) {
        return;
    }
    read_map();
    known = start_of(pixel);
    imageStore(depth, pixel, find_hit(pixel));
}
