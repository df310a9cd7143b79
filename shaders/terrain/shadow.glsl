// The pass `shadow` of one pixel: whether the map stands between the place that was met and the sun. Rays go through the same
// altitude map. The base throws none: of itself what it hides from the sun faces away from it. A slope of land beyond the horizon
// may face the sun, and stays lit unless its own map, which bends with the base, stands before it.

layout(set = 0, binding = 2) uniform texture2D depth;
layout(set = 0, binding = 4) uniform texture2D prior; // what the maps before this one left of the light

float lit_at(ivec2 pixel) {
    read_map();
    vec4 hit = texelFetch(depth, pixel, 0);
    float before = texelFetch(prior, min(pixel, textureSize(prior, 0) - 1), 0).x;
    // What a map before darkens stays dark, even if the ray at this one did not come to its end.
    if ((int(hit.w) & 7) == SKY || before == 0.0) {
        return before;
    }
    shadow_shift = min((int(hit.w) >> 3) & 31, map.top);
    // A texel away from the surface itself, and out of it where coarse triangles lie beneath it.
    float away_m = texel_m(terrain.to_sun, shadow_shift) + (1.0e-5 + terrain.error_m) * hit.x;
    vec3 from = terrain.eye + hit.x * direction_of(vec2(pixel)) + away_m * terrain.to_sun;
    Hit none = Hit(NO_DEPTH, vec2(0.0), float(SKY));
    Hit found = trace(from, terrain.to_sun, NO_DEPTH, none);
    float lit = found.surface == UNFINISHED.surface ? UNKNOWN_LIGHT : before;
    return found.depth < NO_DEPTH ? 0.0 : lit;
}
