#if defined(INTERPOLATION_PACKED16) || defined(INTERPOLATION_PACKED32)
#define IS_PACKED
// The levels of the map as rays over bilinear terrain read them: the corners of a cell by one fetch, and what bounds blocks of cells in an
// image of its own, as floats. Storage images: lavapipe calls a function for a texel of a sampled one, beside which nothing stays in
// registers.

#ifdef INTERPOLATION_PACKED16
layout(set = 0, binding = 6, rgba16ui) uniform readonly uimage2D corners; // corners.frag
#else
layout(set = 0, binding = 6, rgba32ui) uniform readonly uimage2D corners;
#endif
layout(set = 0, binding = 7, r32f) uniform readonly image2D coarser; // coarser.frag

// Of a cell of a level: north-west, north-east, south-west, south-east.
vec4 corners_of(int shift, ivec2 cell) {
    ivec2 origin = shift == 0 ? ivec2(0) : (map.spread >> shift) + map.beside;
    uvec4 bits = imageLoad(corners, origin + cell);
#ifdef INTERPOLATION_PACKED16
    return vec4(ivec4(bits));
#else
    return uintBitsToFloat(bits);
#endif
}

float highest_at(int shift, ivec2 texel) {
    return corners_of(shift, texel).x;
}

float value_above(int layer, int shift, ivec2 texel) {
    return imageLoad(coarser, (map.spread >> shift) + texel).x;
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
