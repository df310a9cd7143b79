// A picture over the first map, or none.

layout(set = 0, binding = 5) uniform texture2D drape;

// The draped picture at a fraction of its sides, between its texels' middles.
vec3 draped(vec2 fraction) {
    vec2 size = vec2(textureSize(drape, 0));
    vec2 texel = clamp(fraction * size - 0.5, vec2(0.0), size - 1.0);
    ivec2 a = ivec2(texel);
    ivec2 b = min(a + 1, ivec2(size) - 1);
    vec2 uv = texel - vec2(a);
    vec3 north = mix(texelFetch(drape, a, 0).xyz, texelFetch(drape, ivec2(b.x, a.y), 0).xyz, uv.x);
    vec3 south = mix(texelFetch(drape, ivec2(a.x, b.y), 0).xyz, texelFetch(drape, b, 0).xyz, uv.x);
    return mix(north, south, uv.y);
}

// The terrain's colour under the drape, of its own colour.
vec3 under_drape(vec3 albedo, vec3 direction, vec4 hit, vec4 facing) {
    int map = (int(hit.w) >> 8) & 15;
    vec2 cells = hit.yz - light.drape_corner;
    // Across the seam of a map that goes once round, the picture goes on.
    if (light.drape_turn > 0.0) {
        cells.x -= light.drape_turn * floor(cells.x / light.drape_turn);
    }
    vec2 fraction = cells / light.drape_cells;
    // A picture with a place of its own ends at its border; the other has its corners on the map's.
    bool is_over = light.draping == DRAPED || all(equal(clamp(fraction, vec2(0.0), vec2(1.0)), fraction));
    vec3 color = albedo;
    if (light.draping != UNDRAPED && is_over && map == 0) {
        color = draped(fraction);
    }
    return color;
}
