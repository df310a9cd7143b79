// Where a last subsegment as short as a texel of the level it is met at crosses the interpolated surface of that level.

Crossing crossing_of(vec3 near, vec3 far, float depth_m) {
    int shift = finest_shift(depth_m);
    float above = near.z - height_at(shift, near.xy);
    float below = far.z - height_at(shift, far.xy);
    float guess = above <= 0.0 ? 0.0 : above / (above - below);
    return Crossing(above > 0.0 && below > 0.0 ? -1.0 : guess, above);
}

// Regula falsi once more. The height above the far end follows from the first guess.
float refined(Crossing crossing, vec3 near, vec3 far, float depth_m) {
    float above = crossing.above;
    float guess = crossing.t;
    float below = above - above / guess;
    vec3 middle = mix(near, far, guess);
    float amid = middle.z - height_at(finest_shift(depth_m), middle.xy);
    float t = amid <= 0.0 ? guess * above / (above - amid) : guess + (1.0 - guess) * amid / (amid - below);
    return above <= 0.0 ? 0.0 : t;
}
