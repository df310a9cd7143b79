// Colours by height. Not the paper's.

// Of atlases: blue below 0 m, then green, yellow, brown and white, linear.
const float HEIGHTS_M[10] = float[](-6000.0, -200.0, 0.0, 0.0, 200.0, 500.0, 1000.0, 2000.0, 3500.0, 5000.0);
const vec3 HYPSOMETRIC_TINTS[10] =
    vec3[](vec3(0.01, 0.03, 0.12), vec3(0.05, 0.16, 0.35), vec3(0.18, 0.35, 0.46), vec3(0.10, 0.26, 0.10),
           vec3(0.22, 0.34, 0.11), vec3(0.44, 0.41, 0.17), vec3(0.38, 0.25, 0.09), vec3(0.24, 0.12, 0.05),
           vec3(0.32, 0.26, 0.24), vec3(0.56, 0.56, 0.57));

vec3 hypsometric_tint(float height_m) {
    vec3 tint = HYPSOMETRIC_TINTS[0];
    for (int i = 0; i < 9; i++) {
        float between = clamp((height_m - HEIGHTS_M[i]) / max(HEIGHTS_M[i + 1] - HEIGHTS_M[i], 1.0e-3), 0.0, 1.0);
        tint = height_m >= HEIGHTS_M[i] ? mix(HYPSOMETRIC_TINTS[i], HYPSOMETRIC_TINTS[i + 1], between) : tint;
    }
    return tint;
}

// The terrain's colour under the drape, of its own colour; `facing` has the height over the base as its fourth number.
vec3 under_drape(vec3 albedo, vec3 direction, vec4 hit, vec4 facing) {
    return hypsometric_tint((facing.w - light.zero_m) / light.drape_scale);
}
