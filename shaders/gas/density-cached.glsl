// The density of a function or a file from the table of its values that `density-cache` makes in every frame: the eight
// entries round the point, of which four stand together, interpolated linearly along each axis. What the solid does with it
// is exact: where it ends, and how it fades.

layout(set = 0, binding = 29, std430) readonly buffer DensityCache {
    vec4 density_cache[]; // a table a volume, x runs fastest: an entry, and those after it in x, in y, and in both
};

float gas_density(vec3 world) {
    uint n = cache_size;
    vec3 q = (world - in_hand.center) / in_hand.half_extent_m * 0.5 + 0.5;
    vec3 position = clamp(q, 0.0, 1.0) * float(n - 1u);
    uvec3 low = min(uvec3(position), uvec3(n - 2u));
    vec3 t = position - vec3(low);
    uint first = ((index_in_hand * n + low.z) * n + low.y) * n + low.x;
    vec4 front = density_cache[first];
    vec4 behind = density_cache[first + n * n];
    vec4 sides = mix(vec4(front.xz, behind.xz), vec4(front.yw, behind.yw), t.x);
    return mix(mix(sides.x, sides.y, t.y), mix(sides.z, sides.w, t.y), t.z);
}
