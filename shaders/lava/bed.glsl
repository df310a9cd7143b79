// The ground under the fluid, at nodes over all of the space and linear between them; free particles have none.

#ifndef SIMULATION_FREE
layout(set = 0, binding = 10) uniform texture2D bed; // slopes along x and z, height in metres

// At a place along x and z as a share of the space's sides.
vec3 bed_at(vec2 share) {
    vec2 last = vec2(textureSize(bed, 0) - 1);
    vec2 place = clamp(share, vec2(0.0), vec2(1.0)) * last;
    vec2 base = min(floor(place), last - 1.0);
    vec2 fraction = place - base;
    ivec2 node = ivec2(base);
    vec3 north = mix(texelFetch(bed, node, 0).xyz, texelFetch(bed, node + ivec2(1, 0), 0).xyz, fraction.x);
    vec3 south = mix(texelFetch(bed, node + ivec2(0, 1), 0).xyz, texelFetch(bed, node + ivec2(1, 1), 0).xyz, fraction.x);
    return mix(north, south, fraction.y);
}
#endif
