// The pass `depth` of one pixel: where its ray ends, on a map, on the base, or nowhere.

layout(set = 0, binding = 2) uniform texture2D prior; // what the maps before this one found

vec4 find_hit(ivec2 pixel) {
    read_map();
    vec3 direction = direction_of(vec2(pixel));
    vec4 before = texelFetch(prior, min(pixel, textureSize(prior, 0) - 1), 0);
    // Of a ray that was left before its end no other map knows more.
    if (before.w == UNFINISHED.surface) {
        return before;
    }
    Hit hit = Hit(before.x, before.yz, before.w);
    int seen = int(before.w) & 7;
    vec2 base = base_depth(direction);
    // Where a map lies in the base, the map is seen: land stays before the base, and behind a base that maps before met this one is
    // followed as far as rounding may have put it.
    float prior_m = seen == BASE && hit.depth > 0.0 ? NO_DEPTH : hit.depth;
    float limit_m = min(prior_m, base.x + base.y);
    if (seen == SKY && base.x < hit.depth) {
        hit = Hit(base.x, base_place(direction, base.x), surface_code(BASE, 0, 0));
    }
    hit = trace(terrain.eye, direction, limit_m, hit);
    return vec4(hit.depth, hit.place, hit.surface);
}
