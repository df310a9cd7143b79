// Culling of pairs of water triangle and plane (section 6.1): what its passes share. A word holds 32 planes of a triangle, a bit each.

#include "common/elements.glsl"
#include "caustics/ray.glsl"
#include "caustics/cell.glsl"

layout(push_constant) uniform Cull {
    vec2 center; // of the box along U and W, from the rays' reference point, metres
    vec2 texels_per_m;
    float top; // of the box along V, from its centre, metres
    float cells_per_m; // along V
    float inset; // of the outer samples of a texel from its sides, texels
    uint map_size; // texels a side
    uint levels; // of the position map's pyramid
    uint triangles;
    uint words; // a triangle
    uint planes; // that there is room for
    uint blocks; // of 256 triangles
    uint vertices; // of the water
    uint depth_levels; // of smart slicing
    float depth_levels_per_m;
} cull;
