// Lines of equal height over the terrain's colours. Not the paper's.

#include "terrain/base-normal.glsl"

const vec3 INK = vec3(0.08, 0.045, 0.02);
// Every fifth line is a wide one.
const float LINE_PX = 1.0;
const float WIDE_LINE_PX = 2.0;
// Terrain on which lines are farther apart lies on none, however near its height is to one's.
const float MOST_APART_PX = 1.0e4;

// The change of the height from a pixel to the next, metres: the next ray meets the plane of the surface in another place.
float rise_per_pixel(vec3 direction, float depth_m, vec3 facing, vec3 up) {
    // A normal between the nodes may point away from the eye.
    float towards = min(dot(facing, direction), -1.0e-4);
    vec3 right = light.right_step - direction * (dot(facing, light.right_step) / towards);
    vec3 down = light.down_step - direction * (dot(facing, light.down_step) / towards);
    return depth_m * length(vec2(dot(up, right), dot(up, down)));
}

// The share of a pixel that a line covers. Lines closer than 2 pixels are left out, those 4 apart are drawn in full.
float line_at(float height_m, float interval_m, float width_px, float rise_m) {
    float rise = max(rise_m, 1.0e-20);
    float apart_px = interval_m / rise;
    float off_px = abs(height_m - interval_m * floor(height_m / interval_m + 0.5)) / rise;
    float line = clamp(0.5 * width_px + 0.5 - off_px, 0.0, 1.0) * clamp(0.5 * apart_px - 1.0, 0.0, 1.0);
    return apart_px < MOST_APART_PX ? line : 0.0;
}

// The terrain's colour under the drape, of its own colour; `facing` has the height over the base as its fourth number.
vec3 under_drape(vec3 albedo, vec3 direction, vec4 hit, vec4 facing) {
    vec3 up = up_at(light.eye + hit.x * direction, facing.w);
    float height_m = facing.w - light.zero_m;
    float rise_m = rise_per_pixel(direction, hit.x, facing.xyz, up);
    float narrow = line_at(height_m, light.drape_scale, LINE_PX, rise_m);
    float wide = line_at(height_m, 5.0 * light.drape_scale, WIDE_LINE_PX, rise_m);
    return mix(albedo, INK, 0.75 * max(narrow, wide));
}
