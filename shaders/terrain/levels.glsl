#ifdef INTERPOLATION_PACKED
// The levels of the map as rays over bilinear terrain read them: the corners of a cell by one fetch, and what bounds blocks of cells in an
// image of its own, as floats.

layout(set = 0, binding = 6) uniform utexture2D corners; // corners.frag
layout(set = 0, binding = 7) uniform texture2D coarser; // coarser.frag

// Of a cell of a level: north-west, north-east, south-west, south-east.
vec4 corners_of(int shift, ivec2 cell) {
    ivec2 origin = shift == 0 ? ivec2(0) : (map.spread >> shift) + map.beside;
    uvec4 bits = texelFetch(corners, origin + cell, 0);
    return map.is_float ? uintBitsToFloat(bits) : vec4(ivec4(bits));
}

float highest_at(int shift, ivec2 texel) {
    return corners_of(shift, texel).x;
}

float value_above(int layer, int shift, ivec2 texel) {
    return texelFetch(coarser, (map.spread >> shift) + texel, 0).x;
}
#else
// The levels of the map as one image. Layer 0 holds the data, the others the coarser levels, each beginning at its padded width.

layout(set = 0, binding = 1) uniform utexture2DArray levels;

// The value of a texel `shift` levels above the data, of a coarser level in `layer`.
float value_in(int layer, int shift, ivec2 texel) {
    int here = shift == 0 ? 0 : layer;
    ivec2 origin = shift == 0 ? ivec2(0) : map.spread >> shift;
    uint bits = texelFetch(levels, ivec3(origin + texel, here), 0).x;
    return map.is_float ? uintBitsToFloat(bits) : float(int(bits));
}

float highest_at(int shift, ivec2 texel) {
    return value_in(1, shift, texel);
}

// As `highest_at` and `lowest_at`, of a level that is not the data's: what is coarser is all that a walk reads before its end.
float value_above(int layer, int shift, ivec2 texel) {
    uint bits = texelFetch(levels, ivec3((map.spread >> shift) + texel, layer), 0).x;
    return map.is_float ? uintBitsToFloat(bits) : float(int(bits));
}

float lowest_at(int shift, ivec2 texel) {
    return value_in(2, shift, texel);
}
#endif
