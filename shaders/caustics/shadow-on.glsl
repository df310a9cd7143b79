// Shadows between receivers (no part of the thesis): a beam is followed from the surface that it lights up to the water, through the
// heights and indices of the receivers nearest to the light. A receiver is taken for solid below what the light sees of it.

layout(set = 0, binding = 2) uniform texture2D shadow_map;

const int SHADOW_STEPS = 48;
const float SHADOW_BIAS_TEXELS = 1.5;

// Set where a driver ends the loop.
bool is_shadow_cut = false;

// False where another receiver stands between the point, along U, V, W from the reference point, and the point of the water.
bool reaches(vec3 point, vec3 water) {
    float rise = min(plane.shadow_top, water.y) - point.y;
    vec2 slope = (water.xz - point.xz) / max(water.y - point.y, 1.0e-6);
    ivec2 last = textureSize(sampler2D(shadow_map, nearest), 0) - 1;
    float bias_m = SHADOW_BIAS_TEXELS / min(plane.shadow_texels_per_m.x, plane.shadow_texels_per_m.y);
    int i = 0;
    for (; i < SHADOW_STEPS; i++) {
        float above = rise * (float(i) + 0.5) / float(SHADOW_STEPS);
        vec2 place = (point.xz + slope * above - plane.shadow_center) * plane.shadow_texels_per_m + 0.5 * vec2(last + 1);
        ivec2 texel = ivec2(floor(place));
        if (all(greaterThanEqual(texel, ivec2(0))) && all(lessThanEqual(texel, last))) {
            vec2 nearest_receiver = texelFetch(sampler2D(shadow_map, nearest), texel, 0).rg;
            bool is_other = abs(nearest_receiver.g - plane.receiver) > 0.5;
            if (is_other && nearest_receiver.r + plane.shadow_middle > point.y + above + bias_m) {
                return false;
            }
        }
    }
    is_shadow_cut = is_shadow_cut || i < SHADOW_STEPS;
    return true;
}
