// The pass `illumination` of one pixel: Lambert's law under the sun and the sky, the ground's colour by height, haze by
// distance. The paper names the pass and no model of light.

layout(set = 0, binding = 0, std140) uniform Light {
    vec4 corner; // direction to the middle of pixel (0, 0), world, for 1 m of depth
    vec4 across;
    vec4 down;
    vec4 sun; // direction to the sun; the strength of the sky's light
    vec4 haze; // colour; share of the colour lost over 1 m, as an exponent
    vec4 range; // lowest and highest height above the base, metres
} light;

layout(set = 0, binding = 1) uniform texture2D depth;
layout(set = 0, binding = 2) uniform texture2D normal;

// Hypsometric tints, linear: meadow, forest, heath, rock, ash, and the pale summit.
const vec3 TINTS[6] = vec3[](vec3(0.22, 0.30, 0.10), vec3(0.10, 0.20, 0.06), vec3(0.24, 0.20, 0.10),
                             vec3(0.25, 0.17, 0.11), vec3(0.30, 0.26, 0.23), vec3(0.62, 0.60, 0.58));
const vec3 ROCK = vec3(0.20, 0.17, 0.15);
const vec3 BASE_TINT = vec3(0.17, 0.22, 0.12);

vec3 tint_at(float share) {
    float place = clamp(share, 0.0, 1.0) * 5.0;
    int below = min(int(place), 4);
    return mix(TINTS[below], TINTS[below + 1], place - float(below));
}

vec3 sky(vec3 direction) {
    float up = clamp(normalize(direction).y, 0.0, 1.0);
    return mix(light.haze.xyz, vec3(0.16, 0.34, 0.68), pow(up, 0.5));
}

vec3 ground(int surface, vec3 facing, float share) {
    vec3 tint = surface == 1 ? BASE_TINT : tint_at(share);
    // Nothing grows on a cliff.
    return mix(ROCK, tint, smoothstep(0.45, 0.75, facing.y));
}

vec3 encoded(vec3 linear) {
    vec3 c = clamp(linear, vec3(0.0), vec3(1.0));
    vec3 low = 12.92 * c;
    vec3 high = 1.055 * pow(max(c, vec3(1.0e-6)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(c, vec3(0.0031308))));
}

vec4 color_of(ivec2 pixel) {
    vec4 hit = texelFetch(depth, pixel, 0);
    vec4 facing = texelFetch(normal, pixel, 0);
    vec3 direction = light.corner.xyz + float(pixel.x) * light.across.xyz + float(pixel.y) * light.down.xyz;
    int surface = int(hit.w) & 7;
    vec3 color = sky(direction);
    if (surface != 0) {
        float share = (facing.w - light.range.x) / max(light.range.y - light.range.x, 1.0e-6);
        float lit = max(dot(facing.xyz, light.sun.xyz), 0.0);
        float open = light.sun.w * (0.5 + 0.5 * facing.y);
        vec3 seen = ground(surface, facing.xyz, share) * (vec3(2.6, 2.45, 2.2) * lit + vec3(0.8, 0.95, 1.2) * open);
        float kept = exp(-light.haze.w * hit.x * length(direction));
        color = mix(light.haze.xyz, seen, kept);
    }
    return vec4(encoded(color), 1.0);
}
