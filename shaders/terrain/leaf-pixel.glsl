// `--lod pixel`: subdivision stops at the pixel's footprint on the ray, and heights come from the level whose texels are that
// large, interpolated. What is finer than a pixel is never read, so the time does not grow with the map.

int finest_shift(float depth_m) {
    int exponent = (floatBitsToInt(depth_m * map.pixel) >> 23) - 127;
    return clamp(exponent, 0, map.top);
}

#include "terrain/footprint.glsl"
