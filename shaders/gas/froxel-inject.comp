#version 450

#pragma variants DENSITY=functions,trilinear,tricubic,cached

// Extinction, and the light that an element sends to the eye times it (section "Illumination of gaseous phenomena"), of
// each froxel: the mean of as many samples along its middle as an increment has, in the middles of their parts. Shadows are the
// table's.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/loops.glsl"
#include "gas/volumes-several.glsl"
#include "gas/density-{DENSITY}.glsl"
#include "gas/volume-density.glsl"
#include "gas/lights-several.glsl"
#include "gas/shadow-table.glsl"
#include "gas/scattering.glsl"
#include "gas/froxels.glsl"

layout(set = 0, binding = 20, std430) buffer Unfinished {
    uint unfinished[4];
    uint stuck[4]; // 1 where a dispatch got no further, see progress.glsl
};

layout(set = 0, binding = 31, rgba32f) uniform writeonly image3D froxel_light;

const uint VOLUME = 1u;

void main() {
    uvec3 froxel = gl_GlobalInvocationID;
    if (froxel.x >= counts.froxel_columns || froxel.y >= counts.froxel_rows || froxel.z >= counts.froxel_slices) {
        return;
    }
    read_counts();
    read_volumes();
    read_lights();
    vec3 ray = column_ray(froxel.xy);
    vec3 direction = normalize(ray);
    vec3 side = normalize(cross(direction, abs(direction.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    Frames frames = Frames(direction, side, cross(side, direction));
    float near_m = slice_border(froxel.z);
    float far_m = slice_border(froxel.z + 1u);
    vec4 sum = vec4(0.0);
    uint i = 0u;
    do {
        vec3 point = frame.eye + ray * mix(near_m, far_m, (float(i) + 0.5) / float(counts.samples));
        float densities[MAX_VOLUMES];
        float previous[MAX_VOLUMES];
        float asides[MAX_VOLUMES];
        float aboves[MAX_VOLUMES];
        float extinction = 0.0;
        float densest = 0.0;
        float apart = 1.0e30; // of the densities by which a solid's normal is found
        // At the point, and for solids behind it, beside it and above it.
        uint places = 1u;
        uint at = 0u;
        do {
            uint v = 0u;
            for (; v < volume_count; v++) {
                take_volume(v);
                bool is_wanted = true;
                if (at > 0u) {
                    is_wanted = densities[v] > 0.0 && in_hand.is_solid != 0u;
                }
                if (is_wanted) {
                    vec3 offset = vec3(0.0);
                    if (at == 1u) {
                        offset = -direction * apart;
                    } else if (at > 1u) {
                        offset = (at == 2u ? frames.side : frames.up) * (0.25 * in_hand.step_m);
                    }
                    float density = volume_density(point + offset);
                    if (at == 0u) {
                        densities[v] = density;
                        densest = max(densest, density);
                        extinction += in_hand.tau_per_m * density;
                        if (density > 0.0) {
                            apart = min(apart, 0.25 * in_hand.step_m);
                            places = in_hand.is_solid != 0u ? 4u : places;
                        }
                    } else if (at == 1u) {
                        previous[v] = density;
                    } else if (at == 2u) {
                        asides[v] = density;
                    } else {
                        aboves[v] = density;
                    }
                }
            }
            is_cut = is_cut || v < volume_count;
            at++;
        } while (at < places);
        is_cut = is_cut || at < places;
        if (extinction > 0.0) {
            vec3 emission = emission_at(point, frames, densest, apart, densities, previous, asides, aboves);
            sum += vec4(emission, extinction);
        }
        i++;
    } while (i < counts.samples);
    if (is_cut || i < counts.samples) {
        stuck[VOLUME] = 1u;
    }
    imageStore(froxel_light, ivec3(froxel), sum / float(counts.samples));
}
