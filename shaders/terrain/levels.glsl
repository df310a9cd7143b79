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
