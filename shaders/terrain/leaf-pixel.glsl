// `--lod pixel`: subdivision ends at the level whose texels are as large as the pixel's footprint. What is finer than a pixel is
// never read, so the time does not grow with the map.

int finest_shift(float depth_m) {
    int exponent = (floatBitsToInt(depth_m * map.pixel) >> 23) - 127;
    return clamp(exponent, 0, map.top);
}
