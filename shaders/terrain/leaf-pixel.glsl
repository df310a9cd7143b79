// `--lod pixel`: subdivision stops at the pixel's footprint on the ray, and heights come from the level whose texels are that
// large, interpolated. What is finer than a pixel is never read, so the time does not grow with the map.

int finest_shift(float depth_m) {
    int exponent = (floatBitsToInt(depth_m * land.eye.w) >> 23) - 127;
    return clamp(exponent, 0, land.size.z);
}

float surface_at(int shift, vec2 place) {
    return bilinear(cell_at(shift, place));
}

bool is_leaf(Segment segment, int shift) {
    return shift <= finest_shift(segment.depth_m);
}

float intersect(Segment segment) {
    int shift = finest_shift(segment.depth_m);
    float near = segment.near.z - surface_at(shift, segment.near.xy);
    float far = segment.far.z - surface_at(shift, segment.far.xy);
    float part = near <= 0.0 ? 0.0 : -1.0;
    if (near > 0.0 && far <= 0.0) {
        // Regula falsi, twice.
        float guess = near / (near - far);
        vec3 middle = mix(segment.near, segment.far, guess);
        float amid = middle.z - surface_at(shift, middle.xy);
        part = amid <= 0.0 ? guess * near / (near - amid)
                           : guess + (1.0 - guess) * amid / (amid - far);
    }
    return part;
}
