#version 450

#pragma variants DENSITY=functions,trilinear,tricubic,cached

// Section "Calculation of the shadow table": "a table of the same dimensions containing functional values is first
// computed". Entries lie on the box around the volume, the first and the last of an axis on its faces.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/loops.glsl"
#include "gas/volumes-several.glsl"
#include "gas/density-{DENSITY}.glsl"
#include "gas/volume-density.glsl"

layout(set = 0, binding = 15, std430) buffer DensityTables {
    vec2 density_tables[]; // a table a volume, x runs fastest: of an entry, and of the one after it in x
};

layout(push_constant, std430) uniform Table {
    uint volume;
} table;

void main() {
    read_counts();
    take_volume(table.volume);
    uint n = frame.table_size;
    uvec3 entry = gl_GlobalInvocationID;
    if (entry.x >= n || entry.y >= n || entry.z >= n) {
        return;
    }
    vec3 q = 2.0 * vec3(entry) / float(n - 1u) - 1.0;
    vec3 point = in_hand.center + q * in_hand.half_extent_m;
    uint at = ((table.volume * n + entry.z) * n + entry.y) * n + entry.x;
    float density = volume_density(point);
    density_tables[at].x = density;
    // Of the last one of a row the first stands for the one after it, which none asks for.
    uint before = entry.x > 0u ? at - 1u : at + n - 1u;
    density_tables[before].y = density;
}
