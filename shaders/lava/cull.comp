#version 450

#pragma variants TURNED=kept,culled

// Culling (chapter 9): one invocation has a cluster. A cluster whose box lies beyond a side of the picture is left out whole; of another
// each splat's square is held against those sides, as clipping would. With TURNED_CULLED a splat that is turned away goes as well where
// the surface hides it by more than epsilon: a level sheet has no back, and what is turned away at an outline is blended with the front.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 32) in;

#include "common/elements.glsl"
#include "lava/scene.glsl"
#include "lava/surface.glsl"
#include "lava/cull.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Places {
    vec2 list[]; // of the splats along x and z, metres
} places;

layout(set = 0, binding = 3, std430) buffer Kept {
    uvec4 list[]; // of each cluster: a bit for each splat that stays; their count; 1 where any splat was looked at
} kept;

// Left to rounding, of a distance.
const float SLACK = 1.0e-4;
const uint ALL_SIDES = 63u;
// Corners of a splat's square lie so far from its middle along an axis, in radii.
const float DIAGONAL = 1.41422;

// The sides of the clip volume that a point lies beyond, a bit for each.
uint sides_beyond(vec3 place_m) {
    vec4 clip = scene.view_projection * vec4(place_m, 1.0);
    float slack = SLACK * (abs(clip.w) + scene.space_m.x + scene.space_m.y + scene.space_m.z);
    uint sides = clip.x > clip.w + slack ? 1u : 0u;
    sides |= -clip.x > clip.w + slack ? 2u : 0u;
    sides |= clip.y > clip.w + slack ? 4u : 0u;
    sides |= -clip.y > clip.w + slack ? 8u : 0u;
    sides |= clip.z > clip.w + slack ? 16u : 0u;
    sides |= clip.z < -slack ? 32u : 0u;
    return sides;
}

// A cluster is a stretch of a row, or of several rows with all of their splats; the surface lies inside the space.
bool is_cluster_beyond(vec2 from_m, vec2 to_m) {
    bool is_row = from_m.y == to_m.y;
    vec2 along_m = is_row ? vec2(from_m.x, to_m.x) : vec2(0.0, scene.space_m.x);
    float across_m = DIAGONAL * scene.splat_radius_m;
    // Up and down by both slopes.
    vec3 reach_m = vec3(across_m, across_m * mix(1.0, DIAGONAL / STEEPEST, scene.fitted), across_m);
    vec3 low_m = vec3(along_m.x, 0.0, from_m.y) - reach_m;
    vec3 high_m = vec3(along_m.y, scene.space_m.y, to_m.y) + reach_m;
    uint sides = ALL_SIDES;
    for (uint corner = 0u; corner < 8u; corner++) {
        vec3 at = vec3(float(corner & 1u), float((corner >> 1u) & 1u), float(corner >> 2u));
        sides &= sides_beyond(mix(low_m, high_m, at));
    }
    return sides != 0u;
}

vec3 corner_at(Splat splat, uint corner) {
    return corner_of(splat, vec2(float(corner & 1u), float(corner >> 1u)) * 2.0 - 1.0);
}

bool is_splat_beyond(Splat splat) {
    uint sides = ALL_SIDES;
    for (uint corner = 0u; corner < 4u; corner++) {
        sides &= sides_beyond(corner_at(splat, corner));
    }
    return sides != 0u;
}

#ifdef TURNED_CULLED
float height_m(vec2 place_m) {
    vec2 column = place_m / scene.space_m.xz * scene.columns - 0.5;
    vec2 base = floor(column);
    vec2 fraction = column - base;
    float near_row = mix(texel_at(base).w, texel_at(base + vec2(1.0, 0.0)).w, fraction.x);
    float far_row = mix(texel_at(base + vec2(0.0, 1.0)).w, texel_at(base + vec2(1.0, 1.0)).w, fraction.x);
    return mix(near_row, far_row, fraction.y);
}

bool is_inside(vec2 place_m) {
    vec2 clamped_m = clamp(place_m, vec2(0.0), scene.space_m.xz);
    return place_m.x == clamped_m.x && place_m.y == clamped_m.y;
}

// The way from a place inside to the eye, as a share of it, until it leaves the space.
float way_out(vec3 place_m, vec3 to_eye_m) {
    vec2 side_m = mix(vec2(0.0), scene.space_m.xz, step(vec2(0.0), to_eye_m.xz));
    vec2 way_m = max(abs(to_eye_m.xz), vec2(1.0e-6));
    vec2 shares = abs(side_m - place_m.xz) / way_m;
    return min(min(shares.x, shares.y), 1.0);
}

// The surface lies between a place and the eye, nearer by more than epsilon: the ray is under it there and above it farther on.
bool is_hidden(vec3 place_m, float margin_m) {
    float depth_m = (scene.view_projection * vec4(place_m, 1.0)).w;
    float share = (scene.epsilon_m + margin_m) / max(depth_m, 1.0e-6);
    vec3 nearer_m = mix(place_m, cull.eye_m, share);
    if (depth_m <= 0.0 || share >= 1.0 || !is_inside(place_m.xz) || !is_inside(nearer_m.xz)) {
        return false;
    }
    vec3 to_eye_m = cull.eye_m - nearer_m;
    vec3 leaving_m = nearer_m + way_out(nearer_m, to_eye_m) * to_eye_m;
    return nearer_m.y < height_m(nearer_m.xz) - margin_m && leaving_m.y > height_m(leaving_m.xz) + margin_m;
}

bool is_turned_away(Splat splat) {
    vec3 normal = cross(splat.tangent, splat.binormal);
    if (dot(normal, cull.eye_m - splat.center_m) >= 0.0) {
        return false;
    }
    float margin_m = scene.splat_radius_m * (length(splat.tangent) + length(splat.binormal));
    bool is_all_hidden = true;
    for (uint corner = 0u; corner < 4u; corner++) {
        is_all_hidden = is_all_hidden && is_hidden(corner_at(splat, corner), margin_m);
    }
    return is_all_hidden;
}
#else
bool is_turned_away(Splat splat) {
    return false;
}
#endif

void main() {
    uint cluster = element(32u);
    if (cluster >= cull.clusters) {
        return;
    }
    uint first = cluster * CLUSTER;
    uint end = min(first + CLUSTER, cull.splats);
    if (is_cluster_beyond(places.list[first], places.list[end - 1u])) {
        kept.list[cluster] = uvec4(0u);
        return;
    }
    uvec2 bits = uvec2(0u);
    uint count = 0u;
    for (uint at = first; at < end; at++) {
        Splat splat = splat_at(places.list[at]);
        if (!is_splat_beyond(splat) && !is_turned_away(splat)) {
            uint bit = 1u << (at & 31u);
            bits |= at - first < 32u ? uvec2(bit, 0u) : uvec2(0u, bit);
            count += 1u;
        }
    }
    kept.list[cluster] = uvec4(bits, count, 1u);
}
