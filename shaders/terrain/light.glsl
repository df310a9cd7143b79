// The sun, the sky and the haze.

layout(set = 0, binding = 0, std140) uniform Light {
    vec4 corner; // direction to the middle of pixel (0, 0), world, for 1 m of depth
    vec4 across;
    vec4 down;
    vec4 sun; // direction to the sun; the strength of the sky's light
    vec4 haze; // colour; share of the colour lost over 1 m, as an exponent
    vec4 range; // lowest and highest height above the base, metres; near plane of what is rasterised
    vec4 drape; // columns and rows of the first map's cells; whether a picture is draped over it; the column where it begins
} light;

vec3 view_direction(vec2 pixel) {
    return light.corner.xyz + pixel.x * light.across.xyz + pixel.y * light.down.xyz;
}

// What a surface of a colour looks like from a distance.
vec3 lit_color(vec3 albedo, vec3 facing, float sunlit, float distance_m) {
    float lit = sunlit * max(dot(facing, light.sun.xyz), 0.0);
    float open = light.sun.w * (0.5 + 0.5 * facing.y);
    vec3 seen = albedo * (vec3(2.0, 1.88, 1.7) * lit + vec3(0.55, 0.68, 0.9) * open);
    return mix(light.haze.xyz, seen, exp(-light.haze.w * distance_m));
}

vec3 encoded(vec3 linear) {
    vec3 c = clamp(linear, vec3(0.0), vec3(1.0));
    vec3 low = 12.92 * c;
    vec3 high = 1.055 * pow(max(c, vec3(1.0e-6)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(c, vec3(0.0031308))));
}
