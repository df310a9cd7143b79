#version 450

#pragma variants BASE=plane,curved INTERPOLATION=bilinear,packed16,packed32,bicubic

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/base-{BASE}.glsl"
#include "terrain/interpolation.glsl"
#include "terrain/leaf-shadow.glsl"
#include "terrain/traversal-dda-{BASE}.glsl"
#include "terrain/shadow.glsl"
#include "terrain/tile.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 3, r32f) uniform writeonly image2D shadow;

void main() {
    ivec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (pixel.x >= imageSize(shadow).x || pixel.y >= imageSize(shadow).y) {
        return;
    }
    read_map();
    known = nothing_known();
    imageStore(shadow, pixel, vec4(lit_at(pixel)));
}
