#version 450
#pragma variants SHADOW=off,on

// The triangles of the refined water that do not land whole on one surface (section 6.3): divided down to rays, each of which lands
// on a texel's area with its share of the triangle's flux.

layout(local_size_x = 64) in;

#include "caustics/hit.glsl"
#include "caustics/hit-sums.glsl"
#include "caustics/water-triangle.glsl"
#include "caustics/shadow-{SHADOW}.glsl"

// Rays for each texel of the triangle's place, and at the most; a shader's loops together end at 65,535 on some devices.
const float RAYS_A_TEXEL = 4.0;
const uint MOST_RAYS = 224u;
// Farther apart in height, neighbouring texels are of two surfaces.
const float SAME_SURFACE_TEXELS = 8.0;
// Invocations that share a triangle's rays, and triangles that they take one after the other at the most.
const uint SHARING = 8u;
const uint IN_TURN = 16u;

// A ray's light over a texel's area around it, on those texels of it that hold the same surface.
void spread(vec4 hit, float light) {
    ivec2 own = ivec2(floor(hit.xy));
    float height = height_at(own);
    float reach = SAME_SURFACE_TEXELS * sqrt(plane.texel_area_m2);
    ivec2 first = ivec2(floor(hit.xy - 0.5));
    vec2 t = hit.xy - 0.5 - vec2(first);
    float sum = 0.0;
    for (int turn = 0; turn < 8; turn++) {
        // The shares are summed up first, then handed out.
        ivec2 aside = ivec2(turn & 1, (turn >> 1) & 1);
        ivec2 texel = first + aside;
        vec2 share = mix(1.0 - t, t, vec2(aside));
        bool counts = is_in_map(texel) && (texel == own || abs(height_at(texel) - height) < reach);
        float weight = counts ? share.x * share.y : 0.0;
        if (turn < 4) {
            sum += weight;
        } else if (weight > 0.0) {
            add_light(texel, light * weight / sum);
        }
    }
}

void main() {
    uint group = gl_GlobalInvocationID.x / SHARING;
    uint groups = (plane.triangles + IN_TURN - 1u) / IN_TURN;
    if (group >= groups) {
        return;
    }
    uint listed = straddling.list[0];
    for (uint at = group; at < listed; at += groups) {
        uint triangle = straddling.list[at + 1u];
        Ray a = rays.list[indices.list[3u * triangle]];
        Ray b = rays.list[indices.list[3u * triangle + 1u]];
        Ray c = rays.list[indices.list[3u * triangle + 2u]];
        vec2 place = place_at(a.origin, a.slope, 0.0);
        vec2 to_b = place_at(b.origin, b.slope, 0.0) - place;
        vec2 to_c = place_at(c.origin, c.slope, 0.0) - place;
        float area = 0.5 * abs(to_b.x * to_c.y - to_b.y * to_c.x);
        float longest = sqrt(max(dot(to_b, to_b), max(dot(to_c, to_c), dot(to_c - to_b, to_c - to_b))));
        uint count = SHARING * min(uint(RAYS_A_TEXEL * max(area, longest)) / SHARING + 1u, MOST_RAYS / SHARING);
        vec3 face = face_of(a, b, c) / float(count);
        for (uint i = gl_GlobalInvocationID.x % SHARING; i < count; i += SHARING) {
            vec2 share = fract(0.5 + float(i) * vec2(0.7548777, 0.5698403));
            share = share.x + share.y > 1.0 ? 1.0 - share : share;
            vec3 weights = vec3(1.0 - share.x - share.y, share);
            vec3 origin = a.origin * weights.x + b.origin * weights.y + c.origin * weights.z;
            vec2 slope = a.slope * weights.x + b.slope * weights.y + c.slope * weights.z;
            float secant = a.secant * weights.x + b.secant * weights.y + c.secant * weights.z;
            vec3 incident = a.incident * weights.x + b.incident * weights.y + c.incident * weights.z;
            vec4 hit = first_hit(origin, slope);
            ivec2 own = ivec2(floor(hit.xy));
            if (hit.w > 0.0 && is_in_map(own)) {
                vec2 landing = (hit.xy - 0.5 * float(plane.map_size)) / plane.texels_per_m + plane.center;
                if (is_receiver(height_at(own)) && reaches(vec3(landing.x, hit.z + plane.middle, landing.y), origin)) {
                    spread(hit, max(-dot(face, incident), 0.0) * landed_weight(hit, origin, slope, secant));
                }
            }
        }
    }
}
