// The pass `depth` of one pixel: where its ray ends, on a map, on the base, or nowhere.

layout(set = 0, binding = 2) uniform texture2D prior; // what the maps before this one found

vec3 direction_of(ivec2 pixel) {
    return land.corner.xyz + float(pixel.x) * land.across.xyz + float(pixel.y) * land.down.xyz;
}

vec4 find(ivec2 pixel) {
    vec3 direction = direction_of(pixel);
    vec4 before = texelFetch(prior, min(pixel, textureSize(prior, 0) - 1), 0);
    Hit hit = Hit(before.x, before.yz, before.w);
    float above = land.eye.z - land.bounds.z;
    float limit_m = hit.depth;
    float base_m = above <= 0.0 ? 0.0 : (direction.z < 0.0 ? above / -direction.z : NO_DEPTH);
    if (base_m < hit.depth) {
        hit = Hit(base_m, land.eye.xy + base_m * direction.xy, surface_code(BASE, 0));
        // Where the map lies in the base, the map is seen.
        limit_m = above <= 0.0 ? 0.0 : min(limit_m, base_m + 2.0 * land.margin.y / -direction.z);
    }
    Hit found = trace(direction, limit_m);
    if (found.depth < NO_DEPTH) {
        hit = found;
    }
    return vec4(hit.depth, hit.place, hit.surface);
}
