// The density of a function or a file from the table of its values that `density-cache` makes in every frame: the eight
// entries round the point, interpolated linearly along each axis. What the solid does with it is exact: where it ends, and
// how it fades.

layout(set = 0, binding = 29, std430) readonly buffer DensityCache {
    float density_cache[]; // a table a volume; x runs fastest
};

float gas_density(uint v, vec3 world) {
    uint n = counts.cache;
    vec3 q = (world - volumes[v].center) / volumes[v].half_extent_m * 0.5 + 0.5;
    vec3 position = clamp(q, 0.0, 1.0) * float(n - 1u);
    uvec3 low = min(uvec3(position), uvec3(n - 2u));
    vec3 t = position - vec3(low);
    uint first = ((v * n + low.z) * n + low.y) * n + low.x;
    uint up = first + n * n;
    float s00 = mix(density_cache[first], density_cache[first + 1u], t.x);
    float s10 = mix(density_cache[first + n], density_cache[first + n + 1u], t.x);
    float s01 = mix(density_cache[up], density_cache[up + 1u], t.x);
    float s11 = mix(density_cache[up + n], density_cache[up + n + 1u], t.x);
    return mix(mix(s00, s10, t.y), mix(s01, s11, t.y), t.z);
}
