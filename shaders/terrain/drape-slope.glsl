// Colours by the angle between the surface that is lit and the base. Not the paper's.

#include "terrain/base-normal.glsl"

// At 0, 15, 30, 45 and 60 degrees, linear: level, grassy, loose, rocky, sheer.
const vec3 SLOPES[5] = vec3[](vec3(0.42, 0.45, 0.40), vec3(0.28, 0.40, 0.12), vec3(0.52, 0.36, 0.04),
                              vec3(0.50, 0.07, 0.03), vec3(0.16, 0.02, 0.16));

vec3 slope_tint(vec3 facing, vec3 up) {
    float place = clamp(degrees(atan(length(cross(facing, up)), dot(facing, up))) / 15.0, 0.0, 4.0);
    int below = min(int(place), 3);
    return mix(SLOPES[below], SLOPES[below + 1], place - float(below));
}

// The terrain's colour under the drape, of its own colour; `facing` has the height over the base as its fourth number.
vec3 under_drape(vec3 albedo, vec3 direction, vec4 hit, vec4 facing) {
    return slope_tint(facing.xyz, up_at(light.eye + hit.x * direction, facing.w));
}
