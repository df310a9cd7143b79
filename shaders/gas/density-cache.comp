#version 450

#pragma variants DENSITY=functions,trilinear,tricubic

// Section "Discussion of results": "Another way to improve performance is to use a stored table of functional values with a
// lower resolution." Densities of the function or the file at the entries of a table on the box around the volume, the first
// and the last of an axis on its faces, of this frame: the gases move. Entries that no point in the solid lies between are 0.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/loops.glsl"
#include "gas/volumes-several.glsl"
#include "gas/density-{DENSITY}.glsl"

layout(set = 0, binding = 29, std430) buffer DensityCache {
    vec4 density_cache[]; // a table a volume, x runs fastest: an entry, and those after it in x, in y, and in both
};

layout(push_constant, std430) uniform Table {
    uint volume;
} table;

// A point of the solid and an entry beside it are sqrt(3) spacings of 2 / (n - 1) apart at most, and inwardness changes by
// sqrt(1.25) of a distance at most, that of a frustum which ends in a point.
const float REACH = 3.9;

void main() {
    read_counts();
    take_volume(table.volume);
    uint n = cache_size;
    uvec3 entry = gl_GlobalInvocationID;
    if (entry.x >= n || entry.y >= n || entry.z >= n) {
        return;
    }
    vec3 q = 2.0 * vec3(entry) / float(n - 1u) - 1.0;
    vec3 point = in_hand.center + q * in_hand.half_extent_m;
    float density = 0.0;
    if (inwardness(point) >= -REACH / float(n - 1u) - 1.0e-3) {
        density = gas_density(point);
    }
    // To where four are read at once; of the last ones of an axis the first stand for those after them, which none asks for.
    uint layer = (table.volume * n + entry.z) * n;
    uvec2 before = uvec2(entry.x > 0u ? entry.x - 1u : n - 1u, entry.y > 0u ? entry.y - 1u : n - 1u);
    density_cache[(layer + entry.y) * n + entry.x].x = density;
    density_cache[(layer + entry.y) * n + before.x].y = density;
    density_cache[(layer + before.y) * n + entry.x].z = density;
    density_cache[(layer + before.y) * n + before.x].w = density;
}
