#version 450

#pragma variants LIGHT=sun,flames

// A surface that a picture covers, repeated beyond its edges. The picture's levels stand below one another in one image
// and are filtered here, for devices filter with 8 bits or more: between the four texels around a coordinate, and
// between the two levels whose texels come nearest to a pixel's size.

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/lit.glsl"

layout(set = 0, binding = 47) uniform texture2D texels;

struct TextureLevel {
    uint width; // texels
    uint height;
    uint first_row; // of the level in the image
    uint level_count; // of the texture
};

layout(set = 0, binding = 48, std430) readonly buffer TextureLevels {
    TextureLevel texture_levels[];
};

layout(location = 4) in vec2 texture_coordinate; // (0, 0) is the picture's lower left corner

layout(location = 0) out vec4 shaded;

vec3 texel(uint level, int column, int row) {
    return texelFetch(texels, ivec2(column, row + int(texture_levels[level].first_row)), 0).rgb;
}

vec3 filtered(uint level, vec2 coordinate) {
    int width = int(texture_levels[level].width);
    int height = int(texture_levels[level].height);
    vec2 at = fract(coordinate) * vec2(float(width), float(height)) - 0.5;
    vec2 t = fract(at);
    int left = (int(floor(at.x)) + width) % width;
    int top = (int(floor(at.y)) + height) % height;
    int right = (left + 1) % width;
    int bottom = (top + 1) % height;
    vec3 upper = mix(texel(level, left, top), texel(level, right, top), t.x);
    vec3 lower = mix(texel(level, left, bottom), texel(level, right, bottom), t.x);
    return mix(upper, lower, t.y);
}

void main() {
    vec2 coordinate = vec2(texture_coordinate.x, 1.0 - texture_coordinate.y);
    vec2 size = vec2(uvec2(texture_levels[0].width, texture_levels[0].height));
    vec2 right = dFdx(coordinate) * size;
    vec2 down = dFdy(coordinate) * size;
    float coarsest = float(texture_levels[0].level_count - 1u);
    float wanted = 0.5 * log2(max(max(dot(right, right), dot(down, down)), 1.0));
    float level = min(wanted, coarsest);
    uint finer = uint(level);
    uint coarser = min(finer + 1u, texture_levels[0].level_count - 1u);
    vec3 color_of_texture = mix(filtered(finer, coordinate), filtered(coarser, coordinate), level - float(finer));
    shaded = lit(color_of_texture);
}
