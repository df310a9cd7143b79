// Bounds of a table of densities: between entries it is their mean by weights, so that the greatest of those round a box
// bounds it.

#include "gas/density-cached.glsl"

float sample_at(uint v, uint index) {
    uint n = counts.cache;
    return density_cache[v * n * n * n + index].x;
}

#include "gas/bound-samples.glsl"

float gas_bound(uint v, vec3 low, vec3 high) {
    uint n = counts.cache;
    float last = float(n - 1u);
    ivec3 first = clamp(ivec3(floor((0.5 * low + 0.5) * last)), ivec3(0), ivec3(int(n) - 2));
    ivec3 end = clamp(ivec3(floor((0.5 * high + 0.5) * last)) + 2, first + 2, ivec3(int(n)));
    Extremes found = extremes(v, first, uvec3(end - first), uvec3(n));
    return found.are_known ? found.greatest : 1.0e30;
}
