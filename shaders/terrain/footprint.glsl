// Where a last segment as short as a texel of the level it is met at crosses the interpolated surface of that level.

float intersect(vec3 near, vec3 far, float depth_m) {
    int shift = finest_shift(depth_m);
    float above = near.z - height_at(shift, near.xy);
    float below = far.z - height_at(shift, far.xy);
    float part = above <= 0.0 ? 0.0 : -1.0;
    if (above > 0.0 && below <= 0.0) {
        // Regula falsi, twice.
        float guess = above / (above - below);
        vec3 middle = mix(near, far, guess);
        float amid = middle.z - height_at(shift, middle.xy);
        part = amid <= 0.0 ? guess * above / (above - amid) : guess + (1.0 - guess) * amid / (amid - below);
    }
    return part;
}
