// The pass `depth` of one pixel: where its ray ends, on a map, on the base, or nowhere.

layout(set = 0, binding = 2) uniform texture2D prior; // what the maps before this one found

vec4 find_hit(ivec2 pixel) {
    read_map();
    vec3 direction = direction_of(vec2(pixel));
    vec4 before = texelFetch(prior, min(pixel, textureSize(prior, 0) - 1), 0);
    Hit hit = Hit(before.x, before.yz, before.w);
    float limit_m = hit.depth;
    vec2 base = base_depth(direction);
    if (base.x < hit.depth) {
        hit = Hit(base.x, base_place(direction, base.x), surface_code(BASE, 0, 0));
        // Where the map lies in the base, the map is seen.
        limit_m = min(limit_m, base.x + base.y);
    }
    hit = trace(terrain.eye, direction, limit_m, hit);
    return vec4(hit.depth, hit.place, hit.surface);
}
