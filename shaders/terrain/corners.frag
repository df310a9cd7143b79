#version 450

// The four corners of each cell in one texel, for rays over bilinear terrain: north-west, north-east, south-west, south-east. The data's
// cells come first, and beside them those of the coarser levels, which lie as they do in their own layer. Once for each map.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/packing.glsl"

layout(location = 0) out uvec4 corners;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 in_layer = texel - packing.beside;
    bool is_data = all(lessThanEqual(texel, packing.last));
    // A level begins at its padded width, so that the highest bit of a place tells which it is.
    int along = max(in_layer.x * packing.axis.x + in_layer.y * packing.axis.y, 1);
    int shift = is_data ? 0 : max(packing.top - int(findMSB(uint(along))), 0);
    ivec2 origin = is_data ? ivec2(0) : packing.axis * (1 << max(packing.top - shift, 0));
    ivec2 last = packing.last >> shift;
    ivec2 a = clamp((is_data ? texel : in_layer) - origin, ivec2(0), last);
    ivec2 b = min(a + 1, last);
    int layer = is_data ? 0 : 1;
    corners = uvec4(texelFetch(levels, ivec3(origin + a, layer), 0).x,
                    texelFetch(levels, ivec3(origin + ivec2(b.x, a.y), layer), 0).x,
                    texelFetch(levels, ivec3(origin + ivec2(a.x, b.y), layer), 0).x,
                    texelFetch(levels, ivec3(origin + b, layer), 0).x);
}
